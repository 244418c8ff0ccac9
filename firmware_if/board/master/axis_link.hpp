// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>

#include "firmware_if/board/master/session.hpp"
#include "firmware_if/image/drive_link.hpp"

namespace servogate::board {

/// Error codes in DriveFeedback of what only a board has; of the range that CiA 301 leaves to makers.
inline constexpr std::uint16_t kErrorFaultInput = 0xFF01;  ///< the amplifier reports a fault
inline constexpr std::uint16_t kErrorTripped = 0xFF02;     ///< the board's watchdog has dropped everything

/// An amplifier on a channel of a board.
struct AxisLinkConfig {
  std::size_t axis = 0;  ///< in ProcessImage::axes
  std::uint8_t channel = 0;
  Output output = Output::step;
  bool encoder = true;  ///< position by the channel's encoder; false: by the steps put out
  /// step: exactly steps / counts steps make one count. With position by steps: 1 / 1.
  std::int64_t steps = 1, counts = 1;
  bool reversed = false;             ///< a positive set-point lowers the counts
  double full_scale_counts_s = 0.0;  ///< analog, pwm: speed at kFullScale
  double offset = 0.0;               ///< analog: added to the output, of the full scale, -1 to 1
  double position_gain = 0.0;        ///< 1/s, analog and pwm; below 1 / (4 cycles)
  double quick_stop = 0.0;           ///< counts/s2 of a quick stop, above 0
};

/// An axis whose amplifier takes step/direction, +-10 V or PWM, as the drive of the kernel: its enable and
/// fault lines in the states of CiA 402, its encoder as actual position. For a speed amplifier the position
/// loop is here: proportional, with the velocity of the set-point fed forward; the following error is
/// supervised by the axis like that of any drive. Enabled, it begins where it stands. A quick stop is a ramp
/// here, and then the enable goes. All but the constructor is real-time safe.
class AxisLink {
 public:
  explicit AxisLink(const AxisLinkConfig& config) : config_(config) {}
  const AxisLinkConfig& config() const noexcept { return config_; }

  /// Into the image; `fresh`: a status came since the last cycle.
  void receive(const Session& session, bool fresh, image::DriveFeedback& to) noexcept;
  /// The command of this cycle, which lasts `dt` s, into its place.
  void send(const image::DriveCommand& from, double dt, Command& to) noexcept;

 private:
  void take_counts(const ChannelStatus& from, const Status& status) noexcept;
  void move(const image::DriveCommand& from, double dt) noexcept;
  std::int64_t steps_of(std::int64_t counts) const noexcept;
  ChannelCommand step_command(double dt) const noexcept;
  ChannelCommand speed_command(double velocity) const noexcept;

  AxisLinkConfig config_;
  bool online_ = false, enabled_ = false, fault_ = false, tripped_ = false;  ///< as the board says
  std::uint32_t session_ = 0;
  std::uint8_t restarts_ = 0;
  bool counts_known_ = false;
  std::int64_t counts_ = 0;  ///< extended
  std::int32_t raw_counts_ = 0, steps_ = 0;
  std::uint32_t t_us_ = 0;
  double velocity_ = 0.0;  ///< measured, counts/s
  std::uint8_t latches_ = 0;
  std::int64_t latched_ = 0;
  std::uint32_t captures_ = 0;
  std::uint32_t missed_ = 0;

  bool on_ = false;                       ///< the enable that is sent
  bool quick_ = false, stopped_ = false;  ///< a quick stop is under way; it has come to rest
  std::int64_t goal_ = 0, goal_before_ = 0, goal_read_ = 0;  ///< counts: newest, one and two cycles ago
  double ramp_ = 0.0, ramp_rest_ = 0.0;  ///< of a quick stop: counts/s, and a part of a count
  std::int64_t zero_counts_ = 0;         ///< set-point and steps where the channel was enabled
  std::int32_t zero_steps_ = 0;
};

}  // namespace servogate::board
