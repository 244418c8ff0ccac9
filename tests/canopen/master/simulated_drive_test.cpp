// SPDX-License-Identifier: Apache-2.0
// The master against the simulated drives of drivers/mock on a simulated wire: two implementations that share
// only the vocabulary of CiA 301 and CiA 402.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "firmware_if/canopen/device/program_store.hpp"
#include "firmware_if/canopen/master/segment.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using mock::DriveFault;
using mock::DriveFaultKind;

constexpr std::int64_t kCountsPerRev = 262'144;

/// Drives on one wire of 1 Mbit/s at 1 ms, run in virtual time.
struct Machine {
  explicit Machine(
      int axes, void (*map)(DriveProfile&) = use_short_position_map,
      image::Nanoseconds cycle_ns = image::kMillisecond, void (*setup)(NodeSetup&) = [](NodeSetup&) {},
      std::size_t program_memory = 0)
      : bus(wire.add_endpoint("master")) {
    config.cycle_ns = cycle_ns;
    for (int i = 0; i < axes; ++i) {
      NodeConfig node;
      node.node = static_cast<NodeId>(i + 1);
      node.target_index = i;
      node.profile.counts_per_rev = kCountsPerRev;
      map(node.profile);
      setup(node.setup);
      config.nodes.push_back(node);
      mock::SimulatedDriveConfig drive;
      drive.node_id = node.node;
      drive.plant.counts_per_rev = kCountsPerRev;
      drive.plant.start_rev = 0.3 + 0.1 * i;
      drive.plant.zero_mark_counts = 10'000;
      drive.program_memory = program_memory;
      drives.push_back(std::make_unique<mock::SimulatedDrive>(drive));
      wire.attach(*drives.back());
    }
    segment = std::make_unique<Segment>(bus, config);
    image->now.period_ns = cycle_ns;
  }

  void step() {
    wire.advance_to(image->now.t_ns);
    segment->open_cycle(*image);
    segment->receive(*image);
    if (control) control(*image);
    segment->send(*image);
    ++image->now.number;
    image->now.t_ns += config.cycle_ns;
    BusEvent e;
    while (segment->events().pop(e)) events.push_back(e);
  }
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) step();
  }
  template <class Condition>
  bool run_until(Condition condition, int limit = 5000) {
    for (int i = 0; i < limit && !condition(); ++i) step();
    return condition();
  }
  bool all(DriveState state) const {
    for (std::size_t i = 0; i < drives.size(); ++i)
      if (image->axes[i].drive.state != state) return false;
    return true;
  }
  bool enable() {
    control = [](image::ProcessImage& im) {
      for (auto& axis : im.axes) {
        axis.drive_command.power = true;
        axis.drive_command.mode = image::DriveMode::csp;
        if (axis.drive.state != DriveState::operation_enabled)
          axis.drive_command.position_counts = axis.drive.position_counts;
      }
    };
    return run_until([this] { return all(DriveState::operation_enabled); });
  }
  int count(BusEventKind kind) const {
    int n = 0;
    for (const BusEvent& e : events) n += e.kind == kind;
    return n;
  }
  std::string story() const {
    std::string all_events;
    for (const BusEvent& e : events)
      all_events += std::to_string(e.t_ns / 1'000'000) + " ms node " + std::to_string(e.node) + ": " +
                    describe(e, "drive", nullptr, text::Language::english) + "\n";
    return all_events;
  }

  mock::CanSegment wire;
  image::CanBus& bus;
  SegmentConfig config;
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives;
  std::unique_ptr<Segment> segment;
  std::unique_ptr<image::ProcessImage> image = std::make_unique<image::ProcessImage>();
  std::function<void(image::ProcessImage&)> control;
  std::vector<BusEvent> events;
};

TEST(SimulatedDrives, three_come_to_operation_enabled_without_a_jump) {
  Machine machine(3);
  std::array<double, 3> start{};
  for (std::size_t i = 0; i < 3; ++i) start[i] = machine.drives[i]->revolutions();
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.run(500);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(machine.drives[i]->state(), DriveState::operation_enabled);
    EXPECT_NEAR(machine.drives[i]->revolutions(), start[i], 1e-3);
  }
  EXPECT_EQ(machine.count(BusEventKind::node_booted), 3);
  EXPECT_EQ(machine.events.size(), 3u) << machine.story();
}

