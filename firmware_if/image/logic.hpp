// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/image/notices.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"

namespace servogate::image {

/// The machine's logic, called once a cycle between reading inputs and moving axes. Everything real-time
/// safe.
class Logic {
 public:
  virtual ~Logic() = default;
  /// One scan on packets A and K; faults (budget, division by zero ...) go into `notices`.
  virtual void scan(ProcessImage& image, Notices& notices) noexcept = 0;
  /// Carries out a change (RequestKind::logic) that the gate has let pass, between two scans. False: it is
  /// not there any more. Or holds the logic, lets it scan, or lets it go (RequestKind::logic_scan): from the
  /// next cycle on, while it is held, what it writes is FALSE or 0.
  virtual bool order(const Request& request) noexcept {
    static_cast<void>(request);
    return false;
  }
  /// The next scan ends before it does anything, with its fault: in the record that is being replayed
  /// somebody ended it (cycle::CycleInputs).
  virtual void end_next_scan() noexcept {}
};

}  // namespace servogate::image
