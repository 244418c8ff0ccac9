// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/bus_gate.hpp"

#include <algorithm>
#include <span>

namespace servogate::mock {
namespace {

constexpr bool means(std::uint32_t wanted, std::uint32_t number) noexcept {
  return wanted == 0 || wanted == number;
}

}  // namespace

bool BusGate::send(const image::CanFrame& frame) noexcept {
  if (!bus_ || spoil_.silent) return true;
  if (frame.id == canopen::cob::heartbeat(device_.node())) return spoil_.heartbeat_lost || bus_->send(frame);
  if (frame.id == canopen::cob::sdo_response(device_.node()))
    return spoil_.sdo_silent || send_later(frame, spoil_.sdo_delay_ns);
  const int number = device_.transmit_pdo_of(frame.id);
  return number > 0 ? send_pdo(frame, static_cast<std::uint32_t>(number)) : bus_->send(frame);
}

bool BusGate::send_pdo(image::CanFrame frame, std::uint32_t number) noexcept {
  if (spoil_.pdo_dropped_every > 0 && means(spoil_.dropped_number, number) &&
      ++pdos_ % spoil_.pdo_dropped_every == 0)
    return true;
  image::CanFrame& old = last_[number - 1];
  if (spoil_.pdo_repeated && means(spoil_.repeated_number, number) && old.length > 0) {
    const std::uint32_t id = frame.id;
    frame = old;
    frame.id = id;  // its master may have moved it meanwhile
    frame.wire_bits = 0;
  } else {
    old = frame;
  }
  if (spoil_.pdo_flip != 0 && means(spoil_.flipped_number, number)) {
    const auto bytes = std::span(frame.data).first(frame.length);
    canopen::store_le(canopen::load_le(bytes) ^ spoil_.pdo_flip, bytes);
    frame.wire_bits = 0;
  }
  return send_later(frame, means(spoil_.late_number, number) ? spoil_.pdo_delay_ns : 0);
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