TEST(SimulatedDrives, three_follow_a_sine_in_csp) {
  Machine machine(3);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.run(100);
  std::array<std::int64_t, 3> origin{};
  for (std::size_t i = 0; i < 3; ++i) origin[i] = machine.image->axes[i].drive.position_counts;
  const std::int64_t first = machine.image->now.number;
  std::array<std::int64_t, 3> worst{}, largest{};
  std::array<std::vector<std::int64_t>, 3> targets;
  machine.control = [&](image::ProcessImage& image) {
    const double t = static_cast<double>(image.now.number - first) * image.now.period_s();
    for (std::size_t i = 0; i < 3; ++i) {
      const double amplitude = 0.5 * kCountsPerRev;
      const double frequency = 0.5 + 0.5 * static_cast<double>(i);
      const double swing = 1.0 - std::cos(2.0 * std::numbers::pi * frequency * t);
      auto& axis = image.axes[i];
      axis.drive_command.position_counts = origin[i] + std::llround(amplitude * swing);
      targets[i].push_back(axis.drive_command.position_counts);
      largest[i] = std::max(largest[i], axis.drive.position_counts - origin[i]);
      if (targets[i].size() > 2)
        worst[i] =
            std::max(worst[i], std::abs(axis.drive.position_counts - targets[i][targets[i].size() - 3]));
    }
  };
  machine.run(4000);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(largest[i], kCountsPerRev * 9 / 10) << "it has really moved";
    EXPECT_LT(worst[i], kCountsPerRev / 10) << "following error of the drive's position loop";
    EXPECT_EQ(machine.image->axes[i].drive.missed, 0u);
  }
  EXPECT_EQ(machine.events.size(), 3u) << machine.story();
  EXPECT_LT(machine.image->segments[0].load, 0.80);
  EXPECT_EQ(machine.image->segments[0].errors, 0u);
  EXPECT_NEAR(machine.image->segments[0].load, machine.wire.load(), 0.02) << "the wire counts the same bits";
}

TEST(SimulatedDrives, sync_is_answered_within_the_cycle_and_nothing_is_ever_missed) {
  Machine machine(3);
  ASSERT_TRUE(machine.enable()) << machine.story();
  for (int i = 0; i < 2000; ++i) {
    machine.step();
    for (std::size_t axis = 0; axis < 3; ++axis) ASSERT_EQ(machine.image->axes[axis].drive.missed, 0u) << i;
  }
}

void expect_zero_mark(void (*map)(DriveProfile&), image::Nanoseconds cycle_ns) {
  Machine machine(1, map, cycle_ns);
  ASSERT_TRUE(machine.enable()) << machine.story();
  auto& axis = machine.image->axes[0];
  std::int64_t target = axis.drive.position_counts;
  const auto offset =
      machine.drives[0]->position_counts() - machine.drives[0]->reported_position();  // world to drive, fixed
  machine.control = [&](image::ProcessImage& image) {
    auto& command = image.axes[0].drive_command;
    command.latch_arm = image.axes[0].drive.latch_sequence == 0;
    command.position_counts = target += image.now.period_ns / 10'000;
  };
  ASSERT_TRUE(machine.run_until([&] { return axis.drive.latch_sequence == 1; }, 8000)) << machine.story();
  const std::int64_t in_world = axis.drive.latch_counts + offset;
  const std::int64_t in_turn = ((in_world - 10'000) % kCountsPerRev + kCountsPerRev) % kCountsPerRev;
  EXPECT_LE(std::min(in_turn, kCountsPerRev - in_turn), 2) << "captured at " << in_world;
  machine.run(50);
  EXPECT_EQ(machine.drives[0]->object(0x60B8), 0);
}

TEST(SimulatedDrives, capture_the_zero_mark_over_sdo) {
  expect_zero_mark(use_short_position_map, image::kMillisecond);
}
TEST(SimulatedDrives, capture_the_zero_mark_over_pdo) {
  expect_zero_mark(use_full_position_map, 2 * image::kMillisecond);
}

TEST(SimulatedDrives, a_fault_is_told_and_reset) {
  Machine machine(2);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.events.clear();
  DriveFault fault;
  fault.kind = DriveFaultKind::over_current;
  machine.drives[0]->inject(fault);
  auto& axis = machine.image->axes[0];
  ASSERT_TRUE(machine.run_until([&] { return axis.drive.state == DriveState::fault; }, 2000))
      << machine.story();
  EXPECT_EQ(axis.drive.error_code, 0x2310);
  EXPECT_EQ(machine.count(BusEventKind::emcy), 1) << machine.story();
  EXPECT_EQ(machine.image->axes[1].drive.state, DriveState::operation_enabled);
  machine.control = nullptr;
  axis.drive_command.power = false;
  machine.run(100);
  EXPECT_EQ(axis.drive.state, DriveState::fault);
  axis.drive_command.reset_fault = true;
  ASSERT_TRUE(machine.run_until([&] { return axis.drive.state == DriveState::switch_on_disabled; }, 200))
      << machine.story();
  axis.drive_command.reset_fault = false;
  machine.run(2);
  EXPECT_TRUE(machine.enable()) << machine.story();
}

TEST(SimulatedDrives, a_lost_heartbeat_is_seen_and_the_others_go_on) {
  Machine machine(3);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.events.clear();
  DriveFault fault;
  fault.kind = DriveFaultKind::heartbeat_lost;
  machine.drives[1]->inject(fault);
  ASSERT_TRUE(machine.run_until([&] { return !machine.image->axes[1].drive.online; }, 500))
      << machine.story();
  EXPECT_EQ(machine.count(BusEventKind::heartbeat_lost), 1);
  EXPECT_TRUE(machine.image->axes[0].drive.online);
  EXPECT_TRUE(machine.image->axes[2].drive.online);
}

TEST(SimulatedDrives, dropped_pdos_are_counted_and_the_drive_comes_back) {
  Machine machine(2);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.events.clear();
  DriveFault fault;
  fault.kind = DriveFaultKind::pdo_dropped;
  fault.duration_ns = 50 * image::kMillisecond;
  machine.drives[0]->inject(fault);
  ASSERT_TRUE(machine.run_until([&] { return !machine.image->axes[0].drive.online; }, 10)) << machine.story();
  EXPECT_EQ(machine.count(BusEventKind::pdo_missing), 1);
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; }, 200)) << machine.story();
  machine.control = nullptr;
  machine.image->axes[0].drive_command.power = false;
  machine.run(2);
  EXPECT_TRUE(machine.enable()) << machine.story();
}

