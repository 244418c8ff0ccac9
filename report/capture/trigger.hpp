// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace servogate::report {

/// When a capture is to be written: in the first cycle in which a condition is true that was not true in the
/// cycle before.
struct Trigger {
  enum class Compare : std::uint8_t { less, less_equal, greater, greater_equal, equal, not_equal, rises };
  std::string channel;  ///< name
  Compare compare = Compare::greater;
  double value = 0.0;
};

/// "X.error > 0.05", "SK200 = 3", "door_open != 0"; "alarm": one more alarm stands than in the cycle before.
/// nullopt: no condition. Not real-time safe.
std::optional<Trigger> parse_trigger(std::string_view text);
/// The channel that `alarm` looks at.
inline constexpr std::string_view kAlarmChannel = "alarms";

/// A trigger at work.
class TriggerWatch {
 public:
  /// `index` of its channel.
  TriggerWatch(const Trigger& trigger, std::size_t index) : trigger_(trigger), index_(index) {}
  /// With each row: whether it fires.
  bool fires(std::span<const double> row);

 private:
  bool met(double value) const;
  Trigger trigger_;
  std::size_t index_;
  bool begun_ = false, was_ = false;
  double before_ = 0.0;
};

}  // namespace servogate::report
