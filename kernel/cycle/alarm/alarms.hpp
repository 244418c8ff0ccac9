// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/alarm_numbers.hpp"
#include "firmware_if/image/alarms/alarm_table.hpp"
#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/alarms/axis_alarms.hpp"

namespace servogate::cycle {

namespace alarm = image::alarm;

/// Alarms as a reader outside the cycle sees them, oldest first. Trivially copyable.
struct AlarmSnapshot {
  static constexpr int kCapacity = 64;
  int count = 0;
  std::uint32_t raised = 0;   ///< records made since the start
  std::uint32_t dropped = 0;  ///< records for which there was no room
  image::Reaction reaction = image::Reaction::none;
  std::array<image::AlarmRecord, kCapacity> records{};
};

/// Bounded store of the alarms. Written by the cycle only. The first fault is flagged, and what follows while
/// the machine reacts to it is its consequence. Records stay until the operator's reset and their reset
/// condition.
class AlarmList {
 public:
  static constexpr int kCapacity = 256;

  /// `table`: its rows say what an alarm does; outlives the list. nullptr: every alarm stops the axes and
  /// goes with the operator's reset.
  explicit AlarmList(const image::AlarmTable* table = nullptr) : table_(table) {}

  /// Stores a fault. From `record` are taken: number, axis, node and all that describes the place and the
  /// figures; reaction where it is stronger than the table's. Sequence, first fault, cycle and time are set
  /// here. The same fault (number, axis, part, source, process, key) while active is not stored
  /// twice. Returns the sequence. real-time safe.
  std::uint32_t raise(const image::AlarmRecord& record, const image::CycleTime& now) noexcept;
  /// A process begins a run: the warnings of the run before it that go by themselves
  /// (ResetCondition::by_itself) end; others stay. real-time safe.
  void run_begins(int process) noexcept;
  /// The cause of a warning of an axis is gone: it ends where it goes by itself. real-time safe.
  void cause_gone(image::AlarmNumber number, int axis) noexcept;
  /// To be told in every cycle: the machine is at rest. A quarter of a second of rest ends the reaction (at 1
  /// ms; 250 cycles), the next fault is then a first fault again. real-time safe.
  void note_rest(bool at_rest) noexcept;
  /// The operator's reset. `still_present(record)` says whether the cause is there; asked only for those
  /// whose condition is that it has gone. `axis` >= 0: only the alarms that name this axis. Returns how many
  /// stay active. real-time safe if `still_present` is.
  template <typename Present>
  int reset(Present&& still_present, int axis = -1) noexcept {
    for (int i = 0; i < stored_; ++i) {
      image::AlarmRecord& r = records_[static_cast<std::size_t>(i)];
      if (axis >= 0 && r.axis != axis) continue;
      if (r.active && (!waits_for_cause(r) || !still_present(static_cast<const image::AlarmRecord&>(r))))
        r.active = false;
    }
    return after_reset();
  }

  /// The strongest reaction in force. real-time safe.
  image::Reaction reaction() const noexcept { return reaction_; }
  int active_count() const noexcept { return active_; }
  /// An active alarm says that the control itself fails its task: late cycles, logic that stopped, is
  /// held or takes too long (AlarmMark::fails_control). real-time safe.
  bool control_fails() const noexcept { return control_fails_; }
  /// The oldest active first fault, nullptr: none. Warnings only when there is no fault. real-time safe.
  const image::AlarmRecord* first() const noexcept;
  /// The same among the alarms of one process and those of the machine. real-time safe.
  const image::AlarmRecord* first_of_process(int process) const noexcept;
  bool active(image::AlarmNumber number, int axis = -1) const noexcept;
  /// Writes NC.alarm, <axis>.alarm, MC.alarm and image.alarms_active. real-time safe.
  void write_interface(image::ProcessImage& image) const noexcept;
  /// Active alarms (the oldest 64) into `out`. real-time safe.
  void snapshot(AlarmSnapshot& out) const noexcept;
  /// Everything kept, active or not, oldest first, for reports. Not real-time safe.
  std::vector<image::AlarmRecord> history() const;

 private:
  const image::AlarmRow* row_of(image::AlarmNumber number) const noexcept {
    return table_ != nullptr ? table_->find(number) : nullptr;
  }
  bool waits_for_cause(const image::AlarmRecord& r) const noexcept;
  int after_reset() noexcept;
  void recount() noexcept;
  int place_for_new() noexcept;

  const image::AlarmTable* table_;
  std::array<image::AlarmRecord, kCapacity> records_{};
  int stored_ = 0;
  int active_ = 0;
  bool control_fails_ = false;
  std::uint32_t sequence_ = 0;
  std::uint32_t dropped_ = 0;
  std::uint32_t group_ = 0;  ///< sequence of the first fault of the reaction under way, 0: none
  int rest_cycles_ = 0;
  image::Reaction dropped_reaction_ = image::Reaction::none;  ///< of records without room, until the reset
  image::Reaction reaction_ = image::Reaction::none;
};
static_assert(std::is_trivially_copyable_v<AlarmSnapshot>);

}  // namespace servogate::cycle
