// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/fault_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace servogate::gateway::command {

namespace {

using Input = mock::DriveSwitch::Input;

std::string quoted(std::string_view word, std::string_view english, std::string_view russian) {
  return text::both("'" + std::string(word) + "' " + std::string(english),
                    "«" + std::string(word) + "» " + std::string(russian));
}

/// A whole number, decimal or 0x.
std::optional<std::int64_t> whole(std::string_view text) {
  const bool minus = text.starts_with('-');
  if (minus) text.remove_prefix(1);
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::int64_t value = 0;
  const auto [end, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return minus ? -value : value;
}

std::optional<double> real(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

/// Seconds, or milliseconds with their unit.
std::optional<image::Nanoseconds> duration(std::string_view text) {
  double scale = 1e9;
  if (text.ends_with("us")) scale = 1e3;
  if (text.ends_with("ms")) scale = 1e6;
  if (scale != 1e9)
    text.remove_suffix(2);
  else if (text.ends_with('s'))
    text.remove_suffix(1);
  const auto value = real(text);
  if (!value || *value < 0.0 || *value > 1e9) return std::nullopt;
  return std::llround(*value * scale);
}

struct State {
  std::string_view name;
  image::DriveState state;
};
constexpr State kStates[] = {{"not_ready_to_switch_on", image::DriveState::not_ready_to_switch_on},
                             {"switch_on_disabled", image::DriveState::switch_on_disabled},
                             {"ready_to_switch_on", image::DriveState::ready_to_switch_on},
                             {"switched_on", image::DriveState::switched_on},
                             {"operation_enabled", image::DriveState::operation_enabled},
                             {"quick_stop_active", image::DriveState::quick_stop_active},
                             {"fault", image::DriveState::fault}};

struct InputName {
  std::string_view name;
  Input input;
};
constexpr InputName kInputs[] = {{"negative_limit", Input::negative_limit},
                                 {"positive_limit", Input::positive_limit},
                                 {"home", Input::home},
                                 {"probe_1", Input::probe_1},
                                 {"probe_2", Input::probe_2}};

template <class Table>
auto find_in(const Table& table, std::string_view name) -> decltype(&table[0]) {
  const auto found =
      std::find_if(std::begin(table), std::end(table), [&](const auto& row) { return row.name == name; });
  return found == std::end(table) ? nullptr : found;
}

template <class Table>
std::string names_of(const Table& table) {
  std::string list;
  for (const auto& row : table) list += (list.empty() ? "" : ", ") + std::string(row.name);
  return list;
}

bool set_duration(std::string_view text, image::Nanoseconds& out) {
  const auto value = duration(text);
  if (value) out = *value;
  return value.has_value();
}

template <class T>
bool set_whole(std::string_view text, std::int64_t min, std::int64_t max, T& out) {
  const auto value = whole(text);
  if (!value || *value < min || *value > max) return false;
  out = static_cast<T>(*value);
  return true;
}

/// KEY=VALUE of a fault. Which kind uses which key says DriveFault.
struct Key {
  std::string_view name;
  bool (*set)(std::string_view value, DriveDeed& deed);
};
constexpr std::int64_t kMost32 = 0xFFFF'FFFF;
constexpr Key kKeys[] = {
    {"node", [](std::string_view v, DriveDeed& d) { return set_whole(v, 1, 127, d.node); }},
    {"at", [](std::string_view v, DriveDeed& d) { return set_duration(v, d.at); }},
    {"for", [](std::string_view v, DriveDeed& d) { return set_duration(v, d.fault.duration_ns); }},
    {"delay", [](std::string_view v, DriveDeed& d) { return set_duration(v, d.fault.delay_ns); }},
    {"number", [](std::string_view v, DriveDeed& d) { return set_whole(v, 1, 4, d.fault.number); }},
    {"every", [](std::string_view v, DriveDeed& d) { return set_whole(v, 1, kMost32, d.fault.every); }},
    {"value",
     [](std::string_view v, DriveDeed& d) { return set_whole(v, INT64_MIN, INT64_MAX, d.fault.value); }},
    {"code", [](std::string_view v, DriveDeed& d) { return set_whole(v, 1, 0xFFFF, d.fault.error_code); }},
    {"index", [](std::string_view v, DriveDeed& d) { return set_whole(v, 0, 0xFFFF, d.fault.index); }},
    {"abort", [](std::string_view v, DriveDeed& d) { return set_whole(v, 1, kMost32, d.fault.abort); }},
    {"state",
     [](std::string_view v, DriveDeed& d) {
       const State* row = find_in(kStates, v);
       if (row != nullptr) d.fault.state = row->state;
       return row != nullptr;
     }},
};

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r", at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    at = end;
  }
  return words;
}

/// A fault by its name; dashes do for underscores.
std::optional<mock::DriveFaultKind> kind_of(std::string_view word) {
  std::string name(word);
  std::replace(name.begin(), name.end(), '-', '_');
  return mock::drive_fault_kind(name);
}

/// What stands before the keys; false: `why`.
bool read_head(const std::vector<std::string_view>& plain, DriveDeed& deed, std::string& why) {
  const std::string_view verb = plain.front();
  const std::size_t given = plain.size() - 1;
  const auto wrong = [&why](std::string message) {
    why = std::move(message);
    return false;
  };
  std::size_t wanted = 0;
  if (verb == "status") {
    deed.kind = DriveDeed::Kind::status;
  } else if (verb == "load") {
    deed.kind = DriveDeed::Kind::load;
    wanted = 1;
    const auto nm = given > 0 ? real(plain[1]) : std::nullopt;
    if (!nm) return wrong(quoted(verb, "needs a torque in N m", "требует момент в Н·м"));
    deed.load_nm = *nm;
  } else if (verb == "input") {
    deed.kind = DriveDeed::Kind::input;
    wanted = 2;
    const InputName* row = given > 0 ? find_in(kInputs, plain[1]) : nullptr;
    if (row == nullptr || given < 2 || (plain[2] != "on" && plain[2] != "off"))
      return wrong(quoted(verb, "needs one of " + names_of(kInputs) + ", and on or off",
                          "требует один из входов " + names_of(kInputs) + " и on или off"));
    deed.input = row->input;
    deed.on = plain[2] == "on";
  } else {
    const bool clear = verb == "clear";
    wanted = clear && given > 0 ? 1 : 0;
    deed.kind =
        clear ? (given > 0 ? DriveDeed::Kind::clear : DriveDeed::Kind::clear_all) : DriveDeed::Kind::fault;
    const std::string_view name = clear && given > 0 ? plain[1] : verb;
    const auto kind = kind_of(name);
    if (!kind && deed.kind != DriveDeed::Kind::clear_all)
      return wrong(
          quoted(name, "is no fault; known: " + fault_names(), "— не отказ; известны: " + fault_names()));
    if (kind) deed.fault.kind = *kind;
  }
  return given <= wanted || wrong(quoted(plain[wanted + 1], "is too much", "лишнее"));
}

}  // namespace

