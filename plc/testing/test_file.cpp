// SPDX-License-Identifier: Apache-2.0
#include "plc/testing/test_file.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "firmware_if/text/nearest.hpp"
#include "plc/syntax/time_literal.hpp"
#include "plc/testing/texts.hpp"
#include "plc/types/type.hpp"

namespace servogate::plc::testing {

namespace {

constexpr image::Nanoseconds kLongest = 24 * 3600 * image::kSecond;
constexpr std::int64_t kMostScans = 1'000'000'000;

const std::vector<std::string>& words_of_a_test() {
  static const std::vector<std::string> words{"set", "hold", "release", "run", "expect", "until"};
  return words;
}
const std::vector<std::string>& words_of_a_file() {
  static const std::vector<std::string> words{"machine", "source", "cycle", "before", "test"};
  return words;
}

/// One line with a place that moves on.
class Line {
 public:
  Line(std::string_view text, int number) : text_(text), number_(number) {}

  bool done() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    return at_ >= text_.size();
  }
  Word here(std::size_t length = 0) {
    done();
    return {std::string(text_.substr(at_, length)), number_, static_cast<int>(at_) + 1};
  }
  /// Letters up to a blank or a sign of comparison; brackets keep together what is inside.
  Word word() {
    done();
    std::size_t end = at_;
    int depth = 0;
    while (end < text_.size()) {
      const char c = text_[end];
      if (depth == 0 &&
          (std::isspace(static_cast<unsigned char>(c)) != 0 || c == '=' || c == '<' || c == '>' || c == ','))
        break;
      depth += c == '[' ? 1 : c == ']' ? -1 : 0;
      ++end;
    }
    return take(end);
  }
  /// A value: quoted text, or everything up to a comma, `within` or `+-`.
  Word value() {
    done();
    std::size_t end = at_;
    if (end < text_.size() && (text_[end] == '\'' || text_[end] == '"')) {
      const char quote = text_[end++];
      while (end < text_.size() && text_[end] != quote) end += text_[end] == '$' ? 2 : 1;
      return take(std::min(end + 1, text_.size()));
    }
    while (end < text_.size() && text_[end] != ',' && !text_.substr(end).starts_with(" within ") &&
           !text_.substr(end).starts_with("+-"))
      ++end;
    while (end > at_ && std::isspace(static_cast<unsigned char>(text_[end - 1])) != 0) --end;
    return take(end);
  }
  Word rest() {
    done();
    return take(text_.size());
  }
  bool eat(std::string_view sign) {
    done();
    if (!text_.substr(at_).starts_with(sign)) return false;
    at_ += sign.size();
    return true;
  }

 private:
  Word take(std::size_t end) {
    Word w{std::string(text_.substr(at_, end - at_)), number_, static_cast<int>(at_) + 1};
    at_ = end;
    while (!w.text.empty() && std::isspace(static_cast<unsigned char>(w.text.back())) != 0) w.text.pop_back();
    return w;
  }
  std::string_view text_;
  int number_;
  std::size_t at_ = 0;
};

/// `#` behind a blank begins a comment; that of T#5s and 16#FF does not.
std::string_view without_comment(std::string_view line) {
  char quote = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '\'' || c == '"') {
      quote = c;
    } else if (c == '#' && (i == 0 || std::isspace(static_cast<unsigned char>(line[i - 1])) != 0)) {
      return line.substr(0, i);
    }
  }
  return line;
}

class Reader {
 public:
  explicit Reader(TestFile& file) : file_(file) {}
  void read(std::string_view text, int number);

 private:
  void wrong(const Word& at, const text::Entry& entry, std::vector<std::string> arguments) {
    file_.findings.push_back(finding_at(file_, at, entry, std::move(arguments)));
  }
  void unknown(const Word& word);
  void step(Line& line, const Word& first);
  void run_step(Line& line, Step& step);
  bool terms(Line& line, Step& step);
  bool assignment(Line& line, Term& term);
  bool condition(Line& line, Term& term);
  bool comparison(Line& line, Comparison& out);
  bool time(const Word& word, image::Nanoseconds& out);
  bool ended(Line& line);

