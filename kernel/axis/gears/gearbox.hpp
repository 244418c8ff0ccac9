// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware_if/image/process_image.hpp"

namespace servogate::axis {

/// One gear range, as plain data from the machine file.
struct GearRange {
  double max_rpm = 0.0;  ///< of the spindle
  double ratio = 1.0;    ///< the motor's speed for one of the spindle, over that of the first gear; > 0
  std::optional<image::Place> output;   ///< TRUE engages it; none: a gear without an output of its own
  std::optional<image::Place> confirm;  ///< TRUE: it is engaged
};

/// The gear ranges of a spindle. Empty: it has none.
struct GearboxConfig {
  std::vector<GearRange> ranges;  ///< rising max_rpm
  double change_rpm = 0.0;        ///< the spindle turns so slowly while its gear changes; 0: it stands
  double change_s = 0.5;          ///< from the outputs to an engaged gear, where no input confirms it
  double timeout_s = 5.0;         ///< to its confirmation; then the change has failed
  std::uint32_t sources = 0;      ///< bit n: image.sources[n] carries one of the outputs or confirmations
};

/// Engages the gear that is wanted, once the spindle is slow enough. All but configure() is real-time safe.
class Gearbox {
 public:
  void configure(const GearboxConfig& config);
  bool present() const noexcept { return !config_.ranges.empty(); }
  const GearboxConfig& config() const noexcept { return config_; }

  /// Wants the gear `number`, from 1; 0: the slowest one that reaches `rpm` (without sign). A change that has
  /// failed begins anew.
  void choose(double rpm, int number) noexcept;
  /// One cycle: reads confirmations, writes outputs. `slow`: the spindle is known to turn no faster than
  /// change_rpm. `lost`: nothing that was engaged can be trusted.
  void step(image::ProcessImage& image, bool slow, bool lost, double dt) noexcept;

  /// The gear in force, from 1; 0: none is known to be.
  int engaged() const noexcept { return engaged_; }
  int wanted() const noexcept { return wanted_; }
  /// The spindle has to turn slowly and to wait.
  bool changing() const noexcept { return wanted_ != 0 && engaged_ != wanted_; }
  /// The gear was not confirmed in time, or its confirmation went.
  bool failed() const noexcept { return failed_; }
  /// One of its stations does not answer.
  bool lost(const image::ProcessImage& image) const noexcept;
  /// Motor speed over that of the first gear; while no gear is known that of the first.
  double ratio() const noexcept;
  /// Largest speed of the gear that is wanted; without gears: `otherwise`.
  double max_rpm(double otherwise) const noexcept;

 private:
  const GearRange& wanted_range() const noexcept {
    return config_.ranges[static_cast<std::size_t>(wanted_ - 1)];
  }
  void begin(image::ProcessImage& image) noexcept;
  void drop() noexcept;

  GearboxConfig config_;
  int engaged_ = 0, wanted_ = 0;
  bool shifting_ = false;  ///< the outputs have the gear that is wanted
  bool failed_ = false;
  double since_s_ = 0.0;
};

}  // namespace servogate::axis
