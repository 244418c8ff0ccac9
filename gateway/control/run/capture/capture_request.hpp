// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace servogate::gateway {

/// What `--capture` and the options beside it ask for.
struct CaptureRequest {
  std::string file;      ///< *.csv or *.mcap; empty: no capture
  std::string channels;  ///< names with commas between them; empty: axes, spindles, processes, points
  std::string trigger;   ///< see report::parse_trigger; empty: everything from the first cycle on
  double before_s = 1.0, after_s = 1.0;

  bool asked() const noexcept { return !file.empty() || !channels.empty() || !trigger.empty(); }
};

}  // namespace servogate::gateway
