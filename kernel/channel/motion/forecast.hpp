// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/text/finding.hpp"
#include "kernel/channel/motion/path_elements.hpp"
#include "kernel/path/path_time.hpp"

namespace servogate::channel {

/// What the motion of a program comes to, found as the feeder would, without a machine. Not real-time safe.
class Forecast {
 public:
  enum class Depth : std::uint8_t {
    drivable,  ///< whether each element can be driven
    timed,     ///< the path is planned, too: how long it takes
  };
  Forecast(Depth depth, const path::Config& config, AxisMap axes, const program::Position& start);

  /// The next command of the program. nullopt: it can be driven; otherwise what keeps it from that (without
  /// its place), and the next command begins where it would have ended.
  std::optional<text::Finding> take(const program::Command& command);
  /// Of all motion taken so far at an override of 100 %, s, ramps and corners included, as if it ended here;
  /// 0 unless timed. M, S, T, dwells and waits take their own.
  double motion_seconds();

 private:
  void begin_anew();

  path::Config config_;
  PathElements elements_;
  path::Vector at_{};
  std::optional<path::PathTime> time_;
  double before_s_ = 0.0;  ///< of what lies before the last element that cannot be driven
};

}  // namespace servogate::channel
