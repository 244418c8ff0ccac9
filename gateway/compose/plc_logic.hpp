// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/compose/retained_memory.hpp"
#include "kernel/cycle/participants.hpp"
#include "plc/engine.hpp"

namespace servogate::gateway {

/// The PLC's engine as the cycle's logic; its faults become alarms, its retained variables leave the cycle
/// after every scan that was whole.
class PlcLogic final : public cycle::Logic {
 public:
  explicit PlcLogic(std::shared_ptr<const plc::Image> image)
      : engine_(std::move(image)), retained_(engine_.retain_bytes()) {}
  /// real-time safe.
  void scan(image::ProcessImage& image, cycle::Notices& notices) noexcept override;
  plc::Engine& engine() noexcept { return engine_; }
  /// The retained variables after the newest scan, for any thread.
  const RetainedMemory& retained() const noexcept { return retained_; }

 private:
  plc::Engine engine_;
  RetainedMemory retained_;
  bool faulted_ = false;
};

}  // namespace servogate::gateway
