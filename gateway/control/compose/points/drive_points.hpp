// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/image/points/point_stage.hpp"
#include "machine/config.hpp"

namespace servogate::gateway {

/// Where the drive of a station stands in the image; the drive is an axis or a spindle.
struct DriveSeat {
  bool spindle = false;
  std::size_t index = 0;
};

/// The digital inputs and outputs of a drive (60FDh, 60FEh:01) as points of packet A: a station of kind
/// "drive". Channel diN is bit N of 60FDh: 0 negative limit, 1 positive limit, 2 home, 3 interlock, from 16
/// on the maker's own; dqN is bit N of 60FEh:01 (CiA 402-2, digital inputs and outputs). Part of the device
/// that carries the drive.
class DrivePoints {
 public:
  /// `source` of ProcessImage::sources. Not real-time safe.
  DrivePoints(const machine::StationConfig& station, DriveSeat seat, int source);

  /// Inputs, once the drive's feedback is in the image. real-time safe.
  void receive(image::ProcessImage& image) noexcept;
  /// Outputs into the drive's command, before it is sent. real-time safe.
  void send(image::ProcessImage& image) noexcept;

 private:
  DriveSeat seat_;
  image::PointStage stage_;
  std::vector<std::uint32_t> masks_;  ///< of each point
};

/// Those of a bus, by its name. Not real-time safe.
std::vector<DrivePoints> drive_points(const machine::MachineConfig& machine, const std::string& bus);

}  // namespace servogate::gateway
