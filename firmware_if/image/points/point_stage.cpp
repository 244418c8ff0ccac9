// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/points/point_stage.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/image/put_bit.hpp"

namespace servogate::image {

PointStage::PointStage(std::vector<PointRule> points, int source, std::vector<AgeLimits> groups)
    : source_(source) {
  for (PointRule& rule : points) points_.push_back({rule});
  if (groups.empty()) groups.emplace_back();
  for (const AgeLimits& limits : groups) groups_.push_back({limits});
}

void PointStage::take(std::size_t n, double raw) noexcept {
  Point& p = points_[n];
  const double value = value_of(p.rule, raw);
  if (p.known && !p.rule.digital && std::abs(value - p.value) < p.rule.hysteresis) return;
  p.value = value;
  p.known = true;
}

void PointStage::edge(std::size_t n, bool raw, Nanoseconds t) noexcept {
  Point& p = points_[n];
  // What comes back with its source is no edge.
  const bool was_known = p.known && !groups_[p.rule.group].lost, was = p.value != 0.0;
  take(n, raw ? 1.0 : 0.0);
  const bool level = p.value != 0.0;
  if (was_known && level != was) edges_.add({p.rule.place, level, t});
}

void PointStage::fresh(std::size_t group, Nanoseconds t) noexcept {
  groups_[group].updated_ns = t;
  groups_[group].lost = false;
}

void PointStage::lost(std::size_t group) noexcept {
  Group& g = groups_[group];
  if (!g.lost && g.updated_ns >= 0) ++errors_;
  g.lost = true;
}

Quality PointStage::quality(std::size_t group, Nanoseconds t) const noexcept {
  const Group& g = groups_[group];
  const Nanoseconds age = t - std::max(g.updated_ns, start_ns_);
  if (g.limits.bad_ns > 0 && age > g.limits.bad_ns) return Quality::bad;
  if (g.updated_ns < 0) return Quality::never;
  if (g.lost) return Quality::bad;
  return g.limits.stale_ns > 0 && age > g.limits.stale_ns ? Quality::stale : Quality::good;
}

inline void PointStage::show(Point& p, ProcessImage& image) noexcept {
  if (!p.rule.digital) {
    if (p.known) image.packets.set_number(p.rule.place, p.value);
    return;
  }
  const bool level = p.known ? p.value != 0.0 : image.packets.bit(p.rule.place);
  // Most stand as they were shown.
  if (!p.started || level != p.seen || p.shown != p.seen) {
    if (!p.started) {
      p.started = true;
      p.seen = p.shown = level;
    }
    if (level != p.seen) {
      p.seen = level;
      p.changed_ns = image.now.t_ns;
    }
    if (image.now.t_ns - p.changed_ns >= p.rule.debounce_ns) p.shown = p.seen;
  }
  if (!p.known) return;
  if (p.rule.place.format == Format::bl)
    put_bit(image.packets, p.rule.place, p.shown);
  else
    image.packets.set_bit(p.rule.place, p.shown);
}

void PointStage::settle(ProcessImage& image) noexcept {
  if (start_ns_ < 0) start_ns_ = image.now.t_ns;
  std::size_t group = groups_.size();
  bool gone = false;  // that group, whose points stand together
  for (Point& p : points_) {
    if (!p.rule.input) continue;
    if (p.rule.group != group) {
      group = p.rule.group;
      gone = groups_[group].lost || quality(group, image.now.t_ns) == Quality::bad;
    }
    if (gone && !p.rule.hold) {
      // At once: what may not be trusted does not wait for its debouncing.
      p.value = p.rule.digital ? (p.rule.loss != 0.0 ? 1.0 : 0.0) : p.rule.loss;
      p.known = p.started = true;
      p.seen = p.shown = p.value != 0.0;
    }
    show(p, image);
  }
  for (const Edge& e : edges_.list()) image.edges.add(e);
  image.edges.note_lost(edges_.take_lost());
  edges_.clear();
  judge(image);
}

void PointStage::judge(ProcessImage& image) const noexcept {
  if (source_ < 0 || source_ >= kMaxSources) return;
  const auto severity = [](Quality q) {
    return q == Quality::bad ? 3 : q == Quality::stale ? 2 : q == Quality::never ? 1 : 0;
  };
  // Of the worst groups the oldest: what is said of the age is of what is stale, not of what came just now.
  IoSource health{quality(0, image.now.t_ns), groups_[0].updated_ns, errors_};
  for (std::size_t g = 1; g < groups_.size(); ++g) {
    const Quality q = quality(g, image.now.t_ns);
    const int worse = severity(q) - severity(health.quality);
    if (worse > 0 || (worse == 0 && groups_[g].updated_ns < health.updated_ns))
      health = {q, groups_[g].updated_ns, errors_};
  }
  // Of one that never came: how long it is awaited.
  if (health.updated_ns < 0) health.updated_ns = start_ns_;
  image.sources[static_cast<std::size_t>(source_)] = health;
}

double PointStage::raw(std::size_t n, const Packets& packets) const noexcept {
  const PointRule& rule = points_[n].rule;
  return raw_of(rule, rule.digital ? (packets.bit(rule.place) ? 1.0 : 0.0) : packets.number(rule.place));
}

}  // namespace servogate::image
