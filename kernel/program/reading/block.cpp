// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/reading/block.hpp"

#include <algorithm>
#include <string>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/reading/block_parts.hpp"

namespace servogate::program {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

bool begins_comment(const Lexis& lexis, std::string_view line, std::size_t pos) {
  const char c = line[pos];
  if (c == lexis.comment) return c != '\0';
  return c == lexis.comment_pair && c != '\0' && pos + 1 < line.size() && line[pos + 1] == c;
}

/// Offset of a comment that follows words, or the end of the line; says which kind of block stands here.
void classify(const Lexis& lexis, Block& block) {
  const std::string_view line = block.line;
  block.end = line.size();
  const bool bracket = lexis.bracket == Bracket::own_form && line[block.body] == '(';
  block.kind = bracket ? BlockKind::own_form : BlockKind::words;
  const auto bit = [](char c) { return std::uint64_t{1} << (static_cast<unsigned char>(c) & 63u); };
  const bool comments = lexis.bracket == Bracket::comment;
  const std::uint64_t marks = bit('"') | bit('=') | bit(lexis.comment) | bit(lexis.comment_pair) |
                              (comments ? bit('(') | bit(')') : 0u);
  bool quoted = false;
  int depth = 0;  // of brackets that are comments
  const std::size_t size = line.size();
  for (std::size_t i = block.body; i < size; ++i) {
    const char c = line[i];
    if ((marks >> (static_cast<unsigned char>(c) & 63u) & 1u) == 0) continue;  // most characters, in one step
    if (comments && (c == '(' || c == ')')) depth = std::max(0, depth + (c == '(' ? 1 : -1));
    if (depth > 0) continue;
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '=' && lexis.equals_is_own_form) block.kind = BlockKind::own_form;
    if (begins_comment(lexis, line, i)) {
      block.end = i;
      block.trailing_comment = true;
      break;
    }
  }
  if (quoted) fail(Fault::string_unclosed, column(line.rfind('"')));
  while (block.end > block.body && is_space(line[block.end - 1])) --block.end;
}

}  // namespace

AxisLetters::AxisLetters(const std::vector<std::string>& letters) : AxisLetters() {
  for (std::size_t i = 0; i < letters.size(); ++i)
    if (letters[i].size() == 1 && static_cast<unsigned char>(letters[i][0]) < 128)
      index_[static_cast<unsigned char>(letters[i][0])] = static_cast<std::int8_t>(i);
}

const Word* Block::find(Meaning meaning) const noexcept {
  for (std::size_t i = 0; i < count; ++i)
    if (words[i].meaning == meaning) return &words[i];
  return nullptr;
}

int column_of(const Block& block, int axis) noexcept {
  if (axis >= 0 && block.kind == BlockKind::words)
    for (std::size_t i = 0; i < block.count; ++i)
      if (block.words[i].axis == axis) return block.words[i].column;
  return column(block.body);
}

std::string word_text(const Dialect& dialect, const Block& block, const Word& word) {
  const std::size_t start = word.column - 1u;
  if (word.value.parameter >= 0)
    return std::string(1, word.letter) + (word.value.negative ? "-" : "") +
           dialect.parameters.name_of(word.value.parameter);
  std::size_t end = word.column;
  while (end < block.end && !is_letter(block.line[end]) && !is_space(block.line[end])) ++end;
  if (word.letter == 0 || word.value.expression != 0) end = word.end;
  return std::string(block.line.substr(start, end - start));
}

bool holds_nothing(const Lexis& lexis, std::string_view line, std::size_t first) noexcept {
  if (first == line.size() || begins_comment(lexis, line, first)) return true;
  return lexis.tape != '\0' && line[first] == lexis.tape;
}

void read_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  if (!read_plain_block(dialect, axes, line, block)) read_any_block(dialect, axes, line, block);
}

void read_any_block(const Dialect& dialect, const AxisLetters& axes, std::string_view line, Block& block) {
  begin_block(block, line);
  if (holds_nothing(dialect.lexis, line, skip_spaces(line, 0))) return;
  if (line.size() > dialect.max_block_characters &&
      (characters(line) > dialect.max_block_characters || line.size() > 4 * dialect.max_block_characters))
    fail(Fault::block_too_long, static_cast<int>(dialect.max_block_characters) + 1,
         {std::to_string(characters(line)), std::to_string(dialect.max_block_characters)});
  read_prefix(dialect, line, block);
  if (block.body >= line.size()) return;
  classify(dialect.lexis, block);
  if (block.body >= block.end) {
    block.kind = BlockKind::empty;
    return;
  }
  if (block.kind == BlockKind::words) read_words(dialect, axes, block);
}

}  // namespace servogate::program
