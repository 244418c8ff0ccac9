// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/alarm/alarms.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "firmware_if/image/interface_map.hpp"
#include "tests/alarms.hpp"
#include "tests/property_seed.hpp"

namespace servogate::cycle {
namespace {

using image::AlarmRecord;
using image::Reaction;

image::CycleTime at(std::int64_t cycle) { return {cycle, cycle * image::kMillisecond, image::kMillisecond}; }

AlarmRecord of(image::AlarmNumber number, int axis = -1) {
  AlarmRecord r;
  r.number = number;
  r.axis = static_cast<std::int8_t>(axis);
  return r;
}

const auto kNothingPresent = [](const AlarmRecord&) { return false; };

TEST(AlarmList, stamps_a_record_and_takes_the_reaction_of_the_table) {
  AlarmList list(&tests::alarm_table());
  EXPECT_EQ(list.raise(of(axis::alarm::kFollowingError, 2), at(77)), 1u);
  const AlarmRecord* r = list.first();
  ASSERT_NE(r, nullptr);
  EXPECT_EQ(r->cycle, 77);
  EXPECT_EQ(r->t_ns, 77 * image::kMillisecond);
  EXPECT_EQ(r->first_fault, 1u);
  EXPECT_EQ(r->reaction, Reaction::stop_axes);
  EXPECT_EQ(list.reaction(), Reaction::stop_axes);
}

TEST(AlarmList, tells_faults_of_one_number_and_place_apart_by_their_key) {
  AlarmList list(&tests::alarm_table());
  image::AlarmRecord sync = of(alarm::kForeignFrame), nmt = sync;
  sync.part.device = nmt.part.device = 0;
  sync.key = 0x080;
  nmt.key = 0x000;
  EXPECT_EQ(list.raise(sync, at(1)), 1u);
  EXPECT_EQ(list.raise(nmt, at(2)), 2u) << "both are of no node";
  EXPECT_EQ(list.raise(sync, at(3)), 1u);
}

TEST(AlarmList, takes_a_stronger_reaction_of_the_machine_file_and_no_weaker_one) {
  AlarmList list(&tests::alarm_table());
  AlarmRecord strong = of(axis::alarm::kFollowingError, 0), weak = of(axis::alarm::kFollowingError, 1);
  strong.reaction = Reaction::power_off;
  weak.reaction = Reaction::warn;
  list.raise(weak, at(1));
  EXPECT_EQ(list.reaction(), Reaction::stop_axes);
  list.raise(strong, at(2));
  EXPECT_EQ(list.reaction(), Reaction::power_off);
}

TEST(AlarmList, tells_a_failing_control_from_a_failing_machine) {
  AlarmList list(&tests::alarm_table());
  list.raise(of(alarm::kEmergencyStop), at(1));
  list.raise(of(axis::alarm::kDriveFault, 0), at(1));
  EXPECT_FALSE(list.control_fails());
  for (const image::AlarmNumber number :
       {alarm::kOverrunLimit, alarm::kPlcBudget, alarm::kPlcFault, alarm::kPlcHeld, alarm::kPlcWatchdog}) {
    list.raise(of(number), at(2));
    EXPECT_TRUE(list.control_fails()) << number;
    list.reset(kNothingPresent);
    EXPECT_FALSE(list.control_fails());
  }
}

TEST(AlarmList, does_not_store_the_same_active_fault_twice) {
  AlarmList list(&tests::alarm_table());
  const auto first = list.raise(of(axis::alarm::kFollowingError, 0), at(1));
  EXPECT_EQ(list.raise(of(axis::alarm::kFollowingError, 0), at(2)), first);
  EXPECT_NE(list.raise(of(axis::alarm::kFollowingError, 1), at(2)), first);
  EXPECT_EQ(list.active_count(), 2);
}

TEST(AlarmList, groups_what_follows_under_the_first_fault_until_the_machine_rests) {
  AlarmList list(&tests::alarm_table());
  list.raise(of(alarm::kStarved), at(0));  // a warning before it is nobody's consequence
  const auto first = list.raise(of(axis::alarm::kDriveFault, 1), at(10));
  list.note_rest(false);
  const auto second = list.raise(of(axis::alarm::kFollowingError, 0), at(30));
  for (int i = 0; i < 100; ++i) list.note_rest(true);
  const auto third = list.raise(of(axis::alarm::kPdoMissing, 0), at(130));
  for (int i = 0; i < 250; ++i) list.note_rest(true);
  const auto fourth = list.raise(of(axis::alarm::kBrakeSlips, 2), at(999));
  AlarmSnapshot s;
  list.snapshot(s);
  ASSERT_EQ(s.count, 5);
  EXPECT_EQ(s.records[0].first_fault, s.records[0].sequence);
  EXPECT_EQ(s.records[1].first_fault, first);
  EXPECT_EQ(s.records[2].sequence, second);
  EXPECT_EQ(s.records[2].first_fault, first);
  EXPECT_EQ(s.records[3].sequence, third);
  EXPECT_EQ(s.records[3].first_fault, first) << "late, but of the same reaction";
  EXPECT_EQ(s.records[4].first_fault, fourth) << "the machine stood: a fault of its own";
  EXPECT_EQ(list.first()->sequence, first) << "the fault, not the warning before it";
}

TEST(AlarmList, keeps_after_a_reset_only_what_waits_for_its_cause) {
  AlarmList list(&tests::alarm_table());
  list.raise(of(axis::alarm::kHardLimitPlus, 0), at(1));  // reset is enough
  list.raise(of(axis::alarm::kDriveFault, 0), at(2));     // the cause has to go
  int asked = 0;
  EXPECT_EQ(list.reset([&](const AlarmRecord& r) { return ++asked, r.number == axis::alarm::kDriveFault; }),
            1);
  EXPECT_EQ(asked, 1);
  EXPECT_TRUE(list.active(axis::alarm::kDriveFault, 0));
  EXPECT_FALSE(list.active(axis::alarm::kDriveFault, 1));
  EXPECT_FALSE(list.active(axis::alarm::kHardLimitPlus));
  EXPECT_EQ(list.reset(kNothingPresent), 0);
  EXPECT_EQ(list.reaction(), Reaction::none);
  EXPECT_EQ(list.history().size(), 2u);
  const auto next = list.raise(of(axis::alarm::kDriveFault, 0), at(9));
  EXPECT_EQ(list.first()->first_fault, next);
}

TEST(AlarmList, lets_only_warnings_go_by_themselves) {
  AlarmList list(&tests::alarm_table());
  AlarmRecord starved = of(alarm::kStarved), warned = of(alarm::kProgramWarning);
  starved.process = 1;
  warned.process = 0;
  AlarmRecord wrong = of(alarm::kMAckTimeout);
  wrong.process = 1;
  list.raise(starved, at(1));
  list.raise(warned, at(1));
  list.raise(wrong, at(1));
  list.raise(of(axis::alarm::kFollowingError, 0), at(1));
  EXPECT_EQ(list.active_count(), 4);
  list.run_begins(1);
  EXPECT_FALSE(list.active(alarm::kStarved)) << "of the run before";
  EXPECT_TRUE(list.active(alarm::kProgramWarning)) << "another process'";
  EXPECT_TRUE(list.active(alarm::kMAckTimeout)) << "no warning";
  list.run_begins(0);
  EXPECT_EQ(list.active_count(), 2);
}

TEST(AlarmList, writes_what_the_plc_sees) {
  AlarmList list(&tests::alarm_table());
  image::ProcessImage image;
  image.axis_count = 3;
  image.process_count = 2;
  AlarmRecord r = of(axis::alarm::kFollowingError, 1);
  r.process = 1;
  list.raise(r, at(1));
  list.write_interface(image);
  auto axis_bit = [&](int a) {
    return image.packets.bit(image::at(image::field(image::kAxisFields, "alarm"), image::axis_base(a)));
  };
  auto process = [&](int p) {
    return image.packets.number(
        image::at(image::field(image::kProcessFields, "alarm"), image::process_base(p)));
  };
  EXPECT_FALSE(axis_bit(0));
  EXPECT_TRUE(axis_bit(1));
  EXPECT_EQ(process(0), 0.0);
  EXPECT_EQ(process(1), axis::alarm::kFollowingError);
  EXPECT_TRUE(image.packets.bit(image::field(image::kMachineFields, "alarm", image::kMachineBase)));
  EXPECT_EQ(image.alarms_active, 1u);
  list.reset(kNothingPresent);
  list.write_interface(image);
  EXPECT_FALSE(axis_bit(1));
  EXPECT_EQ(process(1), 0.0);
}

TEST(AlarmList, stays_bounded_counts_what_it_drops_and_still_reacts_to_it) {
  AlarmList list(&tests::alarm_table());
  for (int i = 0; i < AlarmList::kCapacity; ++i) {
    AlarmRecord r = of(alarm::kNodeLost);
    r.part.part = static_cast<std::int16_t>(i);
    list.raise(r, at(i));
  }
  list.raise(of(alarm::kEmergencyStop), at(999));
  EXPECT_EQ(list.reaction(), Reaction::stop_and_power_off) << "no room for the record, but the machine stops";
  AlarmSnapshot s;
  list.snapshot(s);
  EXPECT_EQ(s.dropped, 1u);
  EXPECT_EQ(s.count, AlarmSnapshot::kCapacity);
  EXPECT_EQ(s.records[0].part.part, 0);
  list.reset(kNothingPresent);
  EXPECT_EQ(list.reaction(), Reaction::none);
  list.raise(of(alarm::kEmergencyStop), at(1000));
  EXPECT_EQ(list.first()->number, alarm::kEmergencyStop);
  EXPECT_EQ(list.history().size(), static_cast<std::size_t>(AlarmList::kCapacity));
}

TEST(AlarmList, holds_its_invariants_over_random_histories) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937_64 random(seed);
  const auto table = tests::alarm_table().rows();
  for (int run = 0; run < 200; ++run) {
    AlarmList list(&tests::alarm_table());
    for (int i = 0; i < 500; ++i) {
      const auto dice = random() % 100;
      if (dice < 60)
        list.raise(of(table[random() % table.size()]->number, static_cast<int>(random() % 8) - 1), at(i));
      else if (dice < 90)
        list.note_rest(dice < 80);
      else if (dice < 97)
        list.reset([&](const AlarmRecord&) { return random() % 2 == 0; });
      else
        list.run_begins(static_cast<int>(random() % 2) - 1);
      const auto history = list.history();
      Reaction strongest = Reaction::none;
      int active = 0;
      for (std::size_t k = 0; k < history.size(); ++k) {
        const AlarmRecord& r = history[k];
        if (k > 0) {
          ASSERT_GT(r.sequence, history[k - 1].sequence);
        }
        ASSERT_LE(r.first_fault, r.sequence);
        if (!r.active) continue;
        ++active;
        strongest = std::max(strongest, r.reaction);
      }
      ASSERT_EQ(active, list.active_count());
      ASSERT_EQ(list.first() != nullptr, active > 0);
      ASSERT_GE(list.reaction(), strongest);
    }
  }
}

}  // namespace
}  // namespace servogate::cycle
