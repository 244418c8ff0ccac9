// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// ,C chamfer, ,R rounding, ,A angle of the line (specification 5.5).
namespace servogate::program::sinumerik::iso {
namespace {

void read_comma(BlockText& text, Word& word) {
  const char c = capital(text.peek());
  if (c != 'C' && c != 'R' && c != 'A') fail(Fault::expected, text.column(), {"C, R, A"});
  ++text.pos;
  word.text_begin = static_cast<std::uint16_t>(c);
  word.value = read_value(text, std::string(",") + c);
  if (word.value.bare) fail(Fault::value_missing, word.column, {std::string(",") + c, std::string(",") + c});
}

void nothing(Execution&, const Word&) {}

const Word* comma(const Block& block, char letter) {
  for (std::size_t i = 0; i < block.count; ++i)
    if (block.words[i].letter == ',' && block.words[i].text_begin == static_cast<std::uint16_t>(letter))
      return &block.words[i];
  return nullptr;
}

double angle_of(const Execution& run, const Word& word) {
  const bool thousandths = !word.value.fraction && setting(run, "MD10884") == 0.0;
  return word.value.number * (thousandths ? 0.001 : 1.0);
}

/// The next block with words, and its angle; the corner is where the two lines meet.
struct Next {
  bool found = false;
  double angle = 0.0;
  Point end;
};

Next next_line(Execution& run, Point from) {
  Next next;
  const Source& source = run.flow().source();
  Block block;
  for (std::uint32_t line = run.flow().line() + 1; line < source.lines(); ++line) {
    try {
      read_block(run.dialect(), run.axes(), source.line(line), block);
    } catch (const ProgramError&) {
      return next;  // told where it is executed
    }
    if (block.kind == BlockKind::empty) continue;
    const FramesState& frames = run.state().frames;
    const Word* angle = comma(block, 'A');
    const bool standard = setting(run, "MD10884") == 0.0;
    int ends = 0;
    next.end = from;
    for (std::size_t i = 0; i < block.count; ++i) {
      Word word = block.words[i];
      if (word.meaning != Meaning::axis || (word.axis != frames.axis1 && word.axis != frames.axis2)) continue;
      if (standard && !word.value.fraction)
        word.value.number *= run.state().modes.unit == Function::inch ? 0.0001 : 0.001;
      const double written = run.numbers().length(word.axis, word.value);
      (word.axis == frames.axis1 ? next.end.x : next.end.y) = written;
      ++ends;
    }
    if (angle == nullptr || ends != 2 || run.state().modes.dimension == Function::incremental) return next;
    next.angle = angle_of(run, *angle);
    next.found = true;
    return next;
  }
  return next;
}

}  // namespace

constexpr WordRule kCommaRule = {.name = ",", .read = read_comma, .run = nothing};
const WordRule kComma = kCommaRule;

/// An end that the angle gives, and what stands between this motion and the next one.
void arrange_angle(Execution& run, BlockWords& words) {
  Block& block = run.block();
  const State& state = run.state();
  const int a1 = state.frames.axis1, a2 = state.frames.axis2;
  const Function motion = state.modes.motion;
  const Word *angle = comma(block, 'A'), *chamfer = comma(block, 'C'), *round = comma(block, 'R');
  const Word* first = angle != nullptr ? angle : chamfer != nullptr ? chamfer : round;
  if (motion != Function::line && motion != Function::arc_cw && motion != Function::arc_ccw)
    fail(Fault::word_without_function, first->column, {word_text(run.dialect(), block, *first)});
  run.frames().need_plane(first->column);
  if (angle != nullptr && motion == Function::line) {
    const double degrees = angle_of(run, *angle), c = cos_deg(degrees), s = sin_deg(degrees);
    const Point from{state.frames.programmed[at(a1)], state.frames.programmed[at(a2)]};
    const bool one = words.axis[at(a1)] != nullptr, two = words.axis[at(a2)] != nullptr;
    const auto refuse = [&] { fail(Wrong::angle_none, angle->column, {text::number(degrees)}); };
    if (one && !two) {
      if (std::abs(c) < 1e-9) refuse();
      const double way = (target(run, words, a1) - from.x) / c;
      if (way < 0.0) refuse();
      set_axis(run, words, a2, from.y + way * s);
    } else if (two && !one) {
      if (std::abs(s) < 1e-9) refuse();
      const double way = (target(run, words, a2) - from.y) / s;
      if (way < 0.0) refuse();
      set_axis(run, words, a1, from.x + way * c);
    } else if (!one && !two) {
      const Next next = next_line(run, from);
      const double nc = cos_deg(next.angle), ns = sin_deg(next.angle), turn = c * ns - s * nc;
      if (!next.found || std::abs(turn) < 1e-9) refuse();
      const double way = ((next.end.x - from.x) * ns - (next.end.y - from.y) * nc) / turn;
      if (way <= 0.0) refuse();
      set_axis(run, words, a1, from.x + way * c);
      set_axis(run, words, a2, from.y + way * s);
    }
  }
  if (words.axis[at(a1)] == nullptr && words.axis[at(a2)] == nullptr) return;
  const Word* corner = chamfer != nullptr ? chamfer : round;
  if (corner == nullptr) return;
  const double size = std::abs(notated(run, *corner));
  if (!(size > 0.0))
    fail(Fault::out_of_range, corner->column,
         {chamfer != nullptr ? ",C" : ",R", text::number(size), "0.001", "99999"});
  CornerWord word;
  word.kind = chamfer != nullptr ? CornerWord::Kind::chamfer : CornerWord::Kind::radius;
  word.value = size;
  word.place = run.contour().place(corner->column, block.number);
  run.contour().corner_behind(std::move(word));
}

}  // namespace servogate::program::sinumerik::iso
