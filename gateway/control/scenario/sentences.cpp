// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/scenario/sentences.hpp"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

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

std::string both(const text::Entry& entry, const std::vector<std::string>& arguments) {
  return text::both(text::render(entry, arguments, text::Language::english),
                    text::render(entry, arguments, text::Language::russian));
}

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
    if (word_ == "ready") return none() ? deeds({sentence::Ready{}}) : std::nullopt;
    if (word_ == "fall_silent") return none() ? deeds({sentence::FallSilent{}}) : std::nullopt;
    if (word_ == "wait") return wait();
    if (word_ == "press") return press();
    if (word_ == "handwheel") return handwheel();
    if (word_ == "run") return run();
    return request();
  }

 private:
  static std::optional<std::vector<Deed>> deeds(std::vector<Deed> list) { return list; }
  std::nullopt_t takes(const char* what) {
    why_ = both(kTakes, {word_, what});
    return std::nullopt;
  }
  bool none() {
    if (!rest_.empty()) takes("-");
    return rest_.empty();
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
      constexpr std::string_view kAlone[] = {"start", "step",       "hold",  "resume",     "return",
                                             "stop",  "quick_stop", "reset", "acknowledge"};
      for (const std::string_view alone : kAlone)
        if (alone == word_ && !none()) return std::nullopt;
      good = add_words(r, rest_, problem);
    }
    if (good)
      if (auto read = read_request(r.dump(), problem)) return deeds({std::move(read->command)});
    why_ = both(*problem.entry, problem.arguments);
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
    why = both(*problem.entry, problem.arguments);
    return std::nullopt;
  }
  auto words = split(what.words);
  if (!words || words->empty()) {
    why = both(kQuote, {what.words});
    return std::nullopt;
  }
  return Sentence(std::move(*words), what.folder, why).read();
}

}  // namespace servogate::gateway
