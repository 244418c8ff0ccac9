// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <utility>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/canopen/device/object_dictionary.hpp"
#include "firmware_if/canopen/device/slave.hpp"

namespace servogate::mock {

/// A CiA 301 device with the profile that stands behind its objects, brought on by the millisecond.
/// Everything but construction and connect() is real-time safe.
template <class Profile>
struct ProfiledNode {
  static constexpr Nanoseconds kPeriod = image::kMillisecond;

  template <class... Arguments>
  ProfiledNode(canopen::NodeId node, double boot_time_s, const std::vector<canopen::ObjectSpec>& rows,
               Arguments&&... arguments)
      : boot_time_ns(static_cast<Nanoseconds>(std::llround(boot_time_s * 1e9))),
        dictionary({rows}),
        profile(dictionary, std::forward<Arguments>(arguments)...),
        slave(node, dictionary, profile) {}

  void connect(image::CanBus& bus, Nanoseconds now) {
    next = now + kPeriod;
    slave.power_on(bus, now, boot_time_ns);
  }
  void on_frame(const CanFrame& frame) noexcept {
    if (!slave.concerned(frame)) return;
    advance_to(frame.timestamp_ns);
    slave.on_frame(frame, frame.timestamp_ns);
  }
  void advance_to(Nanoseconds t) noexcept {
    for (; next <= t; next += kPeriod) {
      profile.tick(next);
      slave.tick(next);
    }
  }

  Nanoseconds boot_time_ns;
  canopen::ObjectDictionary dictionary;
  Profile profile;
  canopen::Slave slave;
  Nanoseconds next = 0;
};

}  // namespace servogate::mock
