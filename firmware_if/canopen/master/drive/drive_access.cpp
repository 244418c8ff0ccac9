// SPDX-License-Identifier: Apache-2.0
// The part of DriveLink that goes over SDO: every object the cycle needs and no PDO carries.
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/master/drive/drive_link.hpp"

namespace servogate::canopen {
namespace {
// A drive may take some time to show a new mode; asking more often would only fill the bus.
constexpr image::Nanoseconds kModePollNs = 10 * image::kMillisecond;
}  // namespace

DriveLink::Access DriveLink::next_access(image::Nanoseconds now) const noexcept {
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

bool DriveLink::finish_access(const SdoClient& sdo) noexcept {
  const Access access = access_;
  access_ = Access::none;
  if (sdo.result().status == SdoStatus::done) return take_result(access, sdo);
  // Not asked again until the wish changes.
  if (access == Access::write_mode || access == Access::read_mode) mode_refused_ = true;
  if (access == Access::read_error_code) error_code_wanted_ = false;
  if (access == Access::write_probe || access == Access::read_probe_status ||
      access == Access::read_probe_value) {
    probe_refused_ = true;
    probe_function_known_ = true;
    probe_.restart();
  }
  return false;
}

bool DriveLink::take_result(Access access, const SdoClient& sdo) noexcept {
  const auto word = static_cast<std::uint16_t>(sdo.value());
  switch (access) {
    case Access::write_mode:
      mode_written_ = static_cast<OperationMode>(static_cast<std::int8_t>(access_value_));
      break;
    case Access::read_mode:
      show_mode(static_cast<std::int8_t>(sdo.value()));
      break;
    case Access::write_probe:
      probe_function_written_ = access_value_;
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
