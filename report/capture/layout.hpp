// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "firmware_if/image/can_bus.hpp"

namespace servogate::report {

/// One value of a capture, taken each cycle. Name and unit are what people read; `topic` and `field` are
/// where an MCAP file has it.
struct CaptureChannel {
  std::string name;   ///< "X.actual", "NC.m_strobe", "SK200", "Mill.count"
  std::string unit;   ///< "mm", "deg", "mm/s", "rpm"; empty: a number as it stands
  std::string topic;  ///< "/axis/X"
  std::string field;  ///< "actual"
  friend bool operator==(const CaptureChannel&, const CaptureChannel&) = default;
};

/// What every row of a capture holds; the same for the whole of it.
struct CaptureLayout {
  image::Nanoseconds period_ns = image::kMillisecond;
  std::vector<CaptureChannel> channels;
  std::vector<std::string> buses;                           ///< names, by number
  std::vector<std::pair<std::string, std::string>> origin;  ///< machine, version and the like, for people
};

/// A frame that passed on a bus, as the master saw it.
struct CaptureFrame {
  image::Nanoseconds t_ns = 0;  ///< machine time, as that of rows
  int bus = 0;
  image::CanFrame frame;
};

/// Takes a capture in the order of time. Errors are kept, never thrown. Not for the cycle.
class CaptureSink {
 public:
  virtual ~CaptureSink() = default;
  virtual void begin(const CaptureLayout& layout) = 0;
  /// One value a channel; machine time from the first cycle of the control.
  virtual void row(image::Nanoseconds t_ns, std::span<const double> values) = 0;
  virtual void frame(const CaptureFrame& frame) = 0;
  /// Something to know at a moment: the trigger, an alarm.
  virtual void note(image::Nanoseconds t_ns, const std::string& text) = 0;
  virtual void end() = 0;
  /// What went wrong, empty when nothing did. After end().
  virtual std::string error() const { return {}; }
};

}  // namespace servogate::report
