// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "gateway/machine/config.hpp"

/// The digital inputs and outputs of drives (60FDh, 60FEh:01) as points of packet A: stations of kind
/// "drive". Channel diN is bit N of 60FDh: 0 negative limit, 1 positive limit, 2 home, 3 interlock, from 16
/// on the maker's own; dqN is bit N of 60FEh:01 (CiA 402-2, digital inputs and outputs).
namespace servogate::gateway {

/// Where the drive of a station stands in the image; the drive is an axis or a spindle.
struct DriveSeat {
  bool spindle = false;
  std::size_t index = 0;
};

/// One point: the bit and its place.
struct DrivePoint {
  std::uint32_t mask = 0;
  image::Place place;
  bool inverted = false;
  bool hold = false;     ///< input: keeps its value while the drive is silent
  bool on_loss = false;  ///< input: otherwise this one, as it stands in packet A
};

struct DriveStation {
  DriveSeat seat;
  std::size_t source = 0;  ///< of ProcessImage::sources
  std::vector<DrivePoint> inputs, outputs;
};

/// The stations of a machine whose points come over drives. Not real-time safe.
std::vector<DriveStation> drive_stations(const machine::MachineConfig& machine);

/// Inputs: stands behind the segments in the cycle, whose feedback it reads.
class DriveInputs final : public image::CycleDevice {
 public:
  explicit DriveInputs(std::vector<DriveStation> stations) : stations_(std::move(stations)) {}
  /// real-time safe.
  void receive(image::ProcessImage& image) noexcept override;
  void send(image::ProcessImage&) noexcept override {}

 private:
  std::vector<DriveStation> stations_;
};

/// Outputs: stands before the segments, which send what it puts into the command.
class DriveOutputs final : public image::CycleDevice {
 public:
  explicit DriveOutputs(std::vector<DriveStation> stations) : stations_(std::move(stations)) {}
  void receive(image::ProcessImage&) noexcept override {}
  /// real-time safe.
  void send(image::ProcessImage& image) noexcept override;

 private:
  std::vector<DriveStation> stations_;
};

}  // namespace servogate::gateway
