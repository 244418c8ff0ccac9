// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/node_monitor.hpp"

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

constexpr NodeId node_of(std::int64_t entry) noexcept { return static_cast<NodeId>(entry >> 16 & 0xFF); }
constexpr image::Nanoseconds time_of(std::int64_t entry) noexcept {
  return (entry & 0xFFFF) * image::kMillisecond;
}
constexpr bool active(std::int64_t entry) noexcept {
  return node_of(entry) >= 1 && node_of(entry) <= kMaxNode && time_of(entry) > 0;
}

}  // namespace

NodeMonitor::NodeMonitor(ObjectDictionary& dictionary, NodeId node)
    : node_(node),
      producer_ms_(dictionary.variable(object::kProducerHeartbeatTime)),
      guard_ms_(dictionary.variable(object::kGuardTime)),
      life_factor_(dictionary.variable(object::kLifeTimeFactor)) {
  for (int i = 0; i < kConsumers; ++i)
    entries_[static_cast<std::size_t>(i)] =
        &dictionary.variable(object::kConsumerHeartbeatTime, static_cast<std::uint8_t>(i + 1));
}

void NodeMonitor::start(image::Nanoseconds now) noexcept {
  running_ = true;
  toggle_ = guarded_ = guard_lost_ = lost_ = false;
  consumers_ = {};
  send(static_cast<std::uint8_t>(NmtState::boot_up));
  producer_changed(now);
}

void NodeMonitor::producer_changed(image::Nanoseconds now) noexcept {
  next_ = now + producer_ms_ * image::kMillisecond;
}

AbortCode NodeMonitor::check_consumer(int n, std::uint32_t value) const noexcept {
  if (!active(value)) return AbortCode::none;
  for (int i = 0; i < kConsumers; ++i) {
    const std::int64_t other = *entries_[static_cast<std::size_t>(i)];
    if (i != n - 1 && active(other) && node_of(other) == node_of(value))
      return AbortCode::parameter_incompatible;
  }
  return AbortCode::none;
}

void NodeMonitor::send(std::uint8_t state) noexcept {
  image::CanFrame frame = heartbeat_frame(node_, NmtState::boot_up);
  frame.data[0] = state;
  if (bus_) bus_->send(frame);
}

void NodeMonitor::on_frame(const image::CanFrame& frame, NmtState own_state,
                           image::Nanoseconds now) noexcept {
  if (frame.id == cob::heartbeat(node_)) {
    if (!frame.remote || producer_ms_ > 0) return;  // a heartbeat producer does not answer guarding
    send(static_cast<std::uint8_t>(static_cast<int>(own_state) | (toggle_ ? 0x80 : 0)));
    toggle_ = !toggle_;
    guarded_ = true;
    guard_lost_ = false;
    guard_deadline_ = now + guard_ms_ * life_factor_ * image::kMillisecond;
    return;
  }
  const auto state = parse_heartbeat(frame);
  if (!state) return;
  for (int i = 0; i < kConsumers; ++i) {
    const std::int64_t entry = *entries_[static_cast<std::size_t>(i)];
    if (!active(entry) || cob::heartbeat(node_of(entry)) != frame.id) continue;
    Consumer& c = consumers_[static_cast<std::size_t>(i)];
    c = {true, false, now + time_of(entry)};
  }
}

void NodeMonitor::watch(image::Nanoseconds now) noexcept {
  bool lost = false;
  for (int i = 0; i < kConsumers; ++i) {
    Consumer& c = consumers_[static_cast<std::size_t>(i)];
    if (!c.running) continue;
    c.lost = now > c.deadline;
    lost |= c.lost;
  }
  if (guarded_ && guard_ms_ * life_factor_ > 0) guard_lost_ = now > guard_deadline_;
  lost_ = lost || guard_lost_;
}

void NodeMonitor::tick(NmtState own_state, image::Nanoseconds now) noexcept {
  if (!running_) return;
  watch(now);
  if (producer_ms_ <= 0 || now < next_) return;
  send(static_cast<std::uint8_t>(own_state));
  next_ += producer_ms_ * image::kMillisecond;
  if (next_ <= now) next_ = now + producer_ms_ * image::kMillisecond;
}

}  // namespace servogate::canopen
