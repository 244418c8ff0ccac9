// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// What stands between programmed coordinates and the settable offset: G52, presets, rotation, mirror, scale,
/// copies, polar coordinates (specification 8, 22).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kExternal = 0, kFirstOfP = 100, kMostOfP = 93;

double external(const Execution& run, int axis) {
  const FramesState& frames = run.state().frames;
  if (frames.origin[at(axis)] == kExternal) return 0.0;  // it is in force itself
  const auto row = frames.tables->origins.find(kExternal);
  if (row == frames.tables->origins.end()) return 0.0;
  const auto entry = row->second.find(run.machine().axes[at(axis)].letter);
  return entry == row->second.end() ? 0.0 : entry->second;
}

void turn(double& x, double& y, double angle, double cx, double cy) {
  const double dx = x - cx, dy = y - cy;
  x = cx + dx * cos_deg(angle) - dy * sin_deg(angle);
  y = cy + dx * sin_deg(angle) + dy * cos_deg(angle);
}

/// Of a rotation in space, along X, Y and Z.
double pivot(const Execution& run, int axis) {
  const std::size_t n = std::string_view("XYZ").find(run.machine().axes[at(axis)].letter);
  return n < 3 ? run.state().own[own::pivot + n] : 0.0;
}

bool mirrored(const State& state, int axis) {
  return (static_cast<unsigned>(value(state, own::mirror)) >> axis & 1u) != 0;
}

bool scaled(const Execution& run) {
  const Frame& frame = run.state().frames.frame;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (frame.scale(a) != 1.0 || frame.mirrored(a)) return true;
  return false;
}

/// A coordinate of a word, absolute whatever dimensions are in force.
double absolute(const Execution& run, const BlockWords& words, int axis, double otherwise) {
  const Word* word = axis < 0 ? nullptr : words.axis[at(axis)];
  return word == nullptr ? otherwise : run.numbers().length(axis, word->value);
}

void alone(Execution& run, const BlockWords& words, std::string_view letters) {
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.meaning == Meaning::g && &word != words.instead_word && word.g != nullptr &&
        word.g->function != Function::plane_12 && word.g->function != Function::plane_31 &&
        word.g->function != Function::plane_23 && word.g->function != Function::absolute &&
        word.g->function != Function::incremental)
      fail(Wrong::alone, word.column, {g_word(run, words), word_text(run.dialect(), block, word)});
  }
  only(run, letters);
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {g_word(run, words), "G41/G42"});
  run.motion().end_profile();
}

/// About the words of the plane's axes, missing ones where the axes stand; R adds with incremental
/// dimensions.
void rotate_in_plane(Execution& run, const BlockWords& words) {
  State& state = run.state();
  run.frames().need_plane(column(words));
  const FramesState& frames = state.frames;
  const int axes[] = {frames.axis1, frames.axis2};
  for (std::size_t i = 0; i < 2; ++i)
    state.own[own::rotation_at + i] = absolute(run, words, axes[i], frames.programmed[at(axes[i])]);
  const double angle = number(run, 'R', setting(run, "SD42150"));
  const bool adds = state.modes.dimension == Function::incremental;
  value(state, own::rotation) = std::fmod(angle + (adds ? value(state, own::rotation) : 0.0), 360.0);
  refresh_offsets(run);
}

}  // namespace

void refuse_scaled(const Execution& run, const BlockWords& words) {
  if (scaled(run)) fail(Wrong::scaled, column(words), {g_word(run, words)});
}

void refresh_offsets(Execution& run) {
  State& state = run.state();
  Frame& frame = state.frames.frame;
  const int a1 = state.frames.axis1, a2 = state.frames.axis2;
  Position zero{};
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    frame.set_mirrored(a, mirrored(state, a));
    zero[at(a)] = mirrored(state, a) ? 2.0 * state.own[own::mirror_at + at(a)] : 0.0;
  }
  double angle = value(state, own::rotation);
  const double copied = value(state, own::copy_angle);
  if (a1 >= 0 && a2 >= 0) {
    // The rotation is that of the part, whose mirror image turns the other way (table 2-12 of the manual).
    const auto centre = [&](std::size_t n, int axis) {
      const double written = state.own[own::rotation_at + n];
      return mirrored(state, axis) ? 2.0 * state.own[own::mirror_at + at(axis)] - written : written;
    };
    if (mirrored(state, a1) != mirrored(state, a2)) angle = -angle;
    turn(zero[at(a1)], zero[at(a2)], angle, centre(0, a1), centre(1, a2));
    turn(zero[at(a1)], zero[at(a2)], copied, state.own[own::copy_at], state.own[own::copy_at + 1]);
  }
  frame.set_rotation(std::fmod(angle + copied, 360.0));
  for (int a = 0; a < run.machine().axis_count(); ++a)
    frame.set_offset(a, zero[at(a)] + pivot(run, a) + state.own[own::copy_shift + at(a)] +
                            state.own[own::local + at(a)] + state.own[own::preset + at(a)] +
                            external(run, a));
  run.frames().changed();
}

