// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/look_alikes.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "kernel/program/reading/block.hpp"

namespace servogate::program {
namespace {

constexpr std::size_t kMostTold = 20'000;  ///< more than `check` tells of all warnings

constexpr std::pair<std::string_view, std::string_view> kLookAlikes[] = {
    {"А", "A"}, {"В", "B"}, {"Е", "E"}, {"К", "K"}, {"М", "M"}, {"Н", "H"},
    {"О", "O"}, {"Р", "P"}, {"С", "C"}, {"Т", "T"}, {"У", "Y"}, {"Х", "X"}};

bool cyrillic(char c) { return c == '\xD0' || c == '\xD1'; }

bool of_name(char c) { return is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 128; }

/// The label in quotes in front of a block: what it is made of is nobody's error. Empty: there is none.
std::string_view label_of(const Lexis& lexis, std::string_view line) {
  std::size_t pos = skip_spaces(line, 0);
  if (pos < line.size() && line[pos] == lexis.skip) pos = skip_spaces(line, pos + 1);
  if (lexis.label != LabelForm::quoted || pos >= line.size() || line[pos] != '"') return {};
  const std::size_t close = line.find('"', pos + 1);
  return close == std::string_view::npos ? std::string_view() : line.substr(pos + 1, close - pos - 1);
}

/// Calls `take(line, last)` for each line.
template <typename Take>
void each_line(std::string_view text, Take take) {
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    take(text.substr(from, end - from), end == text.size());
    from = end + 1;
  }
}

}  // namespace

/// One line, read into `out`.
class LineOfLookAlikes {
 public:
  LineOfLookAlikes(LookAlikes& all, std::string_view line, std::string& out)
      : all_(all), lexis_(*all.lexis_), line_(line), out_(out), begin_(out.size()) {}

  void read() {
    int comment = 0;
    for (std::size_t i = 0; i < line_.size();) {
      const char c = line_[i];
      if (comment == 0 && holds_nothing(lexis_, line_, i)) {
        copy(i, line_.size());
        return;
      }
      if (lexis_.bracket == Bracket::comment) comment += c == '(' ? 1 : c == ')' && comment > 0 ? -1 : 0;
      if (c == '"') {
        const std::size_t close = line_.find('"', i + 1);
        i = copy(i, close == std::string_view::npos ? line_.size() : close + 1);
      } else {
        i = comment == 0 && of_name(c) ? name(i) : copy(i, i + 1);
      }
    }
  }

 private:
  std::size_t copy(std::size_t from, std::size_t to) {
    out_.append(line_.substr(from, to - from));
    return to;
  }

  /// Letters and digits together: a label that the file has, or words.
  std::size_t name(std::size_t from) {
    std::size_t end = from;
    while (end < line_.size() && of_name(line_[end])) ++end;
    if (all_.labels_.contains(line_.substr(from, end - from))) return copy(from, end);
    while (from < end) from = cyrillic(line_[from]) ? word(from) : copy(from, from + 1);
    return end;
  }

  std::size_t word(std::size_t from) {
    std::size_t end = from;
    bool all = true;
    for (; end + 1 < line_.size() && cyrillic(line_[end]); end += 2)
      all = all && !latin_of(line_.substr(end, 2)).empty();
    if (!all || end == from) return copy(from, std::max(end, from + 1));
    for (std::size_t i = from; i < end; i += 2) {
      const std::string_view latin = latin_of(line_.substr(i, 2));
      if (all_.told_.size() < kMostTold)
        all_.told_.push_back(
            {all_.line_, static_cast<int>(out_.size() - begin_) + 1, std::string(line_.substr(i, 2)), latin});
      else
        ++all_.untold_;
      out_ += latin;
    }
    return end;
  }

  LookAlikes& all_;
  const Lexis& lexis_;
  std::string_view line_;
  std::string& out_;
  std::size_t begin_;
};

bool any_cyrillic(std::string_view text) {
  return text.find('\xD0') != std::string_view::npos || text.find('\xD1') != std::string_view::npos;
}

std::string_view latin_of(std::string_view cyrillic) {
  for (const auto& [letter, latin] : kLookAlikes)
    if (letter == cyrillic) return latin;
  return {};
}

void LookAlikes::collect_labels(std::string_view lines) {
  if (!any_cyrillic(lines)) return;
  each_line(lines, [this](std::string_view line, bool) {
    if (const std::string_view label = label_of(*lexis_, line); any_cyrillic(label)) labels_.emplace(label);
  });
}

void LookAlikes::read(std::string& lines) {
  if (!any_cyrillic(lines)) {
    line_ += static_cast<std::uint32_t>(std::count(lines.begin(), lines.end(), '\n'));
    return;
  }
  std::string out;
  out.reserve(lines.size());
  each_line(lines, [&](std::string_view line, bool last) {
    if (any_cyrillic(line))
      LineOfLookAlikes(*this, line, out).read();
    else
      out.append(line);
    if (!last) out += '\n';
    ++line_;
  });
  lines = std::move(out);
}

}  // namespace servogate::program
