// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/master_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace servogate::path {
namespace {

constexpr double kLeastShare = 0.05;    // of the speed that it was begun with
constexpr double kUnknownPatience = 5;  // s
constexpr double kReadyPatience = 10;   // s, besides the ramp of the spindle
constexpr double kSettles = 0.15;       // s behind the lead-in until the window is watched

double seconds(image::Nanoseconds t) noexcept { return static_cast<double>(t) * 1e-9; }

/// Way from rest to a speed, and the time.
Profile lead_in(double v, const Box& box) noexcept {
  Profile profile;
  profile.start({});
  add_ramp(profile, 0.0, 0.0, v, box);
  return profile;
}

}  // namespace

bool MasterMotion::begin(const Ahead& ahead) noexcept {
  const Span* first = ahead.span(0);
  if (first == nullptr) return false;
  lock_ = first->terms.feed.lock;
  box_ = first->terms.box;
  depth_ = 0.0;
  if (!(taps() ? gather_legs(ahead) : gather_segments(ahead))) return false;
  reset();
  if (taps()) begin_leg();
  return true;
}

bool MasterMotion::gather_segments(const Ahead& ahead) noexcept {
  count_ = 0;
  length_ = known_s_ = 0.0;
  ends_ = false;
  first_time_ = ahead.span(0)->time;
  take_spans(ahead);
  return ends_ || count_ == kMostSpans || known_s_ >= kKnownAhead;
}

void MasterMotion::take_spans(const Ahead& ahead) noexcept {
  const Span* front = ahead.span(0);
  if (front == nullptr) return;
  int n = count_ == 0 ? 0 : static_cast<int>(taken_ + 1 - front->number);
  // That nothing follows the last one may have become known since.
  if (n > 0) ends_ = ahead.span(n - 1) != nullptr && ahead.span(n - 1)->stop;
  for (; !ends_ && count_ < kMostSpans && ahead.span(n) != nullptr; ++n) add_segment(*ahead.span(n));
  reckon_box();
}

void MasterMotion::add_segment(const Span& span) noexcept {
  const Bound& terms = span.terms;
  Segment& g = segments_[static_cast<std::size_t>(count_)];
  g = {};
  g.begin = length_;
  g.per_turn = terms.feed.lock.per_turn;
  g.change = terms.feed.lock.change;
  g.velocity = terms.box.velocity;
  g.acceleration = terms.box.acceleration;
  g.jerk = terms.box.jerk;
  g.length = span.length;
  g.most = std::max(g.per_turn, end_lead(g));
  if (count_ > 0) {
    Segment& before = segments_[static_cast<std::size_t>(count_ - 1)];
    g.turns = before.turns + turns_to(before, before.length);
    g.most = std::max(g.most, end_lead(before));
    before.most = std::max(before.most, g.per_turn);
  }
  length_ += span.length;
  known_s_ = span.time - first_time_;
  taken_ = span.number;
  ends_ = span.stop;
  ++count_;
}

/// Those to which no reading that is still on its way reaches back, nor a change of lead.
void MasterMotion::drop_passed() noexcept {
  constexpr double kReadings = 0.1;  // s
  const double behind = state_.s - kReadings * state_.v;
  int passed = 0;
  while (passed + 2 < count_ && segments_[static_cast<std::size_t>(passed + 2)].begin <= behind) ++passed;
  if (passed == 0) return;
  std::move(segments_.begin() + passed, segments_.begin() + count_, segments_.begin());
  count_ -= passed;
}

void MasterMotion::reckon_box() noexcept {
  box_.acceleration = box_.jerk = std::numeric_limits<double>::infinity();
  for (int n = 0; n < count_; ++n) {
    const Segment& g = segments_[static_cast<std::size_t>(n)];
    box_.acceleration = std::min(box_.acceleration, g.acceleration);
    box_.jerk = std::min(box_.jerk, g.jerk);
  }
}

