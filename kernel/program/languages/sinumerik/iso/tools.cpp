// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// T, D, H and the data that programs write (specification 10, 14).
namespace servogate::program::sinumerik::iso {
namespace {

constexpr int kSplit = 100;  ///< of T on a lathe: the tool above, its offset below
constexpr int kSettable = 6, kFirstOfP = 100, kToolChange = 6;
constexpr std::string_view kTurned = "XYZ";

const Tables::Corrector* row_of(const Execution& run, int number) {
  const auto& rows = run.state().frames.tables->correctors;
  const auto row = rows.find(number);
  return row == rows.end() ? nullptr : &row->second;
}

/// The length of a row acts along the axis across the plane.
void use_length(Execution& run, int column) {
  State& state = run.state();
  const int axis = setting(run, "SD42940") == 17.0 ? run.axes().find('Z') : state.frames.normal;
  const int number = static_cast<int>(value(state, own::length_row));
  if (axis < 0) return;
  const Tables::Corrector* row = row_of(run, number);
  if (number != 0 && row == nullptr && column > 0)
    fail(Wrong::offset_missing, column, {"H" + std::to_string(number)});
  const std::string& letter = run.machine().axes[at(axis)].letter;
  double length = 0.0;
  if (row != nullptr) length = row->length_of(row->length.contains(letter) ? letter : "Z");
  length *= value(state, own::length_sign);
  const bool moves =
      setting(run, "MD20382") == 1.0 && std::abs(length - state.frames.frame.length(axis)) > 1e-9;
  const double programmed = state.frames.programmed[at(axis)];
  state.frames.frame.set_length(axis, length);
  run.frames().changed();
  if (!moves) return;
  value(state, own::length_due) = axis + 1.0;
  value(state, own::length_goal) = programmed;
}

void select(Execution& run, double sign) {
  run.state().frames.lengths_by_language = true;
  value(run.state(), own::length_sign) = sign;
  use_length(run, 0);
}

/// Where the tip of a turning tool points: along Z and along X.
struct Tip {
  double z, x;
};
constexpr Tip kTips[] = {{0, 0}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1},
                         {1, 0}, {0, 1}, {-1, 0}, {0, -1},  {0, 0}};

/// While the centre of the nose runs beside the contour, lengths count from it and not from the tip.
void shift_to_nose(Execution& run, double share) {
  if (!run.machine().turns()) return;
  FramesState& frames = run.state().frames;
  run.frames().use_lengths(frames.active_corrector);
  const Tables::Corrector* row = row_of(run, frames.active_corrector);
  const int z = run.axes().find('Z'), x = run.axes().find('X');
  if (row == nullptr || z < 0 || x < 0 || share == 0.0) return;
  const Tip tip = kTips[row->quadrant >= 0 && row->quadrant <= 9 ? row->quadrant : 0];
  const double radius = row->radius + row->radius_wear;
  frames.frame.set_length(z, frames.frame.length(z) + share * tip.z * radius);
  frames.frame.set_length(x, frames.frame.length(x) + share * tip.x * radius);
  run.frames().changed();
}

}  // namespace

void length_plus(Execution& run, BlockWords&, const Word&) { select(run, 1.0); }
void length_minus(Execution& run, BlockWords&, const Word&) { select(run, -1.0); }
void length_off(Execution& run, BlockWords&, const Word&) {
  value(run.state(), own::length_row) = 0.0;
  select(run, 0.0);
}

void nose_on(Execution& run, BlockWords&, const Word&) { shift_to_nose(run, 1.0); }
void nose_off(Execution& run, BlockWords&, const Word&) { shift_to_nose(run, 0.0); }

