// SPDX-License-Identifier: Apache-2.0
// Along the path of a held program: back, and forward again to where it was held.
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/channel/process.hpp"

namespace servogate::channel {

namespace {

using image::at;
using image::field;
using image::kProcessFields;

constexpr image::Place kStopBit = field(kProcessFields, "stop");
constexpr image::Place kFeedEnable = field(kProcessFields, "feed_enable");

}  // namespace

/// The feeder plans the way; the axes are the process' until it ends.
bool Process::go_along(bool forward, const image::Request& request, cycle::ProcessContext& c) noexcept {
  if (!rests_for_operator()) return false;
  step_aside(c);
  if (!acquire(c)) return false;
  FeederOrder order;
  order.kind = FeederOrder::Kind::way;
  order.generation = generation_;
  for (std::size_t i = 0; i < c.axes.size(); ++i) order.position[i] = c.image.axes[i].command;
  path::Vector position{};
  for (std::size_t i = 0; i < config_.axes.machine.size(); ++i)
    position[i] = order.position[static_cast<std::size_t>(config_.axes.machine[i])];
  order.way.number = ++retrace_.number;
  order.way.forward = forward;
  order.way.on_way = retrace_.away;
  order.way.tag = retrace_.away ? retrace_.tag : shown_;
  order.way.to_go = retrace_.away ? retrace_.to_go : to_go_;
  order.way.distance = forward ? 0.0 : request.value;
  order.way.blocks = forward ? 0 : request.index;
  order.way.feed = request.velocity;
  retrace_.capped = request.velocity > 0.0;
  link_.orders.push(order);
  back_.set_position(position);
  retrace_.moves = true;
  retrace_.begun = retrace_.ends = false;
  retrace_.forward = forward;
  return true;
}

/// Entries of the way that are published, the begin of it counted; 0: not begun.
std::uint64_t Process::way_published() const noexcept {
  const WayLink::Begin* begin = link_.way.begin_of(retrace_.number);
  return begin == nullptr ? 0 : 1 + link_.way.track.visible() - begin->track.entry;
}

void Process::hold_way(const cycle::ProcessContext& c) noexcept {
  const image::Packets& k = c.image.packets;
  bool hold = !k.bit(at(kFeedEnable, base_));
  for (const OwnAxis& own : own_axes()) hold = hold || !c.axes[own.machine].feed_enabled();
  hold = hold || out_of_step(c) != nullptr;
  if (hold)
    back_.hold();
  else
    back_.resume();
  const double ratio = way_by_wheel(asked_ratio_, c);
  back_.set_override(retrace_.capped ? std::min(ratio, 1.0) : ratio);
  if (const axis::Spindle* turns = spindle(0, c); turns != nullptr)
    back_.set_spindle(std::abs(c.image.spindles[static_cast<std::size_t>(turns->index())].command_rpm) /
                      60.0);
  if (k.bit(at(kStopBit, base_)) || stopping_) retrace_.ends = true;
  if (retrace_.ends) back_.stop();
}

/// One cycle of the way.
void Process::follow_way(cycle::ProcessContext& c) noexcept {
  const std::uint64_t seen = std::min(way_published(), c.visible[kWay]);
  if (seen == 0) {
    if (retrace_.ends || stopping_) end_way(c);
    return;
  }
  const WayLink::Begin& begin = *link_.way.begin_of(retrace_.number);
  if (!retrace_.begun) {
    retrace_.begun = true;
    retrace_.behind = begin.from;
    back_.skip_to(begin.track);
  }
  hold_way(c);
  const path::Sample sample = back_.step(begin.track.entry + seen - 1);
  drive_axes(sample, c);
  retrace_.feed = sample.feed;
  retrace_.behind =
      std::max(0.0, retrace_.behind + (retrace_.forward ? -1.0 : 1.0) * sample.feed * seconds(c));
  for (const OwnAxis& own : own_axes()) held_as_.on_path[own.path] = sample.position[own.path];
  retrace_.tag = sample.tag;
  retrace_.to_go = sample.distance_to_go;
  switch (sample.state) {
    case path::FollowerState::at_event:
      retrace_.behind = begin.to;
      retrace_.away = !begin.home;
      back_.release_event();
      return end_way(c);
    case path::FollowerState::stopped:
    case path::FollowerState::fault:
      retrace_.away = true;
      return end_way(c);
    default:
      return;
  }
}

void Process::end_way(cycle::ProcessContext& c) noexcept {
  retrace_.moves = retrace_.ends = false;
  retrace_.feed = 0.0;
  release(c);
}

}  // namespace servogate::channel
