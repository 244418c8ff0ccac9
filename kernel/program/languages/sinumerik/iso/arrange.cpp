// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/languages/sinumerik/sinumerik.hpp"

namespace servogate::program::sinumerik::iso {
namespace {

constexpr std::uint32_t kCommaBit = 1u << 26;  ///< of the words ,A ,C and ,R
constexpr std::uint32_t bit_of(char letter) {
  return is_capital(letter) ? 1u << (letter - 'A') : letter == ',' ? kCommaBit : 0u;
}

/// B is an output to the PLC where it is no axis (specification 12.3).
void without_axis(Execution& run, BlockWords& words, const Word& word) {
  if (word.letter != 'B') fail(Fault::axis_missing, word.column, {std::string(1, word.letter)});
  run.numbers().whole(word.value, "B");
  words.h = &word;
}

/// Of the turning cycles U and W are lengths, whether there are such axes or not; of G10 C is one.
bool takes_any_letter(const BlockWords& words) {
  return words.instead == rough_along || words.instead == rough_across || words.instead == repeat_pattern ||
         words.instead == write_data;
}

/// The letters of the block; what reading has left to the language is judged.
std::uint32_t look(Execution& run, BlockWords& words) {
  const Block& block = run.block();
  std::uint32_t letters = 0, axes = 0;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    const std::uint32_t bit = bit_of(word.letter);
    const bool twice = (letters & bit) != 0 && word.meaning == Meaning::centre_of;
    letters |= bit;
    if (word.meaning == Meaning::axis && word.axis < 0) {
      if (words.instead != nullptr && takes_any_letter(words)) continue;
      without_axis(run, words, word);
      continue;
    }
    const std::uint32_t axis = word.meaning == Meaning::axis ? 1u << word.axis : 0u;
    if (twice || (axes & axis) != 0) fail(Fault::word_twice, word.column, {std::string(1, word.letter)});
    axes |= axis;
  }
  return letters;
}

/// O1234 alone in the first block names the program, as other controls with this language write it.
bool is_name(const Execution& run, BlockWords& words, std::uint32_t letters) {
  if (letters != bit_of('O') || run.state().executed != 1) return false;
  words.amount = nullptr;
  return true;
}

/// G50 S or G92 S of turning bounds the speed of G96, as other controls with this language take it.
bool bounds_speed(Execution& run, BlockWords& words, std::uint32_t letters) {
  if (words.instead != preset || words.speed == nullptr || !run.machine().turns() ||
      (letters & ~bit_of('S')) != bit_of('G'))
    return false;
  const double most = run.numbers().resolve(words.speed->value);
  if (!(most > 0.0))
    fail(Wrong::letter_range, words.speed->column, {g_word(run, words), "S", text::number(most), "> 0"});
  run.state().motion.limit_rpm = most;
  run.state().motion.speed_told = false;
  words.speed = nullptr;
  words.instead = nullptr;
  words.instead_word = nullptr;
  return true;
}

/// MD20250: so many blocks without motion in the plane stand between two of a compensated contour.
void count_dummy_blocks(Execution& run, const BlockWords& words) {
  const FramesState& frames = run.state().frames;
  double& blocks = value(run.state(), own::dummy_blocks);
  const bool moves =
      words.axis[at(frames.axis1)] != nullptr || words.axis[at(frames.axis2)] != nullptr || words.has_centres;
  blocks = moves ? 0.0 : blocks + 1.0;
  const double most = setting(run, "MD20250");
  if (blocks > most)
    fail(Fault::contour_behind, static_cast<int>(run.block().body) + 1, {text::number(most)});
}

/// U beside X in the block of a plane: axes are not exchanged.
void judge_plane(const Execution& run, const BlockWords& words) {
  const Block& block = run.block();
  const Word* plane = nullptr;
  for (std::size_t i = 0; i < block.count; ++i)
    if (const GRule* g = block.words[i].g;
        g != nullptr && g->function >= Function::plane_12 && g->function <= Function::plane_23)
      plane = &block.words[i];
  if (plane == nullptr || words.axes == 0) return;
  constexpr std::string_view kMain = "XYZ", kParallel = "UVW";
  for (std::size_t i = 0; i < kMain.size(); ++i) {
    const int one = run.axes().find(kMain[i]), other = run.axes().find(kParallel[i]);
    if (one < 0 || other < 0 || words.axis[at(other)] == nullptr) continue;
    const Word& word = *words.axis[at(other)];
    if (words.axis[at(one)] != nullptr)
      fail(Wrong::plane_parallel, word.column,
           {word_text(run.dialect(), block, *plane), std::string(1, kMain[i]), std::string(1, kParallel[i])});
    fail(Wrong::plane_exchange, word.column,
         {word_text(run.dialect(), block, *plane), std::string(1, kParallel[i]), std::string(1, kMain[i])});
  }
}

constexpr std::uint32_t kSeldom = bit_of('P') | bit_of('Q') | bit_of('L') | bit_of('H') | bit_of('D') |
                                  bit_of('E') | bit_of('O') | bit_of('T') | bit_of('M');

/// Letters that have a meaning beside certain words only.
constexpr std::uint32_t kOnlyTaken = kSeldom & ~bit_of('T') & ~bit_of('M');

/// Those of them that this block takes though nothing stands in place of its motion.
std::uint32_t taken(const Execution& run, const BlockWords& words, std::uint32_t letters) {
  if ((letters & kOnlyTaken) == 0) return 0;
  const State& state = run.state();
  std::uint32_t taken = 0;
  if (state.modes.motion == Function::thread && words.axes > 0) taken |= bit_of('Q');
  if (words.statement_count > 0) taken |= bit_of('P') | bit_of('L');
  if (value(state, own::length_sign) != 0.0) taken |= bit_of('H');
  if (!run.machine().turns()) taken |= bit_of('D');
  if ((letters & bit_of('G')) != 0 && (letters & bit_of('P')) != 0 && words.count == nullptr)
    taken |= bit_of('P');
  return taken;
}

}  // namespace

