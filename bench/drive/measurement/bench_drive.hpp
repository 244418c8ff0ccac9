// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace servogate::bench {

enum class Loop : std::uint8_t {
  position,  ///< rad from where the drive stood at its first answer
  velocity,  ///< rad/s
  torque,    ///< N m
};

/// What the drive is to do in the next cycle.
struct DriveAsk {
  bool power = false;
  bool quick_stop = false;  ///< stop by its own ramp (6085h)
  Loop loop = Loop::velocity;
  double value = 0.0;  ///< set-point of that loop
};

/// What it showed, all of one instant.
struct DriveAnswer {
  bool online = false;   ///< its process data are fresh
  bool enabled = false;  ///< Operation enabled, in the loop that was asked for
  bool faulted = false;
  double time_s = 0.0;        ///< when it was measured, by one clock: cycles may come late
  double position_rad = 0.0;  ///< from where it stood at its first answer
  double torque_nm = 0.0;
  std::uint16_t statusword = 0, error_code = 0;
};

/// One drive, cycle by cycle: a bus with a drive on it, or a plant in a test. Not real-time safe.
class BenchDrive {
 public:
  virtual ~BenchDrive() = default;
  virtual double period_s() const noexcept = 0;
  /// One cycle. False: no further one can follow, the bus is gone.
  virtual bool cycle(const DriveAsk& ask, DriveAnswer& answer) = 0;
  /// Whether its time goes on while nobody asks for a cycle: then it must not be left alone for long.
  virtual bool lives() const { return false; }
  /// The operator ends the run; cycles go on, so that the drive can be stopped.
  virtual bool ended() const = 0;
};

}  // namespace servogate::bench
