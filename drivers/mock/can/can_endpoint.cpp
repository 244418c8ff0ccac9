// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/can/can_endpoint.hpp"

namespace servogate::mock {
namespace {
constexpr std::uint32_t kWarning = 96, kPassive = 128, kBusOff = 256;  // ISO 11898-1, 12.1.4
constexpr std::uint64_t kRecoveryBits = 128 * 11;
constexpr std::uint32_t kSuspendBits = 8;
}  // namespace

bool CanSegment::Endpoint::send(const CanFrame& frame) noexcept {
  const bool down = !connected_ && node_ == nullptr;
  if (frame.fd || frame.error || frame.length > 8 || down || bus_off() ||
      pending_.size() == pending_.capacity()) {
    ++segment_.statistics_.refused;
    return false;
  }
  Nanoseconds from = segment_.now_;
  if (!segment_.faults_.empty())
    if (const fault::Fault* fault = segment_.fault_for(frame, number_, true)) from += fault->delay_ns;
  const Pending p(frame, counted_.bits(frame), from);
  auto place = pending_.begin();
  if (segment_.config_.priority_mailboxes)
    while (place != pending_.end() && place->key > p.key) ++place;
  pending_.insert(place, p);
  segment_.waiting_ |= bit();
  return true;
}

bool CanSegment::Endpoint::receive(CanFrame& frame) noexcept {
  if (count_ == 0) return false;
  frame = received_[head_];
  head_ = head_ + 1 == received_.size() ? 0 : head_ + 1;
  --count_;
  return true;
}

void CanSegment::Endpoint::push(const CanFrame& frame) noexcept {
  if (count_ == received_.size()) {
    ++segment_.statistics_.lost;
    return;
  }
  std::size_t tail = head_ + count_++;
  if (tail >= received_.size()) tail -= received_.size();
  received_[tail] = frame;
}

image::CanState CanSegment::Endpoint::state() const noexcept {
  if (!connected_) return image::CanState::down;
  if (bus_off()) return image::CanState::bus_off;
  const std::uint32_t worst = std::max(transmit_errors_, receive_errors_);
  if (worst >= kPassive) return image::CanState::error_passive;
  return worst >= kWarning ? image::CanState::error_warning : image::CanState::error_active;
}

void CanSegment::Endpoint::sent() noexcept {
  if (transmit_errors_ >= kPassive)
    suspended_until_ = segment_.now_ + segment_.bit_time(image::kIntermissionBits + kSuspendBits);
  if (transmit_errors_ > 0) --transmit_errors_;
}

void CanSegment::Endpoint::transmit_error(bool count) noexcept {
  if (count) transmit_errors_ += 8;
  if (transmit_errors_ >= kBusOff) {
    go_bus_off();
  } else if (transmit_errors_ >= kPassive) {
    suspended_until_ = segment_.now_ + segment_.bit_time(image::kIntermissionBits + kSuspendBits);
  }
}

/// A computer throws away what waits when its interface goes down, so that nothing old moves a drive later.
void CanSegment::Endpoint::set_connected(bool connected) noexcept {
  connected_ = connected;
  if (connected || node_ != nullptr) return;
  pending_.clear();
  segment_.waiting_ &= ~bit();
}

void CanSegment::Endpoint::go_bus_off() noexcept {
  pending_.clear();
  segment_.waiting_ &= ~bit();
  transmit_errors_ = 0;
  receive_errors_ = 0;
  recover_at_ = kNever;
  if (segment_.config_.automatic_restart) recover();
}

void CanSegment::Endpoint::recover() noexcept {
  if (recover_at_ == kNever) recover_at_ = segment_.now_ + segment_.bit_time(kRecoveryBits);
}

}  // namespace servogate::mock
