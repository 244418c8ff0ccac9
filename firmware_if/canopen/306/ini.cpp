// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/306/ini.hpp"

#include <algorithm>
#include <cstdint>
#include <map>

#include "firmware_if/canopen/306/eds_text.hpp"

namespace servogate::canopen {
namespace {

constexpr char lower(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

std::string lower_case(std::string_view text) {
  std::string out(text);
  std::ranges::transform(out, out.begin(), lower);
  return out;
}

std::string_view trim(std::string_view text) noexcept {
  constexpr std::string_view kBlanks = " \t\v\f";
  const auto first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

void append_utf8(std::string& out, std::uint32_t c) {
  if (c < 0x80) {
    out += static_cast<char>(c);
  } else if (c < 0x800) {
    out += static_cast<char>(0xC0 | c >> 6);
    out += static_cast<char>(0x80 | (c & 0x3F));
  } else {
    out += static_cast<char>(0xE0 | c >> 12);
    out += static_cast<char>(0x80 | (c >> 6 & 0x3F));
    out += static_cast<char>(0x80 | (c & 0x3F));
  }
}

std::string from_utf16(std::string_view bytes, bool big_endian) {
  std::string out;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto a = static_cast<unsigned char>(bytes[i]), b = static_cast<unsigned char>(bytes[i + 1]);
    append_utf8(out, big_endian ? a << 8 | b : b << 8 | a);
  }
  return out;
}

/// The file as UTF-8 without byte order mark.
std::string decode(std::string_view bytes, EdsFindings& findings) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    findings.warn(eds_text::kUtf16, 1);
    return from_utf16(bytes.substr(2), bytes[0] == '\xFE');
  }
  if (valid_utf8(bytes)) return std::string(bytes);
  const auto odd = std::ranges::find_if(bytes, [](char c) { return c & 0x80; });
  findings.warn(eds_text::kCodePage, 1 + static_cast<int>(std::count(bytes.begin(), odd, '\n')));
  std::string out;
  for (const char c : bytes) append_utf8(out, static_cast<unsigned char>(c));
  return out;
}

/// Takes the next line off the front, whatever ends it: \n, \r\n, \r, \n\r.
std::string_view next_line(std::string_view& rest) noexcept {
  const auto end = rest.find_first_of("\r\n");
  const std::string_view line = rest.substr(0, end);
  if (end == std::string_view::npos) {
    rest = {};
    return line;
  }
  const bool pair =
      end + 1 < rest.size() && rest[end] != rest[end + 1] && (rest[end + 1] == '\n' || rest[end + 1] == '\r');
  rest.remove_prefix(end + (pair ? 2 : 1));
  return line;
}

class IniReader {
 public:
  explicit IniReader(EdsFindings& findings) : findings_(findings) {}

  void line(std::string_view text, int number) {
    text = trim(text);
    if (text.empty() || text[0] == ';' || text[0] == '\x1A') return;
    if (text[0] == '#' || text.starts_with("//")) return findings_.warn(eds_text::kComment, number);
    if (text[0] == '[') return section(text, number);
    entry(text, number);
  }
  std::vector<IniSection> take() { return std::move(sections_); }

 private:
  void section(std::string_view text, int number) {
    const auto close = text.find(']');
    std::string_view name = trim(text.substr(1, close == std::string_view::npos ? close : close - 1));
    if (close == std::string_view::npos) findings_.warn(eds_text::kNoBracket, number, {std::string(name)});
    const auto [place, added] = by_name_.try_emplace(lower_case(name), sections_.size());
    current_ = place->second;
    if (added)
      sections_.push_back({std::string(name), number, {}});
    else
      findings_.warn(eds_text::kSectionTwice, number,
                     {std::string(name), std::to_string(sections_[current_].line)});
    inside_ = true;
  }

  void entry(std::string_view text, int number) {
    if (!inside_) return findings_.warn(eds_text::kOutside, number);
    auto cut = text.find('=');
    if (cut == std::string_view::npos) {
      cut = text.find_first_of(": \t");
      findings_.warn(eds_text::kNoEquals, number, {std::string(trim(text.substr(0, cut)))});
    }
    const std::string_view key = trim(text.substr(0, cut));
    std::string_view value = cut == std::string_view::npos ? std::string_view{} : trim(text.substr(cut + 1));
    const std::size_t written = value.size();
    while (value.size() >= 2 && value.front() == '"' && value.back() == '"')
      value = trim(value.substr(1, value.size() - 2));
    if (value.size() < written) findings_.warn(eds_text::kQuotes, number, {std::string(key)});
    if (key.empty()) return findings_.warn(eds_text::kNoKey, number);
    IniSection& section = sections_[current_];
    if (const IniEntry* first = section.entry(key)) {
      if (first->value != value)
        findings_.warn(eds_text::kKeyTwice, number, {std::string(key), std::to_string(first->line)});
      return;
    }
    section.entries.push_back({std::string(key), std::string(value), number});
  }

  EdsFindings& findings_;
  std::vector<IniSection> sections_;
  std::map<std::string, std::size_t> by_name_;
  std::size_t current_ = 0;
  bool inside_ = false;
};

}  // namespace

void EdsFindings::add(text::Severity severity, const text::Entry& entry, int line,
                      std::vector<std::string> arguments) {
  // However much is odd, an error is told.
  const std::size_t most = severity == text::Severity::error ? 2 * kMost : kMost;
  if (findings_.size() < most) findings_.push_back({severity, file_, line, 0, &entry, std::move(arguments)});
}
void EdsFindings::warn(const text::Entry& entry, int line, std::vector<std::string> arguments) {
  add(text::Severity::warning, entry, line, std::move(arguments));
}
void EdsFindings::error(const text::Entry& entry, int line, std::vector<std::string> arguments) {
  add(text::Severity::error, entry, line, std::move(arguments));
}

bool valid_utf8(std::string_view bytes) noexcept {
  for (std::size_t i = 0; i < bytes.size();) {
    const auto c = static_cast<unsigned char>(bytes[i]);
    const std::size_t more = c < 0x80                ? 0
                             : c >= 0xC2 && c < 0xE0 ? 1
                             : c >= 0xE0 && c < 0xF0 ? 2
                             : c >= 0xF0 && c < 0xF5 ? 3
                                                     : 9;
    if (more == 9 || i + more >= bytes.size() + (more == 0 ? 1 : 0)) return false;
    for (std::size_t k = 1; k <= more; ++k)
      if ((static_cast<unsigned char>(bytes[i + k]) & 0xC0) != 0x80) return false;
    i += more + 1;
  }
  return true;
}

bool same_word(std::string_view a, std::string_view b) noexcept {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

const IniEntry* IniSection::entry(std::string_view key) const noexcept {
  const auto found =
      std::ranges::find_if(entries, [key](const IniEntry& e) { return same_word(e.key, key); });
  return found == entries.end() ? nullptr : &*found;
}
std::string_view IniSection::find(std::string_view key) const noexcept {
  const IniEntry* found = entry(key);
  return found ? std::string_view(found->value) : std::string_view{};
}

std::vector<IniSection> read_ini(std::string_view bytes, EdsFindings& findings) {
  std::string text = decode(bytes, findings);
  if (const auto removed = std::erase(text, '\0'); removed > 0)
    findings.warn(eds_text::kZeroBytes, 1, {std::to_string(removed)});
  IniReader reader(findings);
  std::string_view rest = text;
  for (int number = 1; !rest.empty(); ++number) reader.line(next_line(rest), number);
  return reader.take();
}

}  // namespace servogate::canopen
