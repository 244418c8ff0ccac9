// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/bus_gate.hpp"

#include <algorithm>
#include <span>

namespace servogate::mock {
namespace {

/// 180h, 280h, 380h, 480h + node. Source: CiA 301, 7.3.5, predefined connection set.
bool means(std::uint32_t number, const image::CanFrame& frame) noexcept {
  return number == 0 || frame.id >> 7 == 2 * number + 1;
}

}  // namespace

bool BusGate::send(const image::CanFrame& frame) noexcept {
  if (!bus_ || spoil_.silent) return true;
  if (frame.id == canopen::cob::heartbeat(node_)) return spoil_.heartbeat_lost || bus_->send(frame);
  if (frame.id == canopen::cob::sdo_response(node_))
    return spoil_.sdo_silent || send_later(frame, spoil_.sdo_delay_ns);
  if (frame.id == canopen::cob::emcy(node_)) return bus_->send(frame);
  return send_pdo(frame);
}

bool BusGate::send_pdo(image::CanFrame frame) noexcept {
  if (spoil_.pdo_dropped_every > 0 && means(spoil_.dropped_number, frame) &&
      ++pdos_ % spoil_.pdo_dropped_every == 0)
    return true;
  const auto same = [&frame](const image::CanFrame& f) { return f.length > 0 && f.id == frame.id; };
  auto old = std::find_if(last_.begin(), last_.end(), same);
  if (old == last_.end())
    old = std::find_if(last_.begin(), last_.end(), [](const auto& f) { return f.length == 0; });
  if (old != last_.end()) {
    if (spoil_.pdo_repeated && means(spoil_.repeated_number, frame) && old->length > 0)
      frame = *old;
    else
      *old = frame;
  }
  if (spoil_.pdo_flip != 0 && means(spoil_.flipped_number, frame)) {
    const auto bytes = std::span(frame.data).first(frame.length);
    canopen::store_le(canopen::load_le(bytes) ^ spoil_.pdo_flip, bytes);
    frame.wire_bits = 0;
  }
  return send_later(frame, means(spoil_.late_number, frame) ? spoil_.pdo_delay_ns : 0);
}

bool BusGate::send_later(const image::CanFrame& frame, image::Nanoseconds delay) noexcept {
  if (delay == 0) return bus_->send(frame);
  if (late_count_ < kLate) late_[late_count_++] = {frame, now_ + delay};
  return true;
}

void BusGate::advance_to(image::Nanoseconds now) noexcept {
  now_ = now;
  const auto begin = late_.begin(), end = begin + static_cast<std::ptrdiff_t>(late_count_);
  const auto kept = std::remove_if(begin, end, [&](const Late& l) {
    const bool due = l.at <= now;
    if (due) bus_->send(l.frame);
    return due;
  });
  late_count_ = static_cast<std::size_t>(kept - begin);
}

}  // namespace servogate::mock
