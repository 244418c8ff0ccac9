// SPDX-License-Identifier: Apache-2.0
// How the words of profiles are read: elements, and what stands between two of them.
#include <algorithm>
#include <string>

#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/profile/profile_words.hpp"
#include "kernel/program/values/number.hpp"

namespace servogate::program::nc110 {

void read_element(BlockText& text, Word& word) {
  const std::string_view line = text.line;
  const std::size_t start = word.column - 1u;
  std::size_t pos = start;
  const auto wrong = [&] { fail(Wrong::element_word, word.column, {std::string(line.substr(start, 2))}); };
  if (line[pos] == '-') pos = skip_spaces(line, pos + 1);
  if (pos >= line.size() || (line[pos] != 'l' && line[pos] != 'c' && (line[pos] != 'p' || pos != start)))
    wrong();
  text.pos = pos + 1;
  word.value = read_value(text, "");
  if (word.value.bare || word.value.fraction || word.value.negative) wrong();
  const std::size_t mark = skip_spaces(line, text.pos);
  if (line.substr(std::min(mark, line.size()), 2) == "s2") text.pos = mark + 2;
  word.text_begin = static_cast<std::uint16_t>(start);
  word.text_end = static_cast<std::uint16_t>(text.pos);
}

void read_corner(BlockText& text, Word& word) {
  const std::size_t start = word.column - 1u;
  const auto measures = [](const Word& g) { return g.g != nullptr && g.g->number == 73; };
  const auto words = text.block.words.begin();
  if (text.line[start] == 'r' && std::any_of(words, words + text.block.count, measures)) {
    word.value = read_value(text, text.line.substr(start, 1));
    word.meaning = Meaning::angle;
    word.rule = nullptr;
    return;
  }
  word.value = read_value(text, text.line.substr(start, 1));
  if (word.value.bare)
    fail(Fault::value_missing, word.column,
         {std::string(text.line.substr(start, 1)), std::string(text.line.substr(start, 1))});
  word.text_begin = static_cast<std::uint16_t>(start);
  word.text_end = static_cast<std::uint16_t>(text.pos);
}

bool corner_word(std::string_view line, std::size_t first) {
  std::size_t pos = first;
  if (pos < line.size() && line[pos] == 'N') {
    ++pos;
    while (pos < line.size() && is_digit(line[pos])) ++pos;
    pos = skip_spaces(line, pos);
  }
  return pos + 1 < line.size() && (line[pos] == 'r' || line[pos] == 'b');
}

}  // namespace servogate::program::nc110
