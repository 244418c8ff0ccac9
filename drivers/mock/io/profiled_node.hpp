// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/canopen/device/node/slave.hpp"

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

  void connect(image::CanBus& its_bus, Nanoseconds now) {
    bus = &its_bus;
    next = now + kPeriod;
    slave.power_on(its_bus, now, boot_time_ns);
  }
  /// Without supply it neither hears nor says anything and keeps nothing; with it again it starts as after
  /// power-on.
  void supply(bool present) noexcept {
    if (present == alive) return;
    alive = present;
    start_again();
  }
  /// Another device takes its place and starts, with this product code (1018h:02; 0: the next one); nullopt:
  /// the device itself is back.
  void swap(std::optional<std::uint32_t> product) noexcept {
    constexpr auto kIdentity = canopen::object::kIdentity;
    if (!own_product) own_product = dictionary.get(kIdentity, 2);
    const std::int64_t other = product.value_or(0) != 0 ? *product : *own_product + 1;
    dictionary.set_default(kIdentity, 2, product ? other : *own_product);
    start_again();
  }
  void start_again() noexcept {
    const Nanoseconds now = next - kPeriod;
    slave.reset_node(now);
    if (bus != nullptr) slave.power_on(*bus, now, boot_time_ns);
  }
  void on_frame(const CanFrame& frame) noexcept {
    if (!alive || !slave.concerned(frame)) return;
    advance_to(frame.timestamp_ns);
    slave.on_frame(frame, frame.timestamp_ns);
  }
  void advance_to(Nanoseconds t) noexcept {
    for (; next <= t; next += kPeriod) {
      if (!alive) continue;
      profile.tick(next);
      slave.tick(next);
    }
  }

  Nanoseconds boot_time_ns;
  canopen::ObjectDictionary dictionary;
  Profile profile;
  canopen::Slave slave;
  Nanoseconds next = 0;
  image::CanBus* bus = nullptr;
  bool alive = true;
  std::optional<std::int64_t> own_product;  ///< 1018h:02 of the device itself, once it was swapped
};

}  // namespace servogate::mock
