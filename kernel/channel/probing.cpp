// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/probing.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::channel {

void Probing::arm(std::uint32_t own) noexcept {
  forget();
  own_ = own;
  armed_ = true;
  unlatched_ = -1;
  latch_wait_s_ = 0.0;
}

void Probing::disarm() noexcept {
  rest_ = newest().actual;
  beyond_ = touched_ ? distance(at_) : 0.0;
  awaits_ = touched_;
  away_ = stuck_s_ = 0.0;
  armed_ = touched_ = known_ = found_ = false;
}

double Probing::distance(const std::array<double, image::kMaxAxes>& from) const noexcept {
  double square = 0.0;
  for (std::size_t a = 0; a < from.size(); ++a) {
    const double d = newest().actual[a] - from[a];
    if ((own_ >> a & 1u) != 0) square += d * d;
  }
  return std::sqrt(square);
}

void Probing::look(const image::ProcessImage& image, std::span<const axis::Axis> axes) noexcept {
  edge_ = false;
  if (!place_) return;
  newest_ = (newest_ + 1) % kKept;
  Place& place = kept_[static_cast<std::size_t>(newest_)];
  place.t_ns = image.now.t_ns - image.now.period_ns;
  for (std::size_t a = 0; a < axes.size() && a < place.actual.size(); ++a) place.actual[a] = axes[a].actual();
  if (count_ < kKept) ++count_;
  take_edges(image);
  watch_release(image.now.period_s());
  if (armed_ && latch_) take_latches(axes, image.now.period_s());
  if (touched_ && !found_) find();
  if (!latch_) known_ = found_;
}

/// Where each axis was is what its drive has latched. One that stood needs no latch; one that moved and has
/// none after a while is not known.
void Probing::take_latches(std::span<const axis::Axis> axes, double dt) noexcept {
  constexpr double kStands = 0.002;  // mm between the touch and its rest
  int latched = 0, missing = -1;
  for (std::size_t a = 0; a < axes.size() && a < at_.size(); ++a) {
    if ((own_ >> a & 1u) == 0) continue;
    if (axes[a].probe_latched()) {
      ++latched;
      if (!touched_) touch_ns_ = newest().t_ns;
      touched_ = true;
    } else if (found_ && std::abs(newest().actual[a] - at_[a]) > kStands) {
      missing = static_cast<int>(a);
    }
  }
  if (!touched_ || !found_ || known_) return;
  latch_wait_s_ += dt;
  if (latch_wait_s_ > kLatchPatience && (latched == 0 || missing >= 0)) unlatched_ = std::max(0, missing);
  if (latched == 0 || missing >= 0) return;
  for (std::size_t a = 0; a < axes.size() && a < at_.size(); ++a)
    if ((own_ >> a & 1u) != 0 && axes[a].probe_latched()) at_[a] = axes[a].probe_position();
  known_ = true;
}

/// Several edges may come in one cycle: the first one into deflection is the touch.
void Probing::take_edges(const image::ProcessImage& image) noexcept {
  const bool before = deflected_, rested = settled_ && !before;
  image::Nanoseconds when = image.now.t_ns - image.now.period_ns;
  deflected_ = image.packets.bit(place_->place) != place_->inverted;
  bool met = deflected_ && !before, changed = deflected_ != before, timed = false;
  for (const image::Edge& e : image.edges.list()) {
    if (!(e.place == place_->place)) continue;
    changed = true;
    if (e.level == place_->inverted || timed) continue;
    when = e.t_ns;
    met = timed = true;
  }
  edge_ = met && rested;
  quiet_s_ = changed ? 0.0 : quiet_s_ + image.now.period_s();
  settled_ = quiet_s_ >= kBounce;
  if (met && armed_ && !touched_) {
    touched_ = true;
    touch_ns_ = when;
  }
}

void Probing::watch_release(double dt) noexcept {
  if (!awaits_) return;
  if (!deflected_) {
    awaits_ = !settled_;
    stuck_s_ = 0.0;
    return;
  }
  away_ = distance(rest_);
  stuck_s_ = away_ > beyond_ + kRelease ? stuck_s_ + dt : 0.0;
}

/// Between the two cycles around the touch; it waits for the later one.
void Probing::find() noexcept {
  const auto kept = [&](int ago) -> const Place& {
    return kept_[static_cast<std::size_t>((newest_ - ago + kKept) % kKept)];
  };
  if (kept(0).t_ns < touch_ns_) return;
  int ago = 0;
  while (ago + 1 < count_ && kept(ago + 1).t_ns > touch_ns_) ++ago;
  const Place &after = kept(ago), &before = kept(ago + 1 < count_ ? ago + 1 : ago);
  const auto between = static_cast<double>(after.t_ns - before.t_ns);
  const double z = between > 0.0 ? static_cast<double>(touch_ns_ - before.t_ns) / between : 1.0;
  for (std::size_t a = 0; a < at_.size(); ++a)
    at_[a] = before.actual[a] + z * (after.actual[a] - before.actual[a]);
  found_ = true;
}

}  // namespace servogate::channel
