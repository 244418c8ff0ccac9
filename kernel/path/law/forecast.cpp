// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/law/forecast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kUnknown = 1e30;
constexpr double kWindow = 6.0;  // lengths in which a stop is over
constexpr double kRest = 0.5;    // of a window: less than that behind it belongs to it
constexpr std::size_t kMostPlaces = 8192;
// mm between places: of the shortest legs, in s of the feed and beside it, and the least.
constexpr double kOfLeg = 0.5, kOfFeed = 0.0008, kBeside = 0.02, kLeastSpacing = 0.005;
constexpr double kStraight = 0.9998;  // cosine: hardly a bend
// What makes the time right, found by comparing with laws (tests/path/forecast_test.cpp): of the jerk between
// places, as a ramp ends without acceleration, and from and to a rest; of the squared speed in accelerations;
// of the speed that a jerk allows over a scale, and a bend.
constexpr double kJerk = 0.5, kJerkAtRest = 0.8, kSlope = 1.9, kOverScale = 0.92, kAtBend = 0.85;
constexpr double kCarried = 0.2;     // of an acceleration by the time of a corner: what needs no rest there
constexpr double kCornerTime = 0.7;  // no two corners are nearer to each other than that of the time of one

constexpr double kShortest = 1e-6;  // mm between nodes
constexpr double kReached = 0.6;    // of an axis' velocity: it is what binds
constexpr double kHidden = 0.5;     // of the tolerance: a step beside the way that is no corner of its own

// y(v) by the root of jerk: the length in which jerk alone reaches v, from rest.
double y_of(double v) { return std::sqrt(2.0) / 3.0 * v * std::sqrt(v); }
double v_of(double y) {
  const double c = std::cbrt(3.0 / std::sqrt(2.0) * y);
  return c * c;
}
const double kTime = std::cbrt(9.0 / 2.0);  // v = kTime y^(2/3)

}  // namespace

void SpeedForecast::clear(double speed) {
  begin_ = wait_ = seconds_ = last_bend_ = 0.0;
  begin_y_ = y_of(speed);
  done_ = false;
}

void SpeedForecast::work(const Run& run, bool ended) {
  if (done_ || run.empty() || (!ended && run.length() <= wait_)) return;
  while (window(run, ended)) {
  }
}

/// Long enough for a stop out of the highest feed in it. 0: that is not known yet.
double SpeedForecast::length_of_window(const Run& run) {
  double length = 0.0;
  feed_ = 0.0;
  double a = kUnknown, j = kUnknown;
  std::size_t k = run.leg_at(begin_, run.first()), legs = 0;
  for (; k < run.end() && run.leg(k).begin <= begin_ + length && legs < kMostPlaces; ++k, ++legs) {
    const Leg& leg = run.leg(k);
    feed_ = std::max(feed_, fastest(leg, axes_));
    for (std::size_t i = 0; i < static_cast<std::size_t>(axes_); ++i) {
      if (!moves(leg, i)) continue;
      a = std::min(a, (*leg.limits)[i].acceleration);
      j = std::min(j, (*leg.limits)[i].jerk);
    }
    // Over more than that, no third and no second difference keeps a path below its feed.
    scale_ = std::max(std::sqrt(4.0 * feed_ * feed_ * feed_ / j), 2.0 * feed_ * feed_ / a);
    length = kWindow * (feed_ * feed_ / kSlope / a + y_of(feed_) / std::sqrt(kJerk * j) + 3.0 * scale_ +
                        64.0 * kBeside);
  }
  return length;
}

/// One window, when all that it looks at is known.
bool SpeedForecast::window(const Run& run, bool ended) {
  if (done_) return false;
  const double length = length_of_window(run), end = begin_ + length, known = end + kRest * length;
  const bool last = ended && run.length() <= known;
  if (!last && run.length() <= known) {
    wait_ = known;
    return false;
  }
  place(run, last ? run.length() : end);
  limit();
  const double to = begin_ + spacing_ * static_cast<double>(places_.size() - 1);
  const bool whole = last && to >= run.length() * (1.0 - 1e-12);
  find_bends(run, to);
  for (std::size_t h = 1; 3 * h < places_.size() && static_cast<double>(h) * spacing_ <= scale_;
       h = h < 4 ? h + 1 : h * 3 / 2)
    limit_over(h);
  make_nodes(run, to, whole);
  reach_between();
  tell(whole);
  return true;
}

