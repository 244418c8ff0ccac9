// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/scenario/time_line/operator.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/scenario/plc_variables.hpp"
#include "gateway/control/scenario/scenario_pendants.hpp"
#include "gateway/control/scenario/sentences.hpp"
#include "gateway/control/server/desk/plc/plc_desk.hpp"
#include "gateway/control/server/desk/urgent_desk.hpp"
#include "gateway/control/server/resident/resident.hpp"

namespace servogate::gateway {

/// The operator of a scenario: a client of the desk, on the thread that steps the machine.
class DeskOperator final : public scenario::Operator {
 public:
  explicit DeskOperator(RunningMachine& machine);
  ~DeskOperator() override;

  std::string problem(const scenario::Do& what) override;
  scenario::Said carry_out(const scenario::Do& what, const std::function<bool()>& step) override;
  bool under_way() override;
  std::string failure() override { return failure_; }
  void poll(const std::function<bool()>& step) override;

  PlcVariables& variables() noexcept { return variables_; }
  /// Asks as a client does. `step` as in carry_out().
  Reply ask(const ask::Command& command, text::Language language, const std::function<bool()>& step);
  Resident& resident() noexcept { return resident_; }

 private:
  /// What was begun, and is to end.
  enum class Begun { nothing, power_on, power_off, home, jog, program };
  struct Pressed {
    std::string point;
    image::Nanoseconds until;
  };
  scenario::Said done(const Reply& reply) const;
  Reply carry(Question question, const std::function<bool()>& step);
  Reply ask_for_pendant(const ask::Command& command, const image::Hand& hand,
                        const std::function<bool()>& step);
  scenario::Said carry_out(const Deed& deed);
  scenario::Said ready();
  scenario::Said ask(const ask::Command& command);
  scenario::Said play(const std::string& point, std::optional<double> value);
  bool settled();
  bool all_online() const;
  image::Nanoseconds now() const { return machine_.image().now.t_ns; }
  static Begun begun_by(const ask::Command& command);

  RunningMachine& machine_;
  Resident resident_;
  PlcDesk plc_{resident_};
  UrgentDesk urgent_;
  PlcVariables variables_;
  ScenarioPendants pendants_;
  std::vector<std::pair<Ticket, Reply>> come_;   ///< answers to what is urgent, not taken yet
  const std::function<bool()>* step_ = nullptr;  ///< while something is carried out
  std::vector<JogBegun> jogs_;                   ///< whose button is held
  std::vector<Pressed> pressed_;
  std::map<std::string, double> counts_;  ///< of handwheels, by their points
  image::Nanoseconds kept_alive_ = 0, looked_ = 0, begun_at_ = 0;
  image::Nanoseconds settled_at_ = -1;  ///< since when what was begun looks ended; -1: it does not
  Begun begun_ = Begun::nothing;
  std::vector<int> axes_;  ///< of a jog or of homing
  std::uint32_t run_ = 0;  ///< number of the program's run before
  std::string failure_;
};

}  // namespace servogate::gateway
