// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "kernel/program/execution/motion/followers.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// G07.1 cylinder, G12.1 face, G68 about an axis in space: programs go on naming X, Y, Z and C; imagined axes
/// u, v and w stand behind their words, and the axes of the machine follow (specification 5.6, 5.7, 8.8).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLeastRadius = 0.1;  ///< mm; nearer to the centre C would have to turn too fast

using Kind = VirtualAxes::Kind;
using Matrix = std::array<std::array<double, 3>, 3>;

int imagined(const Execution& run, std::size_t n) {
  constexpr std::string_view kLetters = "uvw";
  return run.axes().find(kLetters[n]);
}

void only_word(Execution& run, const BlockWords& words, std::string_view letters) {
  const Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (&word == words.instead_word || letters.find(word.letter) != std::string_view::npos) continue;
    fail(Wrong::alone, word.column, {g_word(run, words), word_text(run.dialect(), block, word)});
  }
  if (run.contour().engaged() || run.state().modes.compensation != Function::compensation_off)
    fail(Wrong::compensated, column(words), {g_word(run, words), "G41/G42"});
  run.motion().end_profile();
}

void end(Execution& run) {
  State& state = run.state();
  end_virtual_axes(run.machine(), state.virtual_axes, state.frames.machine);
  for (std::size_t i = 0; i < 3; ++i) state.own[own::pivot + i] = 0.0;
  value(state, own::cylinder_axis) = 0.0;
  run.frames().select_plane(state.frames.plane, false, 0);
  refresh_offsets(run);
}

void start(Execution& run, const VirtualAxes& axes) {
  State& state = run.state();
  state.virtual_axes = axes;
  state.frames.machine = axes.at;
  run.frames().changed();
}

double programmed(const Execution& run, int axis) { return run.state().frames.programmed[at(axis)]; }

/// The word of a real axis becomes that of the imagined one, its value times `factor`.
void rename(Execution& run, BlockWords& words, int from, int to, double factor) {
  Block& block = run.block();
  for (std::size_t i = 0; i < block.count; ++i) {
    Word& word = block.words[i];
    if (word.axis != from || (word.meaning != Meaning::axis && word.meaning != Meaning::centre_of)) continue;
    word.axis = static_cast<std::int8_t>(to);
    if (word.meaning == Meaning::axis) {
      word.value.number *= factor;
      words.axis[at(from)] = nullptr;
      words.axis[at(to)] = &word;
    }
  }
}

Matrix matrix_of(double i, double j, double k, double degrees) {
  const double size = std::sqrt(i * i + j * j + k * k), c = cos_deg(degrees), s = sin_deg(degrees);
  const std::array<double, 3> u{i / size, j / size, k / size};
  Matrix m{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t q = 0; q < 3; ++q) m[r][q] = u[r] * u[q] * (1.0 - c) + (r == q ? c : 0.0);
  m[0][1] -= u[2] * s, m[1][0] += u[2] * s;
  m[0][2] += u[1] * s, m[2][0] -= u[1] * s;
  m[1][2] -= u[0] * s, m[2][1] += u[0] * s;
  return m;
}

/// G codes that may stand beside a cylinder on a milling machine.
bool beside_cylinder(int g) {
  return g <= 4 || (g >= 40 && g <= 42) || (g >= 65 && g <= 67) || g == 90 || g == 91 ||
         g == kPointInG * 1 + 7;
}

}  // namespace