void SpeedForecast::place(const Run& run, double end) {
  const std::size_t first = run.leg_at(begin_, run.first());
  std::size_t leg = run.leg_at(end, first);
  const double mean = (end - begin_) / static_cast<double>(leg - first + 1);
  const double longest = kOfFeed * feed_ + kBeside;
  const double wanted = std::clamp(kOfLeg * mean, std::min(kLeastSpacing, longest), longest);
  const double count = std::max(12.0, std::ceil((end - begin_) / wanted));
  const auto n = static_cast<std::size_t>(std::min(count, static_cast<double>(kMostPlaces)));
  spacing_ = (end - begin_) / count;
  places_.resize(n + 1);
  leg = first;
  for (std::size_t i = 0; i <= n; ++i) {
    const double u = std::min(end, begin_ + static_cast<double>(i) * spacing_);
    leg = run.leg_at(u, leg);
    Place& p = places_[i];
    p.leg = &run.leg(leg);
    p.at = run.at(u, leg);
    p.cap = feed_at(*p.leg, p.at, u);
    p.turns = p.leg->surface.speed > 0.0 ? turns_at(*p.leg, p.at, u) : 0.0;
    if (transformation_ != &identity()) p.at = to_axes(*transformation_, p.at, axes_);
  }
}

/// What feed and velocity allow, and how fast acceleration and jerk change that along the path.
void SpeedForecast::limit() {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::size_t from = std::min(i, places_.size() - 2);
    Place& p = places_[i];
    double a = kUnknown, j = kUnknown;
    p.why = p.jerk_why = p.acceleration_why = {};
    for (int k = 0; k < axes_; ++k) {
      const double rate = std::abs(places_[from + 1].at[k] - places_[from].at[k]) / spacing_;
      if (rate < 1e-9) continue;
      const AxisLimits& limits = (*p.leg->limits)[k];
      const auto axis = static_cast<std::int8_t>(k);
      if (limits.velocity < p.cap * rate) p.cap = limits.velocity / rate, p.why = {Brake::velocity, axis};
      if (limits.acceleration < a * rate)
        a = limits.acceleration / rate, p.acceleration_why = {Brake::acceleration, axis};
      if (limits.jerk < j * rate) j = limits.jerk / rate, p.jerk_why = {Brake::jerk, axis};
    }
    p.cap = std::min(p.cap, feed_);
    p.acceleration = kSlope * a;
    p.jerk_root = std::sqrt(kJerk * j);
    p.bends = 0;
  }
}

SpeedForecast::Bend SpeedForecast::bend(const Leg& before, const Leg& after) const {
  Bend b{};
  b.u = after.begin;
  b.tolerance = std::min(before.tolerance, after.tolerance);
  b.cosine = 1.0;
  b.speed = kUnknown;
  const Vector in = evaluate(before.piece, before.piece.length, axes_).d1,
               out = evaluate(after.piece, 0.0, axes_).d1;
  double product = 0.0;
  for (int i = 0; i < axes_; ++i) product += in[i] * out[i];
  b.corner = after.corner;
  if (product > kStraight) return b;
  b.cosine = product;
  const Vector t0 = turned_to_axes(*transformation_, in, axes_),
               t1 = turned_to_axes(*transformation_, out, axes_);
  const double room = 2.5 * b.tolerance;
  for (int i = 0; i < axes_; ++i) {
    const double turn = std::abs(t1[i] - t0[i]);
    if (turn < 1e-9) continue;
    b.turn = std::max(b.turn, turn);
    const AxisLimits& limits = (*after.limits)[i];
    const double v = std::min(1.5 * room / turn * std::cbrt(2.0 * limits.jerk / room),
                              2.0 * room / turn * std::sqrt(limits.acceleration / room));
    if (v >= b.speed) continue;
    b.speed = v;
    b.axis = static_cast<std::int8_t>(i);
    b.jerk = limits.jerk;
    b.acceleration = limits.acceleration;
  }
  return b;
}

