// SPDX-License-Identifier: Apache-2.0
// What the master writes into simulated drives before they run: SYNC counter, programs, configuration.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "firmware_if/canopen/device/node/program_store.hpp"
#include "tests/canopen/master/simulated/simulated_drives.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::Machine;

TEST(SyncCounter, run_with_a_sync_counter_and_a_synchronous_window) {
  Machine machine(2);
  machine.config.sync_counter_overflow = 10;
  machine.config.sync_window_us = 900;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  ASSERT_TRUE(machine.enable());
  EXPECT_EQ(machine.drives[0]->object(0x1019), 10);
  EXPECT_EQ(machine.drives[1]->object(0x1007), 900);
  machine.run(500);
  EXPECT_TRUE(machine.all(DriveState::operation_enabled));
  EXPECT_EQ(machine.count(BusEventKind::emcy), 0) << machine.story();
}

TEST(SyncCounter, hear_no_sync_with_a_counter_before_all_that_answer_know_of_it) {
  Machine machine(2);
  machine.config.sync_counter_overflow = 240;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  image::CanBus& listener = machine.wire.add_endpoint("listener");
  int syncs = 0;
  image::CanFrame frame;
  const auto first = [&] {
    while (listener.receive(frame))
      if (frame.id == cob::kSync) {
        EXPECT_EQ(frame.length, 1);
        EXPECT_EQ(frame.data[0], syncs % 240 + 1);
        ++syncs;
      }
    return syncs > 0;
  };
  ASSERT_TRUE(machine.run_until(first));
  EXPECT_EQ(machine.drives[0]->object(0x1019), 240);
  EXPECT_EQ(machine.drives[1]->object(0x1019), 240);
  const int before = syncs;
  for (int i = 0; i < 100; ++i) machine.run(1), first();
  EXPECT_EQ(syncs, before + 100) << "and from then on with every cycle";
}

TEST(SyncCounter, with_a_sync_counter_do_not_wait_for_one_that_does_not_answer) {
  Machine machine(2);
  machine.config.sync_counter_overflow = 240;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  const auto errors = [&] {
    return std::ranges::count_if(machine.events, [](const BusEvent& e) {
      return e.kind == BusEventKind::emcy && e.emcy.error_code != 0;
    });
  };
  machine.drives[1]->inject({.kind = fault::Kind::silent});
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; })) << machine.story();
  machine.drives[1]->clear_faults();
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[1].drive.online; })) << machine.story();
  EXPECT_EQ(errors(), 0) << machine.story();
  machine.drives[0]->inject({.kind = fault::Kind::reset});
  ASSERT_TRUE(machine.run_until([&] { return !machine.image->axes[0].drive.online; })) << machine.story();
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; })) << machine.story();
  EXPECT_EQ(errors(), 0) << "8240h of one that boots among others that run\n" << machine.story();
  machine.run(200);
  EXPECT_TRUE(machine.image->axes[1].drive.online);
}

TEST(SyncCounter, that_run_with_a_sync_counter_tell_of_a_sync_without_one) {
  Machine machine(1);
  machine.config.sync_counter_overflow = 240;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  image::CanBus& foreign = machine.wire.add_endpoint("foreign");
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.wire.advance_to(machine.image->now.t_ns - 300'000);  // between two of ours
  foreign.send(make_frame(cob::kSync, {}));
  machine.run(5);
  EXPECT_NE(machine.story().find("8240h"), std::string::npos) << machine.story();
}

/// A program of 5000 bytes and what a drive says of it.
const std::vector<std::uint8_t>& new_program() {
  static const std::vector<std::uint8_t> image = [] {
    std::vector<std::uint8_t> bytes(5000);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * 37 >> 3);
    return bytes;
  }();
  return image;
}
void with_new_program(NodeSetup& setup) {
  setup.program = NodeProgram{new_program(), program_identification(new_program()), 1};
}

struct ProgramDownload : ::testing::Test {
  Machine machine{1, use_short_position_map, image::kMillisecond, with_new_program, 10'000};
  std::string failure() {
    for (const BusEvent& e : machine.events)
      if (e.kind == BusEventKind::boot_failed) return describe(e, "X", nullptr, text::Language::english);
    return {};
  }
  bool boots(int cycles = 30'000) {
    return machine.run_until([&] { return machine.image->axes[0].drive.online || !failure().empty(); },
                             cycles) &&
           failure().empty();
  }
};

TEST_F(ProgramDownload, a_drive_with_another_program_gets_the_right_one_and_runs) {
  ASSERT_TRUE(boots()) << failure();
  EXPECT_EQ(machine.drives[0]->object(0x1F56, 1), program_identification(new_program()));
  EXPECT_EQ(machine.drives[0]->object(0x1F51, 1), 1);
  EXPECT_EQ(machine.drives[0]->object(0x1F57, 1), 0);
  EXPECT_TRUE(machine.enable());
}

TEST_F(ProgramDownload, a_drive_that_has_it_already_is_left_alone) {
  ASSERT_TRUE(boots());
  const auto boot_time = [&] {
    machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
    const auto begin = machine.image->now.t_ns;
    machine.image->axes[0].drive.online = false;
    EXPECT_TRUE(boots());
    return machine.image->now.t_ns - begin;
  };
  EXPECT_LT(boot_time(), 500 * image::kMillisecond)
      << "clearing the flash alone takes 200 ms, writing it longer";
}

TEST_F(ProgramDownload, an_error_of_the_flash_is_named) {
  machine.drives[0]->spoil_next_program(5);
  EXPECT_FALSE(boots());
  EXPECT_EQ(
      failure(),
      "X: boot stopped at step \"program of the device\": reading 1F57h:01 Flash status identification: "
      "writing the flash failed (0000000Ah)");
}

TEST(SimulatedDrives, of_another_software_version_are_named_with_both_versions) {
  Machine machine(1, use_short_position_map, image::kMillisecond,
                  [](NodeSetup& setup) { setup.software_version = "2.7"; });
  machine.run(1000);
  ASSERT_EQ(machine.count(BusEventKind::boot_failed), 1);
  EXPECT_EQ(machine.story(),
            std::to_string(machine.events[0].t_ns / 1'000'000) +
                " ms node 1: drive: boot stopped at step \"software version\": reading 100Ah:00 "
                "Manufacturer software version: expected \"2.7\", got \"0.1\"\n");
}

TEST(SimulatedDrives, get_a_concise_dcf_where_its_date_is_another_one) {
  Machine machine(1, use_short_position_map, image::kMillisecond, [](NodeSetup& setup) {
    const std::vector<ConfigurationEntry> entries{{0x6065, 0, {0x10, 0x27, 0, 0}},
                                                  {0x2100, 0, std::vector<std::uint8_t>(40, 'x')}};
    setup.concise_dcf = write_concise_dcf(entries);
    setup.configuration_date = ConfigurationDate{15'000, 3'600'000};
  });
  const auto boot = [&] {
    machine.image->axes[0].drive.online = false;
    machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
    return machine.run_until([&] { return machine.image->axes[0].drive.online; });
  };
  ASSERT_TRUE(boot()) << machine.story();
  EXPECT_EQ(machine.drives[0]->object(0x6065), 10'000);
  EXPECT_EQ(machine.drives[0]->object(0x1020, 1), 15'000);
  EXPECT_EQ(machine.drives[0]->object(0x1020, 2), 3'600'000);
  // A reset of communication forgets 1020h, which nobody stored: the values are written again.
  ASSERT_TRUE(boot());
  EXPECT_EQ(machine.drives[0]->object(0x1020, 2), 3'600'000);
}

}  // namespace
}  // namespace servogate::canopen
