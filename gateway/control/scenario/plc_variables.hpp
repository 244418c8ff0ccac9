// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "bench/scenario/signals/signals.hpp"
#include "gateway/control/compose/control.hpp"

namespace servogate::gateway {

/// Variables of the PLC behind each scan. For the thread that steps the machine.
class PlcVariables final : public scenario::Variables {
 public:
  explicit PlcVariables(Control& control) : control_(control) {}
  ~PlcVariables() override;
  PlcVariables(const PlcVariables&) = delete;
  std::optional<int> watch(std::string_view name) override;
  double value(int variable) const override { return values_[static_cast<std::size_t>(variable)]; }
  /// Behind a cycle: takes what its scan has filled, and asks for the next one.
  void poll();

 private:
  void ask();
  Control& control_;
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::unique_ptr<plc::LogicSample> sample_;
  std::vector<std::optional<plc::Handle>> handles_;  ///< in the program that the sample belongs to
  bool asked_ = false;
  int waited_ = 0;  ///< polls since then
};

}  // namespace servogate::gateway
