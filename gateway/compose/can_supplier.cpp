// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/can_supplier.hpp"

#include "kernel/cycle/alarm/alarm_table.hpp"

namespace servogate::gateway {

namespace {

using canopen::BusEventKind;

struct Row {
  BusEventKind kind;
  image::AlarmNumber number;
};
/// Which event is which alarm. What the axis finds by itself (refused transition, missing process data) is
/// not here.
constexpr Row kAlarms[] = {
    {BusEventKind::boot_failed, cycle::alarm::kBootFailed},
    {BusEventKind::emcy, cycle::alarm::kEmergencyMessage},
    {BusEventKind::heartbeat_lost, cycle::alarm::kNodeLost},
    {BusEventKind::node_restarted, cycle::alarm::kNodeLost},
    {BusEventKind::node_left, cycle::alarm::kNodeLost},
    {BusEventKind::foreign_frame, cycle::alarm::kForeignFrame},
    {BusEventKind::send_failed, cycle::alarm::kBusSendOverflow},
};

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

void CanSupplier::receive(image::ProcessImage& image) noexcept {
  segment_.receive(image);
  canopen::BusEvent event;
  for (int i = 0; i < cycle::kNoticesPerCycle && segment_.events().pop(event); ++i) {
    report(event, image);
    kept_.push(event);
  }
}

void CanSupplier::report(const canopen::BusEvent& event, const image::ProcessImage&) noexcept {
  image::AlarmRecord r;
  for (const Row& row : kAlarms)
    if (row.kind == event.kind) r.number = row.number;
  if (event.kind == BusEventKind::emcy && event.emcy.error_code == 0) return;
  if (event.kind == BusEventKind::bus_state)
    for (const StateRow& row : kStates)
      if (row.state == event.bus_state) r.number = row.number;
  if (r.number == 0 || notices_ == nullptr) return;
  r.segment = event.segment;
  r.node = event.node;
  r.error_code = event.emcy.error_code;
  r.statusword = event.statusword;
  r.object_index = event.boot.index;
  r.object_subindex = event.boot.subindex;
  r.limit =
      static_cast<double>(event.kind == BusEventKind::boot_failed ? event.boot.expected : event.expected);
  r.value = static_cast<double>(event.kind == BusEventKind::boot_failed     ? event.boot.got
                                : event.kind == BusEventKind::foreign_frame ? event.frame.id
                                                                            : event.got);
  r.detail1 = static_cast<double>(event.boot.step);
  for (const canopen::NodeConfig& n : segment_.config().nodes)
    if (n.node == event.node && n.target == canopen::DriveTarget::axis)
      r.axis = static_cast<std::int8_t>(n.target_index);
  notices_->add(r);
}

}  // namespace servogate::gateway
