// SPDX-License-Identifier: Apache-2.0
#pragma once
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
  Output(CommandQueue& queue, const Flow& flow, const Block& block, const int& process, State& state)
      : queue_(queue), flow_(flow), block_(block), process_(process), state_(state) {}

  template <typename What>
  void emit(What&& what) {
    Command command{flow_.line_number(), flow_.file(), process_, block_.number, std::forward<What>(what)};
    if (state_.profile.held)
      state_.profile.behind.emplace_back(std::move(command));
    else if (state_.contour.held)
      state_.contour.behind.emplace_back(std::move(command));
    else
      queue_.commands.push_back(std::move(command));
  }

 private:
  CommandQueue& queue_;
  const Flow& flow_;
  const Block& block_;
  const int& process_;
  State& state_;
};

}  // namespace servogate::program
