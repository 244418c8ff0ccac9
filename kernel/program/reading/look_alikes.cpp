// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/look_alikes.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "kernel/program/reading/block.hpp"

namespace servogate::program {
namespace {

constexpr std::size_t kMostTold = 1'000'000;

constexpr std::pair<std::string_view, std::string_view> kLookAlikes[] = {
    {"А", "A"}, {"В", "B"}, {"Е", "E"}, {"К", "K"}, {"М", "M"}, {"Н", "H"},
    {"О", "O"}, {"Р", "P"}, {"С", "C"}, {"Т", "T"}, {"У", "Y"}, {"Х", "X"}};

bool cyrillic(char c) { return c == '\xD0' || c == '\xD1'; }

using Labels = std::set<std::string_view>;

bool of_name(char c) { return is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 128; }

/// The labels in quotes in front of blocks: what they are made of is nobody's error.
void collect_label(const Lexis& lexis, std::string_view line, Labels& labels) {
  std::size_t pos = skip_spaces(line, 0);
  if (pos < line.size() && line[pos] == lexis.skip) pos = skip_spaces(line, pos + 1);
  if (lexis.label != LabelForm::quoted || pos >= line.size() || line[pos] != '"') return;
  const std::size_t close = line.find('"', pos + 1);
  if (close != std::string_view::npos) labels.insert(line.substr(pos + 1, close - pos - 1));
}

/// One line, read into `out`.
class Line {
 public:
  Line(const Lexis& lexis, const Labels& labels, std::string_view line, std::uint32_t index, std::string& out,
       std::vector<LookAlike>& told)
      : lexis_(lexis),
        labels_(labels),
        line_(line),
        index_(index),
        out_(out),
        begin_(out.size()),
        told_(told) {}

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
    if (labels_.contains(line_.substr(from, end - from))) return copy(from, end);
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
      if (told_.size() < kMostTold)
        told_.push_back(
            {index_, static_cast<int>(out_.size() - begin_) + 1, std::string(line_.substr(i, 2)), latin});
      out_ += latin;
    }
    return end;
  }

  const Lexis& lexis_;
  const Labels& labels_;
  std::string_view line_;
  std::uint32_t index_;
  std::string& out_;
  std::size_t begin_;
  std::vector<LookAlike>& told_;
};

/// Calls `take(line, index, last)` for each line.
template <typename Take>
void each_line(std::string_view text, Take take) {
  std::uint32_t index = 0;
  for (std::size_t from = 0; from < text.size(); ++index) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    take(text.substr(from, end - from), index, end == text.size());
    from = end + 1;
  }
}

}  // namespace

bool any_cyrillic(std::string_view text) {
  return text.find('\xD0') != std::string_view::npos || text.find('\xD1') != std::string_view::npos;
}

std::string_view latin_of(std::string_view cyrillic) {
  for (const auto& [letter, latin] : kLookAlikes)
    if (letter == cyrillic) return latin;
  return {};
}

std::vector<LookAlike> read_look_alikes(const Lexis& lexis, std::string& text) {
  std::vector<LookAlike> told;
  if (!any_cyrillic(text)) return told;
  Labels labels;
  each_line(text, [&](std::string_view line, std::uint32_t, bool) { collect_label(lexis, line, labels); });
  std::string out;
  out.reserve(text.size());
  each_line(text, [&](std::string_view line, std::uint32_t index, bool last) {
    if (any_cyrillic(line))
      Line(lexis, labels, line, index, out, told).read();
    else
      out.append(line);
    if (!last) out += '\n';
  });
  text = std::move(out);
  return told;
}

}  // namespace servogate::program