/// On a lathe T0203 is tool 2 with the offset 3, and T2 is T0202; on a milling machine H and D name offsets.
void arrange_tool(Execution& run, BlockWords& words) {
  State& state = run.state();
  Block& block = run.block();
  const bool turns = run.machine().turns();
  state.frames.lengths_by_language = !turns;
  if (words.tool != nullptr) {
    Word& tool = block.words[static_cast<std::size_t>(words.tool - block.words.data())];
    const int number = run.numbers().whole(tool.value, "T");
    block.corrector = Value{};
    block.corrector.column = tool.column;
    const bool split = turns && number >= kSplit;
    if (split) tool.value.number = number / kSplit;
    block.corrector.number = !turns ? state.frames.corrector : split ? number % kSplit : number;
  }
  words.tool_behind = words.tool != nullptr && setting(run, "MD22220") == 2.0;
  if (turns || words.instead != nullptr) return;
  const Word *h = find(block, 'H'), *d = find(block, 'D');
  const bool changes = std::find(words.m_code.begin(), words.m_code.begin() + words.m_count, kToolChange) !=
                       words.m_code.begin() + words.m_count;
  if (changes && setting(run, "MD20270") == 0.0) {
    value(state, own::length_row) = 0.0;
    use_length(run, 0);
  }
  if (h != nullptr) {
    value(state, own::length_row) = whole(run, 'H', 0);
    if (value(state, own::length_sign) != 0.0) use_length(run, h->column);
  }
  if (d == nullptr) return;
  const int number = whole(run, 'D', 0);
  if (number != 0 && row_of(run, number) == nullptr)
    fail(Wrong::offset_missing, d->column, {"D" + std::to_string(number)});
  if (run.contour().engaged() && number != state.frames.radius_row)
    fail(Wrong::compensated, d->column, {"D" + std::to_string(number), "G41/G42"});
  state.frames.radius_row = number;
}

void arrange_length(Execution& run, BlockWords& words) {
  State& state = run.state();
  const int axis = static_cast<int>(value(state, own::length_due)) - 1;
  if (axis < 0 || words.axes == 0) return;
  value(state, own::length_due) = 0.0;
  if (words.instead == nullptr && words.axis[at(axis)] == nullptr)
    set_axis(run, words, axis, value(state, own::length_goal));
}

