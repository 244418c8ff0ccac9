// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/plc/look.hpp"

#include <thread>

namespace servogate::gateway {

bool look(plc::Logic& logic, plc::LogicSample& sample, std::chrono::milliseconds patience) {
  logic.ask(sample);
  const auto end = std::chrono::steady_clock::now() + patience;
  while (!logic.filled(sample)) {
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    if (std::chrono::steady_clock::now() > end && logic.take_back()) return false;
  }
  return true;
}

bool look(plc::Logic& logic, plc::LogicSample& sample, const std::function<bool()>& step) {
  logic.ask(sample);
  while (!logic.filled(sample))
    if (!step() && logic.take_back()) return false;
  return true;
}

}  // namespace servogate::gateway
