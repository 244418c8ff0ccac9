// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/sdo/error_history.hpp"

#include <algorithm>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {

bool ErrorHistory::start(image::Nanoseconds now, SdoClient& sdo) noexcept {
  if (missing_ || running_) return false;
  if (left_ == 0) {
    if (known_ && (!wanted_ || now < due_ns_)) return false;
    if (known_) wanted_ = false;  // what happens from here on is read once more
    next_ = 0;
  }
  running_ = sdo.upload(object::kPredefinedErrorField, next_);
  return running_;
}

std::optional<ErrorHistory::Entry> ErrorHistory::finish(const SdoClient& sdo) noexcept {
  running_ = false;
  if (sdo.result().status != SdoStatus::done) {
    missing_ = sdo.result().status == SdoStatus::aborted;
    left_ = 0;
    if (!known_) known_ = std::uint8_t{0};
    return std::nullopt;
  }
  if (next_ == 0) {
    const auto count = static_cast<std::uint8_t>(sdo.value());
    // A full list has as many as before, and another one at its head; a shorter one was cleared in between.
    if (known_ && count > 0)
      left_ = std::min<std::uint8_t>(kMost, count > *known_   ? static_cast<std::uint8_t>(count - *known_)
                                            : count < *known_ ? count
                                                              : std::uint8_t{1});
    known_ = count;
    next_ = 1;
    return std::nullopt;
  }
  const Entry entry{next_, static_cast<std::uint16_t>(sdo.value())};
  ++next_;
  --left_;
  return entry;
}

}  // namespace servogate::canopen
