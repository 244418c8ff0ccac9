// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/text/finding.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace servogate::text {

Language user_language() {
  for (const char* name : {"LC_ALL", "LC_MESSAGES", "LANG"}) {
    const char* value = std::getenv(name);
    if (value != nullptr && *value != '\0')
      return std::string_view(value).starts_with("ru") ? Language::russian : Language::english;
  }
  return Language::english;
}

namespace {
// ASCII start, middle and end: cannot stand in a name or a number.
constexpr char kBegin = '\x02', kBetween = '\x1f', kEnd = '\x03';
}  // namespace

std::string both(std::string_view english, std::string_view russian) {
  return kBegin + std::string(english) + kBetween + std::string(russian) + kEnd;
}

std::string in_language(std::string_view words, Language language) {
  std::string out;
  // Of each both() that is open: whether its half of this language is being read.
  std::vector<bool> chosen;
  for (const char c : words) {
    if (c == kBegin)
      chosen.push_back(language == Language::english);
    else if (c == kBetween && !chosen.empty())
      chosen.back() = language == Language::russian;
    else if (c == kEnd && !chosen.empty())
      chosen.pop_back();
    else if (std::find(chosen.begin(), chosen.end(), false) == chosen.end())
      out += c;
  }
  return out;
}

std::string render(const Entry& entry, std::span<const std::string> arguments, Language language) {
  const std::string_view pattern = language == Language::russian ? entry.russian : entry.english;
  std::string out;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const bool placeholder = pattern[i] == '{' && i + 2 < pattern.size() && pattern[i + 2] == '}' &&
                             pattern[i + 1] >= '0' && pattern[i + 1] <= '9';
    const std::size_t which = placeholder ? static_cast<std::size_t>(pattern[i + 1] - '0') : 0;
    if (placeholder && which < arguments.size()) {
      out += in_language(arguments[which], language);
      i += 2;
    } else {
      out += pattern[i];
    }
  }
  return out;
}

namespace {

/// Length of the printable character of UTF-8 at `at`; 0: there is none. Controls of both ASCII and Latin-1
/// are none, nor is what turns the direction of writing.
std::size_t printable(std::string_view words, std::size_t at) noexcept {
  const auto byte = [&](std::size_t n) {
    return at + n < words.size() ? static_cast<unsigned char>(words[at + n]) : 0U;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 && first != 0x7F ? 1 : 0;
  const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  for (std::size_t n = 1; n < length; ++n)
    if ((byte(n) & 0xC0) != 0x80) return 0;
  if (first == 0xC2 && byte(1) < 0xA0) return 0;
  const unsigned turns = first == 0xE2 ? byte(1) << 8 | byte(2) : 0;
  return (turns >= 0x80AA && turns <= 0x80AE) || (turns >= 0x81A6 && turns <= 0x81A9) ? 0 : length;
}

}  // namespace

std::string visible(std::string_view words) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string out;
  for (std::size_t at = 0; at < words.size();) {
    const char c = words[at];
    const std::size_t length = c == '\n' || c == '\t' ? 1 : printable(words, at);
    if (length > 0) {
      out += words.substr(at, length);
    } else {
      const auto byte = static_cast<unsigned char>(c);
      out += std::string("\\x") + kHex[byte >> 4] + kHex[byte & 0xF];
    }
    at += std::max<std::size_t>(length, 1);
  }
  return out;
}

std::string Finding::str(Language language) const {
  std::string out = visible(file);
  if (line > 0) out += ":" + std::to_string(line);
  if (line > 0 && column > 0) out += ":" + std::to_string(column);
  out += severity == Severity::error ? ": error: " : ": warning: ";
  if (entry != nullptr) {
    out += visible(render(*entry, arguments, language));
    out += " [" + std::string(entry->id) + "]";
  }
  return out;
}

std::string Finding::excerpt() const {
  if (source.empty() || line <= 0 || column <= 0) return {};
  constexpr int kShown = 160;  // characters; more of a long line is left out on both sides
  std::string shown, below;
  int at = 0;
  const int first = column > kShown / 2 ? column - kShown / 2 : 1;
  for (std::size_t i = 0; i < source.size();) {
    const std::size_t length = printable(source, i);
    // A byte that is no character of UTF-8 counts as one.
    if (length > 0 || (static_cast<unsigned char>(source[i]) & 0xC0) != 0x80) ++at;
    const bool tab = source[i] == '\t';
    if (at >= first && at < first + kShown) {
      shown += tab ? "\t" : length > 0 ? source.substr(i, length) : "?";
      if (at < column) below += tab ? '\t' : ' ';
    }
    i += std::max<std::size_t>(length, 1);
  }
  const std::string number = std::to_string(line);
  return " " + number + " | " + shown + "\n " + std::string(number.size(), ' ') + " | " + below + "^\n";
}

/// From here on the digits before the point say nothing to a person.
constexpr double kLongest = 1e15;

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return value > 0 ? "inf" : value < 0 ? "-inf" : "nan";
  char buffer[64];
  if (std::abs(value) >= kLongest) {
    std::snprintf(buffer, sizeof buffer, "%.6g", value);
    return buffer;
  }
  std::snprintf(buffer, sizeof buffer, "%.*f", std::min(digits, 30), value);
  std::string out = buffer;
  if (out.find('.') != std::string::npos) {
    while (out.back() == '0') out.pop_back();
    if (out.back() == '.') out.pop_back();
  }
  return out == "-0" ? "0" : out;
}

}  // namespace servogate::text