TEST(SimulatedDrives, a_stuck_state_is_a_refusal_with_its_name) {
  Machine machine(1);
  machine.config.nodes[0].profile.transition_timeout_ms = 300;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  DriveFault fault;
  fault.kind = DriveFaultKind::stuck_state;
  fault.state = DriveState::switched_on;
  machine.drives[0]->inject(fault);
  EXPECT_FALSE(machine.enable());
  const auto& refusal = machine.image->axes[0].drive.refusal;
  EXPECT_EQ(refusal.from, DriveState::switched_on) << machine.story();
  EXPECT_EQ(refusal.wanted, DriveState::operation_enabled);
  EXPECT_EQ(machine.count(BusEventKind::refused), 1);
}

TEST(SimulatedDrives, a_drive_that_restarts_is_booted_again_and_enabled_after_power_was_withdrawn) {
  Machine machine(2);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.events.clear();
  DriveFault fault;
  fault.kind = DriveFaultKind::reset;
  machine.drives[0]->inject(fault);
  auto& axis = machine.image->axes[0];
  ASSERT_TRUE(machine.run_until([&] { return !axis.drive.online; }, 500)) << machine.story();
  ASSERT_TRUE(machine.run_until([&] { return axis.drive.online; }, 2000)) << machine.story();
  machine.run(200);
  EXPECT_EQ(axis.drive.state, DriveState::switch_on_disabled);
  machine.control = nullptr;
  axis.drive_command.power = false;
  machine.run(2);
  EXPECT_TRUE(machine.enable()) << machine.story();
}

TEST(SimulatedDrives, a_drive_that_does_not_answer_one_object_is_named_with_it) {
  Machine machine(1);
  DriveFault fault;
  fault.kind = DriveFaultKind::sdo_abort;
  fault.index = 0x60C2;
  fault.abort = AbortCode::object_does_not_exist;
  machine.drives[0]->inject(fault);
  machine.run(1000);
  ASSERT_EQ(machine.count(BusEventKind::boot_failed), 1);
  EXPECT_NE(machine.story().find(
                "boot stopped at step \"interpolation time period\": writing 60C2h:02 Interpolation "
                "time period: refused by the device, the object does not exist in the device"),
            std::string::npos)
      << machine.story();
}

TEST(SimulatedDrives, two_runs_are_equal_to_the_bit) {
  const auto trace = [] {
    Machine machine(3);
    std::vector<std::int64_t> positions;
    machine.control = [&positions](image::ProcessImage& image) {
      for (auto& axis : image.axes) {
        axis.drive_command.power = true;
        axis.drive_command.position_counts = axis.drive.state == DriveState::operation_enabled
                                                 ? axis.drive_command.position_counts + 17
                                                 : axis.drive.position_counts;
        positions.push_back(axis.drive.position_counts);
      }
    };
    machine.run(1500);
    return positions;
  };
  EXPECT_EQ(trace(), trace());
}