  TestFile& file_;
  std::vector<Step>* steps_ = nullptr;
};

void Reader::unknown(const Word& word) {
  std::vector<std::string> known = words_of_a_file();
  if (steps_ != nullptr) known.insert(known.end(), words_of_a_test().begin(), words_of_a_test().end());
  for (const std::string& w : words_of_a_test())
    if (steps_ == nullptr && w == word.text) return wrong(word, texts::kOutside, {word.text});
  const std::string near = text::nearest(word.text, known);
  wrong(word, texts::kUnknownWord,
        {word.text, near.empty()
                        ? std::string()
                        : text::both("; did you mean '" + near + "'?", "; может быть, «" + near + "»?")});
}

void Reader::read(std::string_view text, int number) {
  Line line(without_comment(text), number);
  if (line.done()) return;
  const Word first = line.word();
  const std::string& w = first.text;
  if (w == "machine" || w == "source") {
    Word path = line.rest();
    if (path.text.empty()) return wrong(path, texts::kExpected, {text::both("a path", "путь")});
    if (w == "machine")
      file_.machine = std::move(path);
    else
      file_.sources.push_back(std::move(path));
  } else if (w == "cycle") {
    const Word length = line.rest();
    if (time(length, file_.cycle_ns) && file_.cycle_ns < 1000) wrong(length, texts::kTime, {length.text});
  } else if (w == "before") {
    steps_ = &file_.before;
    ended(line);
  } else if (w == "test") {
    Word name = line.rest();
    if (name.text.size() > 1 && name.text.front() == '"' && name.text.back() == '"')
      name.text = name.text.substr(1, name.text.size() - 2);
    if (name.text.empty()) wrong(first, texts::kNoName, {});
    file_.tests.push_back({std::move(name), {}});
    steps_ = &file_.tests.back().steps;
  } else if (steps_ == nullptr) {
    unknown(first);
  } else {
    step(line, first);
  }
}

void Reader::step(Line& line, const Word& first) {
  Step s;
  s.word = first;
  const std::string& w = first.text;
  if (w == "run") {
    run_step(line, s);
    return;
  }
  if (w == "set")
    s.kind = StepKind::set;
  else if (w == "hold")
    s.kind = StepKind::hold;
  else if (w == "release")
    s.kind = StepKind::release;
  else if (w == "expect")
    s.kind = StepKind::expect;
  else if (w == "until")
    s.kind = StepKind::until;
  else
    return unknown(first);
  if (s.kind == StepKind::expect && line.eat("fault")) {
    s.kind = StepKind::expect_fault;
    if (ended(line)) steps_->push_back(std::move(s));
    return;
  }
  if (!terms(line, s)) return;
  if (s.kind == StepKind::until) {
    if (!line.eat("within")) return wrong(line.here(), texts::kExpected, {"'within'"});
    if (!time(line.rest(), s.time_ns)) return;
  }
  if (ended(line)) steps_->push_back(std::move(s));
}

void Reader::run_step(Line& line, Step& step) {
  const Word length = line.rest();
  const char* const end = length.text.data() + length.text.size();
  const auto [rest, error] = std::from_chars(length.text.data(), end, step.scans);
  const bool number = error == std::errc{} && rest == end && !length.text.empty();
  if (number && (step.scans < 1 || step.scans > kMostScans))
    return wrong(length, texts::kScans, {length.text, std::to_string(kMostScans)});
  if (!number) {
    step.scans = 0;
    if (!time(length, step.time_ns)) return;
  }
  steps_->push_back(std::move(step));
}

