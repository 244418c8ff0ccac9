// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/control/run/running_machine.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::machine_run {

/// Judges the set-points of a composed machine in every cycle by finite differences of their positions, while
/// the drives follow and the coordinates stay the same.
class LimitJudge {
 public:
  explicit LimitJudge(const machine::MachineConfig& machine);
  void add(const image::ProcessImage& image);
  /// What has been exceeded by more than 0.1 %, empty: nothing.
  std::string verdict() const;

 private:
  struct Axis {
    double x[4] = {};
    int known = 0;
    bool homed = false;
    double velocity = 0.0, acceleration = 0.0, jerk = 0.0;
  };
  const machine::MachineConfig& machine_;
  std::vector<Axis> axes_;
};

/// The example mill in virtual time in the test's own process, with a person at its panel.
class Mill {
 public:
  /// With `program` as its part program (NC-110). `source`: the inputs come from a record.
  explicit Mill(std::string_view program = {}, cycle::InputSource* source = nullptr);
  /// The same with another machine file. `settings`: its source is `source`.
  Mill(const machine::LoadResult& machine, std::string_view program, cycle::InputSource* source = nullptr,
       gateway::RunSettings settings = {});

  gateway::RunningMachine& machine() { return *machine_; }
  gateway::Control& control() { return *control_; }
  const image::ProcessImage& image() const { return control_->cycle().image(); }
  const image::ProcessStatus& process() const { return image().processes[0]; }
  const image::AxisImage& axis(std::string_view letter) const;
  LimitJudge& judge() { return *judge_; }

  /// Steps `seconds` of machine time.
  void run(double seconds);
  /// Steps until `met`; false: it was not within `patience_s` of machine time.
  bool until(const std::function<bool()>& met, double patience_s = 60.0);
  /// Posts a request and steps until it is answered: the refusal, none: accepted.
  cycle::Refusal ask(image::RequestKind kind, double value = 0.0, int axis = -1);
  /// The whole answer to the last ask().
  const image::Answer& answer() const { return answer_; }
  /// ask() without waiting for the answer.
  void post(image::RequestKind kind, double value = 0.0, int axis = -1);
  /// The same with all that a request can say; its number is given here.
  void post(image::Request request);
  /// Emergency stop chain closed, buses up, drives on, all axes homed, AUTO. False: it did not come to that.
  bool make_ready();
  /// Drives on, but nothing homed.
  bool power_on();
  /// Number of records with this alarm so far.
  int alarms(image::AlarmNumber number) const;
  /// All alarm numbers so far, for messages.
  std::string alarm_list() const;
  bool standing() const;
  double true_position(int axis) { return control_->world().axis_position(axis); }
  /// A fault of the vocabulary on something simulated, at the beginning of the next cycle.
  void inject(std::string_view device, const fault::Fault& fault);
  void inject(std::string_view device, fault::Kind kind) { inject(device, fault::Fault{.kind = kind}); }

  /// Called after every cycle.
  std::function<void()> after_cycle;
  /// Takes the place of Cycle::step() where set.
  std::function<void(cycle::Cycle&)> step_cycle;

 private:
  void step();

  std::string program_;
  program::MachineModel model_;
  std::unique_ptr<gateway::RunningMachine> machine_;
  gateway::Control* control_ = nullptr;  ///< machine_'s
  std::unique_ptr<LimitJudge> judge_;
  std::uint64_t next_id_ = 1;
  image::Answer answer_;
};

/// The example mill's machine file with its text changed.
machine::LoadResult changed_mill(const std::function<void(std::string& text)>& change);
/// For such a change: the first `from` in the text becomes `to`; a failure when it has none.
void replace(std::string& text, const std::string& from, const std::string& to);

/// A bit of the image by the name of its symbol, e.g. "coolant", "NC.m_strobe".
image::Place place_of(const gateway::Control& control, std::string_view symbol);

}  // namespace servogate::machine_run