/// The place where the axes stand gets the coordinates of the block; all settable offsets move with it.
void preset(Execution& run, const BlockWords& words) {
  only(run, "XYZABCUVWH");
  refuse_scaled(run, words);
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {g_word(run, words), "G41/G42"});
  if (words.axes == 0) fail(Wrong::axis_alone, column(words), {g_word(run, words)});
  State& state = run.state();
  run.motion().end_profile();
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[at(a)] != nullptr)
      state.own[own::preset + at(a)] += state.frames.programmed[at(a)] - target(run, words, a);
  refresh_offsets(run);
}

/// P0, or the axes that the block names.
void preset_off(Execution& run, const BlockWords& words) {
  only(run, "XYZABCUVWHP");
  State& state = run.state();
  if (words.axes == 0 && find(run.block(), 'P') == nullptr)
    fail(Wrong::axis_alone, column(words), {g_word(run, words)});
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axes == 0 || words.axis[at(a)] != nullptr)
      state.own[own::preset + at(a)] = state.own[own::local + at(a)] = 0.0;
  run.motion().end_profile();
  refresh_offsets(run);
}

void local(Execution& run, const BlockWords& words) {
  only(run, "XYZABCUVWH");
  refuse_scaled(run, words);
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {g_word(run, words), "G41/G42"});
  if (words.axes == 0) fail(Wrong::axis_alone, column(words), {g_word(run, words)});
  for (int a = 0; a < run.machine().axis_count(); ++a)
    run.state().own[own::local + at(a)] = absolute(run, words, a, run.state().own[own::local + at(a)]);
  run.motion().end_profile();
  refresh_offsets(run);
}

void settable(Execution& run, BlockWords&, const Word&) { refresh_offsets(run); }

/// G54 P1 to P93; P0 is the external offset alone.
void arrange_offset(Execution& run, BlockWords& words) {
  const Block& block = run.block();
  const Word* p = find(block, 'P');
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.g == nullptr || word.g->function != Function::work_offset) continue;
    if (scaled(run)) fail(Wrong::scaled, word.column, {word_text(run.dialect(), block, word)});
    if (p == nullptr || words.instead != nullptr || words.statement_count > 0 || word.g->number != 54) return;
    const int number = whole(run, 'P', 0);
    if (number > kMostOfP) fail(Wrong::offset_number, p->column, {"G54", std::to_string(number), "0-93"});
    run.frames().use_origin(number == 0 ? kExternal : kFirstOfP + number, p->column);
    refresh_offsets(run);
    words.count = nullptr;
  }
}

void scale(Execution& run, const BlockWords& words) {
  alone(run, words, "XYZPIJK");
  const double weight = setting(run, "MD22910") == 1.0 ? 0.00001 : 0.001;
  const bool by_axis = setting(run, "MD22914") == 1.0;
  const Block& block = run.block();
  const Word* p = find(block, 'P');
  Frame& frame = run.state().frames.frame;
  constexpr std::string_view kCentres = "IJK", kLetters = "XYZ";
  for (std::size_t i = 0; i < 3; ++i) {
    const int axis = run.axes().find(kLetters[i]);
    if (axis < 0) continue;
    const Word* own = find(block, kCentres[i]);
    const std::string name = std::string("SD43120_") + kLetters[i];
    double factor = by_axis ? setting(run, name.c_str()) : setting(run, "SD42140");
    if (by_axis && own != nullptr) factor = run.numbers().resolve(own->value) * weight;
    const bool named =
        find(block, 'I') != nullptr || find(block, 'J') != nullptr || find(block, 'K') != nullptr;
    if (!by_axis && p != nullptr && !named) factor = run.numbers().resolve(p->value) * weight;
    if (factor == 0.0) fail(Fault::scale_zero, column(words));
    if (!by_axis && factor < 0.0)
      fail(Wrong::letter_range, p->column, {g_word(run, words), "P", text::number(number(run, 'P')), "> 0"});
    frame.set_scale(axis, factor);
  }
  refresh_offsets(run);
}

