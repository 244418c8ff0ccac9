// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "gateway/machine/config.hpp"

namespace servogate::gateway {

/// Digital inputs that follow a change only after it has lasted (`debounce` of a point), whatever source they
/// come from. Two devices of the cycle: the first gives sources their own levels back, the second stands
/// behind them all and holds what has not lasted yet.
class Debounce {
 public:
  /// Not real-time safe.
  explicit Debounce(const machine::MachineConfig& machine);
  bool empty() const noexcept { return points_.empty(); }
  image::CycleDevice& before() noexcept { return before_; }
  image::CycleDevice& after() noexcept { return after_; }

 private:
  struct Point {
    image::Place place;
    image::Nanoseconds time_ns = 0;
    bool started = false;
    bool raw = false;    ///< as the source says
    bool shown = false;  ///< as packet A says
    image::Nanoseconds changed_ns = 0;
  };
  class Before final : public image::CycleDevice {
   public:
    explicit Before(std::vector<Point>& points) : points_(points) {}
    /// real-time safe.
    void receive(image::ProcessImage& image) noexcept override;
    void send(image::ProcessImage&) noexcept override {}

   private:
    std::vector<Point>& points_;
  };
  class After final : public image::CycleDevice {
   public:
    explicit After(std::vector<Point>& points) : points_(points) {}
    /// real-time safe.
    void receive(image::ProcessImage& image) noexcept override;
    void send(image::ProcessImage&) noexcept override {}

   private:
    std::vector<Point>& points_;
  };

  std::vector<Point> points_;
  Before before_{points_};
  After after_{points_};
};

}  // namespace servogate::gateway
