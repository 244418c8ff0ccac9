// SPDX-License-Identifier: Apache-2.0
#include "plc/syntax/lexer.hpp"

#include <cctype>
#include <charconv>
#include <cstdio>
#include <set>

#include "plc/syntax/time_literal.hpp"
#include "plc/terms/texts.hpp"
#include "plc/types/characters.hpp"

namespace servogate::plc::syntax {

namespace {

bool letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }
// No program has these, outside of white space.
bool control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }
bool word_part(char c) { return letter(c) || digit(c); }
// Letters of other scripts, which names have not (IEC 61131-3, 6.1.2); signs and symbols are none.
bool foreign_letter(std::string_view text, std::size_t at) {
  if (at >= text.size() || static_cast<unsigned char>(text[at]) < 0x80) return false;
  const char32_t c = take_character(text, at);
  const bool sign = c < 0xC0 || c == 0xD7 || c == 0xF7 || (c >= 0x2000 && c < 0x2C00) ||
                    (c >= 0x3000 && c < 0x3040) || (c >= 0xFE00 && c <= 0xFF20);
  return !sign;
}

class Lexer {
 public:
  Lexer(std::string_view text, const Location& begin, Report& report)
      : text_(text), file_(begin.file), report_(report), line_(begin.line), column_(begin.column) {}

  std::vector<Token> run() {
    std::vector<Token> out;
    while (skip_blank()) {
      report_.go_on();
      const std::size_t errors = report_.errors();
      out.push_back(next());
      out.back().wrong = report_.errors() - errors;
      out.back().end = at_;
      out.back().text = text_.substr(out.back().offset, at_ - out.back().offset);
    }
    out.push_back(start(TokenKind::end));
    out.back().told = open_;
    return out;
  }

