// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <string>

#include "kernel/program/faults/texts.hpp"
#include "kernel/program/reading/block_parts.hpp"

namespace servogate::program {
namespace {

int column(std::size_t offset) { return static_cast<int>(offset) + 1; }

bool label_character(char c) { return is_letter(c) || is_digit(c) || static_cast<unsigned char>(c) >= 128; }

std::size_t read_label(const Dialect& dialect, std::string_view line, std::size_t pos) {
  const std::size_t close = line.find('"', pos + 1);
  if (close == std::string_view::npos) fail(Fault::label_unclosed, column(pos));
  const std::string_view label = line.substr(pos + 1, close - pos - 1);
  if (label.empty() || characters(label) > dialect.max_label_characters ||
      !std::all_of(label.begin(), label.end(), label_character))
    fail(Fault::label_bad, column(pos), {std::string(label), std::to_string(dialect.max_label_characters)});
  return close + 1;
}

/// Offset of the colon behind a label that begins at `pos`; npos: no such label stands there.
std::size_t colon_of_label(const Lexis& lexis, std::string_view line, std::size_t pos) {
  if (lexis.label != LabelForm::colon || pos + 1 >= line.size()) return std::string_view::npos;
  if (!is_letter(line[pos]) && line[pos] != '_') return std::string_view::npos;
  if (!is_letter(line[pos + 1]) && line[pos + 1] != '_') return std::string_view::npos;
  while (pos < line.size() && name_character(line[pos])) ++pos;
  return pos < line.size() && line[pos] == ':' ? pos : std::string_view::npos;
}

/// A block number begins at `pos`, not a name whose first letter is the same.
bool is_block_number(const Dialect& dialect, std::string_view line, std::size_t pos) {
  char c = line[pos];
  if (dialect.lexis.named_words) {
    c = capital(c);
    if (pos + 1 < line.size() && (is_letter(line[pos + 1]) || line[pos + 1] == '_')) return false;
  }
  return static_cast<unsigned char>(c) < 128 &&
         dialect.letters[static_cast<unsigned char>(c)].meaning == Meaning::number;
}

std::int32_t read_number(const Lexis& lexis, std::string_view line, std::size_t& pos) {
  const std::size_t start = pos++;
  if (lexis.bare_block_number && (pos == line.size() || !is_digit(line[pos]))) return -1;
  const int number = read_index(line, pos);
  if (number < 0 || (pos < line.size() && line[pos] == '.')) fail(Fault::number_missing_block, column(start));
  return number;
}

enum class Prefix : std::uint8_t { none, skip, label, number, colon_label, sync };

Prefix prefix_at(const Dialect& dialect, std::string_view line, std::size_t pos) {
  const Lexis& lexis = dialect.lexis;
  const char c = line[pos];
  if (c == '\0') return Prefix::none;
  if (c == lexis.skip) return Prefix::skip;
  if (c == '"' && lexis.label == LabelForm::quoted) return Prefix::label;
  if (is_block_number(dialect, line, pos)) return Prefix::number;
  if (c == lexis.request_sync || c == lexis.cancel_sync) return Prefix::sync;
  return colon_of_label(lexis, line, pos) != std::string_view::npos ? Prefix::colon_label : Prefix::none;
}

}  // namespace

void fail_prefix(const Dialect& dialect, int column, char c) {
  const Terms& terms = dialect.terms;
  fail(Fault::prefix_order, column, {std::string(1, c), text::both(terms.prefix, terms.prefix_russian)});
}

std::uint8_t read_skip_level(const Lexis& lexis, std::string_view line, std::size_t& pos) {
  const std::size_t begin = ++pos;
  if (!lexis.skip_levels || pos == line.size() || !is_digit(line[pos])) return 0;
  if (lexis.skip_anywhere && read_index(line, pos) > 9)
    fail(Fault::skip_level, column(begin), {std::string(line.substr(begin, pos - begin))});
  pos = begin + 1;
  return static_cast<std::uint8_t>(line[begin] - '0');
}

void read_prefix(const Dialect& dialect, std::string_view line, Block& block) {
  std::size_t pos = 0;
  for (Prefix before = Prefix::none;;) {
    pos = skip_spaces(line, pos);
    if (pos >= line.size()) break;
    const Prefix part = prefix_at(dialect, line, pos);
    if (part == Prefix::none || (part <= before && part == Prefix::skip && dialect.lexis.skip_anywhere))
      break;
    if (part <= before) fail_prefix(dialect, column(pos), line[pos]);
    before = part;
    if (part == Prefix::skip) {
      block.skip = true;
      block.skip_level = read_skip_level(dialect.lexis, line, pos);
    } else if (part == Prefix::label) {
      pos = read_label(dialect, line, pos);
    } else if (part == Prefix::colon_label) {
      pos = colon_of_label(dialect.lexis, line, pos) + 1;
    } else if (part == Prefix::number) {
      block.number_column = static_cast<std::uint16_t>(column(pos));
      block.number = read_number(dialect.lexis, line, pos);
    } else {
      block.sync = line[pos] == dialect.lexis.request_sync ? Sync::request : Sync::cancel;
      ++pos;
    }
  }
  block.body = pos;
}

std::size_t skip_prefix(const Dialect& dialect, std::string_view line, std::int32_t& number,
                        std::string_view& label) noexcept {
  std::size_t pos = skip_spaces(line, 0);
  if (pos < line.size() && line[pos] == dialect.lexis.skip && line[pos] != '\0') {
    ++pos;
    if (dialect.lexis.skip_levels && pos < line.size() && is_digit(line[pos])) ++pos;
    pos = skip_spaces(line, pos);
  }
  if (pos < line.size() && line[pos] == '"' && dialect.lexis.label == LabelForm::quoted) {
    const std::size_t close = line.find('"', pos + 1);
    if (close != std::string_view::npos) {
      label = line.substr(pos + 1, close - pos - 1);
      pos = close + 1;
    }
    return pos;
  }
  if (pos < line.size() && is_block_number(dialect, line, pos)) {
    ++pos;
    number = read_index(line, pos);
    pos = skip_spaces(line, pos);
  }
  const std::size_t colon = colon_of_label(dialect.lexis, line, pos);
  if (colon == std::string_view::npos) return pos;
  label = line.substr(pos, colon - pos);
  return skip_spaces(line, colon + 1);
}

}  // namespace servogate::program
