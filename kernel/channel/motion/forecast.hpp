// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/text/finding.hpp"
#include "kernel/channel/motion/path_elements.hpp"
#include "kernel/channel/motion/tap_commands.hpp"
#include "kernel/path/path_time.hpp"
#include "kernel/path/survey.hpp"

namespace servogate::channel {

/// What the motion of a program comes to, found as the feeder would, without a machine. Not real-time safe.
class Forecast {
 public:
  enum class Depth : std::uint8_t {
    drivable,  ///< whether each element can be driven
    timed,     ///< the path is planned, too: how long it takes
    surveyed,  ///< and driven cycle by cycle: where it is slow, and why
  };
  /// `own`: the machine axes that the program may move, as bits.
  Forecast(Depth depth, const path::Config& config, AxisMap axes, const program::Position& start,
           std::uint32_t own = ~std::uint32_t{0});

  /// The next command of the program. nullopt: it can be driven; otherwise what keeps it from that (without
  /// its place), and the next command begins where it would have ended.
  std::optional<text::Finding> take(const program::Command& command);
  /// A machine axis that the command would move although it is another process', -1: none; what follows is
  /// judged from where it would have moved it.
  int foreign_axis(const program::Command& command);
  /// Of all motion taken so far at an override of 100 %, s, ramps and corners included, as if it ended here;
  /// 0 unless timed or surveyed. M, S, T, dwells and waits take their own.
  double motion_seconds();
  /// Where most time is lost, only if surveyed; since the last element that cannot be driven.
  std::vector<path::SlowPlace> slowest() const {
    if (!survey_) return {};
    return survey_->slowest();
  }

 private:
  std::optional<text::Finding> drive(path::Element element, const program::Command& command);
  std::optional<text::Finding> tap();
  path::Flaw add(const path::Element& element);
  void rest();
  void begin_anew();

  path::Config config_;
  AxisMap axes_;
  PathElements elements_;
  TapCommands tap_;
  path::Vector at_{};
  program::Position stands_;  ///< of the axes of other processes
  std::optional<path::PathTime> time_;
  std::optional<path::Survey> survey_;
  double before_s_ = 0.0;  ///< of what lies before the last element that cannot be driven
};

}  // namespace servogate::channel