namespace {

void adopt(Execution& run, Tables tables) {
  State& state = run.state();
  run.frames().adopt(std::move(tables));
  if (run.machine().turns())
    shift_to_nose(run, state.modes.compensation == Function::compensation_off ? 0.0 : 1.0);
  else if (value(state, own::length_sign) != 0.0)
    use_length(run, 0);
}

bool adds(const Execution& run, const Word& word) {
  return word.value.dimension == Dimension::as_modes ? run.state().modes.dimension == Function::incremental
                                                     : word.value.dimension == Dimension::incremental;
}

/// G10 L2 P and G10 P00: settable offsets, 0 the external one.
void write_offset(Execution& run, const BlockWords& words, int number) {
  Tables tables = *run.state().frames.tables;
  for (int a = 0; a < run.machine().axis_count(); ++a) {
    const Word* word = words.axis[at(a)];
    if (word == nullptr) continue;
    double& entry = tables.origins[number][run.machine().axes[at(a)].letter];
    const double written = run.numbers().length(a, word->value);
    entry = adds(run, *word) ? entry + written : written;
  }
  adopt(run, std::move(tables));
  refresh_offsets(run);
}

Tables::Corrector& existing(Tables& tables, int number, int column) {
  const auto row = tables.correctors.find(number);
  if (row == tables.correctors.end()) fail(Wrong::offset_missing, column, {"P" + std::to_string(number)});
  return row->second;
}

/// On a lathe P1 to 99 are the wear of that offset, P101 on its geometry; with MD20734 bit 1 from 10001 on.
void write_turned(Execution& run, const BlockWords& words, int p) {
  only(run, "PXYZUVWRCQ");
  const int first = bit(run, 1) ? 10'000 : 100;
  const bool geometry = p > first;
  Tables tables = *run.state().frames.tables;
  Tables::Corrector& row = existing(tables, geometry ? p - first : p, find(run.block(), 'P')->column);
  for (const char letter : kTurned) {
    const int axis = run.axes().find(letter);
    const Word* word = axis < 0 ? nullptr : words.axis[at(axis)];
    if (word == nullptr) continue;
    double& entry = (geometry ? row.length : row.wear)[std::string(1, letter)];
    const double written = run.numbers().length(axis, word->value);
    entry = adds(run, *word) ? entry + written : written;
  }
  double& radius = geometry ? row.radius : row.radius_wear;
  if (const Word* r = find(run.block(), 'R'); r != nullptr) radius = length(run, *r);
  if (const Word* c = find(run.block(), 'C'); c != nullptr) radius += length(run, *c);
  const int tip = whole(run, 'Q', row.quadrant);
  if (tip > 9)
    fail(Fault::out_of_range, find(run.block(), 'Q')->column, {"Q", std::to_string(tip), "0", "9"});
  row.quadrant = tip;
  adopt(run, std::move(tables));
}

/// L10 length, L11 (or L1) its wear, L12 radius, L13 its wear.
void write_milled(Execution& run, const BlockWords& words, int kind) {
  only(run, "LPR");
  for (const char letter : {'P', 'R'})
    if (find(run.block(), letter) == nullptr)
      fail(Wrong::letter_missing, column(words), {"G10", std::string(1, letter)});
  Tables tables = *run.state().frames.tables;
  Tables::Corrector& row = existing(tables, whole(run, 'P', 0), find(run.block(), 'P')->column);
  const double written = length(run, *find(run.block(), 'R'));
  double& entry = kind == 10   ? row.length["Z"]
                  : kind == 12 ? row.radius
                  : kind == 13 ? row.radius_wear
                               : row.wear["Z"];
  entry = run.state().modes.dimension == Function::incremental ? entry + written : written;
  adopt(run, std::move(tables));
}

}  // namespace

/// With MD20734 bit 13 the data are written when the motion before has ended.
void write_data(Execution& run, const BlockWords& words) {
  if (run.contour().engaged()) fail(Wrong::compensated, column(words), {"G10", "G41/G42"});
  const int kind = whole(run, 'L', 0);
  const Word* p = find(run.block(), 'P');
  const int number = whole(run, 'P', 0);
  run.motion().end_profile();
  if (bit(run, 13)) run.state().flow.barrier = true;
  if (kind == 2) {
    only(run, "LPXYZABCUVWH");
    if (p == nullptr) fail(Wrong::letter_missing, column(words), {"G10 L2", "P"});
    if (number > kSettable) fail(Wrong::offset_number, p->column, {"G10 L2", std::to_string(number), "0-6"});
    return write_offset(run, words, number);
  }
  if (kind == 20) {
    only(run, "LPXYZABCUVW");
    if (p == nullptr) fail(Wrong::letter_missing, column(words), {"G10 L20", "P"});
    if (number < 1 || number > 93)
      fail(Wrong::offset_number, p->column, {"G10 L20", std::to_string(number), "1-93"});
    return write_offset(run, words, kFirstOfP + number);
  }
  if (run.machine().turns()) {
    if (find(run.block(), 'L') != nullptr)
      fail(Wrong::letter_range, find(run.block(), 'L')->column, {"G10", "L", std::to_string(kind), "2"});
    if (p == nullptr) fail(Wrong::letter_missing, column(words), {"G10", "P"});
    if (number == 0) {
      only(run, "PXYZABCUVWH");
      return write_offset(run, words, 0);
    }
    return write_turned(run, words, number);
  }
  if (kind != 1 && (kind < 10 || kind > 13))
    fail(Wrong::letter_range, column(words), {"G10", "L", std::to_string(kind), "2, 10-13"});
  write_milled(run, words, kind);
}

}  // namespace servogate::program::sinumerik::iso
