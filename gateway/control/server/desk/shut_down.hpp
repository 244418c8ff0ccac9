// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <memory>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/run/announce.hpp"
#include "gateway/control/server/resident/request_desk.hpp"

namespace servogate::gateway {

/// The end of a control, look by look, so that its clients see it: motion stops on the path, the drives go
/// off, the spindles run down. It waits for nobody. For one thread.
class ShutDown {
 public:
  /// `announce`: hears what does not rest.
  ShutDown(Control& control, RequestDesk& requests, Announce announce)
      : control_(control),
        requests_(requests),
        announce_(std::move(announce)),
        image_(std::make_unique<image::ProcessImage>()) {}

  /// One look. True: everything rests, or it was waited for long enough; what does not rest has been
  /// announced.
  bool look();
  /// After look() was true: the axes are off and every spindle is known to stand.
  bool rests() const noexcept { return rests_; }

 private:
  enum class Stage { begin, stop, motion, power, drives, spindles, done };
  void enter(Stage stage);
  double in_stage() const;
  bool moving();
  bool asked(image::RequestKind kind);
  void end();
  void announce(const text::Entry& entry, const std::vector<std::string>& arguments) const {
    if (announce_) announce_(entry, arguments);
  }

  const image::ProcessImage& image();

  Control& control_;
  RequestDesk& requests_;
  Announce announce_;
  std::unique_ptr<image::ProcessImage> image_;
  Stage stage_ = Stage::begin;
  std::uint64_t request_ = 0;  ///< whose answer is waited for
  std::chrono::steady_clock::time_point entered_;
  bool said_ = false, rests_ = false;
};

}  // namespace servogate::gateway