TEST(SimulatedDrives, a_drive_without_heartbeat_is_guarded_and_its_loss_is_seen) {
  Machine machine(1, [](DriveProfile& profile) {
    use_short_position_map(profile);
    profile.guard_time_ms = 20;
    profile.life_time_factor = 3;
  });
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; }));
  EXPECT_EQ(machine.drives[0]->object(0x1017), 0);
  EXPECT_EQ(machine.drives[0]->object(0x100C), 20);
  EXPECT_EQ(machine.drives[0]->object(0x100D), 3);
  machine.run(2000);
  EXPECT_TRUE(machine.image->axes[0].drive.online);
  EXPECT_EQ(machine.drives[0]->object(0x1001), 0) << "and the drive sees its master";
  machine.drives[0]->inject({.kind = DriveFaultKind::heartbeat_lost});
  EXPECT_TRUE(machine.run_until([&] { return !machine.image->axes[0].drive.online; }, 62 + 20))
      << "after guard time times life time factor";
  machine.drives[0]->clear_faults();
  EXPECT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; }));
}

TEST(SimulatedDrives, run_with_a_sync_counter_and_a_synchronous_window) {
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

TEST(SimulatedDrives, hear_no_sync_with_a_counter_before_all_that_answer_know_of_it) {
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

TEST(SimulatedDrives, with_a_sync_counter_do_not_wait_for_one_that_does_not_answer) {
  Machine machine(2);
  machine.config.sync_counter_overflow = 240;
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  const auto errors = [&] {
    return std::ranges::count_if(machine.events, [](const BusEvent& e) {
      return e.kind == BusEventKind::emcy && e.emcy.error_code != 0;
    });
  };
  machine.drives[1]->inject({.kind = DriveFaultKind::silent});
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; })) << machine.story();
  machine.drives[1]->clear_faults();
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[1].drive.online; })) << machine.story();
  EXPECT_EQ(errors(), 0) << machine.story();
  machine.drives[0]->inject({.kind = DriveFaultKind::reset});
  ASSERT_TRUE(machine.run_until([&] { return !machine.image->axes[0].drive.online; })) << machine.story();
  ASSERT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; })) << machine.story();
  EXPECT_EQ(errors(), 0) << "8240h of one that boots among others that run\n" << machine.story();
  machine.run(200);
  EXPECT_TRUE(machine.image->axes[1].drive.online);
}

