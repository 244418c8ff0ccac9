// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/scenario/sentences.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bench/scenario/reading/keys.hpp"
#include "firmware_if/text/in_both.hpp"
#include "gateway/control/server/protocol/request_form.hpp"
#include "gateway/control/server/protocol/request_words.hpp"
#include "machine/keys/units.hpp"

namespace servogate::gateway {

namespace {

using nlohmann::json;

const text::Entry kTakes{"scenario.takes", "`{0}` takes: {1}", "`{0}` принимает: {1}"};
const text::Entry kQuote{"scenario.quote", "a quotation mark of `{0}` is not closed",
                         "в `{0}` не закрыта кавычка"};

constexpr image::Nanoseconds kPressed = 100 * image::kMillisecond;

/// Words between spaces; what stands between quotation marks is one.
std::optional<std::vector<std::string>> split(const std::string& sentence) {
  std::vector<std::string> words;
  char quote = 0;
  bool inside = false;
  for (const char c : sentence) {
    if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        words.back() += c;
    } else if (c == ' ' || c == '\t') {
      inside = false;
    } else {
      if (!inside) words.emplace_back();
      inside = true;
      if (c == '"' || c == '\'')
        quote = c;
      else
        words.back() += c;
    }
  }
  return quote == 0 ? std::optional(std::move(words)) : std::nullopt;
}

/// The words from `first` on as one: "+5", "mm" is "+5mm".
void join_from(std::vector<std::string>& words, std::size_t first) {
  while (words.size() > first + 1) {
    words[first] += words[first + 1];
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(first) + 1);
  }
}

json to_json(const machine::Element& e) {
  using Kind = machine::Element::Kind;
  switch (e.kind) {
    case Kind::boolean:
      return e.boolean;
    case Kind::integer:
      return e.integer;
    case Kind::real:
      return e.real;
    case Kind::array: {
      json list = json::array();
      for (const machine::Element& child : e.children) list.push_back(to_json(child));
      return list;
    }
    case Kind::table: {
      json object = json::object();
      for (const machine::Element& child : e.children) object[child.key] = to_json(child);
      return object;
    }
    default:
      return e.string;
  }
}

std::string from_folder(const std::string& path, const std::string& folder) {
  const std::filesystem::path p(path);
  return p.is_absolute()
             ? path
             : std::filesystem::absolute(std::filesystem::path(folder) / p).lexically_normal().string();
}

class Sentence {
 public:
  Sentence(std::vector<std::string> words, const std::string& folder, std::string& why)
      : word_(words.front()), folder_(folder), why_(why) {
    words.erase(words.begin());
    rest_ = std::move(words);
  }

  std::optional<std::vector<Deed>> read() {
    if (takes_none() && !rest_.empty()) return takes("-");
    if (word_ == "ready") return deeds({sentence::Ready{}});
    if (word_ == "fall_silent") return deeds({sentence::FallSilent{}});
    if (word_ == "wait") return wait();
    if (word_ == "press") return press();
    if (word_ == "handwheel") return handwheel();
    if (word_ == "run") return run();
    return request();
  }

 private:
  static std::optional<std::vector<Deed>> deeds(std::vector<Deed> list) { return list; }
  std::nullopt_t takes(const char* what) {
    why_ = text::in_both(kTakes, {word_, what});
    return std::nullopt;
  }
  /// As the table of the words has it.
  bool takes_none() const {
    const auto known = scenario::words();
    return std::any_of(known.begin(), known.end(),
                       [&](const scenario::WordRow& w) { return w.name == word_ && w.arguments.empty(); });
  }
  static std::optional<image::Nanoseconds> time(const std::string& words) {
    const auto read = machine::parse_quantity(words, machine::Unit::second, machine::AxisUnits::either);
    if (read.error != machine::QuantityError::none || read.value < 0.0 || read.value > 1e6)
      return std::nullopt;
    return static_cast<image::Nanoseconds>(std::llround(read.value * 1e9));
  }
  std::optional<std::vector<Deed>> wait() {
    join_from(rest_, 0);
    const auto t = rest_.empty() ? std::nullopt : time(rest_[0]);
    if (!t) return takes("TIME (200 ms)");
    return deeds({sentence::Wait{*t}});
  }
  std::optional<std::vector<Deed>> press() {
    join_from(rest_, 1);
    if (rest_.empty()) return takes("POINT [TIME]");
    const auto t = rest_.size() > 1 ? time(rest_[1]) : std::optional(kPressed);
    if (!t) return takes("POINT [TIME (200 ms)]");
    return deeds({sentence::Press{rest_[0], *t}});
  }
  std::optional<std::vector<Deed>> handwheel() {
    double counts = 0.0;
    std::string_view behind;
    if (rest_.size() != 2 || !parse_number(rest_[1], counts, behind) || !behind.empty())
      return takes("POINT +20");
    return deeds({sentence::Handwheel{rest_[0], counts}});
  }
  std::optional<std::vector<Deed>> run() {
    word_ = "load";
    auto load = request();
    if (load) load->push_back(ask::Command(ask::Start{}));
    return load;
  }

