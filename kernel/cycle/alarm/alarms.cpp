// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/alarm/alarms.hpp"

#include <algorithm>
#include <cstdio>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::cycle {

using image::AlarmRecord;
using image::Reaction;

namespace {

/// So many cycles at rest end the reaction to a first fault: late consequences (a drive's message) still
/// belong to it.
constexpr int kRestCycles = 250;

bool is_fault(const AlarmRecord& r) noexcept { return r.reaction >= Reaction::stop_at_block_end; }

bool same(const AlarmRecord& a, const AlarmRecord& b) noexcept {
  return a.number == b.number && a.axis == b.axis && a.part == b.part && a.source == b.source &&
         a.process == b.process && a.key == b.key;
}

}  // namespace

int AlarmList::place_for_new() noexcept {
  if (stored_ < kCapacity) return stored_++;
  const auto begin = records_.begin();
  const auto oldest = std::find_if(begin, records_.end(), [](const AlarmRecord& r) { return !r.active; });
  if (oldest == records_.end()) return -1;
  std::move(oldest + 1, records_.end(), oldest);
  return kCapacity - 1;
}

std::uint32_t AlarmList::raise(const AlarmRecord& record, const image::CycleTime& now) noexcept {
  for (int i = 0; i < stored_; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (r.active && same(r, record)) return r.sequence;
  }
  const image::AlarmRow* row = row_of(record.number);
  AlarmRecord made = record;
  made.reaction = std::max(record.reaction, row != nullptr ? row->reaction : Reaction::stop_axes);
  made.active = true;
  made.sequence = ++sequence_;
  made.cycle = now.number;
  made.t_ns = now.t_ns;
  if (is_fault(made) && group_ == 0) group_ = made.sequence;
  made.first_fault = group_ != 0 ? group_ : made.sequence;
  rest_cycles_ = 0;
  const int place = place_for_new();
  if (place < 0) {
    ++dropped_;
    dropped_reaction_ = std::max(dropped_reaction_, made.reaction);
  } else {
    records_[static_cast<std::size_t>(place)] = made;
  }
  recount();
  return made.sequence;
}

void AlarmList::run_begins(int process) noexcept {
  for (int i = 0; i < stored_; ++i) {
    AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (!r.active || r.process != process) continue;
    const image::AlarmRow* row = row_of(r.number);
    if (row != nullptr && row->reset == image::ResetCondition::by_itself) r.active = false;
  }
  recount();
}

void AlarmList::cause_gone(image::AlarmNumber number, int axis) noexcept {
  if (active_ == 0 || !active(number, axis)) return;
  const image::AlarmRow* row = row_of(number);
  if (row == nullptr || row->reset != image::ResetCondition::by_itself) return;
  for (int i = 0; i < stored_; ++i) {
    AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (r.number == number && r.axis == axis) r.active = false;
  }
  recount();
}

void AlarmList::note_rest(bool at_rest) noexcept {
  rest_cycles_ = at_rest ? std::min(rest_cycles_ + 1, kRestCycles) : 0;
  if (rest_cycles_ >= kRestCycles) group_ = 0;
}

bool AlarmList::waits_for_cause(const AlarmRecord& r) const noexcept {
  const image::AlarmRow* row = row_of(r.number);
  return row != nullptr && row->reset == image::ResetCondition::cause_gone;
}

int AlarmList::after_reset() noexcept {
  dropped_reaction_ = Reaction::none;
  recount();
  if (active_ == 0) group_ = 0;
  return active_;
}

void AlarmList::recount() noexcept {
  active_ = 0;
  control_fails_ = false;
  reaction_ = dropped_reaction_;
  for (int i = 0; i < stored_; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (!r.active) continue;
    ++active_;
    control_fails_ =
        control_fails_ || (table_ != nullptr && table_->mark(r.number) == image::AlarmMark::fails_control);
    reaction_ = std::max(reaction_, r.reaction);
  }
}

const AlarmRecord* AlarmList::first() const noexcept { return first_of_process(-1); }

const AlarmRecord* AlarmList::first_of_process(int process) const noexcept {
  const AlarmRecord* fault = nullptr;
  const AlarmRecord* warning = nullptr;
  for (int i = 0; i < stored_; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (!r.active || (process >= 0 && r.process >= 0 && r.process != process)) continue;
    if (is_fault(r) && fault == nullptr) fault = &r;
    if (!is_fault(r) && warning == nullptr) warning = &r;
  }
  return fault != nullptr ? fault : warning;
}

bool AlarmList::active(image::AlarmNumber number, int axis) const noexcept {
  for (int i = 0; i < stored_; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (r.active && r.number == number && (axis < 0 || r.axis == axis)) return true;
  }
  return false;
}

void AlarmList::write_interface(image::ProcessImage& image) const noexcept {
  using image::field;
  image::Packets& packets = image.packets;
  image.alarms_active = static_cast<std::uint32_t>(active_);
  packets.set_bit(field(image::kMachineFields, "alarm", image::kMachineBase), active_ > 0);
  for (int p = 0; p < image.process_count; ++p) {
    const AlarmRecord* r = first_of_process(p);
    packets.set_number(image::at(field(image::kProcessFields, "alarm"), image::process_base(p)),
                       r != nullptr ? r->number : 0.0);
  }
  std::uint32_t named = 0;
  for (int i = 0; i < stored_; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (r.active && r.axis >= 0) named |= std::uint32_t{1} << r.axis;
  }
  for (int a = 0; a < image.axis_count; ++a)
    packets.set_bit(image::at(field(image::kAxisFields, "alarm"), image::axis_base(a)),
                    (named >> a & 1u) != 0);
}

void AlarmList::snapshot(AlarmSnapshot& out) const noexcept {
  out.count = 0;
  out.raised = sequence_;
  out.dropped = dropped_;
  out.reaction = reaction_;
  for (int i = 0; i < stored_ && out.count < AlarmSnapshot::kCapacity; ++i) {
    const AlarmRecord& r = records_[static_cast<std::size_t>(i)];
    if (r.active) out.records[static_cast<std::size_t>(out.count++)] = r;
  }
}

std::vector<AlarmRecord> AlarmList::history() const { return {records_.begin(), records_.begin() + stored_}; }

}  // namespace servogate::cycle
