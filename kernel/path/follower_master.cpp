// SPDX-License-Identifier: Apache-2.0
// How the follower goes by the spindle's angle.
#include <algorithm>
#include <cmath>

#include "kernel/path/follower.hpp"

namespace servogate::path {
namespace {

constexpr std::uint64_t kPiecesLookedAt = 256;  // of a run; with more of them any axis may take all
constexpr int kSpansPerCycle = 16;              // passed

}  // namespace

void Follower::set_master(const MasterReading& reading) noexcept {
  reading_ = reading;
  estimate_.take(reading);
  if (!reading.by_setpoint) return;
  MasterReading commanded = reading;
  commanded.valid = reading.valid && reading.setpoint_ahead.has_value();
  const double angle = reading.part + reading.setpoint_ahead.value_or(0.0), whole = std::floor(angle);
  commanded.turns += static_cast<std::int64_t>(whole);
  commanded.part = angle - whole;
  commanded_.take(commanded);
}

bool Follower::begin_by_master() noexcept {
  if (!master_.begin(window_)) return false;
  by_master_ = true;
  off_path_ = false;
  legs_behind_ = 0;
  run_begin_ = 0.0;
  retract_.clear();
  along_ = Vector{};
  std::uint64_t pieces = 0;
  bool bends = false;
  for (int n = 0; window_.span(n) != nullptr; ++n) {
    const Span& span = *window_.span(n);
    for (std::uint64_t k = 0; k < span.pieces && pieces < kPiecesLookedAt; ++k, ++pieces) {
      const Piece& piece = track_.pieces[span.first_piece + k];
      bends = bends || piece.shape != Piece::Shape::line;
      for (int i = 0; i < config_.axis_count && piece.shape == Piece::Shape::line; ++i)
        along_[i] = std::max(along_[i], std::abs(piece.c1[i]));
    }
    if (span.stop) break;
  }
  const bool unknown = pieces == kPiecesLookedAt || !master_.ends();
  for (double& axis : along_)  // a rounded corner may take all that an axis has
    if (unknown || (bends && axis > 0.0)) axis = 1.0;
  return true;
}

void Follower::follow_master() noexcept {
  const bool rests = master_.left();
  const bool leave = stopping_ || (hold_ && config_.threads.hold_retracts && !master_.taps());
  master_.extend(window_);
  master_.step(master_.by_setpoint(reading_) ? commanded_ : estimate_, reading_, rest_asked(), leave);
  if (rests) retract_.path_rests(config_);
  if (master_.leaving()) return move_off_path();
  leave_spans_behind();
  if (!master_.arrived()) return;
  const Span span = front();
  window_.pop();
  arrive(track_.pieces[span.first_piece + span.pieces - 1], false);
  track_.pieces.free_below(span.first_piece + span.pieces);
}

/// A leg of a tap ends where its spindle has turned round.
void Follower::leave_spans_behind() noexcept {
  for (int n = 0; n < kSpansPerCycle; ++n) {
    const Span span = front();
    const bool tapped = legs_behind_ < master_.leg();
    const bool passed =
        !span.stop && master_.state().s > run_begin_ + span.length && window_.span(1) != nullptr;
    if (!tapped && !passed) return;
    if (passed) run_begin_ += span.length;
    if (tapped) ++legs_behind_;
    window_.pop();
    track_.pieces.free_below(span.first_piece + span.pieces);
    enter();
  }
}

/// The path has at most the speed that it settles at, until it rests.
void Follower::begin_retract() noexcept {
  const MotionState& at = master_.state();
  Box leaving = master_.box();
  leaving.velocity = at.v + 0.5 * at.a * std::max(0.0, at.a) / leaving.jerk;
  Retract::Path path;
  path.along = along_;
  path.box = leaving;
  path.at = sample_.position;
  path.way = ramp_distance(at.v, at.a, 0.0, leaving) + at.v * config_.period_s;
  retract_.begin(config_, front().terms.feed.lock, path);
}

/// Off the thread, beside what the path still moves until it rests; then the path is given up.
void Follower::move_off_path() noexcept {
  if (!off_path_ && master_.state().v != 0.0 && !master_.taps()) begin_retract();
  off_path_ = true;
  leave_spans_behind();
  retract_.step(config_.period_s);
  if (master_.left() && !retract_.moving()) stopping_ = true;
}

void Follower::place_master_on_axes() noexcept {
  MotionState state = master_.state();
  state.s -= run_begin_;
  locate(state.s);
  const Piece& piece = track_.pieces[piece_];
  const double s = state.s - piece.start;
  // Only a tap may be beyond its depth.
  place_on_axes(master_.taps() ? s : std::clamp(s, 0.0, piece.length), state);
  if (!off_path_) return;
  for (int i = 0; i < config_.axis_count; ++i) {
    const MotionState off = retract_.at(i);
    sample_.position[i] += off.s;
    sample_.velocity[i] += off.v;
    sample_.acceleration[i] += off.a;
  }
}

void Follower::show_master() noexcept {
  ByMaster& shown = sample_.master;
  shown.underway = in_span_ && by_master_;
  if (!shown.underway) {
    shown.waits = shown.leaving = shown.locked = shown.taps = shown.bound = shown.halt = false;
    shown.turn = 0;
    shown.fault = MasterFault::none;
    return;
  }
  shown.waits = master_.at_rest() && !master_.leaving();
  shown.leaving = master_.leaving();
  shown.locked = master_.locked();
  shown.taps = master_.taps();
  shown.bound = master_.bound();
  shown.halt = master_.wants_halt();
  shown.turn = static_cast<std::int8_t>(master_.wants_turn());
  shown.turn_rpm = master_.wants_rpm();
  shown.fault = master_.fault();
  shown.value = master_.value();
  shown.limit = master_.limit();
  shown.phase_error = master_.phase_error();
  shown.overshoot = master_.overshoot();
}

}  // namespace servogate::path
