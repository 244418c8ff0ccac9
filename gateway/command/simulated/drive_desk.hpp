// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gateway/cli/bus_options.hpp"
#include "gateway/command/simulated/fault_line.hpp"
#include "gateway/command/simulated/input_lines.hpp"

namespace servogate::gateway::command {

/// Reads `--fault` and `--script` of a command. What happens at the start has to be for one of `nodes`; later
/// a drive may have got another node-ID. nullopt: wrong, which has been said (exit code kWrongUse).
std::optional<std::vector<DriveDeed>> read_deeds(const FaultOptions& options, std::span<const int> nodes);

/// Lets deeds happen to simulated drives: those of a script at their times, those of standard input as they
/// come.
class DriveDesk {
 public:
  /// `listening`: reads standard input, too, until its end. `json`: what is done is said on standard output,
  /// too, an object a line.
  DriveDesk(std::vector<DriveDeed> script, bool listening, bool json);
  /// Does what is due `since_start`. `other`: takes lines of standard input that are its own; false: not its.
  void advance(image::Nanoseconds since_start, std::span<mock::SimulatedDrive* const> drives,
               const std::function<bool(const std::string& line)>& other = {});
  /// Who puts faults on devices by their names in a machine file; false: `why`, in both languages.
  using OnDevice = std::function<bool(const DriveDeed& deed, std::string& why)>;
  void set_devices(OnDevice on_device) { on_device_ = std::move(on_device); }
  /// For poll(2): -1 when standard input is not listened to just now.
  int descriptor() const { return input_.descriptor(); }

 private:
  void take(const std::string& line, image::Nanoseconds since_start,
            const std::function<bool(const std::string& line)>& other);
  void perform(const DriveDeed& deed, image::Nanoseconds since_start,
               std::span<mock::SimulatedDrive* const> drives);
  void perform_on_device(const DriveDeed& deed, image::Nanoseconds since_start);

  std::vector<DriveDeed> waiting_;  ///< by time
  InputLines input_;
  bool json_;
  OnDevice on_device_;
};

}  // namespace servogate::gateway::command