std::string fault_names() {
  std::string list;
  for (int i = 0; i <= static_cast<int>(mock::DriveFaultKind::reset); ++i)
    list += (list.empty() ? "" : ", ") + std::string(mock::name_of(static_cast<mock::DriveFaultKind>(i)));
  return list;
}

std::optional<mock::DriveSwitch::Input> drive_input(std::string_view name) {
  const InputName* row = find_in(kInputs, name);
  return row != nullptr ? std::optional(row->input) : std::nullopt;
}

std::string drive_input_names() { return names_of(kInputs); }

std::optional<DriveDeed> parse_deed(std::string_view line, std::string& why) {
  DriveDeed deed;
  std::vector<std::string_view> plain;
  for (const std::string_view word : words_of(line)) {
    deed.words += (deed.words.empty() ? "" : " ") + std::string(word);
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) {
      plain.push_back(word);
      continue;
    }
    const Key* key = find_in(kKeys, word.substr(0, equals));
    if (key == nullptr) {
      why = quoted(word.substr(0, equals), "is not known; known: " + names_of(kKeys),
                   "неизвестно; известны: " + names_of(kKeys));
      return std::nullopt;
    }
    if (!key->set(word.substr(equals + 1), deed)) {
      why = quoted(word, "is out of range, or no value of its kind", "вне пределов или не того вида");
      return std::nullopt;
    }
  }
  if (plain.empty()) {
    why = text::both("a fault is missing", "не назван отказ");
    return std::nullopt;
  }
  if (!read_head(plain, deed, why)) return std::nullopt;
  return deed;
}

std::optional<std::vector<DriveDeed>> parse_script(std::string_view text, int& number, std::string& why) {
  std::vector<DriveDeed> deeds;
  for (number = 0; !text.empty();) {
    ++number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line = line.substr(0, line.find('#'));
    const auto words = words_of(line);
    if (words.empty()) continue;
    const auto at = duration(words.front());
    if (!at) {
      why = quoted(words.front(), "is no time in seconds", "— не время в секундах");
      return std::nullopt;
    }
    const auto behind = static_cast<std::size_t>(words.front().data() - line.data()) + words.front().size();
    auto deed = parse_deed(line.substr(behind), why);
    if (!deed) return std::nullopt;
    deed->at = *at;
    deeds.push_back(std::move(*deed));
  }
  std::stable_sort(deeds.begin(), deeds.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  return deeds;
}

}  // namespace servogate::gateway::command
