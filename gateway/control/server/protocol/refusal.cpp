// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/protocol/refusal.hpp"

#include <string>
#include <vector>

#include "kernel/cycle/gate/gate.hpp"

namespace servogate::gateway {

namespace {

/// The cycle knows radii only; of a diameter axis people see the diameter, and are told so. Gives the units
/// of the axes.
std::vector<std::string> as_people_write(image::Answer& answer, const machine::MachineConfig& machine) {
  std::vector<std::string> units = machine.unit_words();
  const auto refusal = static_cast<cycle::Refusal>(answer.refusal);
  const bool of_radius = refusal == cycle::Refusal::jog_range || refusal == cycle::Refusal::at_soft_limit;
  const bool of_place = of_radius || refusal == cycle::Refusal::zero_range;
  const auto axis = static_cast<std::size_t>(answer.axis);
  if (!of_place || answer.axis < 0 || !machine.axes[axis].diameter) return units;
  units[axis] += text::both(" in diameter", " по диаметру");
  if (of_radius) answer.value *= 2.0, answer.limit *= 2.0;
  return units;
}

}  // namespace

Reply refused_by_gate(image::Answer answer, const machine::MachineConfig& machine, text::Language language) {
  const std::vector<std::string> units = as_people_write(answer, machine);
  Reply reply;
  reply.ok = false;
  reply.exit = kAlarm;
  reply.code = cycle::refusal_texts()[answer.refusal].id;
  reply.text = cycle::render(answer, machine.letters(), language, units);
  return reply;
}

}  // namespace servogate::gateway