void MasterMotion::extend(const Ahead& ahead) noexcept {
  if (taps() || ends_ || leaving()) return;
  if (count_ > kMostSpans / 2) drop_passed();
  const int known = count_;
  take_spans(ahead);
  if (phase_ == Phase::waiting) return;
  for (int n = known; n < count_; ++n) smooth_lead(static_cast<std::size_t>(n), begun_with_);
}

void MasterMotion::reset() noexcept {
  state_ = {};
  phase_ = Phase::waiting;
  clock_ = unknown_s_ = not_ready_s_ = locked_s_ = phase_error_ = value_ = limit_ = 0.0;
  fraction_ = -1.0;
  settled_ = halt_ = false;
  fault_ = MasterFault::none;
  remembered_ = 0;
  leg_ = 0;
  leg_begin_ = deepest_ = 0.0;
  sense_ = 1.0;
  turn_ = Turn::none;
  turn_s_ = turn_w_ = stood_s_ = asked_rpm_ = 0.0;
  asked_turn_ = 0;
}

/// Revolutions from the begin of a segment to `s` along it.
double MasterMotion::turns_to(const Segment& g, double s) const noexcept {
  if (g.change == 0.0) return s / std::max(g.per_turn, 1e-9);
  const double end = std::sqrt(std::max(0.0, g.per_turn * g.per_turn + 2.0 * g.change * s));
  return (end - g.per_turn) / g.change;
}

/// Where the angle says the path is, and how it moves.
MasterMotion::Ideal MasterMotion::ideal(const MasterState& master) const noexcept {
  const double m = progress(master.n), w = direction_ * master.w, a = direction_ * master.a;
  int n = 0;
  while (n + 1 < count_ && segments_[static_cast<std::size_t>(n + 1)].turns <= m) ++n;
  const Segment& g = segments_[static_cast<std::size_t>(n)];
  const double u = m - g.turns, per_turn = g.per_turn + g.change * u;
  Ideal at{{g.begin + u * (g.per_turn + 0.5 * g.change * u), per_turn * w, per_turn * a + g.change * w * w}};
  for (int k = n; k <= n + 1 && k < count_; ++k) {
    const Segment& next = segments_[static_cast<std::size_t>(k)];
    if (next.over <= 0.0) continue;
    const double z = (m - next.turns) / next.over + 0.5;
    if (z <= 0.0 || z >= 1.0) continue;
    // The lead rises as 3 z^2 - 2 z^3; the place is again that of a lead that steps when it is through.
    const double step = z > 0.5 ? 1.0 : 0.0, slope = 6.0 * z * (1.0 - z) / next.over;
    const double more = z * z * (3.0 - 2.0 * z) - step;
    at.motion.s += next.rise * next.over * (z * z * z * (1.0 - 0.5 * z) - step * (z - 0.5));
    at.motion.v += next.rise * more * w;
    at.motion.a += next.rise * (slope * w * w + more * a);
    at.jerk += next.rise * (6.0 - 12.0 * z) / (next.over * next.over) * w * w * w;
  }
  return at;
}

/// Where leads differ one goes over into the other in the time that the limits ask for.
void MasterMotion::smooth_lead(std::size_t n, double w) noexcept {
  constexpr double kShare = 0.5;  // of acceleration and jerk
  const Segment& before = segments_[n - 1];
  Segment& next = segments_[n];
  const double turns = next.turns - before.turns;
  next.rise = next.per_turn - (before.per_turn + before.change * turns);
  const double rise = std::abs(next.rise);
  const double over = std::max(std::sqrt(6.0 * rise * w * w * w / (kShare * box_.jerk)),
                               1.5 * rise * w * w / (kShare * box_.acceleration));
  next.over = std::min({over, turns, turns_to(next, next.length)});
}

