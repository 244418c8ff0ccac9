// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/node_boot.hpp"

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {
// The flash is asked for its status so often.
constexpr image::Nanoseconds kFlashPollNs = 20 * image::kMillisecond;
constexpr std::uint32_t kFlashBusy = 1;
// A device that stores all its parameters answers behind that (CiA 301, 7.5.2.13).
constexpr image::Nanoseconds kStoreNs = 10 * image::kSecond;

constexpr bool accesses(BootAction::Kind kind) noexcept {
  return kind != BootAction::Kind::start && kind != BootAction::Kind::await_boot_up &&
         kind != BootAction::Kind::await_sync;
}
}  // namespace

void NodeBoot::restart_at(std::size_t action, SdoClient& sdo) noexcept {
  sdo.cancel();
  state_ = State::running;
  action_ = action;
  entered_ = false;
  list_size_ = list_entry_ = 0;
  error_code_ = 0;
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
  flash_deadline_ns_ = poll_again_ns_ = 0;
  list_size_ = list_entry_ = 0;
  describe_action();
  if (action_ >= plan_.size()) state_ = State::done;
}

void NodeBoot::fail(BootProblem problem) noexcept {
  report_.problem = problem;
  state_ = State::failed;
}

bool NodeBoot::poll(image::Nanoseconds now, SdoClient& sdo, image::CanBus& bus, bool sync_runs) noexcept {
  if (state_ != State::running) return false;
  now_ = now;
  switch (plan_[action_].kind) {
    case BootAction::Kind::reset:
      // A message from before the command does not count.
      if (!entered_) boot_up_seen_ = false;
      return command_and_wait(now, bus, NmtCommand::reset_communication, boot_up_seen_);
    case BootAction::Kind::start:
      return command_and_wait(now, bus, NmtCommand::start, nmt_state_ == NmtState::operational);
    case BootAction::Kind::await_boot_up:
      return await_boot_up(now);
    case BootAction::Kind::await_sync:
      if (sync_runs) next();
      return false;
    default:
      return access(now, sdo, bus);
  }
}

// The message may have come while the start was being confirmed.
bool NodeBoot::await_boot_up(image::Nanoseconds now) noexcept {
  if (!entered_) deadline_ns_ = now + timeout_ns_;
  entered_ = true;
  if (boot_up_seen_)
    next();
  else if (now >= deadline_ns_)
    fail(BootProblem::no_answer);
  return false;
}

bool NodeBoot::start_transfer(SdoClient& sdo) noexcept {
  const BootAction& action = plan_[action_];
  if (action.kind == BootAction::Kind::find_in_list) return sdo.upload(action.index, list_entry_);
  if (action.kind != BootAction::Kind::write) return sdo.upload(action.index, action.subindex);
  // A boot-up from before the program control does not count.
  boot_up_seen_ = false;
  const bool started = action.data.empty()
                           ? sdo.download(action.index, action.subindex, action.value, action.bytes)
                           : sdo.download_from(action.index, action.subindex, action.data);
  if (started) sdo.wait_for(writing_time(action.index));
  return started;
}

/// How long a device that writes into its flash may keep silent.
image::Nanoseconds NodeBoot::writing_time(std::uint16_t index) const noexcept {
  switch (index) {
    case object::kProgramData:
    case object::kProgramControl:
      return flash_timeout_ns_;
    case object::kStoreParameters:
      return kStoreNs;
    default:
      return 0;
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
    if (state_ != State::running || !accesses(plan_[action_].kind)) return false;
  }
  if (!entered_ && now >= poll_again_ns_) entered_ = start_transfer(sdo);
  return sdo.poll(now, bus);
}

void NodeBoot::on_result(const SdoClient& sdo) noexcept {
  const BootAction& action = plan_[action_];
  const SdoResult& result = sdo.result();
  report_.abort = result.abort;
  switch (result.status) {
    case SdoStatus::done:
      return action.kind == BootAction::Kind::write ? next() : judge_value(sdo);
    case SdoStatus::aborted: {
      if (action.kind == BootAction::Kind::jump_if_equal ||
          action.kind == BootAction::Kind::jump_unless_equal)
        return jump(false);
      const bool missing = result.abort == AbortCode::object_does_not_exist ||
                           result.abort == AbortCode::subindex_does_not_exist;
      // What is only noted is no reason to refuse a device.
      const bool noted = action.keep == BootAction::Keep::error_code;
      return (action.optional && missing) || noted ? next() : fail(BootProblem::aborted);
    }
    case SdoStatus::no_answer:
      return fail(BootProblem::no_answer);
    default:
      return fail(BootProblem::bad_protocol);
  }
}

void NodeBoot::judge_value(const SdoClient& sdo) noexcept {
  const BootAction& action = plan_[action_];
  if (action.kind == BootAction::Kind::read_text) return judge_text(sdo);
  if (sdo.result().size < action.bytes) {
    report_.expected = action.bytes;
    report_.got = sdo.result().size;
    return fail(BootProblem::wrong_length);
  }
  // An expedited answer without a size gives four bytes; those beyond the object mean nothing.
  const auto value = static_cast<std::uint32_t>(load_le(sdo.data().first(action.bytes)));
  keep(value);
  if (action.kind == BootAction::Kind::await_flash) return judge_flash(sdo);
  if (action.kind == BootAction::Kind::find_in_list) return judge_list(value);
  if (action.kind != BootAction::Kind::read) return jump(value == action.value);
  if ((value & action.mask) != (action.value & action.mask)) {
    report_.got = value;
    return fail(BootProblem::wrong_value);
  }
  next();
}

void NodeBoot::judge_text(const SdoClient& sdo) noexcept {
  const auto text = [](std::span<const std::uint8_t> bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  std::string_view got = text(sdo.data());
  // Many devices end their strings with zeros.
  got = got.substr(0, got.find('\0'));
  const std::string_view expected = text(plan_[action_].data);
  if (got == expected) return next();
  report_.expected_text = BootText(expected);
  report_.got_text = BootText(got);
  fail(BootProblem::wrong_text);
}

void NodeBoot::judge_flash(const SdoClient& sdo) noexcept {
  const auto status = static_cast<std::uint32_t>(sdo.value());
  report_.got = status;
  if (!(status & kFlashBusy)) return status >> 1 & 0x7F ? fail(BootProblem::flash_error) : next();
  if (flash_deadline_ns_ == 0) flash_deadline_ns_ = now_ + flash_timeout_ns_;
  if (now_ >= flash_deadline_ns_) return fail(BootProblem::flash_timeout);
  entered_ = false;
  poll_again_ns_ = now_ + kFlashPollNs;
}

// The entries are 16 bits wide in CiA 402-2 and 8 in some drives; the number is in the lowest.
void NodeBoot::judge_list(std::uint32_t value) noexcept {
  const BootAction& action = plan_[action_];
  if (list_entry_ == 0)
    list_size_ = static_cast<std::uint8_t>(value);
  else if (value == action.value)
    return next();
  report_.got = list_size_;
  if (list_entry_ >= list_size_) return fail(BootProblem::not_in_list);
  ++list_entry_;
  entered_ = false;
}

void NodeBoot::jump(bool equal) noexcept {
  const BootAction& action = plan_[action_];
  const bool wanted = action.kind == BootAction::Kind::jump_if_equal;
  if (equal == wanted) action_ += action.jump;
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
    case BootAction::Keep::error_code:
      error_code_ = static_cast<std::uint16_t>(value);
      break;
    case BootAction::Keep::nothing:
      break;
  }
}

}  // namespace servogate::canopen
