// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/can_supplier.hpp"

#include "firmware_if/canopen/master/alarms/event_alarms.hpp"

namespace servogate::gateway {

void CanSupplier::listened(image::Nanoseconds now) noexcept {
  alive_ns_ = now;
  segment_.listened();
}

/// Whoever was stopped (a signal, a debugger, the system) for so long may have been replaced: another control
/// listens longer than this before it begins.
void CanSupplier::look_at_clock() noexcept {
  constexpr image::Nanoseconds kReplaced = image::kSecond;
  if (clock_ == nullptr) return;
  const image::Nanoseconds now = clock_->now_ns();
  if (alive_ns_ != 0 && now - alive_ns_ >= kReplaced) segment_.came_back(now - alive_ns_);
  alive_ns_ = now;
}

void CanSupplier::open_cycle(image::ProcessImage& image) noexcept {
  look_at_clock();
  if (clock_ != nullptr) sync_ns_ = alive_ns_;
  segment_.open_cycle(image);
}

void CanSupplier::receive(image::ProcessImage& image, image::Notices& notices) noexcept {
  segment_.receive(image);
  for (DrivePoints& drive : drives_) drive.receive(image);
  // What finds no place in this cycle waits in the ring for the next one; a few are left to others.
  constexpr int kOfOthers = 4;
  canopen::BusEvent event;
  while (notices.room() > kOfOthers && segment_.events().pop(event))
    if (const auto alarm = canopen::alarm_of(event, segment_.config())) notices.add(*alarm);
  report_lost(notices);
}

void CanSupplier::send(image::ProcessImage& image) noexcept {
  for (DrivePoints& drive : drives_) drive.send(image);
  look_at_clock();  // set-points of a cycle in which it was stopped are of yesterday
  segment_.send(image);
}

/// What the full ring swallowed.
void CanSupplier::report_lost(image::Notices& notices) noexcept {
  const std::uint32_t lost = segment_.events().lost();
  if (lost == lost_said_ || notices.room() == 0) return;
  notices.add(canopen::reports_lost(segment_.config(), lost - lost_said_));
  lost_said_ = lost;
}

}  // namespace servogate::gateway
