// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/can_supplier.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "firmware_if/canopen/302/boot_detail.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/image/frames/frame_record.hpp"
#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::gateway {

namespace {

using canopen::BusEventKind;

struct Row {
  BusEventKind kind;
  image::AlarmNumber number;
};
/// Which event is which alarm. What the axis finds by itself (a refused transition) is not here.
constexpr Row kAlarms[] = {
    {BusEventKind::boot_failed, cycle::alarm::kBootFailed},
    {BusEventKind::emcy, cycle::alarm::kEmergencyMessage},
    {BusEventKind::error_history, cycle::alarm::kErrorHistory},
    {BusEventKind::heartbeat_lost, cycle::alarm::kNodeLost},
    {BusEventKind::pdo_missing, axis::alarm::kPdoMissing},
    {BusEventKind::pdo_short, cycle::alarm::kPdoShort},
    {BusEventKind::node_restarted, cycle::alarm::kNodeRestarted},
    {BusEventKind::node_left, cycle::alarm::kNodeLeft},
    {BusEventKind::not_interpolating, cycle::alarm::kNotInterpolating},
    {BusEventKind::foreign_frame, cycle::alarm::kForeignFrame},
    {BusEventKind::foreign_request, cycle::alarm::kForeignRequest},
    {BusEventKind::lead_lost, cycle::alarm::kLeadLost},
    {BusEventKind::send_failed, cycle::alarm::kBusSendOverflow},
};

/// Those that mean the loss of a node.
constexpr BusEventKind kLosses[] = {BusEventKind::heartbeat_lost, BusEventKind::pdo_missing,
                                    BusEventKind::node_restarted, BusEventKind::node_left};

struct StateRow {
  image::CanState state;
  image::AlarmNumber number;
};
constexpr StateRow kStates[] = {
    {image::CanState::bus_off, cycle::alarm::kBusOff},
    {image::CanState::error_passive, cycle::alarm::kBusErrorPassive},
    {image::CanState::down, cycle::alarm::kBusDown},
};

void describe_boot(const canopen::BootReport& report, image::AlarmRecord& record) noexcept {
  const bool aborted = report.abort != canopen::AbortCode::none;
  record.object_index = report.index;
  record.object_subindex = report.subindex;
  record.limit = static_cast<double>(report.expected);
  record.value = static_cast<double>(aborted ? static_cast<std::uint32_t>(report.abort) : report.got);
  record.detail.put(canopen::boot_detail(report));
}

}  // namespace

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
  while (notices.room() > kOfOthers && segment_.events().pop(event)) report(event, notices);
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
  image::AlarmRecord r;
  r.number = cycle::alarm::kReportsLost;
  r.segment = static_cast<std::int16_t>(segment_.config().index);
  r.value = lost - lost_said_;
  notices.add(r);
  lost_said_ = lost;
}

void CanSupplier::report(const canopen::BusEvent& event, image::Notices& notices) const noexcept {
  image::AlarmRecord r;
  for (const Row& row : kAlarms)
    if (row.kind == event.kind) r.number = row.number;
  if (event.kind == BusEventKind::emcy && event.emcy.error_code == 0) return;
  if (event.kind == BusEventKind::bus_state)
    for (const StateRow& row : kStates)
      if (row.state == event.bus_state) r.number = row.number;
  if (r.number == 0) return;
  r.segment = event.segment;
  if (event.node != 0) r.node = event.node;
  r.error_code = event.emcy.error_code;
  r.statusword = event.statusword;
  r.limit = static_cast<double>(event.expected);
  r.value = static_cast<double>(event.kind == BusEventKind::emcy ? event.emcy.error_register : event.got);
  r.detail1 = event.pdo;
  if (event.kind == BusEventKind::error_history) {
    r.object_index = canopen::object::kPredefinedErrorField;
    r.object_subindex = event.pdo;
    r.detail1 = 0.0;
  }
  if (event.kind == BusEventKind::foreign_frame || event.kind == BusEventKind::foreign_request ||
      event.kind == BusEventKind::lead_lost) {
    const std::size_t length = std::min<std::size_t>(event.frame.length, event.frame.data.size());
    r.value = event.frame.id;
    r.limit = event.kind == BusEventKind::lead_lost ? static_cast<double>(event.got) / 1000.0 : 0.0;
    r.detail.put(
        image::frame_detail(canopen::make_frame(event.frame.id, std::span(event.frame.data).first(length))));
  }
  if (event.kind == BusEventKind::boot_failed) describe_boot(event.boot, r);
  // Without its bus no node is reached: the strongest of what their losses demand.
  if (r.number == cycle::alarm::kBusOff || r.number == cycle::alarm::kBusDown)
    for (const canopen::NodeConfig& n : segment_.config().nodes)
      r.reaction = std::max(r.reaction, n.loss_reaction);
  const bool lost = std::find(std::begin(kLosses), std::end(kLosses), event.kind) != std::end(kLosses);
  for (const canopen::NodeConfig& n : segment_.config().nodes) {
    if (n.node != event.node) continue;
    if (n.target == canopen::DriveTarget::axis) r.axis = static_cast<std::int8_t>(n.target_index);
    if (lost) r.reaction = n.loss_reaction;
  }
  notices.add(r);
}

}  // namespace servogate::gateway