bool Reader::terms(Line& line, Step& step) {
  do {
    Term term;
    bool good = true;
    switch (step.kind) {
      case StepKind::set:
      case StepKind::hold:
        good = assignment(line, term);
        break;
      case StepKind::release:
        term.name = line.word();
        good = !term.name.text.empty();
        if (!good) wrong(term.name, texts::kExpected, {text::both("a name", "имя")});
        break;
      default:
        good = condition(line, term);
    }
    if (!good) return false;
    step.terms.push_back(std::move(term));
  } while (line.eat(","));
  return true;
}

bool Reader::assignment(Line& line, Term& term) {
  term.name = line.word();
  if (term.name.text.empty()) {
    wrong(term.name, texts::kExpected, {text::both("a name", "имя")});
    return false;
  }
  if (!line.eat(":=") && !line.eat("=")) {
    wrong(line.here(), texts::kExpected, {"'='"});
    return false;
  }
  term.value = line.value();
  if (term.value.text.empty()) wrong(term.value, texts::kExpected, {text::both("a value", "значение")});
  return !term.value.text.empty();
}

bool Reader::comparison(Line& line, Comparison& out) {
  constexpr struct {
    std::string_view sign;
    Comparison comparison;
  } kSigns[] = {{"<>", Comparison::not_equal},     {"<=", Comparison::less_equal},
                {">=", Comparison::greater_equal}, {"=", Comparison::equal},
                {"<", Comparison::less},           {">", Comparison::greater}};
  for (const auto& s : kSigns)
    if (line.eat(s.sign)) {
      out = s.comparison;
      return true;
    }
  return false;
}

bool Reader::condition(Line& line, Term& term) {
  term.name = line.word();
  if (same_name(term.name.text, "NOT")) {
    term.negated = true;
    term.name = line.word();
  }
  if (term.name.text.empty()) {
    wrong(term.name, texts::kExpected, {text::both("a name", "имя")});
    return false;
  }
  if (term.negated || !comparison(line, term.comparison)) return true;
  term.value = line.value();
  if (term.value.text.empty()) {
    wrong(term.value, texts::kExpected, {text::both("a value", "значение")});
    return false;
  }
  if (!line.eat("+-")) return true;
  term.tolerance = line.value();
  if (term.comparison == Comparison::equal && !term.tolerance.text.empty()) return true;
  wrong(term.tolerance, texts::kTolerance, {});
  return false;
}

bool Reader::time(const Word& word, image::Nanoseconds& out) {
  const std::string& t = word.text;
  const std::string_view number = key_of(t.substr(0, 2)) == "T#" ? std::string_view(t).substr(2) : t;
  image::Nanoseconds ns = 0;
  const bool good = syntax::parse_time(Kind::time, number, ns) && ns > 0 && ns <= kLongest;
  if (good)
    out = ns;
  else
    wrong(word, texts::kTime, {t});
  return good;
}

bool Reader::ended(Line& line) {
  if (line.done()) return true;
  const Word rest = line.rest();
  wrong(rest, texts::kTooMuch, {rest.text});
  return false;
}

}  // namespace

text::Finding finding_at(const TestFile& file, const Word& at, const text::Entry& entry,
                         std::vector<std::string> arguments) {
  text::Finding f{text::Severity::error, file.name, at.line, at.column, &entry, std::move(arguments), {}};
  if (at.line > 0 && static_cast<std::size_t>(at.line) <= file.lines.size())
    f.source = file.lines[static_cast<std::size_t>(at.line) - 1];
  return f;
}

TestFile read_test_file(std::string name, std::string_view text) {
  TestFile file;
  file.name = std::move(name);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line(text.substr(begin, end - begin));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    file.lines.push_back(std::move(line));
    begin = end + 1;
  }
  Reader reader(file);
  for (std::size_t n = 0; n < file.lines.size(); ++n) reader.read(file.lines[n], static_cast<int>(n) + 1);
  if (file.tests.empty() && file.findings.empty())
    file.findings.push_back(finding_at(file, {}, texts::kNoTest, {}));
  return file;
}

}  // namespace servogate::plc::testing
