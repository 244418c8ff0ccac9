// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "kernel/path/shape/element.hpp"

namespace servogate::path {

/// What keeps a path below its programmed feed.
enum class Brake : std::uint8_t {
  rest,          ///< it rests there: an exact stop, an event, its begin and end
  velocity,      ///< of an axis
  acceleration,  ///< the same
  jerk,          ///< the same
  shape,         ///< no limit is reached: a corner is rounded within the tolerance, or the way is too short
};

/// A part of a path that is foretold and not driven.
struct Moment {
  double seconds = 0.0;
  double feed = 0.0;  ///< speed of the vector over mm and degrees
  Brake brake = Brake::shape;
  int axis = -1;              ///< path axis of a limit
  std::uint64_t command = 0;  ///< Tag::command of the element
  double turns = 0.0;         ///< revolutions a second that it is planned for there; 0: Element::revolutions
};

/// Where moments go, in order. A rest is one that takes no time and has no feed.
class MomentSink {
 public:
  virtual void put(const Moment& moment) = 0;

 protected:
  ~MomentSink() = default;
};

}  // namespace servogate::path
