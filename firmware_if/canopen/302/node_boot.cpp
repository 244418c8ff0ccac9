// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/node_boot.hpp"

namespace servogate::canopen {

void NodeBoot::restart_at(std::size_t action, SdoClient& sdo) noexcept {
  sdo.cancel();
  state_ = State::running;
  action_ = action;
  entered_ = false;
  nmt_state_ = NmtState::boot_up;
  describe_action();
}

void NodeBoot::begin(SdoClient& sdo) noexcept {
  boot_up_seen_ = false;
  restart_at(0, sdo);
}

void NodeBoot::begin_after_boot_up(SdoClient& sdo) noexcept { restart_at(1, sdo); }

void NodeBoot::describe_action() noexcept {
  report_ = {};
  if (action_ >= plan_.size()) {
    report_.step = BootStep::done;
    return;
  }
  const BootAction& action = plan_[action_];
  report_.step = action.step;
  report_.index = action.index;
  report_.subindex = action.subindex;
  report_.writing = action.kind == BootAction::Kind::write;
  report_.expected = action.value;
}

void NodeBoot::next() noexcept {
  ++action_;
  entered_ = false;
  describe_action();
  if (action_ >= plan_.size()) state_ = State::done;
}

void NodeBoot::fail(BootProblem problem) noexcept {
  report_.problem = problem;
  state_ = State::failed;
}

bool NodeBoot::poll(image::Nanoseconds now, SdoClient& sdo, image::CanBus& bus) noexcept {
  if (state_ != State::running) return false;
  switch (plan_[action_].kind) {
    case BootAction::Kind::reset:
      // A message from before the command does not count.
      if (!entered_) boot_up_seen_ = false;
      return command_and_wait(now, bus, NmtCommand::reset_communication, boot_up_seen_);
    case BootAction::Kind::start:
      return command_and_wait(now, bus, NmtCommand::start, nmt_state_ == NmtState::operational);
    default:
      return access(now, sdo, bus);
  }
}

bool NodeBoot::command_and_wait(image::Nanoseconds now, image::CanBus& bus, NmtCommand command,
                                bool arrived) noexcept {
  if (!entered_) {
    nmt_state_ = NmtState::boot_up;
    if (!bus.send(nmt_frame(command, node_))) return false;
    entered_ = true;
    deadline_ns_ = now + timeout_ns_;
    return true;
  }
  if (arrived) {
    next();
  } else if (now >= deadline_ns_) {
    fail(BootProblem::no_answer);
  }
  return false;
}

bool NodeBoot::access(image::Nanoseconds now, SdoClient& sdo, image::CanBus& bus) noexcept {
  if (entered_ && !sdo.busy()) {
    on_result(sdo);
    if (state_ != State::running || plan_[action_].kind == BootAction::Kind::start) return false;
  }
  if (!entered_) {
    const BootAction& action = plan_[action_];
    entered_ = action.kind == BootAction::Kind::write
                   ? sdo.download(action.index, action.subindex, action.value, action.bytes)
                   : sdo.upload(action.index, action.subindex);
  }
  return sdo.poll(now, bus);
}

void NodeBoot::on_result(const SdoClient& sdo) noexcept {
  const BootAction& action = plan_[action_];
  const SdoResult& result = sdo.result();
  report_.abort = result.abort;
  switch (result.status) {
    case SdoStatus::done:
      return action.kind == BootAction::Kind::read ? judge_value(sdo) : next();
    case SdoStatus::aborted: {
      const bool missing = result.abort == AbortCode::object_does_not_exist ||
                           result.abort == AbortCode::subindex_does_not_exist;
      return action.optional && missing ? next() : fail(BootProblem::aborted);
    }
    case SdoStatus::no_answer:
      return fail(BootProblem::no_answer);
    default:
      return fail(BootProblem::bad_protocol);
  }
}

void NodeBoot::judge_value(const SdoClient& sdo) noexcept {
  const BootAction& action = plan_[action_];
  if (sdo.result().size < action.bytes) {
    report_.expected = action.bytes;
    report_.got = sdo.result().size;
    return fail(BootProblem::wrong_length);
  }
  // An expedited answer without a size gives four bytes; those beyond the object mean nothing.
  const auto value = static_cast<std::uint32_t>(load_le(sdo.data().first(action.bytes)));
  keep(value);
  if ((value & action.mask) != (action.value & action.mask)) {
    report_.got = value;
    return fail(BootProblem::wrong_value);
  }
  next();
}

void NodeBoot::keep(std::uint32_t value) noexcept {
  switch (plan_[action_].keep) {
    case BootAction::Keep::device_type:
      identity_.device_type = value;
      break;
    case BootAction::Keep::vendor_id:
      identity_.vendor_id = value;
      break;
    case BootAction::Keep::product_code:
      identity_.product_code = value;
      break;
    case BootAction::Keep::revision:
      identity_.revision = value;
      break;
    case BootAction::Keep::serial:
      identity_.serial = value;
      break;
    case BootAction::Keep::nothing:
      break;
  }
}

}  // namespace servogate::canopen
