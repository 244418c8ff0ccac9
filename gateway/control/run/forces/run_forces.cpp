// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/forces/run_forces.hpp"

#include "plc/logic/force_plan.hpp"

namespace servogate::gateway {

namespace {
const text::Entry kNoVariable{"run.force-name", "there is no variable or place '{0}'",
                              "переменной или места «{0}» нет"};
const text::Entry kNoValue{"run.force-value", "'{1}' is no value for '{0}'",
                           "«{1}» не является значением для «{0}»"};
}  // namespace

std::vector<text::Finding> RunForces::plan(const std::vector<report::ForceEntry>& wanted) {
  std::vector<text::Finding> findings;
  const plc::Engine* program = control_.logic() == nullptr ? nullptr : &control_.logic()->engine();
  for (const report::ForceEntry& w : wanted) {
    plc::ForcePlan plan = plc::plan_force(control_.symbols(), program, w.name, w.value);
    if (plan.kind == plc::ForcePlan::Kind::unknown || plan.kind == plc::ForcePlan::Kind::no_value) {
      text::Finding f;
      f.file = "--force";
      f.entry = plan.kind == plc::ForcePlan::Kind::unknown ? &kNoVariable : &kNoValue;
      f.arguments = {w.name, w.value};
      findings.push_back(std::move(f));
      continue;
    }
    const int entry = static_cast<int>(wanted_.size());
    if (plan.kind == plc::ForcePlan::Kind::variable) plan.requests.emplace_back();
    for (const image::Request& r : plan.requests)
      steps_.push_back({r, entry, plan.kind == plc::ForcePlan::Kind::variable, false});
    steps_.back().last = true;
    wanted_.push_back(w);
  }
  return findings;
}

void RunForces::poll() {
  if (waits_ || refused_ || next_ == steps_.size()) return;
  const Step& step = steps_[next_];
  image::Request request = step.request;
  if (step.variable) {
    const report::ForceEntry& entry = wanted_[static_cast<std::size_t>(step.entry)];
    plc::LogicChange change;
    change.kind = plc::LogicChange::Kind::force;
    change.name = entry.name;
    change.value = entry.value;
    change.number = control_.next_logic_change();
    control_.prepare(change);
    request.kind = image::RequestKind::logic;
    request.index = change.number;
    request.value = 1.0;
  }
  request.id = kFirstId + next_;
  request.asker = image::Asker::command_line;
  waits_ = control_.cycle().post(request);
}

bool RunForces::take(const image::Answer& answer) {
  if (!waits_ || answer.id != kFirstId + next_) return false;
  waits_ = false;
  if (steps_[next_].variable) control_.logic()->settle();
  refused_ = answer.refusal != 0;
  if (refused_) return false;
  const Step& step = steps_[next_++];
  if (step.last) active_.push_back(wanted_[static_cast<std::size_t>(step.entry)]);
  return true;
}

}  // namespace servogate::gateway