void arrange(Execution& run, BlockWords& words) {
  State& state = run.state();
  if (state.contour.coming.kind != CornerWord::Kind::none) run.contour().corner_behind({});
  if (take_macro(run, words)) return;
  scale_numbers(run, words);
  const std::uint32_t letters = look(run, words);
  if (is_name(run, words, letters) || bounds_speed(run, words, letters)) return;
  if (words.feed != nullptr && run.numbers().resolve(words.feed->value) <= 0.0)
    fail(Wrong::feed_zero, words.feed->column, {text::number(words.feed->value.number)});
  if ((letters & kSeldom) != 0) {
    arrange_tool(run, words);
    arrange_calls(run, words);
    arrange_offset(run, words);
  }
  arrange_hole(run, words);
  arrange_turning(run, words);
  if ((letters & (bit_of('U') | bit_of('V') | bit_of('W'))) != 0 && !run.machine().turns())
    judge_plane(run, words);
  arrange_transformation(run, words);
  arrange_length(run, words);
  if (words.instead == nullptr) {
    arrange_polar(run, words);
    if ((letters & kCommaBit) != 0) arrange_angle(run, words);
    arrange_circle(run, words);
    words.for_instead = words.for_instead && (letters & ~taken(run, words, letters) & kOnlyTaken) != 0;
  }
  arrange_override(run);
  if (run.contour().engaged()) count_dummy_blocks(run, words);
  const bool calls = value(state, own::macro) != 0.0 && words.axes > 0 && words.instead == nullptr;
  if (calls && !is_macro_program(run, 2.0)) arrange_calls(run, words);
}

/// G290 and G291 act behind their line; PROC makes a subprogram one of the Siemens mode.
const Dialect* speaks(const MachineModel& machine, std::string_view line, bool first) {
  std::size_t pos = skip_spaces(line, 0);
  const auto takes = [&](std::string_view word) {
    for (std::size_t i = 0; i < word.size(); ++i)
      if (pos + i >= line.size() || capital(line[pos + i]) != word[i]) return false;
    const std::size_t end = pos + word.size();
    return end == line.size() || (!is_digit(line[end]) && !is_letter(line[end]) && line[end] != '.');
  };
  if (first) return takes("PROC") ? &sinumerik::dialect() : nullptr;
  if (pos < line.size() && capital(line[pos]) == 'N') {
    ++pos;
    if (read_index(line, pos) < 0) return nullptr;
    pos = skip_spaces(line, pos);
  }
  if (takes("G290")) return &sinumerik::dialect();
  return takes("G291") ? &dialect(machine) : nullptr;
}

}  // namespace servogate::program::sinumerik::iso
