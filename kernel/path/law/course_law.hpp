// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "kernel/path/shape/gather.hpp"

namespace servogate::path {

/// What makes a course of each run that it is given.
class CourseLaw : public RunSink {
 public:
  virtual ~CourseLaw() = default;
  /// Plans a window of what can be planned. False: nothing was to be done.
  virtual bool work() = 0;
  /// The course in work has got its rest, and is not given as far as that: call work(), and put nothing
  /// before.
  virtual bool ends() const = 0;
  /// There is no law inside of the limits for what comes next: what was given rests before it, and nothing
  /// more is given, until restart().
  virtual bool broken() const = 0;
  /// Where a broken course rests.
  struct Rest {
    double place = 0.0;       ///< path parameter from the start of the course
    std::optional<Vector> x;  ///< path coordinates; not at its start: the programmed place
  };
  virtual Rest rest_place() const = 0;
  /// Path parameter that a course which breaks now surely comes to.
  virtual double sure() const = 0;
  /// Forgets what was not given yet.
  virtual void restart() = 0;
};

}  // namespace servogate::path
