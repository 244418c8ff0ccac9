// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/alarms/event_alarms.hpp"

#include <algorithm>
#include <iterator>
#include <span>

#include "firmware_if/canopen/302/boot_detail.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/image/alarm_numbers.hpp"
#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/image/frames/frame_record.hpp"

namespace servogate::canopen {

namespace {

namespace alarm = image::alarm;

struct Row {
  BusEventKind kind;
  image::AlarmNumber number;
};
/// Which event is which alarm. What the axis finds by itself (a refused transition) is not here.
constexpr Row kAlarms[] = {
    {BusEventKind::boot_failed, alarm::kBootFailed},
    {BusEventKind::emcy, alarm::kEmergencyMessage},
    {BusEventKind::error_history, alarm::kErrorHistory},
    {BusEventKind::heartbeat_lost, alarm::kNodeLost},
    {BusEventKind::pdo_missing, alarm::kPdoMissing},
    {BusEventKind::pdo_short, alarm::kPdoShort},
    {BusEventKind::node_restarted, alarm::kNodeRestarted},
    {BusEventKind::node_left, alarm::kNodeLeft},
    {BusEventKind::not_interpolating, alarm::kNotInterpolating},
    {BusEventKind::foreign_frame, alarm::kForeignFrame},
    {BusEventKind::foreign_request, alarm::kForeignRequest},
    {BusEventKind::lead_lost, alarm::kLeadLost},
    {BusEventKind::send_failed, alarm::kBusSendOverflow},
};

/// Those that mean the loss of a node.
constexpr BusEventKind kLosses[] = {BusEventKind::heartbeat_lost, BusEventKind::pdo_missing,
                                    BusEventKind::node_restarted, BusEventKind::node_left};

struct StateRow {
  image::CanState state;
  image::AlarmNumber number;
};
constexpr StateRow kStates[] = {
    {image::CanState::bus_off, alarm::kBusOff},
    {image::CanState::error_passive, alarm::kBusErrorPassive},
    {image::CanState::down, alarm::kBusDown},
};

image::AlarmNumber number_of(const BusEvent& event) noexcept {
  if (event.kind == BusEventKind::emcy && event.emcy.error_code == 0) return 0;  // the error is gone
  for (const Row& row : kAlarms)
    if (row.kind == event.kind) return row.number;
  for (const StateRow& row : kStates)
    if (event.kind == BusEventKind::bus_state && row.state == event.bus_state) return row.number;
  return 0;
}

std::uint64_t object_key(std::uint16_t index, std::uint8_t subindex) noexcept {
  return std::uint64_t{index} << 8 | subindex;
}

/// Whoever sent a frame that was not ours: its identifier tells a SYNC from a controlword.
void add_frame(const BusEvent& event, image::AlarmRecord& r) noexcept {
  const std::size_t length = std::min<std::size_t>(event.frame.length, event.frame.data.size());
  r.key = event.frame.id;
  r.value = 0.0;
  r.limit = event.kind == BusEventKind::lead_lost ? static_cast<double>(event.got) / 1000.0 : 0.0;
  r.detail.put(image::frame_detail(make_frame(event.frame.id, std::span(event.frame.data).first(length))));
}

void add_boot(const BootReport& report, image::AlarmRecord& r) noexcept {
  const bool aborted = report.abort != AbortCode::none;
  r.key = object_key(report.index, report.subindex);
  r.limit = static_cast<double>(report.expected);
  r.value = static_cast<double>(aborted ? static_cast<std::uint32_t>(report.abort) : report.got);
  r.detail.put(boot_detail(report));
}

void add_report(const BusEvent& event, image::AlarmRecord& r) noexcept {
  image::DriveReport report;
  report.statusword = event.statusword;
  report.error_code = event.emcy.error_code;
  r.limit = static_cast<double>(event.expected);
  r.value = static_cast<double>(event.kind == BusEventKind::emcy ? event.emcy.error_register : event.got);
  r.detail1 = event.pdo;
  if (event.kind == BusEventKind::emcy) r.key = event.emcy.error_code;  // one may be the cause of the next
  if (event.kind == BusEventKind::error_history) {
    report.object_index = object::kPredefinedErrorField;
    report.object_subindex = event.pdo;
    r.key = object_key(report.object_index, event.pdo);
    r.detail1 = 0.0;
  }
  r.detail.put(report);
}

bool of_foreign_frame(BusEventKind kind) noexcept {
  return kind == BusEventKind::foreign_frame || kind == BusEventKind::foreign_request ||
         kind == BusEventKind::lead_lost;
}

}  // namespace

std::optional<image::AlarmRecord> alarm_of(const BusEvent& event, const SegmentConfig& config) noexcept {
  image::AlarmRecord r;
  r.number = number_of(event);
  if (r.number == 0) return std::nullopt;
  r.part.device = event.segment;
  if (event.node != 0) r.part.part = event.node;
  if (of_foreign_frame(event.kind))
    add_frame(event, r);
  else if (event.kind == BusEventKind::boot_failed)
    add_boot(event.boot, r);
  else
    add_report(event, r);
  // Without its bus no node is reached: the strongest of what their losses demand.
  const bool whole_bus = r.number == alarm::kBusOff || r.number == alarm::kBusDown;
  const bool lost = std::find(std::begin(kLosses), std::end(kLosses), event.kind) != std::end(kLosses);
  for (const NodeConfig& n : config.nodes) {
    if (whole_bus) r.reaction = std::max(r.reaction, n.loss_reaction);
    if (n.node != event.node) continue;
    if (n.target == DriveTarget::axis) r.axis = static_cast<std::int8_t>(n.target_index);
    if (lost) r.reaction = n.loss_reaction;
  }
  return r;
}

image::AlarmRecord reports_lost(const SegmentConfig& config, std::uint32_t count) noexcept {
  image::AlarmRecord r;
  r.number = alarm::kReportsLost;
  r.part.device = static_cast<std::int16_t>(config.index);
  r.value = count;
  return r;
}

}  // namespace servogate::canopen