  /// What a client of the control asks.
  std::optional<std::vector<Deed>> request() {
    json r{{"cmd", word_}, {"asker", "scenario"}};
    FormProblem problem;
    bool good = true;
    if (word_ == "load") {
      if (rest_.size() != 1) return takes("PROGRAM");
      r["program"] = from_folder(rest_[0], folder_);
    } else if (word_ == "write") {
      std::string_view behind;
      double value = 0.0;
      if (rest_.size() != 2 || !parse_number(rest_[1], value, behind) || !behind.empty())
        return takes("PLACE NUMBER");
      return deeds({ask::Command(ask::SetPlace{rest_[0], value})});
    } else if (word_ == "force") {
      if (rest_.size() != 2) return takes("NAME VALUE");
      r["cmd"] = "plc_force", r["name"] = rest_[0], r["value"] = rest_[1];
    } else if (word_ == "release") {
      if (rest_.size() > 1) return takes("[NAME]");
      r["cmd"] = "plc_release", r["name"] = rest_.empty() ? "" : rest_[0];
    } else if (word_ == "jog_stop") {
      if (rest_.size() > 1) return takes("[AXIS]");
      if (!rest_.empty()) r["axis"] = rest_[0];
    } else if (word_ == "assign") {
      if (rest_.size() != 2) return takes("AXIS PROCESS");
      double number = 0.0;
      std::string_view behind;
      if (!parse_number(rest_[1], number, behind) || !behind.empty()) return takes("AXIS PROCESS");
      r["process"] = static_cast<int>(number);
      rest_.pop_back();
      good = add_words(r, rest_, problem);
    } else {
      if (word_ == "set") r["cmd"] = "input";
      if (word_ == "jog" || word_ == "zero") join_from(rest_, 1);
      if (word_ == "override") join_from(rest_, 0);
      good = add_words(r, rest_, problem);
    }
    if (good)
      if (auto read = read_request(r.dump(), problem)) return deeds({std::move(read->command)});
    why_ = text::in_both(*problem.entry, problem.arguments);
    return std::nullopt;
  }

  std::string word_;
  std::vector<std::string> rest_;
  const std::string& folder_;
  std::string& why_;
};

}  // namespace

std::optional<std::vector<Deed>> read_sentence(const scenario::Do& what, std::string& why) {
  if (what.command) {
    json r = to_json(*what.command);
    r["asker"] = "scenario";
    if (r.contains("program") && r["program"].is_string())
      r["program"] = from_folder(r["program"], what.folder);
    if (r.contains("file") && r["file"].is_string()) r["file"] = from_folder(r["file"], what.folder);
    FormProblem problem;
    if (auto read = read_request(r.dump(), problem)) return std::vector<Deed>{std::move(read->command)};
    why = text::in_both(*problem.entry, problem.arguments);
    return std::nullopt;
  }
  auto words = split(what.words);
  if (!words || words->empty()) {
    why = text::in_both(kQuote, {what.words});
    return std::nullopt;
  }
  return Sentence(std::move(*words), what.folder, why).read();
}

}  // namespace servogate::gateway
