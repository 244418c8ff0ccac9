// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "bench/scenario/signals/signals.hpp"

namespace servogate::scenario {

/// The last 50 ms of some signals, for the picture of a failure.
class Recent {
 public:
  explicit Recent(std::vector<Signal> signals);
  void add(const View& view);
  /// A timing diagram as text: switches as levels, numbers as bars from their smallest to their largest
  /// value. `began`: machine time that its times count from.
  std::string diagram(image::Nanoseconds began) const;

 private:
  static constexpr std::size_t kColumns = 50;
  std::vector<Signal> signals_;
  std::vector<std::vector<double>> rows_;  ///< ring of cycles, by signal
  std::vector<image::Nanoseconds> times_;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace servogate::scenario