void MasterMotion::fail(MasterFault fault, double value, double limit) noexcept {
  if (fault_ != MasterFault::none) return;
  fault_ = fault;
  value_ = value;
  limit_ = limit;
  // Its axis stops here: the spindle must, too.
  if (taps() && phase_ != Phase::waiting) halt_ = true;
  give_up();
}

void MasterMotion::give_up() noexcept {
  if (phase_ == Phase::waiting) {
    phase_ = Phase::left;
  } else if (phase_ == Phase::running_in || phase_ == Phase::locked) {
    // A tap may be on its way back.
    const double sign = state_.v < 0.0 ? -1.0 : 1.0;
    MotionState from{sign * state_.s, sign * state_.v, sign * state_.a};
    profile_.start(from);
    add_ramp(profile_, from.v, from.a, 0.0, leaving_box(from));
    profile_.finish_at({profile_.end().s, 0.0, 0.0});
    direction_ = sign;
    clock_ = 0.0;
    phase_ = Phase::leaving;
  }
}

void MasterMotion::run_profile() noexcept {
  clock_ += period_;
  state_ = clock_ < profile_.duration() ? profile_.at(clock_) : profile_.end();
}

/// It waits for its spindle, for so long as that may take.
bool MasterMotion::not_ready(const MasterEstimate& master, const MasterReading& reading) noexcept {
  if (!(reading.ordered > 0.0)) {
    fail(MasterFault::stands, 0.0, 0.0);
    return true;
  }
  const bool stands = master.known() && std::abs(master.at(reading.acts_ns).w) < kMasterStands;
  if (!reading.ready || stands) {
    fraction_ = -1.0;
    not_ready_s_ += period_;
    const double ramp = reading.braking > 0.0 ? reading.ordered / reading.braking : 0.0;
    const double patience = kReadyPatience + 2.0 * ramp;
    if (not_ready_s_ > patience) fail(MasterFault::stands, not_ready_s_, patience);
    return true;
  }
  if (master.known()) return false;
  unknown_s_ += period_;
  if (unknown_s_ > kUnknownPatience) fail(MasterFault::lost, 0.0, 0.0);
  return true;
}

void MasterMotion::try_begin(const MasterEstimate& master, const MasterReading& reading) noexcept {
  if (not_ready(master, reading)) return;
  const MasterState now = master.at(reading.acts_ns);
  const double w = std::abs(now.w);
  direction_ = now.w < 0.0 ? -1.0 : 1.0;
  const bool taps = this->taps();
  if (too_fast(w, length_)) return;
  // The speed at the end of the lead-in depends on its way where the lead changes.
  const Segment& first = segments_[0];
  Profile profile = lead_in(first.per_turn * w, box_);
  for (int round = 0; round < 3 && first.change != 0.0; ++round)
    profile = lead_in((first.per_turn + first.change * turns_to(first, profile.end().s)) * w, box_);
  const double way = profile.end().s;
  const double braking = reading.braking > 0.0 ? first.per_turn * w * w / (2.0 * reading.braking) : 0.0;
  const double needed =
      way +
      (taps ? braking
            : ramp_distance(end_lead(segments_[static_cast<std::size_t>(count_ - 1)]) * w, 0.0, 0.0, box_));
  if (needed > length_) return fail(MasterFault::too_short, length_, needed);
  const double begins = turns_to(first, way) - w * profile.duration();
  start_ = taps ? 0.0 : lock_.start;
  const double since = direction_ * (now.n - start_) - begins;
  const double fraction = taps ? 0.0 : since - std::floor(since);
  // The angle is passed in this cycle when it was not behind in the last one.
  const bool passes = taps || (fraction_ >= 0.0 && fraction < fraction_ && fraction <= 1.5 * w * period_);
  fraction_ = fraction;
  if (!passes) return;
  for (int n = 1; n < count_; ++n) smooth_lead(static_cast<std::size_t>(n), w);
  whole_ = since - fraction;
  begun_with_ = w;
  profile_ = profile;
  clock_ = std::min(fraction / w, period_) - period_;
  phase_ = Phase::running_in;
  run_profile();
}

