// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/can_supplier.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/image/frame_record.hpp"
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
    {BusEventKind::send_failed, cycle::alarm::kBusSendOverflow},
};

/// Those that mean the loss of a node.
constexpr BusEventKind kLosses[] = {BusEventKind::heartbeat_lost, BusEventKind::pdo_missing,
                                    BusEventKind::node_restarted, BusEventKind::node_left};

/// A boot report in AlarmRecord::detail2: its problem, and these.
constexpr unsigned kWriting = 16, kAborted = 32;

struct StateRow {
  image::CanState state;
  image::AlarmNumber number;
};
constexpr StateRow kStates[] = {
    {image::CanState::bus_off, cycle::alarm::kBusOff},
    {image::CanState::error_passive, cycle::alarm::kBusErrorPassive},
    {image::CanState::down, cycle::alarm::kBusDown},
};

}  // namespace

void CanSupplier::open_cycle(image::ProcessImage& image) noexcept {
  if (clock_ != nullptr) sync_ns_ = clock_->now_ns();
  segment_.open_cycle(image);
}

void CanSupplier::receive(image::ProcessImage& image) noexcept {
  segment_.receive(image);
  canopen::BusEvent event;
  while (room() && segment_.events().pop(event)) report(event);
  report_lost();
}

/// What finds no place in this cycle waits in the ring for the next one; a few are left to others.
bool CanSupplier::room() const noexcept {
  constexpr int kOfOthers = 4;
  return notices_ == nullptr || notices_->room() > kOfOthers;
}

/// What the full ring swallowed.
void CanSupplier::report_lost() noexcept {
  const std::uint32_t lost = segment_.events().lost();
  if (notices_ == nullptr || lost == lost_said_ || notices_->room() == 0) return;
  image::AlarmRecord r;
  r.number = cycle::alarm::kReportsLost;
  r.segment = static_cast<std::int16_t>(segment_.config().index);
  r.value = lost - lost_said_;
  notices_->add(r);
  lost_said_ = lost;
}

void CanSupplier::report(const canopen::BusEvent& event) noexcept {
  image::AlarmRecord r;
  for (const Row& row : kAlarms)
    if (row.kind == event.kind) r.number = row.number;
  if (event.kind == BusEventKind::emcy && event.emcy.error_code == 0) return;
  if (event.kind == BusEventKind::bus_state)
    for (const StateRow& row : kStates)
      if (row.state == event.bus_state) r.number = row.number;
  if (r.number == 0 || notices_ == nullptr) return;
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
  if (event.kind == BusEventKind::foreign_frame) {
    const std::size_t length = std::min<std::size_t>(event.frame.length, event.frame.data.size());
    image::pack_frame(canopen::make_frame(event.frame.id, std::span(event.frame.data).first(length)), r);
  }
  if (event.kind == BusEventKind::boot_failed) pack(event.boot, r);
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
  notices_->add(r);
}

void pack(const canopen::BootReport& report, image::AlarmRecord& record) noexcept {
  const bool aborted = report.abort != canopen::AbortCode::none;
  record.object_index = report.index;
  record.object_subindex = report.subindex;
  record.limit = static_cast<double>(report.expected);
  record.value = static_cast<double>(aborted ? static_cast<std::uint32_t>(report.abort) : report.got);
  record.text = report.got_text.bytes;
  record.detail1 = static_cast<double>(report.step);
  record.detail2 =
      static_cast<double>(report.problem) + (report.writing ? kWriting : 0.0) + (aborted ? kAborted : 0.0);
}

canopen::BootReport unpack(const image::AlarmRecord& record) noexcept {
  canopen::BootReport report;
  const auto flags = static_cast<unsigned>(record.detail2);
  report.step = static_cast<canopen::BootStep>(record.detail1);
  report.problem = static_cast<canopen::BootProblem>(flags % kWriting);
  report.writing = (flags & kWriting) != 0;
  report.index = record.object_index;
  report.subindex = record.object_subindex;
  report.expected = static_cast<std::uint32_t>(record.limit);
  const auto value = static_cast<std::uint32_t>(record.value);
  if ((flags & kAborted) != 0)
    report.abort = static_cast<canopen::AbortCode>(value);
  else
    report.got = value;
  report.got_text.bytes = record.text;
  return report;
}

}  // namespace servogate::gateway