/// Bends of the window, and how long the way is on either side that has none. Those of lines have a speed of
/// their own; where an arc is, the differences say it.
void SpeedForecast::find_bends(const Run& run, double end) {
  bends_.clear();
  double from = last_bend_;
  std::size_t k = run.leg_at(begin_, run.first());
  for (; k + 1 < run.end() && run.leg(k + 1).begin < end; ++k) {
    const Leg &before = run.leg(k), &after = run.leg(k + 1);
    if (after.begin <= begin_) continue;
    const bool lines = before.piece.shape == Piece::Shape::line && after.piece.shape == Piece::Shape::line;
    Bend b = bend(before, after);
    if (b.cosine == 1.0 && lines && b.corner >= feed_) continue;
    if (!bends_.empty()) bends_.back().after = b.u - from;
    b.before = b.u - from;
    from = b.u;
    if (!lines) b.speed = kUnknown;
    bends_.push_back(b);
  }
  if (!bends_.empty()) bends_.back().after = std::max(end, run.leg(k).end()) - from;
  for (Bend& b : bends_)
    if (std::min(b.before, b.after) * b.turn < kHidden * b.tolerance) b.speed = kUnknown;
  std::size_t n = 0;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    while (n < bends_.size() && bends_[n].u <= begin_ + static_cast<double>(i) * spacing_) ++n;
    places_[i].bends = static_cast<int>(n);
  }
}

/// A corner takes a time, and is rounded as far as the tolerance allows in it. It is passed the faster, the
/// more acceleration comes to it that ends there and the one behind it begins with.
double SpeedForecast::speed_at(const Bend& b) const {
  double v = b.speed;
  if (v < kUnknown) {
    const double room = std::min(b.before, b.after), time = std::cbrt(48.0 * b.tolerance / b.jerk);
    const double turned = std::min(1.0, 1.0 - b.cosine);
    const double a = std::min(
        {b.acceleration, std::sqrt(feed_ * b.jerk), 0.25 * b.jerk * std::cbrt(32.0 * room / b.jerk)});
    v = std::min(kAtBend * v + kCarried * a * time * turned,
                 kCornerTime * room / time / std::max(0.01, turned));
  }
  return std::min(v, b.corner);
}

/// What third and second differences over a scale allow in their middle, less what the tolerance takes away.
void SpeedForecast::limit_over(std::size_t d) {
  const std::size_t n = places_.size() - 1, stride = std::max<std::size_t>(1, d / 2), wide = (d + 1) / 2;
  const double l = static_cast<double>(d) * spacing_;
  for (std::size_t i = 0; i + 3 * d <= n; i += stride) {
    const Place &p = places_[i], &q = places_[i + d], &r = places_[i + 2 * d], &s = places_[i + 3 * d];
    if (p.leg == s.leg && p.leg->piece.shape == Piece::Shape::line) continue;
    if (s.bends - p.bends == 1 && bends_[static_cast<std::size_t>(p.bends)].speed < kUnknown) continue;
    double time3 = 0.0, time2 = 0.0;
    std::int8_t axis3 = -1, axis2 = -1;
    for (int k = 0; k < axes_; ++k) {
      const AxisLimits& limits = (*p.leg->limits)[k];
      const double e3 = std::abs(s.at[k] - p.at[k] + 3.0 * (q.at[k] - r.at[k])) - 5.0 * p.leg->tolerance;
      const double e2 = std::abs(r.at[k] - 2.0 * q.at[k] + p.at[k]) - 3.0 * p.leg->tolerance;
      if (e3 > time3 * limits.jerk) time3 = e3 / limits.jerk, axis3 = static_cast<std::int8_t>(k);
      if (e2 > time2 * limits.acceleration)
        time2 = e2 / limits.acceleration, axis2 = static_cast<std::int8_t>(k);
    }
    const double slow = l / feed_;
    if (time3 > std::pow(kOverScale * slow, 3))
      cap(i + d + d / 4, wide, kOverScale * l / std::cbrt(time3), {Brake::jerk, axis3});
    if (time2 > slow * slow) cap(i + d - d / 4, wide, l / std::sqrt(time2), {Brake::acceleration, axis2});
  }
}

