// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"

namespace servogate::bench {

/// A whole machine as this room sees it; the gateway hands it over. Virtual time: it moves only in step().
class Machine {
 public:
  virtual ~Machine() = default;
  /// One cycle, simulated devices and reading ahead included.
  virtual void step() = 0;
  /// The image as the last cycle left it.
  virtual const image::ProcessImage& image() const = 0;
  /// Posts a request to the gate. False: the queue is full.
  virtual bool post(const image::Request& request) = 0;
  /// How long Cycle::step() took in the last cycle, by the wall clock; simulated devices are not in it. -1:
  /// this cycle was not measured.
  virtual image::Nanoseconds cycle_duration_ns() const = 0;
  /// Puts a fault on a simulated device ("can.x", "over_current"); false: no such device or fault.
  virtual bool inject(std::string_view device, std::string_view fault) = 0;
};

}  // namespace servogate::bench