TEST(SimulatedDrives, that_run_with_a_sync_counter_tell_of_a_sync_without_one) {
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

TEST(SimulatedDrives, found_in_a_fault_show_its_code_from_the_first_cycle) {
  Machine machine(1);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.drives[0]->inject({.kind = DriveFaultKind::over_current});
  machine.run(100);
  // The control is started again; nobody has told this one of the fault.
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  machine.image->axes[0].drive = {};
  machine.events.clear();
  const auto& drive = machine.image->axes[0].drive;
  ASSERT_TRUE(machine.run_until([&] { return drive.state == DriveState::fault; })) << machine.story();
  EXPECT_EQ(drive.error_code, 0x2310) << machine.story();
}

TEST(SimulatedDrives, hear_the_time_of_day) {
  Machine machine(1);
  machine.config.time_ms = 100;
  machine.config.time_at_start = {3'600'000, 15'000};
  machine.segment = std::make_unique<Segment>(machine.bus, machine.config);
  image::CanBus& listener = machine.wire.add_endpoint("listener");
  machine.run(1050);
  std::vector<TimeOfDay> heard;
  image::CanFrame frame;
  while (listener.receive(frame))
    if (frame.id == cob::kTime) heard.push_back(*parse_time(frame));
  ASSERT_GE(heard.size(), 2u);
  EXPECT_EQ(heard[0], (TimeOfDay{3'600'000, 15'000}));
  EXPECT_EQ(heard[1], (TimeOfDay{3'600'100, 15'000}));
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

TEST(SimulatedDrives, without_csp_follow_in_interpolated_position) {
  Machine machine(1, [](DriveProfile& profile) {
    use_short_position_map(profile);
    profile.position_mode = OperationMode::interpolated_position;
    profile.modes = supported_bit(OperationMode::interpolated_position);
    profile.rpdo[0].mapping = {};
    profile.rpdo[0].mapping.add({0x6040, 0, 16});
    profile.rpdo[0].mapping.add({0x60C1, 1, 32});
  });
  ASSERT_TRUE(machine.enable()) << machine.story();
  EXPECT_EQ(machine.drives[0]->object(0x6061), 7);
  std::int64_t target = machine.image->axes[0].drive.position_counts;
  machine.control = [&](image::ProcessImage& im) {
    im.axes[0].drive_command.position_counts = target += 100;
  };
  machine.run(1000);
  machine.control = nullptr;
  machine.run(50);
  EXPECT_NEAR(static_cast<double>(machine.drives[0]->reported_position()), static_cast<double>(target), 30);
  EXPECT_TRUE(machine.image->axes[0].drive.state == DriveState::operation_enabled);
}

TEST(SimulatedDrives,
     that_home_by_themselves_are_followed_over_their_new_zero_and_taken_over_without_a_jump) {
  Machine machine(1, [](DriveProfile& profile) {
    use_short_position_map(profile);
    profile.settings.push_back({0x6098, 0, 1, 37});
    profile.settings.push_back({0x607C, 0, 4, 100'000});
  });
  ASSERT_TRUE(machine.enable()) << machine.story();
  const double before = machine.drives[0]->revolutions();
  const auto& drive = machine.image->axes[0].drive;
  machine.control = [](image::ProcessImage& im) { im.axes[0].drive_command.mode = image::DriveMode::homing; };
  ASSERT_TRUE(machine.run_until(
      [&] { return drive.mode == image::DriveMode::homing && (drive.statusword & 0x1000); }));
  machine.run(5);
  EXPECT_NEAR(static_cast<double>(drive.position_counts), -100'000, 100)
      << "home is at minus the home offset";
  // The axis seats its command on the feedback, and only then asks for csp.
  machine.control = [](image::ProcessImage& im) {
    im.axes[0].drive_command.position_counts = im.axes[0].drive.position_counts;
    im.axes[0].drive_command.mode = image::DriveMode::csp;
  };
  ASSERT_TRUE(machine.run_until([&] { return drive.mode == image::DriveMode::csp; }));
  machine.control = nullptr;
  machine.run(500);
  EXPECT_EQ(machine.drives[0]->state(), DriveState::operation_enabled);
  EXPECT_NEAR(machine.drives[0]->revolutions(), before, 1e-3);
  EXPECT_EQ(machine.count(BusEventKind::handover_held), 0);
  EXPECT_EQ(machine.count(BusEventKind::emcy), 0) << machine.story();
}

TEST(SimulatedDrives, that_would_not_notice_the_death_of_the_control_are_refused_or_waived) {
  Machine machine(1);
  machine.config.nodes[0].profile.has_heartbeat_consumer = false;
  EXPECT_THROW(Segment(machine.bus, machine.config), std::invalid_argument);
  machine.config.nodes[0].profile.rpdo[0].event_ms = 20;
  EXPECT_NO_THROW(Segment(machine.bus, machine.config)) << "the deadline of an RPDO is enough";
  machine.config.nodes[0].profile.rpdo[0].event_ms = 0;
  machine.config.nodes[0].unsupervised = true;
  EXPECT_NO_THROW(Segment(machine.bus, machine.config));
  machine.config.nodes[0].unsupervised = false;
  machine.config.nodes[0].profile.has_heartbeat_consumer = true;
  machine.config.nodes[0].profile.abort_connection_option = std::nullopt;
  EXPECT_THROW(Segment(machine.bus, machine.config), std::invalid_argument) << "it hears, and does nothing";
}

TEST(SimulatedDrives, stop_by_the_deadline_of_their_rpdo_when_the_control_dies) {
  Machine machine(1, [](DriveProfile& profile) {
    use_short_position_map(profile);
    profile.has_heartbeat_consumer = false;
    profile.rpdo[0].event_ms = 20;
  });
  ASSERT_TRUE(machine.enable()) << machine.story();
  EXPECT_EQ(machine.drives[0]->object(0x1400, 5), 20) << "written and read back";
  machine.wire.advance_to(machine.image->now.t_ns + 15 * image::kMillisecond);
  EXPECT_EQ(machine.drives[0]->state(), DriveState::operation_enabled);
  machine.wire.advance_to(machine.image->now.t_ns + 200 * image::kMillisecond);
  EXPECT_EQ(machine.drives[0]->state(), DriveState::fault);
  EXPECT_EQ(machine.drives[0]->error_code(), 0x8250);
}

}  // namespace
}  // namespace servogate::canopen
