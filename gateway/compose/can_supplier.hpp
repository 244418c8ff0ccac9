// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/canopen/master/segment.hpp"
#include "kernel/cycle/participants.hpp"

namespace servogate::gateway {

/// A CANopen segment as a device of the cycle whose bus events become alarms.
class CanSupplier final : public image::CycleDevice {
 public:
  CanSupplier(image::CanBus& bus, canopen::SegmentConfig config) : segment_(bus, std::move(config)) {}
  /// Where faults are reported; set before the first cycle.
  void report_to(cycle::Notices& notices) noexcept { notices_ = &notices; }

  /// From now on sync_ns() says when each SYNC went. Before the first cycle.
  void time_sync(const image::Clock& clock) noexcept { clock_ = &clock; }
  /// Time by that clock at which the SYNC of this cycle was handed to the bus. real-time safe.
  image::Nanoseconds sync_ns() const noexcept { return sync_ns_; }

  /// Sends SYNC. real-time safe.
  void open_cycle(image::ProcessImage& image) noexcept override;
  /// real-time safe.
  void receive(image::ProcessImage& image) noexcept override;
  /// real-time safe.
  void send(image::ProcessImage& image) noexcept override { segment_.send(image); }

  /// See canopen::Segment. real-time safe.
  bool leave(image::Nanoseconds now) noexcept { return segment_.leave(now); }

  const canopen::Segment& segment() const noexcept { return segment_; }
  /// Reading objects from outside the cycle; one asker. real-time safe.
  canopen::ObjectQuestion& question() noexcept { return segment_.question(); }

 private:
  void report(const canopen::BusEvent& event) noexcept;
  bool room() const noexcept;
  void report_lost() noexcept;

  canopen::Segment segment_;
  cycle::Notices* notices_ = nullptr;
  const image::Clock* clock_ = nullptr;
  image::Nanoseconds sync_ns_ = 0;
  std::uint32_t lost_said_ = 0;
};

/// A start-up that failed in the figures of an alarm record (kBootFailed), and back; texts that a device
/// should have said and did not are not kept. real-time safe.
void pack(const canopen::BootReport& report, image::AlarmRecord& record) noexcept;
canopen::BootReport unpack(const image::AlarmRecord& record) noexcept;

}  // namespace servogate::gateway
