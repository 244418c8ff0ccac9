// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cmath>
#include <numbers>

#include "bench/drive/measurement/bench_drive.hpp"
#include "drivers/mock/drive/plant.hpp"

namespace servogate::bench {

/// A plant as the bench would see it over a bus: what is asked acts one cycle later, and what is measured is
/// read one cycle later.
class PlantOnBench final : public BenchDrive {
 public:
  explicit PlantOnBench(const mock::PlantConfig& config) : config_(config), plant_(config, kServo) {
    start_ = plant_.counts();
  }
  double period_s() const noexcept override { return 1e-3; }
  bool ended() const override { return ends; }
  bool lives() const override { return alive; }
  bool cycle(const DriveAsk& ask, DriveAnswer& answer) override {
    answer = measured_;
    ++cycles;
    const double turn = static_cast<double>(config_.counts_per_rev);
    // SYNC: what was asked a cycle ago acts, what is now is latched.
    measured_.online = online;
    measured_.time_s = clock_s;
    clock_s += 1e-3;
    measured_.faulted = faulted;
    measured_.enabled = acting_.power && !faulted && !drops;
    measured_.position_rad =
        static_cast<double>(plant_.state().position - start_) / turn * 2.0 * std::numbers::pi;
    measured_.torque_nm = plant_.state().torque * config_.rated_torque_nm / 1000.0;
    canopen::ServoCommand c;
    c.brake_released = true;
    c.torque_limit_positive = c.torque_limit_negative = 3000.0;
    const double counts = acting_.value * turn / (2.0 * std::numbers::pi);
    if (acting_.power && !faulted) {
      using L = canopen::ServoCommand::Loop;
      c.loop = acting_.quick_stop || acting_.loop == Loop::velocity ? L::velocity
               : acting_.loop == Loop::torque                       ? L::torque
                                                                    : L::position;
      if (c.loop == L::torque)
        c.torque = std::round(acting_.value / config_.rated_torque_nm * 1000.0);
      else if (c.loop == L::position)
        c.position = counts + static_cast<double>(start_);
      else
        c.velocity = acting_.quick_stop ? 0.0 : std::round(counts);
    }
    for (int i = 0; i < 4; ++i) plant_.step(c);
    acting_ = ask;
    asked = ask;
    return !gone;
  }
  const mock::Plant& plant() const { return plant_; }

  bool ends = false, gone = false, online = true, faulted = false, drops = false;
  bool alive = false;           ///< as if its time went on by itself
  std::atomic<int> cycles = 0;  ///< so far
  DriveAsk asked;
  double clock_s = 0.0;  ///< by which the answers are measured

 private:
  static constexpr image::Nanoseconds kServo = 250'000;
  mock::PlantConfig config_;
  mock::Plant plant_;
  std::int64_t start_;
  DriveAsk acting_;
  DriveAnswer measured_;
};

}  // namespace servogate::bench
