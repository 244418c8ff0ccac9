// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/simulated/fault_line.hpp"

#include <algorithm>
#include <iterator>

namespace servogate::gateway::command {

namespace {

using Input = mock::DriveSwitch::Input;

std::string quoted(std::string_view word, std::string_view english, std::string_view russian) {
  return text::both("'" + std::string(word) + "' " + std::string(english),
                    "«" + std::string(word) + "» " + std::string(russian));
}

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

/// KEY=VALUE: whose and when, or a parameter of the fault. False: `why`.
bool read_pair(std::string_view key, std::string_view value, DriveDeed& deed, unsigned& given,
               std::string& why) {
  const auto spoilt = [&] {
    why = quoted(std::string(key) + "=" + std::string(value), "is out of range, or no value of its kind",
                 "вне пределов или не того вида");
    return false;
  };
  if (key == "node") {
    const auto node = fault::read_whole(value, 1, 127);
    deed.node = static_cast<int>(node.value_or(0));
    return node.has_value() || spoilt();
  }
  if (key == "device") {
    deed.device = value;
    return !value.empty() || spoilt();
  }
  if (key == "at") {
    const auto at = fault::read_time(value);
    deed.at = at.value_or(0);
    return at.has_value() || spoilt();
  }
  const fault::ParameterRow* parameter = fault::find_parameter(key);
  if (parameter == nullptr) {
    const std::string known = "node, device, at, " + fault::parameter_names();
    why = quoted(key, "is not known; known: " + known, "неизвестно; известны: " + known);
    return false;
  }
  given |= 1u << static_cast<unsigned>(parameter->parameter);
  return parameter->set(value, deed.fault) || spoilt();
}

/// A fault takes what its row says. False: `why`.
bool fits(const DriveDeed& deed, unsigned given, std::string& why) {
  const unsigned taken = deed.kind == DriveDeed::Kind::fault ? fault::row(deed.fault.kind).parameters : 0;
  for (const fault::ParameterRow& p : fault::parameters()) {
    if ((given & ~taken & 1u << static_cast<unsigned>(p.parameter)) == 0) continue;
    why = quoted(p.name, "means nothing to this", "здесь ничего не значит");
    return false;
  }
  return true;
}

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
    const auto nm = given > 0 ? fault::read_number(plain[1]) : std::nullopt;
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
    const fault::KindRow* row = fault::find_kind(name);
    const unsigned meant = deed.device.empty() ? static_cast<unsigned>(fault::Device::drive) : ~0u;
    const bool known = row != nullptr && (row->devices & meant) != 0;
    if (!known && deed.kind != DriveDeed::Kind::clear_all) {
      const std::string names = fault::names_for(meant);
      return wrong(quoted(name, "is no fault; known: " + names, "— не отказ; известны: " + names));
    }
    if (known) deed.fault.kind = row->kind;
  }
  return given <= wanted || wrong(quoted(plain[wanted + 1], "is too much", "лишнее"));
}

}  // namespace

std::optional<mock::DriveSwitch::Input> drive_input(std::string_view name) {
  const InputName* row = find_in(kInputs, name);
  return row != nullptr ? std::optional(row->input) : std::nullopt;
}

std::string drive_input_names() { return names_of(kInputs); }

std::optional<DriveDeed> parse_deed(std::string_view line, std::string& why) {
  DriveDeed deed;
  std::vector<std::string_view> plain;
  unsigned given = 0;
  for (const std::string_view word : words_of(line)) {
    deed.words += (deed.words.empty() ? "" : " ") + std::string(word);
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) {
      plain.push_back(word);
      continue;
    }
    if (!read_pair(word.substr(0, equals), word.substr(equals + 1), deed, given, why)) return std::nullopt;
  }
  if (plain.empty()) {
    why = text::both("a fault is missing", "не назван отказ");
    return std::nullopt;
  }
  if (!read_head(plain, deed, why) || !fits(deed, given, why)) return std::nullopt;
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
    const auto at = fault::read_time(words.front());
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
