// SPDX-License-Identifier: Apache-2.0
// The part of DriveLink that goes over SDO: every object the cycle needs and no PDO carries.
#include <iterator>
#include <span>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/master/drive/drive_link.hpp"

namespace servogate::canopen {
namespace {
// A drive may take some time to show a new mode; asking more often would only fill the bus.
constexpr image::Nanoseconds kModePollNs = 10 * image::kMillisecond;
// One turn in so many of a drive that only answers SDO is for what is not of the cycle.
constexpr std::uint8_t kTurns = 6, kTurnOfObjects = 5;
}  // namespace

DriveLink::Access DriveLink::next_access(image::Nanoseconds now) noexcept {
  if (!profile_.sdo_only) return next_object(now);
  // What stops a drive does not wait for its turn.
  if (control_written_ != static_cast<std::uint32_t>(data_.to_send(out_.controlword)))
    return Access::write_control;
  const std::uint8_t turn = turn_;
  turn_ = static_cast<std::uint8_t>((turn_ + 1) % kTurns);
  const Access object = turn == kTurnOfObjects ? next_object(now) : Access::none;
  return object != Access::none ? object : next_in_round();
}

/// Statusword, target where it is another one, actual value, and from the beginning.
DriveLink::Access DriveLink::next_in_round() noexcept {
  constexpr Access kRound[] = {Access::read_status, Access::write_target, Access::read_actual};
  const PdoField target = field_of(Access::write_target);
  Access next = kRound[turn_ % std::size(kRound)];
  if (next == Access::write_target && target_written_ == static_cast<std::uint32_t>(data_.to_send(target)))
    next = Access::read_status;
  return next;
}

DriveLink::Access DriveLink::next_object(image::Nanoseconds now) const noexcept {
  if (profile_.ip_buffer && buffer_open_wanted_ != buffer_open_ && !buffer_refused_)
    return Access::write_buffer;
  if (!out_.mode.mapped() && mode_wanted_ != mode_written_ && !mode_refused_) return Access::write_mode;
  if (error_code_wanted_) return Access::read_error_code;
  // A drive without a touch probe must not be bothered before one is asked for.
  const bool clearing = probe_.wants_status() && !probe_function_known_;
  if (!out_.probe_function.mapped() && !probe_refused_ &&
      (clearing || probe_function_written_ != probe_.function()))
    return Access::write_probe;
  if (probe_.wants_value() && !probe_refused_) return Access::read_probe_value;
  // Before the probe's status: that one is asked for again and again until the mark comes, and a spindle that
  // waits for its mode never turns to it.
  if (!in_.mode.mapped() && !mode_ready() && !mode_refused_ && now >= mode_read_ns_) return Access::read_mode;
  if (probe_.wants_status() && !in_.probe_status.mapped()) return Access::read_probe_status;
  return Access::none;
}

void DriveLink::start_access(image::Nanoseconds now, SdoClient& sdo) noexcept {
  access_ = next_access(now);
  switch (access_) {
    case Access::none:
      break;
    case Access::write_control:
    case Access::write_target:
    case Access::read_status:
    case Access::read_actual:
      start_field(access_, sdo);
      break;
    case Access::write_buffer:
      access_value_ = buffer_open_wanted_ ? 1 : 0;
      sdo.download(object::kInterpolationBuffer, kBufferClear, access_value_, 1);
      break;
    case Access::write_mode:
      access_value_ = static_cast<std::uint8_t>(mode_wanted_);
      sdo.download(object::kModesOfOperation, 0, access_value_, 1);
      break;
    case Access::read_mode:
      mode_read_ns_ = now + kModePollNs;
      sdo.upload(object::kModesOfOperationDisplay, 0);
      break;
    case Access::write_probe:
      access_value_ = probe_.function();
      sdo.download(object::kTouchProbeFunction, 0, access_value_, 2);
      break;
    case Access::read_probe_status:
      sdo.upload(object::kTouchProbeStatus, 0);
      break;
    case Access::read_probe_value:
      sdo.upload(probe_.wants_value(), 0);
      break;
    case Access::read_error_code:
      sdo.upload(object::kErrorCode, 0);
      break;
  }
}

PdoField DriveLink::field_of(Access access) const noexcept {
  const bool axis = target_ == DriveTarget::axis;
  switch (access) {
    case Access::write_control:
      return out_.controlword;
    case Access::write_target:
      return axis                            ? out_.target_position
             : out_.target_velocity.mapped() ? out_.target_velocity
                                             : out_.vl_velocity;
    case Access::read_status:
      return in_.statusword;
    default:
      return axis ? in_.position : in_.velocity;
  }
}

void DriveLink::start_field(Access access, SdoClient& sdo) noexcept {
  const bool write = access == Access::write_control || access == Access::write_target;
  const PdoField field = field_of(access);
  const MappingEntry& object =
      (write ? profile_.rpdo : profile_.tpdo)[static_cast<std::size_t>(field.pdo)].mapping.entries[0];
  access_value_ = static_cast<std::uint32_t>(data_.to_send(field));
  if (write)
    sdo.download(object.index, 0, access_value_, object.bits / 8u);
  else
    sdo.upload(object.index, 0);
}

bool DriveLink::finish_access(const SdoClient& sdo) noexcept {
  const Access access = access_;
  access_ = Access::none;
  if (sdo.result().status != SdoStatus::no_answer) waited_ = 0;
  if (sdo.result().status == SdoStatus::done) return take_result(access, sdo);
  // Not asked again until the wish changes.
  if (access == Access::write_mode || access == Access::read_mode) mode_refused_ = true;
  if (access == Access::write_buffer) buffer_refused_ = true;
  // A drive need not have 603Fh; then its messages and its history say what it is.
  if (access == Access::read_error_code) {
    error_code_wanted_ = false;
    return true;
  }
  // The loss of the node says enough of a request that nobody answers.
  if (profile_.sdo_only && sdo.result().status == SdoStatus::no_answer) return true;
  if (access == Access::write_probe || access == Access::read_probe_status ||
      access == Access::read_probe_value) {
    probe_refused_ = true;
    probe_function_known_ = true;
    probe_.restart();
  }
  return false;
}

/// An answer stands for the process data that the drive does not have.
void DriveLink::take_field(Access access, const SdoClient& sdo) noexcept {
  const int number = field_of(access).pdo + 1;
  image::CanFrame frame;
  frame.length = data_.tpdo_bytes(number);
  store_le(sdo.value(), std::span(frame.data).first(kPdoBytes));
  data_.take(number, frame);
}

bool DriveLink::take_result(Access access, const SdoClient& sdo) noexcept {
  const auto word = static_cast<std::uint16_t>(sdo.value());
  switch (access) {
    case Access::write_control:
      control_written_ = access_value_;
      break;
    case Access::write_target:
      target_written_ = access_value_;
      break;
    case Access::read_status:
    case Access::read_actual:
      take_field(access, sdo);
      break;
    case Access::write_buffer:
      buffer_open_ = access_value_ != 0;
      break;
    case Access::write_mode:
      mode_written_ = static_cast<OperationMode>(static_cast<std::int8_t>(access_value_));
      break;
    case Access::read_mode:
      show_mode(static_cast<std::int8_t>(sdo.value()));
      break;
    case Access::write_probe:
      probe_function_written_ = static_cast<std::uint16_t>(access_value_);
      probe_function_known_ = true;
      break;
    // A status asked for before the function changed says nothing about the new one.
    case Access::read_probe_status:
      if (out_.probe_function.mapped() || probe_function_written_ == probe_.function())
        probe_.on_status(word);
      break;
    case Access::read_probe_value:
      probe_.on_value(static_cast<std::int32_t>(static_cast<std::uint32_t>(sdo.value())), position_counts_);
      break;
    case Access::read_error_code:
      error_code_wanted_ = false;
      if (word != 0) error_code_ = word;
      break;
    case Access::none:
      break;
  }
  return true;
}

}  // namespace servogate::canopen
