// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "gateway/control/compose/control.hpp"
#include "gateway/control/history/event_log.hpp"

namespace servogate::gateway::history {

/// Finds out what has happened since it looked last: alarms that came and went, drives that went on and off,
/// references, programs that began, were held, stopped or ended. One thread outside the cycle.
class MachineWatch {
 public:
  /// `typed`: the block that was typed last for a process.
  explicit MachineWatch(Control& control, std::function<std::string(int process)> typed = {})
      : control_(control), typed_(std::move(typed)) {}

  /// Compares with the last look; the first one compares with a machine that is off and without alarms.
  std::vector<Event> look(const image::ProcessImage& image, const cycle::AlarmSnapshot& alarms);

 private:
  struct Alarm {
    std::string id, english, russian;
    int number = 0;
  };
  void look_at_alarms(const cycle::AlarmSnapshot& alarms);
  void look_at_axes(const image::ProcessImage& image);
  void look_at_process(const image::ProcessImage& image, int process);
  void add(std::string kind, const text::Entry& entry, const std::vector<std::string>& arguments);
  std::string letter(int axis) const;

  Control& control_;
  std::function<std::string(int)> typed_;
  std::vector<Event> found_;
  double now_s_ = 0.0;
  std::map<std::uint32_t, Alarm> alarms_;  ///< that stand, by sequence
  std::uint32_t alarms_seen_ = 0;          ///< records made until the last look
  bool powered_ = false;
  std::array<bool, image::kMaxAxes> homed_{};
  std::array<image::ProcessStatus, image::kMaxProcesses> processes_{};
};

}  // namespace servogate::gateway::history