std::size_t MasterMotion::segment_at(double s) const noexcept {
  int n = 0;
  while (n + 1 < count_ && segments_[static_cast<std::size_t>(n + 1)].begin <= s) ++n;
  return static_cast<std::size_t>(n);
}

/// From here to `until` the path has a place that may not be passed as fast as the master turns.
bool MasterMotion::too_fast(double w, double until) noexcept {
  const double settles = state_.v + 0.5 * state_.a * std::max(0.0, state_.a) / box_.jerk;
  for (auto n = static_cast<int>(segment_at(state_.s)); n < count_; ++n) {
    const Segment& g = segments_[static_cast<std::size_t>(n)];
    if (g.begin > until) break;
    const double asked = std::max(g.most * w, settles);
    if (asked <= g.velocity) continue;
    fail(MasterFault::too_fast, asked, g.velocity);
    return true;
  }
  return false;
}

/// As far as it comes before it can rest, with what the cycles to come may add.
double MasterMotion::reach() const noexcept {
  constexpr double kCycles = 6.0;
  return state_.s + ramp_distance(state_.v, state_.a, 0.0, box_) + kCycles * period_ * state_.v;
}

/// On what may be passed yet.
double MasterMotion::velocity_allowed() const noexcept {
  const double until = reach();
  double least = std::numeric_limits<double>::infinity();
  for (auto n = static_cast<int>(segment_at(state_.s)); n < count_; ++n) {
    const Segment& g = segments_[static_cast<std::size_t>(n)];
    if (g.begin > until) break;
    least = std::min(least, g.velocity);
  }
  return least;
}

/// The jerk that is wanted, or what of it keeps the limits in this cycle and those to come.
double MasterMotion::within_limits(double jerk) const noexcept {
  const double most = velocity_allowed();
  const double dt = period_, least = taps() ? -most : 0.0;
  const auto held = [&](double j) {
    j = std::clamp(j, (-box_.acceleration - state_.a) / dt, (box_.acceleration - state_.a) / dt);
    return std::clamp(j, -box_.jerk, box_.jerk);  // what is known further on may be tighter
  };
  const double j = held(jerk);
  const double a = state_.a + dt * j, v = state_.v + dt * (state_.a + 0.5 * dt * j);
  const double settled = v + 0.5 * a * std::abs(a) / box_.jerk;
  if (a > 0.0 && settled > most) return held(-box_.jerk);
  if (a < 0.0 && settled < least) return held(box_.jerk);
  return j;
}

/// What the readings say of the motion, while it goes by them.
void MasterMotion::watch(const MasterEstimate& master, const MasterReading& reading) noexcept {
  if (!master.known()) return fail(MasterFault::lost, 0.0, 0.0);
  if (!ends_ && reach() > length_) return fail(MasterFault::starved, 0.0, 0.0);
  const double w = direction_ * master.at(reading.acts_ns).w;
  const bool turns_round = turn_ == Turn::turning || halt_;
  const double least = taps() ? least_of_tap() : kLeastShare * begun_with_;
  if (!turns_round && w < least) return fail(MasterFault::reversed, w, least);
  if (!taps() && phase_ == Phase::locked && too_fast(w, reach())) return;
  if (!master.fresh()) return;
  const double ago = seconds(newest_ns_ - master.read_at()) / period_;
  if (ago < 0.0 || ago + 1.0 > remembered_ - 1) return;
  const int whole = static_cast<int>(ago);
  const auto place = [&](int cycles) {
    return history_[static_cast<std::size_t>((head_ - cycles + 2 * kHistory) % kHistory)];
  };
  const double z = ago - whole, then = (1.0 - z) * place(whole) + z * place(whole + 1);
  const double ahead = by_setpoint(reading) ? reading.setpoint_ahead.value_or(0.0) : 0.0;
  phase_error_ = then - ideal({master.read() - ahead, 0.0, 0.0}).motion.s;
  if (phase_ != Phase::locked) return;
  if (locked_s_ > kSettles + ago * period_) settled_ = true;
  if (settled_ && std::abs(phase_error_) > window_)
    fail(MasterFault::window, std::abs(phase_error_), window_);
}