/// G07.1 C57.296 begins, G07.1 C0 ends. Circles lie in the plane of the unrolled axis and Z.
void cylinder(Execution& run, const BlockWords& words) {
  only_word(run, words, "ABCU");
  int rotary = -1;
  for (int a = 0; a < run.machine().axis_count(); ++a)
    if (words.axis[at(a)] != nullptr) rotary = a;
  if (rotary < 0) fail(Wrong::axis_alone, column(words), {"G07.1"});
  const Word& word = *words.axis[at(rotary)];
  const double radius =
      run.numbers().resolve(word.value) * (run.state().modes.unit == Function::inch ? 25.4 : 1.0);
  if (!run.machine().rotary(rotary) || radius < 0.0)
    fail(Wrong::letter_range, word.column,
         {"G07.1", run.machine().axes[at(rotary)].letter, text::number(radius),
          text::both("the radius of a cylinder about a rotary axis, 0 ends it",
                     "радиус цилиндра вокруг поворотной оси, 0 — отмена")});
  State& state = run.state();
  if (state.virtual_axes.kind != Kind::none) end(run);
  if (radius == 0.0) return;
  refuse_scaled(run, words);
  if (value(state, own::rotation) != 0.0) fail(Wrong::scaled, column(words), {"G07.1"});
  VirtualAxes axes = no_virtual_axes(run.machine());
  axes.at = state.frames.machine;
  axes.kind = Kind::linear;
  axes.followers = axes.leaders = 1;
  axes.follower[0] = rotary;
  axes.leader[0] = imagined(run, 0);
  axes.radius = radius;
  axes.share[0][0] = 1.0 / (kDegree * radius);
  axes.at[at(axes.leader[0])] = programmed(run, rotary) * kDegree * radius;
  start(run, axes);
  value(state, own::cylinder_axis) = rotary + 1.0;
  run.frames().set_plane(axes.leader[0], run.axes().find('Z'), run.axes().find('X'));
}

/// X and C are a plane across the spindle: X as ever, C in mm.
void polar_interpolation(Execution& run, const BlockWords& words) {
  only_word(run, words, "");
  State& state = run.state();
  const int x = run.axes().find('X'), c = run.axes().find('C');
  if (x < 0 || c < 0 || !run.machine().rotary(c))
    fail(Fault::axis_missing, column(words), {x < 0 ? "X" : "C"});
  if (state.virtual_axes.kind != Kind::none) end(run);
  const double radius = programmed(run, x), angle = programmed(run, c);
  if (radius < kLeastRadius)
    fail(Fault::virtual_radius, column(words), {text::number(radius, 4), text::number(kLeastRadius)});
  VirtualAxes axes = no_virtual_axes(run.machine());
  axes.at = state.frames.machine;
  axes.kind = Kind::polar;
  axes.followers = axes.leaders = 2;
  axes.follower = {x, c};
  axes.leader = {imagined(run, 0), imagined(run, 1)};
  axes.least_radius = kLeastRadius;
  axes.at[at(axes.leader[0])] = radius * cos_deg(angle);
  axes.at[at(axes.leader[1])] = radius * sin_deg(angle);
  start(run, axes);
  run.frames().set_plane(axes.leader[0], axes.leader[1], run.axes().find('Z'));
}

void polar_interpolation_off(Execution& run, const BlockWords& words) {
  only_word(run, words, "");
  if (run.state().virtual_axes.kind == Kind::polar) end(run);
}

