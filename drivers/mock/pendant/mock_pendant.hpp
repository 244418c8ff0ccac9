// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/pendant_port.hpp"
#include "firmware_if/pendant/report.hpp"

namespace servogate::mock {

/// A simulated pendant. Controls by name: `wheel` (all counts so far), `ring`, `axis` (position of the
/// selector from 1, 0: off), `step` (the same), and each button (0 or 1). Not real-time safe; any thread.
class MockPendant final : public drivers::PendantPort {
 public:
  explicit MockPendant(pendant::Layout layout);

  enum class Played : std::uint8_t { done, no_such_control, out_of_range };
  /// Each change is a report; wheel counts that one report cannot hold are several.
  Played play(std::string_view control, double value);
  bool has_button(std::string_view name) const { return layout_.button(name) >= 0; }
  /// Names of all its controls.
  std::vector<std::string> controls() const;
  /// Largest and smallest value of a control.
  std::pair<double, double> range(std::string_view control) const;

  // Faults.
  void plug(bool in);
  /// Its reports are of bytes by chance from now on, of the right length.
  void garble(bool on);
  /// A button stays at this level, whoever presses it.
  void stick(std::string_view button, bool level);
  void release(std::string_view button);

  void show(std::vector<std::vector<std::uint8_t>> reports) override;
  std::vector<std::vector<std::uint8_t>> shown() const;

 private:
  void send();

  mutable std::mutex mutex_;
  pendant::Layout layout_;
  pendant::ReportWriter writer_{layout_};
  pendant::Reading reading_;
  std::int64_t wheel_ = 0;
  std::uint32_t stuck_on_ = 0, stuck_off_ = 0;
  bool plugged_ = true, garbled_ = false;
  std::uint32_t chance_ = 1;
  std::vector<std::vector<std::uint8_t>> shown_;
};

}  // namespace servogate::mock
