// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/codes/operands.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"

namespace servogate::program::nc110::code {
namespace {

constexpr int kMostProcesses = 5;

/// A number from 1 that is not this process'.
int process_of(const Execution& run, const Operands& operands, const Value& value) {
  const int number = run.numbers().whole(value, operands.rule->name);
  if (number < 1 || number > kMostProcesses)
    fail(Wrong::process_number, value.column,
         {std::string(operands.rule->name), std::to_string(kMostProcesses)});
  if (number == run.process() + 1)
    fail(Wrong::process_own, value.column, {std::string(operands.rule->name), std::to_string(number)});
  return number;
}

void give(Execution& run, ProcessOrder order) {
  run.motion().end_profile();
  run.depends_on_machine();
  run.emit(std::move(order));
}

}  // namespace

void exe(Execution& run, const Operands& operands) {
  ProcessOrder order;
  order.action = ProcessOrder::Action::start;
  order.process = process_of(run, operands, operands.items[0].value);
  order.program = std::string(program_name(operands, operands.items[1]));
  order.after_motion = run.block().sync == Sync::request;
  give(run, std::move(order));
}

/// Nothing behind it runs.
void rel(Execution& run, const Operands&) {
  ProcessOrder order;
  order.action = ProcessOrder::Action::release;
  order.after_motion = true;
  give(run, std::move(order));
  run.finish(false);
}

void snd(Execution& run, const Operands& operands) {
  ProcessOrder order;
  order.action = ProcessOrder::Action::restart;
  order.process = process_of(run, operands, operands.items[0].value);
  order.after_motion = run.block().sync == Sync::request;
  give(run, std::move(order));
}

void wait_for_process(Execution& run, const Operands& operands, const Value& value) {
  ProcessOrder order;
  order.action = ProcessOrder::Action::wait;
  order.process = process_of(run, operands, value);
  order.after_motion = true;
  run.state().flow.barrier = true;
  give(run, std::move(order));
}

}  // namespace servogate::program::nc110::code
