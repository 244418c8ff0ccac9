// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/cycle/participants.hpp"
#include "plc/engine.hpp"

namespace servogate::gateway {

/// The PLC's engine as the cycle's logic; its faults become alarms.
class PlcLogic final : public cycle::Logic {
 public:
  explicit PlcLogic(std::shared_ptr<const plc::Image> image) : engine_(std::move(image)) {}
  /// real-time safe.
  void scan(image::ProcessImage& image, cycle::Notices& notices) noexcept override;
  plc::Engine& engine() noexcept { return engine_; }

 private:
  plc::Engine engine_;
  bool faulted_ = false;
};

}  // namespace servogate::gateway