void scale_off(Execution& run, const BlockWords& words) {
  alone(run, words, "");
  for (int a = 0; a < run.machine().axis_count(); ++a) run.state().frames.frame.set_scale(a, 1.0);
  refresh_offsets(run);
}

void mirror(Execution& run, const BlockWords& words) {
  alone(run, words, "XYZ");
  if (words.axes == 0) fail(Wrong::axis_alone, column(words), {g_word(run, words)});
  State& state = run.state();
  auto bits = static_cast<unsigned>(value(state, own::mirror));
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    if (words.axis[at(a)] == nullptr) continue;
    bits |= 1u << a;
    state.own[own::mirror_at + at(a)] = absolute(run, words, a, 0.0);
  }
  value(state, own::mirror) = bits;
  refresh_offsets(run);
}

void mirror_off(Execution& run, const BlockWords& words) {
  alone(run, words, "XYZ");
  State& state = run.state();
  auto bits = static_cast<unsigned>(value(state, own::mirror));
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axes == 0 || words.axis[at(a)] != nullptr) bits &= ~(1u << a);
  value(state, own::mirror) = bits;
  refresh_offsets(run);
}

/// In the plane, or about I, J and K (specification 8.7, 8.8).
void rotate(Execution& run, const BlockWords& words) {
  for (const char letter : {'I', 'J', 'K'})
    if (const Word* word = find(run.block(), letter); word != nullptr) {
      alone(run, words, "XYZIJKR");
      return turn_space(run, words);
    }
  alone(run, words, "XYZR");
  rotate_in_plane(run, words);
}

/// A double turret is switched by G68 alone, which here has no meaning.
void rotate_turned(Execution& run, const BlockWords& words) {
  alone(run, words, "XYZR");
  if (find(run.block(), 'R') == nullptr) fail(Wrong::turret, column(words), {g_word(run, words)});
  refuse_scaled(run, words);
  rotate_in_plane(run, words);
}

void rotate_off(Execution& run, const BlockWords& words) {
  alone(run, words, "");
  State& state = run.state();
  end_transformation(run);
  value(state, own::rotation) = state.own[own::rotation_at] = state.own[own::rotation_at + 1] = 0.0;
  refresh_offsets(run);
}

/// With G91 the pole of a block with a radius is where the axes stand, otherwise zero (specification 8.11).
void polar_on(Execution& run, BlockWords&, const Word&) {
  State& state = run.state();
  value(state, own::polar) = 1.0;
  state.own[own::polar_at] = state.own[own::polar_at + 1] = 0.0;
}

void polar_off(Execution& run, BlockWords&, const Word&) { value(run.state(), own::polar) = 0.0; }

void arrange_polar(Execution& run, BlockWords& words) {
  State& state = run.state();
  const int a1 = state.frames.axis1, a2 = state.frames.axis2;
  if (value(state, own::polar) == 0.0 || a1 < 0 || a2 < 0) return;
  const Word *radius = words.axis[at(a1)], *angle = words.axis[at(a2)];
  if (radius == nullptr && angle == nullptr) return;
  const bool incremental = state.modes.dimension == Function::incremental;
  const Position& from = state.frames.programmed;
  double pole1 = 0.0, pole2 = 0.0;
  double r = state.own[own::polar_at], phi = state.own[own::polar_at + 1];
  if (incremental) {  // the pole is where the axes stand, and stays where the angle alone changes
    pole1 = from[at(a1)] - (radius == nullptr ? r * cos_deg(phi) : 0.0);
    pole2 = from[at(a2)] - (radius == nullptr ? r * sin_deg(phi) : 0.0);
  }
  if (radius != nullptr)
    r = std::abs(run.numbers().length(a1, radius->value));
  else if (!incremental)
    r = std::hypot(from[at(a1)], from[at(a2)]);
  if (angle != nullptr) {
    const double written = run.numbers().resolve(angle->value);
    phi = incremental ? phi + written : written;
  }
  state.own[own::polar_at] = r;
  state.own[own::polar_at + 1] = phi;
  set_axis(run, words, a1, pole1 + r * cos_deg(phi));
  set_axis(run, words, a2, pole2 + r * sin_deg(phi));
}

}  // namespace servogate::program::sinumerik::iso