 private:
  char peek(std::size_t ahead = 0) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }
  Location here() const { return {static_cast<std::int16_t>(file_), line_, column_}; }
  void step() {
    const auto c = static_cast<unsigned char>(text_[at_++]);
    if (c == '\n')
      ++line_, column_ = 1;
    else if ((c & 0xC0) != 0x80)
      ++column_;
  }
  void step(std::size_t n) {
    for (; n > 0; --n) step();
  }
  void step_character() {
    do step();
    while (at_ < text_.size() && (static_cast<unsigned char>(text_[at_]) & 0xC0) == 0x80);
  }
  Token start(TokenKind kind) const {
    Token t;
    t.kind = kind;
    t.location = here();
    t.offset = t.end = at_;
    return t;
  }

  // Blanks, comments and pragmas. False at the end of the text.
  bool skip_blank() {
    while (at_ < text_.size()) {
      const char c = peek();
      if (std::isspace(static_cast<unsigned char>(c)) || text_.substr(at_, 3) == "\xEF\xBB\xBF")
        step(c == '\xEF' ? 3 : 1);
      else if (c == '/' && peek(1) == '/')
        while (at_ < text_.size() && peek() != '\n') step();
      else if ((c == '(' || c == '/') && peek(1) == '*')
        skip_comment(c == '(' ? "(*" : "/*", c == '(' ? "*)" : "*/");
      else if (c == '{')
        skip_comment("{", "}");
      else
        return true;
    }
    return false;
  }
  void skip_comment(std::string_view open, std::string_view close) {
    const Location begin = here();
    int depth = 0;
    do {
      if (at_ >= text_.size()) {
        open_ = true;
        return report_.error(begin, texts::kOpenComment, {std::string(close)});
      }
      if (text_.substr(at_, open.size()) == open)
        ++depth, step(open.size());
      else if (text_.substr(at_, close.size()) == close)
        --depth, step(close.size());
      else
        step();
    } while (depth > 0);
  }

  Token next() {
    const char c = peek();
    if (letter(c) || foreign_letter(text_, at_)) return word();
    if (digit(c)) return number();
    if (c == '\'' || c == '"') return string();
    if (c == '%') return direct();
    return symbol();
  }

  Token word() {
    Token t = start(TokenKind::word);
    bool foreign = false;
    for (; word_part(peek()) || foreign_letter(text_, at_); step_character())
      foreign = foreign || !word_part(peek());
    t.key = key_of(text_.substr(t.offset, at_ - t.offset));
    foreign = foreign || t.key.find("__") != std::string::npos;
    if (foreign && foreign_.insert(t.key).second)
      report_.error(t.location, texts::kForeignName, {cropped(text_.substr(t.offset, at_ - t.offset))});
    if (t.key == "TRUE" || t.key == "FALSE") {
      t.kind = TokenKind::literal;
      t.literal.kind = Kind::boolean;
      t.literal.magnitude = t.key == "TRUE";
      return t;
    }
    if (t.key == "LADDER" && alone_on_line(t.offset)) return ladder(std::move(t));
    if (peek() != '#') return t;
    step();
    const Kind time = time_prefix(t.key);
    if (time == Kind::none) {
      t.kind = TokenKind::typed;
      return t;
    }
    return time_literal(std::move(t), time);
  }

  static bool begins_body(std::string_view before) {
    constexpr std::string_view kEnd = "END_VAR";
    return before.size() > kEnd.size() && same_name(before.substr(before.size() - kEnd.size()), kEnd) &&
           !word_part(before[before.size() - kEnd.size() - 1]);
  }
  // A ladder is drawn, not written: its lines are taken as they are. LADDER ends its line.
  bool alone_on_line(std::size_t begin) const {
    const std::string_view before = text_.substr(0, begin);
    const std::size_t line = before.find_last_not_of(" \t");
    const bool first =
        line == std::string_view::npos || before[line] == '\n' || begins_body(before.substr(0, line + 1));
    std::size_t end = at_;
    while (end < text_.size() && (text_[end] == ' ' || text_[end] == '\t' || text_[end] == '\r')) ++end;
    return first && end < text_.size() && text_[end] == '\n';
  }
  std::string found() const {
    std::size_t end = at_;
    while (end < text_.size() && (word_part(text_[end]) || text_[end] == ' ')) ++end;
    const std::string word(text_.substr(at_, end - at_));
    return at_ >= text_.size() ? text::both("the end of the file", "конец файла")
                               : "'" + word.substr(word.find_first_not_of(' ')) + "'";
  }
  Token ladder(Token t) {
    while (at_ < text_.size() && peek() != '\n') step();
    const std::size_t begin = at_;
    while (at_ < text_.size()) {
      step();  // the end of the line before
      std::size_t first = at_;
      while (first < text_.size() && (text_[first] == ' ' || text_[first] == '\t')) ++first;
      constexpr std::string_view kEnd = "END_LADDER";
      const std::string_view rest = text_.substr(first);
      if (same_name(rest.substr(0, 11), "END_PROGRAM") || same_name(rest.substr(0, 12), "END_FUNCTION"))
        break;
      if (same_name(text_.substr(first, kEnd.size()), kEnd)) {
        t.kind = TokenKind::ladder;
        t.literal.text = text_.substr(begin, at_ - begin);
        step(first + kEnd.size() - at_);
        return t;
      }
      while (at_ < text_.size() && peek() != '\n') step();
    }
    report_.error(t.location, texts::kUnclosed,
                  {"'END_LADDER'", "LADDER", std::to_string(t.location.line), found()});
    t.kind = TokenKind::ladder;
    return t;
  }

  Token time_literal(Token t, Kind kind) {
    const std::size_t begin = at_;
    if (peek() == '-' || peek() == '+') step();
    while (word_part(peek()) || (peek() == '.' && digit(peek(1))) ||
           (kind != Kind::time && ((peek() == ':' && digit(peek(1))) || (peek() == '-' && digit(peek(1))))))
      step();
    t.kind = TokenKind::literal;
    t.literal.kind = kind;
    std::int64_t ns = 0;
    const std::string_view body = text_.substr(begin, at_ - begin);
    if (!parse_time(kind, body, ns)) {
      const char* name = kind == Kind::time   ? "TIME"
                         : kind == Kind::date ? "DATE"
                         : kind == Kind::tod  ? "TIME_OF_DAY"
                                              : "DATE_AND_TIME";
      report_.error(
          t.location, texts::kBadTime,
          {std::string(text_.substr(t.offset, at_ - t.offset)), name, std::string(time_example(kind))});
    }
    t.literal.negative = ns < 0;
    t.literal.magnitude = ns < 0 ? 0 - static_cast<std::uint64_t>(ns) : static_cast<std::uint64_t>(ns);
    return t;
  }

  Token number() {
    Token t = start(TokenKind::literal);
    while (digit(peek()) || (peek() == '_' && digit(peek(1)))) step();
    if (peek() == '#') return based(std::move(t));
    const bool real = peek() == '.' && digit(peek(1));
    if (real) {
      step();
      while (digit(peek()) || (peek() == '_' && digit(peek(1)))) step();
    }
    const std::size_t sign = peek(1) == '-' || peek(1) == '+' ? 1 : 0;
    const bool exponent = (peek() == 'e' || peek() == 'E') && digit(peek(1 + sign));
    if (exponent) {
      step(1 + sign);
      while (digit(peek())) step();
    }
    std::string body = clean(t.offset);
    if (letter(peek())) {
      while (word_part(peek())) step();
      const std::string_view whole = text_.substr(t.offset, at_ - t.offset);
      if (format_of_characters(t.offset, whole)) {
        t.kind = TokenKind::word;
        t.text = whole;
        t.key = key_of(whole);
        return t;
      }
      report_.error(t.location, texts::kBadNumber, {cropped(whole)});
      t.literal.magnitude = 1;
      return t;
    }
    if (real || exponent) {
      t.literal.kind = Kind::untyped_real;
      if (std::from_chars(body.data(), body.data() + body.size(), t.literal.real).ec != std::errc{})
        report_.error(t.location, texts::kHugeNumber, {cropped(body)});
    } else if (std::from_chars(body.data(), body.data() + body.size(), t.literal.magnitude).ec !=
               std::errc{}) {
      report_.error(t.location, texts::kHugeNumber, {cropped(body)});
      t.literal.magnitude = 1;
    }
    return t;
  }
  // The 4CH of a place of a packet, AT SK20.4CH; anywhere else the parser refuses the word.
  bool format_of_characters(std::size_t begin, std::string_view whole) const {
    const std::size_t digits = whole.find_first_not_of("0123456789");
    return begin > 0 && text_[begin - 1] == '.' && digits != std::string_view::npos &&
           key_of(whole.substr(digits)) == "CH";
  }
  Token based(Token t) {
    const std::string base_text = clean(t.offset);
    const int base = base_text == "2" ? 2 : base_text == "8" ? 8 : base_text == "16" ? 16 : 0;
    step();
    const std::size_t begin = at_;
    while (word_part(peek())) step();
    const std::string body = clean(begin);
    const std::string whole(text_.substr(t.offset, at_ - t.offset));
    if (base == 0) {
      report_.error(t.location, texts::kBadNumber, {cropped(whole)});
      t.literal.magnitude = 1;
      return t;
    }
    const auto [end, error] =
        std::from_chars(body.data(), body.data() + body.size(), t.literal.magnitude, base);
    if (error == std::errc::result_out_of_range)
      report_.error(t.location, texts::kHugeNumber, {cropped(whole)});
    else if (error != std::errc{} || end != body.data() + body.size())
      report_.error(t.location, texts::kBadNumber, {cropped(whole)});
    return t;
  }
  std::string clean(std::size_t begin) const {
    std::string out;
    for (const char c : text_.substr(begin, at_ - begin))
      if (c != '_') out += c;
    return out;
  }

  // A ';' at the end of a line whose string is not closed ends the statement all the same.
  void end_of_statement(std::size_t begin) {
    std::size_t last = at_;
    while (last > begin && std::isspace(static_cast<unsigned char>(text_[last - 1]))) --last;
    if (last == begin || text_[last - 1] != ';') return;
    column_ -= static_cast<int>(at_ - (last - 1));
    at_ = last - 1;
  }
  // 'STRING' of bytes, or "WSTRING" of units of 16 bits (6.3.3).
  Token string() {
    Token t = start(TokenKind::literal);
    const char quote = peek();
    t.literal.kind = quote == '"' ? Kind::wide_string : Kind::string;
    step();
    const std::size_t begin = at_;
    while (peek() != quote) {
      if (at_ >= text_.size() || peek() == '\n') {
        report_.error(t.location, texts::kOpenString, {std::string(1, quote)});
        end_of_statement(begin);
        return t;
      }
      if (peek() == '$')
        escape(t.literal);
      else
        character(t.literal);
    }
    step();
    return t;
  }
  void character(Literal& out) {
    if (out.kind == Kind::string) {
      out.text += peek();
      return step();
    }
    std::size_t behind = at_;
    add(out, take_character(text_, behind));
    step(behind - at_);
  }
  static void add(Literal& out, char32_t c) {
    char16_t units[2];
    if (out.kind == Kind::string)
      out.text += static_cast<char>(c);
    else
      out.wide.append(units, put_character(c, units));
  }
  void escape(Literal& out) {
    const Location begin = here();
    const char c = static_cast<char>(std::toupper(static_cast<unsigned char>(peek(1))));
    constexpr std::pair<char, char> plain[] = {{'$', '$'},  {'\'', '\''}, {'"', '"'},  {'L', '\n'},
                                               {'N', '\n'}, {'P', '\f'},  {'R', '\r'}, {'T', '\t'}};
    for (const auto& [name, value] : plain)
      if (c == name) {
        add(out, static_cast<char32_t>(value));
        return step(2);
      }
    const std::size_t digits = out.kind == Kind::string ? 2 : 4;
    std::size_t found = 0;
    while (found < digits && std::isxdigit(static_cast<unsigned char>(peek(1 + found)))) ++found;
    if (found == digits) {
      add(out, static_cast<char32_t>(std::stoul(std::string(text_.substr(at_ + 1, digits)), nullptr, 16)));
      return step(1 + digits);
    }
    std::string shown = "$";
    step();
    if (at_ < text_.size() && peek() != '\n') shown += peek();
    report_.error(begin, out.kind == Kind::string ? texts::kBadEscape : texts::kBadWideEscape, {shown});
  }

  Token direct() {
    Token t = start(TokenKind::direct);
    step();
    while (word_part(peek()) || (peek() == '.' && digit(peek(1)))) step();
    if (peek() == '*' && at_ == t.offset + 2) step();  // %Q*: VAR_CONFIG says where
    return t;
  }

  // Operators of other languages: what was meant is read.
  static constexpr std::pair<std::string_view, std::string_view> kForeignOperators[] = {{"!=", "<>"},
                                                                                        {"||", "OR"}};
  Token foreign_operator(Token t, std::string_view foreign, std::string_view own) {
    report_.error(t.location, texts::kForeign, {std::string(foreign), std::string(own)});
    t.key = own;
    step(foreign.size());
    return t;
  }
  // Of a binary file one finding says all; nothing behind it is read.
  Token no_text(Token t) {
    char hex[8];
    std::snprintf(hex, sizeof hex, "%02X", static_cast<unsigned char>(peek()));
    report_.error(t.location, texts::kNoText, {hex});
    t.kind = TokenKind::bad;
    at_ = text_.size();
    open_ = true;
    return t;
  }
  Token symbol() {
    Token t = start(TokenKind::symbol);
    constexpr std::string_view known[] = {":=", "=>", "?=", "^", "<=", ">=", "<>", "**", "..",
                                          "+",  "-",  "*",  "/", "=",  "<",  ">",  "(",  ")",
                                          "[",  "]",  ",",  ";", ":",  ".",  "&"};
    if (control(peek())) return no_text(std::move(t));
    if (text_.substr(at_, 2) == "==") return foreign_operator(std::move(t), "==", "=");
    if (text_.substr(at_, 2) == "&&") return foreign_operator(std::move(t), "&&", "AND");
    for (const std::string_view s : known)
      if (text_.substr(at_, s.size()) == s) {
        t.key = s;
        step(s.size());
        return t;
      }
    for (const auto& [foreign, own] : kForeignOperators)
      if (text_.substr(at_, 2) == foreign) return foreign_operator(std::move(t), foreign, own);
    if (peek() == '!') return foreign_operator(std::move(t), "!", "NOT");
    std::size_t n = 1;
    while (at_ + n < text_.size() && (static_cast<unsigned char>(text_[at_ + n]) & 0xC0) == 0x80) ++n;
    report_.error(t.location, texts::kBadCharacter, {std::string(text_.substr(at_, n))});
    step(n);
    t.kind = TokenKind::bad;
    return t;
  }

  std::string_view text_;
  int file_;
  Report& report_;
  std::size_t at_ = 0;
  bool open_ = false;              ///< a comment has swallowed the rest, or the rest is no text
  std::set<std::string> foreign_;  ///< names of other letters that were reported
  int line_, column_;
};

}  // namespace

std::vector<Token> tokens(std::string_view text, const Location& begin, Report& report) {
  return Lexer(text, begin, report).run();
}

bool parse_literal(std::string_view text, Literal& out) {
  Report report({"value"});
  std::vector<Token> list = tokens(text, {0, 1, 1}, report);
  std::size_t at = 0;
  if (list[at].kind == TokenKind::typed) ++at;
  bool negative = false;
  if (list[at].is("-") || list[at].is("+")) negative = list[at++].is("-");
  if (report.failed() || list[at].kind != TokenKind::literal || list[at + 1].kind != TokenKind::end)
    return false;
  out = list[at].literal;
  if (negative && (out.kind == Kind::boolean || is_text(out.kind) || is_temporal(out.kind))) return false;
  if (negative) out.negative = !out.negative, out.real = -out.real;
  return true;
}

}  // namespace servogate::plc::syntax
