// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/can/foreign_sender.hpp"

#include <algorithm>
#include <limits>

#include "firmware_if/image/frames/can_wire.hpp"

namespace servogate::mock {

namespace {
constexpr std::uint32_t kMostStandardId = 0x7FF;
}  // namespace

void ForeignSender::connect(image::CanBus& bus, Nanoseconds) { bus_ = &bus; }

const CanFilter* ForeignSender::filter() const noexcept {
  static const CanFilter kNothing;
  return &kNothing;
}

bool ForeignSender::begin(const fault::Fault& fault, Nanoseconds now) noexcept {
  if (streams_.size() == kMost) std::erase_if(streams_, [](const Stream& s) { return s.ended(); });
  if (streams_.size() == kMost) return false;
  Stream stream;
  stream.fault = fault;
  stream.frame.id = fault.id;
  stream.frame.extended = fault.id > kMostStandardId;
  stream.frame.length = fault.length;
  std::copy_n(fault.data.begin(), fault.length, stream.frame.data.begin());
  const std::uint64_t bits = image::frame_bits(stream.frame) + image::kIntermissionBits;
  const Nanoseconds shortest =
      static_cast<Nanoseconds>(bits * static_cast<std::uint64_t>(image::kSecond) / bus_->bit_rate());
  stream.period = std::max(fault.delay_ns, shortest);
  stream.next = now + fault.delay_ns;
  streams_.push_back(stream);
  return true;
}

void ForeignSender::end(const fault::Fault& fault) noexcept {
  const auto same =
      std::find_if(streams_.begin(), streams_.end(), [&](const Stream& s) { return s.fault == fault; });
  if (same != streams_.end()) streams_.erase(same);
}

void ForeignSender::advance_to(Nanoseconds t) noexcept {
  for (Stream& s : streams_)
    for (; !s.ended() && s.next <= t; s.next += s.period)
      if (bus_->send(s.frame)) ++s.sent;
}

Nanoseconds ForeignSender::next_action_ns() const noexcept {
  Nanoseconds next = std::numeric_limits<Nanoseconds>::max();
  for (const Stream& s : streams_)
    if (!s.ended()) next = std::min(next, s.next);
  return next;
}

}  // namespace servogate::mock
