// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/planning.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::path {
namespace {

constexpr std::uint32_t kMostPieces = 512;  // in a span
constexpr double kPiecesPerCycle = 50.0;    // the most the cycle has to walk over
constexpr double kSpansPerCycle = 4.0;

/// Stretches that may be driven as one: their feeds have the same master.
bool same_master(const Feed& a, const Feed& b) {
  if (a.lock.kind != b.lock.kind || a.lock.change != b.lock.change || a.lock.change != 0.0) return false;
  if (a.per_turn == 0.0 || b.per_turn == 0.0) return a.per_turn == b.per_turn;
  return std::abs(a.per_turn - b.per_turn) <= 1e-3 * a.per_turn &&
         std::max(a.turns, b.turns) <= 1.05 * std::min(a.turns, b.turns);
}

double ramp_time(const Box& b) { return b.velocity / b.acceleration + b.acceleration / b.jerk; }

/// Time that is lost at most when a stretch of `length` and `time` with box `own` is driven with box
/// `common`.
double loss(double length, double time, const Box& own, const Box& common) {
  const double cruise = length / common.velocity - time;
  const double ramps = std::max(0.0, ramp_time({common.velocity, common.acceleration, common.jerk}) -
                                         ramp_time({common.velocity, own.acceleration, own.jerk}));
  return cruise + ramps * std::min(1.0, time / ramp_time(own));
}

Box least(const Box& a, const Box& b) {
  return {std::min(a.velocity, b.velocity), std::min(a.acceleration, b.acceleration),
          std::min(a.jerk, b.jerk)};
}

}  // namespace

Planning::Planning(const Config& config, std::uint32_t capacity, SpanSink& sink)
    : config_(config), most_pieces_(std::min(kMostPieces, capacity / 16)), sink_(sink) {}

void Planning::restart() {
  open_ = Open{};
  pieces_.clear();
  last_.reset();
}

/// True when the piece is driven with the open span at little loss of time.
bool Planning::belongs(const Piece& piece, const Bound& bound, double own_time) const {
  const Bound& open = open_.least;
  const Box common = least(open.box, bound.box);
  const double lost =
      loss(open_.length, open_.time, open.box, common) + loss(piece.length, own_time, bound.box, common);
  const double scale = common.acceleration / common.jerk;
  const bool same_feed = std::abs(bound.feed.speed - open.feed.speed) <= 1e-3 * open.feed.speed;
  const bool short_ones = std::min(open_.time, own_time) < 0.5 * scale;
  return same_master(open.feed, bound.feed) && lost <= 0.5 * std::min(open_.time + own_time, scale) &&
         (same_feed || short_ones) && pieces_.size() < most_pieces_;
}

void Planning::append(const Piece& piece, const Bound& bound) {
  const double own_time = piece.length / bound.box.velocity;
  if (!pieces_.empty() && !belongs(piece, bound, own_time)) close();
  open_.length += piece.length;
  open_.time += own_time;
  Feed& feed = open_.least.feed;
  open_.least.box = least(open_.least.box, bound.box);
  feed.speed = std::min(feed.speed, bound.feed.speed);
  feed.per_turn = pieces_.empty() ? bound.feed.per_turn : std::min(feed.per_turn, bound.feed.per_turn);
  feed.turns = std::max(feed.turns, bound.feed.turns);
  if (pieces_.empty()) feed.lock = bound.feed.lock;
  feed.rapid = bound.feed.rapid;
  pieces_.push_back(piece);
}

void Planning::close() {
  if (pieces_.empty()) return;
  if (last_) sink_.put(*last_);
  Span& span = last_.emplace();
  span.number = ++number_;
  span.first_piece = next_piece_;
  span.pieces = static_cast<std::uint32_t>(pieces_.size());
  Box& box = span.terms.box;
  Feed& feed = span.terms.feed;
  box = open_.least.box;
  feed = open_.least.feed;
  const double per_cycle = std::min(kSpansPerCycle, kPiecesPerCycle / span.pieces);
  box.velocity = std::min(box.velocity, per_cycle * open_.length / config_.period_s);
  feed.speed = std::min(feed.speed, box.velocity);
  for (Piece& piece : pieces_) {
    piece.start = span.length;
    span.length += piece.length;
    piece.time = time_ += piece.length / box.velocity;
    sink_.put(piece);
  }
  span.time = time_;
  next_piece_ += span.pieces;
  open_ = Open{};
  pieces_.clear();
}

void Planning::rest(bool confirm) {
  close();
  if (!last_) return;
  last_->stop = true;
  last_->confirm = confirm;
  sink_.put(*last_);
  last_.reset();
}

}  // namespace servogate::path