void MasterMotion::remember(image::Nanoseconds acts_ns) noexcept {
  head_ = (head_ + 1) % kHistory;
  history_[static_cast<std::size_t>(head_)] = state_.s;
  remembered_ = std::min(remembered_ + 1, kHistory);
  newest_ns_ = acts_ns;
}

void MasterMotion::follow(const MasterEstimate& master, const MasterReading& reading) noexcept {
  const auto period = static_cast<image::Nanoseconds>(std::llround(period_ * 1e9));
  const Ideal there = ideal(master.at(reading.acts_ns - period));
  const MotionState& wanted = there.motion;
  const double j = within_limits(
      there.jerk + settling_jerk(wanted.s - state_.s, wanted.v - state_.v, wanted.a - state_.a));
  const double dt = period_;
  const MotionState next{state_.s + dt * (state_.v + dt * (0.5 * state_.a + dt * j / 6.0)),
                         state_.v + dt * (state_.a + 0.5 * dt * j), state_.a + dt * j};
  locked_s_ += dt;
  const bool brakes = (!taps() || last_leg()) && next.v > 0.0;
  if (brakes && next.s + ramp_distance(next.v, next.a, 0.0, box_) > length_) {
    Goal goal;
    goal.length = length_ - state_.s;
    goal.velocity = std::clamp(state_.v + 0.5 * state_.a * std::abs(state_.a) / box_.jerk, 1e-6,
                               std::max(1e-6, segments_[static_cast<std::size_t>(count_ - 1)].velocity));
    if (!plan(profile_, state_, goal, box_)) {
      profile_.start(state_);
      add_ramp(profile_, state_.v, state_.a, 0.0, box_);
    }
    profile_.finish_at({length_, 0.0, 0.0});
    clock_ = 0.0;
    phase_ = Phase::braking;
    return run_profile();
  }
  state_ = next;
  if (taps()) tap(master.at(reading.acts_ns), reading);
}

void MasterMotion::step(const MasterEstimate& master, const MasterReading& reading, bool wait,
                        bool leave) noexcept {
  braking_ = reading.braking;
  if (leave && (!taps() || phase_ == Phase::waiting)) give_up();
  if (leave && phase_ == Phase::locked) halt_ = true;
  // In its lead-in it does not go with the angle yet.
  if (leave && taps() && phase_ == Phase::running_in) {
    halt_ = true;
    give_up();
  }
  if (phase_ == Phase::running_in || phase_ == Phase::locked) watch(master, reading);
  switch (phase_) {
    case Phase::waiting:
      if (!wait) try_begin(master, reading);
      break;
    case Phase::running_in:
      run_profile();
      if (clock_ >= profile_.duration()) {
        phase_ = Phase::locked;
        // The end of the lead-in lies within this cycle.
        const double beyond = clock_ - profile_.duration();
        state_.s += beyond * state_.v;
      }
      break;
    case Phase::locked:
      follow(master, reading);
      break;
    case Phase::braking:
      run_profile();
      if (clock_ >= profile_.duration()) phase_ = Phase::arrived;
      break;
    case Phase::leaving: {
      clock_ += period_;
      const MotionState at = clock_ < profile_.duration() ? profile_.at(clock_) : profile_.end();
      state_ = {direction_ * at.s, direction_ * at.v, direction_ * at.a};
      if (clock_ >= profile_.duration()) phase_ = Phase::left;
      break;
    }
    case Phase::left:
    case Phase::arrived:
      state_.v = state_.a = 0.0;
      break;
  }
  if (phase_ != Phase::waiting) remember(reading.acts_ns);
}

}  // namespace servogate::path