/// About I, J, K through X, Y, Z, which becomes the zero; a second one adds (specification 8.8).
void turn_space(Execution& run, const BlockWords& words) {
  State& state = run.state();
  const double i = number(run, 'I'), j = number(run, 'J'), k = number(run, 'K');
  if (i == 0.0 && j == 0.0 && k == 0.0) fail(Wrong::rotation_vector, column(words), {g_word(run, words)});
  const std::array<int, 3> real{run.axes().find('X'), run.axes().find('Y'), run.axes().find('Z')};
  for (std::size_t n = 0; n < 3; ++n)
    if (real[n] < 0) fail(Fault::axis_missing, column(words), {std::string(1, "XYZ"[n])});
  if (value(state, own::rotation) != 0.0) fail(Wrong::scaled, column(words), {g_word(run, words)});
  refuse_scaled(run, words);
  const Matrix turn = matrix_of(i, j, k, number(run, 'R', setting(run, "SD42150")));
  const bool second = state.virtual_axes.kind == Kind::linear && state.virtual_axes.leaders == 3;
  std::array<double, 3> pivot{};
  for (std::size_t n = 0; n < 3; ++n)
    if (const Word* word = find(run.block(), "XYZ"[n]); word != nullptr) pivot[n] = length(run, *word);
  Matrix before{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::array<double, 3> shift{};
  if (second)
    for (std::size_t n = 0; n < 3; ++n) {
      shift[n] = state.own[own::pivot + n];
      for (std::size_t q = 0; q < 3; ++q) before[n][q] = state.virtual_axes.share[n][q];
    }
  end_virtual_axes(run.machine(), state.virtual_axes, state.frames.machine);
  VirtualAxes axes = no_virtual_axes(run.machine());
  axes.kind = Kind::linear;
  axes.followers = axes.leaders = 3;
  axes.keeps_lengths = true;
  for (std::size_t n = 0; n < 3; ++n) {
    axes.follower[n] = real[n];
    axes.leader[n] = imagined(run, n);
    state.own[own::pivot + n] = shift[n];
    for (std::size_t q = 0; q < 3; ++q) {
      state.own[own::pivot + n] += before[n][q] * pivot[q];
      axes.share[n][q] = 0.0;
      for (std::size_t p = 0; p < 3; ++p) axes.share[n][q] += before[n][p] * turn[p][q];
    }
  }
  refresh_offsets(run);
  axes.at = state.frames.machine;
  for (std::size_t q = 0; q < 3; ++q) {
    double place = 0.0;
    for (std::size_t n = 0; n < 3; ++n) place += axes.share[n][q] * programmed(run, real[n]);
    axes.at[at(axes.leader[q])] = place;
  }
  start(run, axes);
  const Function plane = state.frames.plane;
  const std::size_t first = plane == Function::plane_12 ? 0 : plane == Function::plane_31 ? 2 : 1;
  run.frames().set_plane(axes.leader[first], axes.leader[(first + 1) % 3], axes.leader[(first + 2) % 3]);
}

void end_transformation(Execution& run) {
  if (run.state().virtual_axes.kind != Kind::none) end(run);
}

void arrange_transformation(Execution& run, BlockWords& words) {
  const VirtualAxes& axes = run.state().virtual_axes;
  if (axes.kind == Kind::none) return;
  const Block& block = run.block();
  const bool cylinder_on = value(run.state(), own::cylinder_axis) != 0.0;
  for (std::size_t i = 0; i < block.count; ++i) {
    const Word& word = block.words[i];
    if (word.g == nullptr) continue;
    const bool frame = word.g->function == Function::work_offset || word.g->motion == preset ||
                       word.g->motion == local || word.g->motion == scale || word.g->motion == mirror ||
                       word.g->motion == rotate || word.g->motion == rotate_turned;
    const bool turned = word.g->motion == rotate && !cylinder_on && axes.kind != Kind::polar;
    if ((frame && !turned) || (cylinder_on && !run.machine().turns() && !beside_cylinder(word.g->number)))
      fail(Wrong::alone, word.column,
           {cylinder_on                ? "G07.1"
            : axes.kind == Kind::polar ? "G12.1"
                                       : "G68",
            word_text(run.dialect(), block, word)});
  }
  if (words.instead != nullptr) {
    const bool ends = words.instead == rotate || words.instead == rotate_off || words.instead == cylinder ||
                      words.instead == polar_interpolation || words.instead == polar_interpolation_off ||
                      words.instead == dwell;
    for (int i = 0; !ends && i < axes.followers; ++i)
      if (const Word* word = words.axis[at(axes.follower[at(i)])]; word != nullptr)
        fail(Wrong::alone, word->column,
             {cylinder_on                ? "G07.1"
              : axes.kind == Kind::polar ? "G12.1"
                                         : "G68",
              word_text(run.dialect(), block, *word)});
    return;
  }
  if (axes.kind == Kind::polar) {
    const double half = run.machine().axes[at(axes.follower[0])].diameter ? 0.5 : 1.0;
    rename(run, words, axes.follower[0], axes.leader[0], half);
    rename(run, words, axes.follower[1], axes.leader[1], 1.0);
    for (std::size_t i = 0; i < block.count; ++i)
      if (block.words[i].letter == 'J') run.block().words[i].axis = static_cast<std::int8_t>(axes.leader[1]);
    return;
  }
  if (cylinder_on)
    return rename(run, words, axes.follower[0], axes.leader[0],
                  kDegree * axes.radius / run.numbers().unit_factor(axes.leader[0]));
  for (std::size_t n = 0; n < 3; ++n) rename(run, words, axes.follower[n], axes.leader[n], 1.0);
}

}  // namespace servogate::program::sinumerik::iso
