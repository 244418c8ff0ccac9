// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/bus_gate.hpp"

#include <algorithm>
#include <span>

namespace servogate::mock {

bool BusGate::send(const image::CanFrame& frame) noexcept {
  if (!bus_ || spoil_.silent) return true;
  if (frame.id == canopen::cob::heartbeat(node_)) return spoil_.heartbeat_lost || bus_->send(frame);
  if (frame.id == canopen::cob::sdo_response(node_)) return spoil_.sdo_silent || bus_->send(frame);
  if (frame.id == canopen::cob::emcy(node_)) return bus_->send(frame);
  return send_pdo(frame);
}

bool BusGate::send_pdo(image::CanFrame frame) noexcept {
  ++pdos_;
  if (spoil_.pdo_dropped_every > 0 && pdos_ % spoil_.pdo_dropped_every == 0) return true;
  const auto same = [&frame](const image::CanFrame& f) { return f.length > 0 && f.id == frame.id; };
  auto old = std::find_if(last_.begin(), last_.end(), same);
  if (old == last_.end())
    old = std::find_if(last_.begin(), last_.end(), [](const auto& f) { return f.length == 0; });
  if (old != last_.end()) {
    if (spoil_.pdo_repeated && old->length > 0)
      frame = *old;
    else
      *old = frame;
  }
  if (spoil_.pdo_flip != 0) {
    const auto bytes = std::span(frame.data).first(frame.length);
    canopen::store_le(canopen::load_le(bytes) ^ spoil_.pdo_flip, bytes);
    frame.wire_bits = 0;
  }
  if (spoil_.pdo_delay_ns == 0) return bus_->send(frame);
  if (late_count_ < kLate) late_[late_count_++] = {frame, now_ + spoil_.pdo_delay_ns};
  return true;
}

void BusGate::advance_to(image::Nanoseconds now) noexcept {
  now_ = now;
  std::size_t sent = 0;
  while (sent < late_count_ && late_[sent].at <= now) bus_->send(late_[sent++].frame);
  if (sent == 0) return;
  std::move(late_.begin() + static_cast<std::ptrdiff_t>(sent),
            late_.begin() + static_cast<std::ptrdiff_t>(late_count_), late_.begin());
  late_count_ -= sent;
}

}  // namespace servogate::mock
