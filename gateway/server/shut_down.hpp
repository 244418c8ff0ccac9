// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>

#include "gateway/server/resident.hpp"

namespace servogate::gateway {

/// The end of a control, look by look, so that its clients see it: motion stops on the path, the drives go
/// off, the spindles run down. For the thread of the Resident.
class ShutDown {
 public:
  explicit ShutDown(Resident& resident) : resident_(resident) {}

  /// One look. True: everything rests, or it was waited for long enough; what does not rest has been said on
  /// standard error.
  bool look();
  /// After look() was true: the axes are off and every spindle is known to stand.
  bool rests() const noexcept { return rests_; }

 private:
  enum class Stage { begin, motion, drives, spindles, done };
  void enter(Stage stage);
  double in_stage() const;
  bool moving();
  void end();

  Resident& resident_;
  Stage stage_ = Stage::begin;
  std::chrono::steady_clock::time_point entered_;
  bool said_ = false, rests_ = false;
};

}  // namespace servogate::gateway
