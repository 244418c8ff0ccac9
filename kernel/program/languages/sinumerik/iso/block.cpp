// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

namespace servogate::program::sinumerik::iso {

const Word* find(const Block& block, char letter) {
  for (std::size_t i = 0; i < block.count; ++i)
    if (block.words[i].letter == letter) return &block.words[i];
  return nullptr;
}

void only(const Execution& run, std::string_view letters) {
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.letter == 'G' || letters.find(word.letter) != std::string_view::npos) continue;
    fail(Fault::word_without_function, word.column, {word_text(run.dialect(), block, word)});
  }
}

double number(const Execution& run, char letter, double otherwise) {
  const Word* word = find(run.block(), letter);
  return word == nullptr ? otherwise : run.numbers().resolve(word->value);
}

int whole(const Execution& run, char letter, int otherwise) {
  const Word* word = find(run.block(), letter);
  return word == nullptr ? otherwise : run.numbers().whole(word->value, std::string(1, letter));
}

double length(const Execution& run, const Word& word) {
  const double unit = run.state().modes.unit == Function::inch ? 25.4 : 1.0;
  return run.numbers().resolve(word.value) * unit;
}

double increments(const Execution& run, const Word& word) {
  const double value = std::abs(length(run, word));
  if (word.value.fraction) return value;
  const double least = run.state().modes.unit == Function::inch ? 0.0001 : 0.001;
  return value * least * (setting(run, "MD10886") == 1.0 ? 0.1 : 1.0);
}

double notated(const Execution& run, const Word& word) {
  return setting(run, "MD10884") == 0.0 ? increments(run, word) : std::abs(length(run, word));
}

void set_axis(Execution& run, BlockWords& words, int axis, double programmed) {
  Block& block = run.block();
  const MachineModel::Axis& a = run.machine().axes[at(axis)];
  Word* word = nullptr;
  for (std::size_t i = 0; i < block.count; ++i)
    if (block.words[i].meaning == Meaning::axis && block.words[i].axis == axis) word = &block.words[i];
  if (word == nullptr) {
    if (block.count == Block::kMaxWords)
      fail(Fault::too_many_words, static_cast<int>(block.body) + 1, {std::to_string(Block::kMaxWords)});
    word = &block.words[block.count++];
    *word = Word{};
    word->letter = a.letter[0];
    word->meaning = Meaning::axis;
    word->axis = static_cast<std::int8_t>(axis);
    word->column = word->value.column = static_cast<std::uint16_t>(block.body + 1);
  }
  const double shown = a.diameter && run.state().modes.across == Function::diameter ? 2.0 : 1.0;
  word->value.number = programmed * shown / run.numbers().unit_factor(axis);
  word->value.expression = 0;
  word->value.dimension = Dimension::absolute;
  if (words.axis[at(axis)] == nullptr) ++words.axes;
  words.axis[at(axis)] = word;
}

void leave_to_instead(BlockWords& words) {
  BlockWords kept;
  kept.block = words.block;
  kept.one_shot = words.one_shot;
  kept.then = words.then;
  kept.instead = words.instead;
  kept.instead_word = words.instead_word;
  words = kept;
}

double target(const Execution& run, const BlockWords& words, int axis) {
  const double from = run.state().frames.programmed[at(axis)];
  const Word* word = words.axis[at(axis)];
  if (word == nullptr) return from;
  const double value = run.numbers().length(axis, word->value);
  const bool adds = word->value.dimension == Dimension::as_modes
                        ? run.state().modes.dimension == Function::incremental
                        : word->value.dimension == Dimension::incremental;
  return adds ? from + value : value;
}

std::string g_word(const Execution& run, const BlockWords& words) {
  if (words.instead_word == nullptr) return {};
  return word_text(run.dialect(), run.block(), *words.instead_word);
}

int column(const BlockWords& words) { return words.instead_word == nullptr ? 0 : words.instead_word->column; }

}  // namespace servogate::program::sinumerik::iso