void SpeedForecast::cap(std::size_t from, std::size_t count, double speed, Why why) {
  for (std::size_t k = from; k <= std::min(places_.size() - 1, from + count); ++k) {
    if (speed >= places_[k].cap) continue;
    places_[k].cap = speed;
    places_[k].why = why;
  }
}

std::size_t SpeedForecast::place_at(double u) const {
  const double at = std::max(0.0, (u - begin_) / spacing_);
  return std::min(static_cast<std::size_t>(at), places_.size() - 2);
}

void SpeedForecast::nodes_around(double u, double y, Why why, double tolerance, double end) {
  more_.push_back({u, y, why});
  const Place &p = places_[place_at(u)], &q = places_[place_at(u) + 1];
  const double ramp = y_of(std::min(p.cap, q.cap)) / p.jerk_root;
  for (double s = std::min(0.5 * tolerance, std::max(kShortest, ramp)); s < 2.0 * spacing_; s *= 1.5) {
    if (u + s < end) more_.push_back({u + s, kUnknown, {}});
    if (u - s > begin_) more_.push_back({u - s, kUnknown, {}});
  }
}

void SpeedForecast::make_nodes(const Run& run, double end, bool last) {
  nodes_.clear();
  more_.clear();
  const double out = last ? run.end_speed() : 0.0;
  for (std::size_t i = 0; i < places_.size(); ++i)
    nodes_.push_back({begin_ + static_cast<double>(i) * spacing_, y_of(places_[i].cap), places_[i].why});
  nodes_.front().y = std::min(nodes_.front().y, begin_y_);
  nodes_.back() = {end, y_of(out), {}};
  for (const Bend& b : bends_)
    if (const double v = speed_at(b); v < feed_)
      nodes_around(b.u, y_of(v), {Brake::jerk, b.axis}, b.tolerance, end);
  if (begin_y_ == 0.0) nodes_around(begin_, 0.0, {}, places_.front().leg->tolerance, end);
  if (last && out == 0.0) nodes_around(end, 0.0, {}, places_.back().leg->tolerance, end);
  const auto before = [](const Node& p, const Node& q) { return p.u < q.u; };
  std::stable_sort(more_.begin(), more_.end(), before);
  sorted_.resize(nodes_.size() + more_.size());
  std::merge(nodes_.begin(), nodes_.end(), more_.begin(), more_.end(), sorted_.begin(), before);
  std::size_t kept = 0;
  for (std::size_t i = 1; i < sorted_.size(); ++i) {
    if (sorted_[i].u > sorted_[kept].u + 1e-7)
      sorted_[++kept] = sorted_[i];
    else if (sorted_[i].y < sorted_[kept].y)
      sorted_[kept].y = sorted_[i].y, sorted_[kept].why = sorted_[i].why;
  }
  sorted_.resize(kept + 1);
  nodes_.swap(sorted_);
  for (Node& node : nodes_) {
    if (node.y != kUnknown) continue;
    const Place &p = places_[place_at(node.u)], &q = places_[place_at(node.u) + 1];
    node.y = y_of(std::min(p.cap, q.cap));
    node.why = p.cap < q.cap ? p.why : q.why;
  }
}

/// So fast it may be beside a node, with a share of the root of jerk; then it is jerk or acceleration that
/// binds there.
double SpeedForecast::reach(const Node& from, Node& to, double share) const {
  if (to.y <= from.y) return to.y;
  const Place& p = places_[place_at(0.5 * (from.u + to.u))];
  const double h = std::abs(to.u - from.u), v = v_of(from.y);
  const double by_jerk = from.y + share * p.jerk_root * h;
  if (by_jerk < to.y) {
    to.y = by_jerk;
    to.why = p.jerk_why;
  }
  const double by_acceleration = y_of(std::sqrt(v * v + p.acceleration * h));
  if (by_acceleration < to.y) {
    to.y = by_acceleration;
    to.why = p.acceleration_why;
  }
  return to.y;
}

