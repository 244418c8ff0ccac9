// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/canopen/master/segment.hpp"
#include "firmware_if/image/cycle_device.hpp"
#include "gateway/control/compose/points/drive_points.hpp"

namespace servogate::gateway {

/// A CANopen segment as a device of the cycle: its bus events become alarms, the inputs and outputs of its
/// drives points.
class CanSupplier final : public image::CycleDevice {
 public:
  CanSupplier(image::CanBus& bus, canopen::SegmentConfig config, std::vector<DrivePoints> drives)
      : segment_(bus, std::move(config)), drives_(std::move(drives)) {}

  /// From now on sync_ns() says when each SYNC went. Before the first cycle.
  void time_sync(const image::Clock& clock) noexcept { clock_ = &clock; }
  /// Time by that clock at which the SYNC of this cycle was handed to the bus. real-time safe.
  image::Nanoseconds sync_ns() const noexcept { return sync_ns_; }

  /// The bus has been listened to until this moment of the clock of time_sync(). Before the first cycle.
  void listened(image::Nanoseconds now) noexcept;

  /// Sends SYNC. real-time safe.
  void open_cycle(image::ProcessImage& image) noexcept override;
  /// real-time safe.
  void receive(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// real-time safe.
  void send(image::ProcessImage& image) noexcept override;

  /// See canopen::Segment. real-time safe.
  bool leave(image::Nanoseconds now) noexcept { return segment_.leave(now); }

  const canopen::Segment& segment() const noexcept { return segment_; }
  /// Reading objects from outside the cycle; one asker. real-time safe.
  canopen::ObjectQuestion& question() noexcept { return segment_.question(); }

 private:
  void look_at_clock() noexcept;
  void report_lost(image::Notices& notices) noexcept;

  canopen::Segment segment_;
  std::vector<DrivePoints> drives_;
  const image::Clock* clock_ = nullptr;
  image::Nanoseconds sync_ns_ = 0;
  image::Nanoseconds alive_ns_ = 0;  ///< when the control was certainly running; 0: nobody knows
  std::uint32_t lost_said_ = 0;
};

}  // namespace servogate::gateway
