// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <type_traits>
#include <utility>
#include <vector>

#include "kernel/program/execution/contour/contour_state.hpp"
#include "kernel/program/execution/flow/flow.hpp"
#include "kernel/program/execution/state/step.hpp"

namespace servogate::program {

/// Commands of the block that is executed, until they are taken.
struct CommandQueue {
  std::vector<Command> commands;
  std::size_t head = 0;

  bool empty() const noexcept { return head == commands.size(); }
  void clear() noexcept {
    commands.clear();
    head = 0;
  }
  Step take() {
    Step step(std::in_place_type<Command>, std::move(commands[head++]));
    if (empty()) clear();
    return step;
  }
};

/// Gives commands with the place they come from, behind a motion that is kept back.
class Output {
 public:
  Output(CommandQueue& queue, const Flow& flow, const Block& block, const int& process, State& state,
         const MachineModel& machine)
      : queue_(queue), flow_(flow), block_(block), process_(process), state_(state), machine_(machine) {}

  /// Throws for what a spindle cannot do as an axis, an axis as a spindle, and a spindle whose angle nobody
  /// measures.
  template <typename What>
  void check(const What& what) const {
    if constexpr (std::is_same_v<What, Thread> || std::is_same_v<What, SpindleMark>) check_angle();
    if (machine_.spindle_axis < 0) return;
    if constexpr (requires { what.to[0]; }) check_place(what.to);
    if constexpr (requires { what.feed.unit; })
      if (what.feed.unit == FeedUnit::mm_per_rev) check_turning();
    if constexpr (std::is_same_v<What, Thread> || std::is_same_v<What, SpindleMark>) check_turning();
    if constexpr (std::is_same_v<What, Spindle>)
      if (what.mode != SpindleMode::stop && what.mode != SpindleMode::keep) check_turning();
    if constexpr (std::is_same_v<What, SpindleCoupling>)
      if (what.on) check_turning();
  }

  /// Throws for a word that turns the spindle while it is an axis.
  void refuse_turning(int column) const;

  template <typename What>
  void emit(What&& what) {
    check(std::as_const(what));
    if constexpr (std::is_same_v<std::decay_t<What>, SpindleCoupling>) state_.motion.coupled = what.on;
    Command command{flow_.line_number(), flow_.file(), process_, block_.number, std::forward<What>(what)};
    if (state_.profile.held)
      state_.profile.behind.emplace_back(std::move(command));
    else if (state_.contour.held)
      state_.contour.behind.emplace_back(std::move(command));
    else
      queue_.commands.push_back(std::move(command));
  }

 private:
  // output.cpp
  void check_place(const Position& to) const;
  void check_turning() const;
  void check_angle() const;

  CommandQueue& queue_;
  const Flow& flow_;
  const Block& block_;
  const int& process_;
  State& state_;
  const MachineModel& machine_;
};

}  // namespace servogate::program
