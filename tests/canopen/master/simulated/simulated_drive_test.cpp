// SPDX-License-Identifier: Apache-2.0
// The master against the simulated drives of drivers/mock on a simulated wire: two implementations that share
// only the vocabulary of CiA 301 and CiA 402.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "tests/canopen/master/simulated/simulated_drives.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;
using testing::kCountsPerRev;
using testing::Machine;

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
  fault::Fault fault;
  fault.kind = fault::Kind::over_current;
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
  fault::Fault fault;
  fault.kind = fault::Kind::heartbeat_lost;
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
  fault::Fault fault;
  fault.kind = fault::Kind::pdo_dropped;
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
  fault::Fault fault;
  fault.kind = fault::Kind::stuck_state;
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
  fault::Fault fault;
  fault.kind = fault::Kind::reset;
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
  fault::Fault fault;
  fault.kind = fault::Kind::sdo_abort;
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
  machine.drives[0]->inject({.kind = fault::Kind::heartbeat_lost});
  EXPECT_TRUE(machine.run_until([&] { return !machine.image->axes[0].drive.online; }, 62 + 20))
      << "after guard time times life time factor";
  machine.drives[0]->clear_faults();
  EXPECT_TRUE(machine.run_until([&] { return machine.image->axes[0].drive.online; }));
}

TEST(SimulatedDrives, found_in_a_fault_show_its_code_from_the_first_cycle) {
  Machine machine(1);
  ASSERT_TRUE(machine.enable()) << machine.story();
  machine.drives[0]->inject({.kind = fault::Kind::over_current});
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
