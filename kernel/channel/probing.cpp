// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/probing.hpp"

namespace servogate::channel {

void Probing::arm() noexcept {
  armed_ = true;
  touched_ = known_ = false;
}

void Probing::look(const image::ProcessImage& image, std::span<const axis::Axis> axes) noexcept {
  edge_ = false;
  if (!place_) return;
  newest_ = (newest_ + 1) % kKept;
  Place& place = kept_[static_cast<std::size_t>(newest_)];
  place.t_ns = image.now.t_ns - image.now.period_ns;
  for (std::size_t a = 0; a < axes.size() && a < place.actual.size(); ++a) place.actual[a] = axes[a].actual();
  if (count_ < kKept) ++count_;

  const bool before = deflected_;
  image::Nanoseconds when = image.now.t_ns - image.now.period_ns;
  deflected_ = image.packets.bit(place_->place) != place_->inverted;
  edge_ = deflected_ && !before;
  for (const image::Edge& e : image.edges.list()) {
    if (!(e.place == place_->place) || e.level == place_->inverted) continue;
    when = e.t_ns;
    edge_ = true;
    break;
  }
  if (edge_ && armed_ && !touched_) {
    touched_ = true;
    touch_ns_ = when;
  }
  if (touched_ && !known_) find();
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
  known_ = true;
}

}  // namespace servogate::channel