void SpeedForecast::reach_between() {
  const double at_rest = std::sqrt(kJerkAtRest / kJerk);
  double share = nodes_.front().y == 0.0 ? at_rest : 1.0;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    const double free = nodes_[i].y;
    if (reach(nodes_[i - 1], nodes_[i], share) == free) share = 1.0;
  }
  share = nodes_.back().y == 0.0 ? at_rest : 1.0;
  bool touched = true;
  free_to_ = begin_;
  for (std::size_t i = nodes_.size() - 1; i-- > 0;) {
    const double was = nodes_[i].y, y = reach(nodes_[i + 1], nodes_[i], share);
    if (y == was) share = 1.0;
    if (touched && y >= was && i + 1 < nodes_.size() - 1) {
      touched = false;
      free_to_ = nodes_[i].u;
    }
  }
}

/// What a rest at the window's end does not touch is known; at least half of it is told.
void SpeedForecast::tell(bool last) {
  const double end = nodes_.back().u;
  const double to = last ? end : std::max(free_to_, 0.5 * (begin_ + end));
  std::size_t k = 0;
  double z0 = std::cbrt(nodes_[0].y);
  if (nodes_[0].y == 0.0) sink_.put({0.0, 0.0, Brake::rest, -1, places_.front().leg->piece.tag.command});
  for (; k + 1 < nodes_.size() && (last || nodes_[k + 1].u <= to || k == 0); ++k) {
    const Node &from = nodes_[k], &next = nodes_[k + 1];
    const double z1 = std::cbrt(next.y);
    const double seconds = 3.0 * (next.u - from.u) / kTime / std::max(1e-15, z0 * z0 + z0 * z1 + z1 * z1);
    const Why& why = from.y > next.y ? from.why : next.why;
    const Place& p = places_[place_at(0.5 * (from.u + next.u))];
    sink_.put({seconds, (next.u - from.u) / seconds, why.brake, why.axis, p.leg->piece.tag.command, p.turns});
    seconds_ += seconds;
    z0 = z1;
  }
  if (last && nodes_.back().y == 0.0)
    sink_.put({0.0, 0.0, Brake::rest, -1, places_.back().leg->piece.tag.command});
  begin_ = nodes_[k].u;
  begin_y_ = nodes_[k].y;
  for (const Bend& b : bends_)
    if (b.u <= begin_) last_bend_ = b.u;
  done_ = last;
}

CourseForecast::CourseForecast(const Config& config, MomentSink& moments, CourseSink& sink)
    : axes_(config.axis_count),
      transformation_(config.transformation),
      moments_(moments),
      sink_(sink),
      run_(config.axis_count),
      speed_(config.axis_count, *config.transformation, moments) {}

void CourseForecast::begin() {
  if (begun_) return;
  begun_ = true;
  seconds_ = 0.0;
  sink_.begin_course();
}

void CourseForecast::put(const Leg& leg) {
  begin();
  if (run_.empty()) speed_.clear(run_.begin_speed());
  run_.append(leg);
  speed_.work(run_, false);
  run_.forget_before(speed_.needs_from());
}

void CourseForecast::end_run(double speed) {
  run_.end_at(speed);
  speed_.work(run_, true);
  seconds_ += speed_.seconds();
  run_.clear(speed);
}

void CourseForecast::cruise(const Leg& leg, double speed) {
  end_run(speed);
  const double seconds = leg.piece.length / speed;
  Moment moment{seconds, speed, Brake::shape, -1, leg.piece.tag.command};
  const Vector along = turned_to_axes(*transformation_, evaluate(leg.piece, 0.0, axes_).d1, axes_);
  double most = kReached;
  for (int i = 0; i < axes_; ++i) {
    const double share = speed * std::abs(along[i]) / (*leg.limits)[i].velocity;
    if (share <= most) continue;
    most = share;
    moment.brake = Brake::velocity;
    moment.axis = i;
  }
  moments_.put(moment);
  seconds_ += seconds;
}

void CourseForecast::rest(bool confirm) {
  if (!begun_) return;
  end_run(0.0);
  CourseExtent extent;
  extent.complete = true;
  extent.confirm = confirm;
  extent.seconds = seconds_;
  sink_.extend(extent);
  begun_ = false;
}

void CourseForecast::restart() {
  run_.clear();
  begun_ = false;
}

}  // namespace servogate::path
