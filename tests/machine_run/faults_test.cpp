// SPDX-License-Identifier: Apache-2.0
// Faults of the example mill with its simulated drives: what stops, how, in which order, and what it says.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/image/interface_map.hpp"
#include "gateway/control/run/words/ready_words.hpp"
#include "machine/consequences.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/property_seed.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::Mode;
using image::ProcessState;
using image::RequestKind;

// A straight line in space, long enough to be in full motion after half a second.
constexpr const char* kLine = "N10 G90 G94 G71\nN20 G1 X200 Y100 Z-50 F9000\nN30 X0 Y0 Z0\nN40 M30\n";

double off_line(const image::ProcessImage& image) {
  const double d[] = {200, 100, -50};
  const double length2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  double dot = 0.0, square = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    dot += image.axes[i].command * d[i];
    square += image.axes[i].command * image.axes[i].command;
  }
  return std::sqrt(std::max(0.0, square - dot * dot / length2));
}

/// A mill in full motion along kLine.
class Moving : public Mill {
 public:
  Moving() : Mill(kLine) {
    EXPECT_TRUE(make_ready()) << alarm_list();
    EXPECT_EQ(ask(RequestKind::start), Refusal::none);
    run(0.6);
    EXPECT_GT(process().feed_mm_s, 100.0) << alarm_list();
  }
};

TEST(Faults, emergency_stop_in_motion_stops_every_axis_within_its_limits_and_only_then_takes_the_power) {
  Moving mill;
  const double x = mill.axis("X").command, feed_x = mill.axis("X").command_velocity;
  bool driven = true, brake_open = true;
  int engaging = 0;
  mill.after_cycle = [&] {  // what moves is driven, and no brake closes against it
    for (const char* letter : {"X", "Y", "Z"})
      driven &= !mill.axis(letter).moving || mill.axis(letter).drive_command.power;
    const image::AxisImage& z = mill.axis("Z");
    brake_open &= !z.moving || z.drive_command.brake_release;
    engaging += !z.drive_command.brake_release && z.drive_command.power;
  };
  mill.control().world().set_input("estop_chain_ok", false);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kEmergencyStop) > 0; }, 0.1));
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
  // 1000 mm/s2, 10 000 mm/s3: v (v / a + a / j) / 2
  EXPECT_LT(mill.axis("X").actual - x, feed_x * (feed_x / 1000.0 + 0.1) / 2.0 + 1.0) << "nothing coasts";
  const double z = mill.true_position(2);
  mill.run(2.0);
  EXPECT_TRUE(driven);
  EXPECT_TRUE(brake_open);
  EXPECT_NEAR(engaging, 110, 2) << "the drive of Z holds until its brake, told within ten cycles, has closed";
  for (const char* letter : {"X", "Y", "Z"}) EXPECT_FALSE(mill.axis(letter).drive_command.power) << letter;
  EXPECT_NEAR(mill.true_position(2), z, 0.1) << "the load does not drop";
  EXPECT_EQ(mill.judge().verdict(), "");
  EXPECT_EQ(mill.process().state, ProcessState::stopped_by_alarm);
  // One fault with one cause: everything else is its consequence.
  const auto history = mill.control().cycle().alarms().history();
  ASSERT_FALSE(history.empty());
  for (const image::AlarmRecord& r : history)
    EXPECT_EQ(r.first_fault, history.front().sequence) << mill.alarm_list();
  EXPECT_EQ(history.front().number, cycle::alarm::kEmergencyStop) << mill.alarm_list();
  EXPECT_EQ(mill.alarms(axis::alarm::kEnableWithdrawn), 0)
      << "that the PLC takes the enable away with the power says nothing new: " << mill.alarm_list();
}

TEST(Faults, emergency_stop_at_any_moment_ends_within_the_time_that_check_tells_for_the_safety_relay) {
  double told = 0.0;
  const machine::LoadResult loaded = changed_mill([](std::string&) {});
  for (const machine::Consequence& c : machine::consequences(loaded))
    if (c.subject == "emergency stop") told = c.figures.at("stop_time");
  ASSERT_GT(told, 0.0);
  std::mt19937 random(static_cast<unsigned>(servogate::test::property_seed()));
  for (int n = 0; n < 40; ++n) {
    Mill mill("N10 G90 G94 G71 G29\nN20 G0 X280 Y-280 Z-250\nN30 G0 X-280 Y280 Z0\nN40 M30\n");
    ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
    ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
    mill.run(0.05 + 0.001 * static_cast<double>(random() % 2500));
    mill.control().world().set_input("estop_chain_ok", false);
    EXPECT_TRUE(mill.until(
        [&] {
          return !mill.axis("X").drive_command.power && !mill.axis("Y").drive_command.power &&
                 !mill.axis("Z").drive_command.power;
        },
        told + 0.002))
        << n;
    EXPECT_EQ(mill.judge().verdict(), "") << n;
  }
}

TEST(Faults, power_that_is_asked_for_while_the_axes_ramp_down_is_refused_and_nothing_coasts) {
  for (const bool emergency : {true, false}) {
    Mill mill("N10 G90 G94 G71 G29\nN20 G0 X280 Y-280 Z-250\nN30 M30\n");
    ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
    ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
    ASSERT_TRUE(mill.until([&] { return mill.axis("X").command_velocity > 450.0; }, 5.0));
    if (emergency) {
      mill.control().world().set_input("estop_chain_ok", false);
      mill.run(0.03);
      mill.control().world().set_input("estop_chain_ok", true);
      mill.run(0.03);
      ASSERT_EQ(mill.ask(RequestKind::reset), Refusal::none);
    } else {
      ASSERT_EQ(mill.ask(RequestKind::power, 0.0), Refusal::none);
    }
    for (int n = 0; n < 300; ++n) {  // an impatient hand
      if (mill.ask(RequestKind::power, 1.0) == Refusal::none) break;
      EXPECT_EQ(mill.answer().refusal, static_cast<std::uint16_t>(Refusal::switching_off));
      mill.run(0.003);
    }
    EXPECT_TRUE(mill.standing()) << "it is switched on at rest only";
    EXPECT_LT(mill.axis("X").actual, 300.0);
    EXPECT_EQ(mill.judge().verdict(), "");
    EXPECT_TRUE(mill.until([&] { return mill.axis("Z").enabled; }, 3.0)) << mill.alarm_list();
    EXPECT_EQ(mill.alarms(axis::alarm::kBrakeNoTorque) + mill.alarms(axis::alarm::kEnableWithdrawn), 0)
        << mill.alarm_list();
  }
}

TEST(Faults, requests_on_the_way_from_a_reset_to_rest_are_told_that_the_program_stops) {
  Mill mill("N10 G90 G94 G71 G29\nN20 G0 X280 Y-280 Z-250\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").command_velocity > 450.0; }, 5.0));
  EXPECT_EQ(mill.ask(RequestKind::home), Refusal::program_runs);
  ASSERT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  for (const RequestKind k : {RequestKind::home, RequestKind::start, RequestKind::resume, RequestKind::step})
    EXPECT_EQ(mill.ask(k), Refusal::program_stopping) << static_cast<int>(k);
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 3.0));
  mill.run(0.1);
  EXPECT_EQ(mill.ask(RequestKind::home), Refusal::none);
}

TEST(Faults, drives_that_are_still_being_switched_off_are_not_advised_to_be_switched_on_at_once) {
  Mill mill("N10 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const auto missing = [&] {
    return gateway::missing_for_power(mill.control(), mill.image(), cycle::AlarmSnapshot{},
                                      text::Language::english);
  };
  EXPECT_TRUE(missing().empty());
  ASSERT_EQ(mill.ask(RequestKind::power, 0.0), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return !mill.axis("X").enabled; }, 1.0));
  ASSERT_TRUE(mill.axis("Z").drive_command.power) << "its brake closes";
  ASSERT_EQ(missing().size(), 1u);
  EXPECT_EQ(missing()[0].reason, "switching_off");
  EXPECT_EQ(missing()[0].remedy, "Wait until they are off, then `servogate power on`.");
  EXPECT_EQ(mill.ask(RequestKind::home), Refusal::switching_off);
  EXPECT_EQ(mill.ask(RequestKind::jog_increment, 1.0, 0), Refusal::switching_off) << "X is off, but Z is not";
  ASSERT_TRUE(mill.until([&] { return !mill.axis("Z").drive_command.power; }, 1.0));
  mill.run(0.01);
  EXPECT_EQ(missing()[0].reason, "not_asked");
}

TEST(Faults, spindle_of_the_mill_ramps_down_under_power_in_an_emergency_stop) {
  Mill mill("N10 G90 G94 G71\nN20 S3000 M3\nN30 G4 TMR=60\nN40 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  const image::SpindleImage& spindle = mill.image().spindles[0];
  ASSERT_TRUE(mill.until([&] { return spindle.at_speed; }, 10.0)) << mill.alarm_list();
  const auto contactor = [&] {
    return mill.image().packets.bit(place_of(mill.control(), "spindle_contactor"));
  };
  mill.control().world().set_input("estop_chain_ok", false);
  bool held = true;
  EXPECT_TRUE(mill.until(
      [&] {
        const bool turns = std::abs(spindle.actual_rpm) > 10.0;
        held = held && (!turns || contactor());
        return !turns;
      },
      1.5))
      << "3000 rpm at 3000 rpm/s, still " << spindle.actual_rpm;
  EXPECT_TRUE(held) << "the contactor falls at rest only";
  EXPECT_TRUE(mill.until([&] { return !contactor(); }, 1.0));
}

TEST(Faults, no_program_and_no_typed_block_starts_on_a_limit_switch) {
  Mill mill("N10 G90 G94 G71\nN20 G1 X20 F3000\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.control().world().play_input("x_limit_plus", {1.0});
  mill.run(0.1);
  ASSERT_TRUE(mill.axis("X").limit_plus);
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::on_hard_limit);
  EXPECT_TRUE(mill.standing());
}

TEST(Faults, relay_that_takes_the_torque_at_once_closes_the_brake_of_z_at_once) {
  Moving mill;
  mill.control().world().set_input("estop_chain_ok", false);
  for (const char* node : {"can.x", "can.y", "can.z"})
    mill.control().world().drive(node)->set_safe_torque_off(false);
  const double z = mill.true_position(2);
  mill.run(0.01);
  EXPECT_FALSE(mill.axis("Z").drive_command.brake_release) << "stop category 0: no ramp can be waited for";
  mill.run(2.0);
  const double rest = mill.true_position(2);
  EXPECT_NEAR(rest, z, 20.0);
  mill.run(1.0);
  EXPECT_NEAR(mill.true_position(2), rest, 0.01);
  const auto history = mill.control().cycle().alarms().history();
  ASSERT_FALSE(history.empty());
  EXPECT_EQ(history.front().number, cycle::alarm::kEmergencyStop) << mill.alarm_list();
  for (const image::AlarmRecord& r : history)
    EXPECT_EQ(r.first_fault, history.front().sequence) << mill.alarm_list();
}

TEST(Faults, drives_stay_off_after_an_emergency_stop_until_somebody_wants_them_on_again) {
  Moving mill;
  mill.control().world().set_input("estop_chain_ok", false);
  mill.run(2.0);
  mill.control().world().set_input("estop_chain_ok", true);
  mill.run(0.1);
  ASSERT_EQ(mill.ask(RequestKind::reset), Refusal::none);
  mill.run(1.0);
  EXPECT_FALSE(mill.image().packets.bit(place_of(mill.control(), "MC.power_request")))
      << "the wish of before the stop has gone, for the PLC, too";
  for (const char* letter : {"X", "Y", "Z"}) EXPECT_FALSE(mill.axis(letter).drive_command.power) << letter;
  ASSERT_TRUE(mill.power_on()) << mill.alarm_list();
}

TEST(Faults, after_an_emergency_stop_the_machine_is_made_ready_and_works_again) {
  Moving mill;
  mill.control().world().set_input("estop_chain_ok", false);
  mill.run(1.0);
  EXPECT_NE(mill.ask(RequestKind::power, 1.0), Refusal::none);
  mill.control().world().set_input("estop_chain_ok", true);
  mill.run(0.2);
  EXPECT_FALSE(mill.axis("X").drive_command.power) << "nothing comes on unasked";
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; })) << mill.alarm_list();
}

TEST(Faults, of_one_drive_stops_the_healthy_axes_together_within_their_limits) {
  Moving mill;
  mill.inject("can.y", fault::Kind::over_current);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::stopped_by_alarm; }, 2.0))
      << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
  EXPECT_EQ(mill.alarms(axis::alarm::kDriveFault), 1) << mill.alarm_list();
  const auto history = mill.control().cycle().alarms().history();
  for (const image::AlarmRecord& r : history)
    if (r.number == axis::alarm::kDriveFault) {
      EXPECT_EQ(r.axis, 1);
      EXPECT_EQ(r.detail.get<image::DriveReport>().value_or(image::DriveReport{}).error_code, 0x2310);
      EXPECT_EQ(r.line, 2);
    }
  // X and Z on one line still: their ways keep the ratio of the programmed line.
  EXPECT_NEAR(mill.axis("Z").command / mill.axis("X").command, -50.0 / 200.0, 1e-3);
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, of_drives_have_the_words_of_their_own_device_file_or_of_the_standard) {
  Mill mill(kLine);
  const auto said = [&](int number, std::uint16_t code) {
    image::AlarmRecord r;
    r.number = number;
    const bool spindle = number == axis::alarm::kSpindleDriveFault;
    r.axis = static_cast<std::int8_t>(spindle ? -1 : 0);
    r.part = {0, static_cast<std::int16_t>(spindle ? 4 : 1)};
    r.detail.put(image::DriveReport{0, code, 0, 0});
    return image::render(r, mill.control().alarm_names(), text::Language::english);
  };
  const auto has = [](const std::string& text, const char* words) {
    return text.find(words) != std::string::npos;
  };
  const std::string spindle = said(axis::alarm::kSpindleDriveFault, 0x8400);
  EXPECT_TRUE(has(spindle, "(speed controller: deviation too large)")) << spindle;
  const std::string axis = said(axis::alarm::kDriveFault, 0x8611);
  EXPECT_TRUE(has(axis, "(following error too large)")) << axis;
  const std::string standard = said(axis::alarm::kDriveFault, 0x8130);
  EXPECT_TRUE(has(standard, "0x8130 (") && has(standard, "heartbeat")) << standard;
  const std::string none = said(axis::alarm::kDriveFault, 0);
  EXPECT_TRUE(has(none, "error without a code")) << none;
}

TEST(Faults, node_that_falls_silent_stops_the_program_and_is_named) {
  Moving mill;
  mill.inject("can.y", fault::Kind::silent);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::stopped_by_alarm; }, 2.0))
      << mill.alarm_list();
  mill.run(1.0);
  EXPECT_TRUE(mill.alarms(axis::alarm::kPdoMissing) + mill.alarms(axis::alarm::kDriveOffline) +
                  mill.alarms(cycle::alarm::kNodeLost) >
              0)
      << mill.alarm_list();
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
    EXPECT_TRUE(r.axis < 0 || r.axis == 1) << r.number;
  EXPECT_TRUE(mill.standing());
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, open_door_holds_the_feed_on_the_path_and_only_a_resume_behind_the_closed_one_goes_on) {
  Moving mill;
  mill.control().world().set_input("door_closed", false);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::held; }, 2.0))
      << mill.alarm_list();
  EXPECT_LT(off_line(mill.image()), 1e-4);
  mill.run(0.5);
  EXPECT_EQ(mill.ask(RequestKind::resume), Refusal::feed_not_enabled);
  mill.run(0.5);
  EXPECT_TRUE(mill.standing());
  mill.control().world().set_input("door_closed", true);
  mill.run(2.0);
  EXPECT_TRUE(mill.standing()) << "closing a guard starts nothing";
  EXPECT_EQ(mill.process().state, ProcessState::held);
  ASSERT_EQ(mill.ask(RequestKind::resume), Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; })) << mill.alarm_list();
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, spindle_that_an_open_door_stopped_runs_up_after_the_resume_and_before_the_feed) {
  Mill mill("N10 G90 G94 G71\nN20 S1000 M3\nN30 G1 X200 F1200\nN40 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").command > 5.0; })) << mill.alarm_list();
  const image::SpindleImage& spindle = mill.image().spindles[0];
  EXPECT_TRUE(spindle.at_speed);
  mill.control().world().set_input("door_closed", false);
  ASSERT_TRUE(mill.until([&] { return mill.standing() && std::abs(spindle.actual_rpm) < 5.0; }, 10.0));
  mill.control().world().set_input("door_closed", true);
  mill.run(2.0);
  EXPECT_LT(std::abs(spindle.actual_rpm), 5.0) << "closing a guard starts nothing";
  EXPECT_TRUE(mill.standing());
  bool moved_early = false;
  mill.after_cycle = [&] { moved_early |= !mill.standing() && !spindle.at_speed; };
  ASSERT_EQ(mill.ask(RequestKind::resume), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return !mill.standing(); }, 10.0)) << mill.alarm_list();
  EXPECT_FALSE(moved_early) << "the tool would cut without turning";
  mill.after_cycle = {};
  EXPECT_TRUE(mill.until([&] { return mill.process().state == ProcessState::ended; })) << mill.alarm_list();
}

TEST(Faults, spindle_that_an_open_door_stopped_stays_off_when_the_program_is_given_up) {
  for (const bool before_closing : {true, false}) {
    Mill mill("N10 G90 G94 G71\nN20 S1000 M3\nN30 G1 X200 F1200\nN40 M30\n");
    ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
    ASSERT_EQ(mill.ask(RequestKind::start), Refusal::none);
    ASSERT_TRUE(mill.until([&] { return mill.axis("X").command > 5.0; })) << mill.alarm_list();
    const image::SpindleImage& spindle = mill.image().spindles[0];
    const auto give_up = [&] { EXPECT_EQ(mill.ask(RequestKind::stop), Refusal::none); };
    mill.control().world().set_input("door_closed", false);
    ASSERT_TRUE(mill.until([&] { return mill.standing() && std::abs(spindle.actual_rpm) < 5.0; }, 10.0));
    if (before_closing) give_up();
    mill.control().world().set_input("door_closed", true);
    mill.run(0.5);
    if (!before_closing) give_up();
    mill.run(3.0);
    EXPECT_LT(std::abs(spindle.actual_rpm), 5.0) << before_closing;
    EXPECT_FALSE(mill.image().packets.bit(place_of(mill.control(), "spindle_contactor")));
  }
}

TEST(Faults, behind_an_open_door_nothing_starts_homes_or_jogs_and_what_jogs_comes_to_rest) {
  Mill mill("N10 G90 G94 G71\nN20 G1 X20 F3000\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  const auto door = [&](bool closed) {
    mill.control().world().set_input("door_closed", closed);
    mill.run(0.1);
  };
  door(false);
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::feed_not_enabled);
  EXPECT_EQ(
      cycle::render(mill.answer(), {"X", "Y", "Z"}, text::Language::english),
      "X: the PLC does not permit motion: X.feed_enable is FALSE (an open door, for example; the PLC program "
      "shows the reason)");
  ASSERT_EQ(mill.ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  EXPECT_EQ(mill.ask(RequestKind::jog_increment, 1.0, 0), Refusal::feed_not_enabled);
  EXPECT_EQ(mill.ask(RequestKind::jog_continuous, 1.0, 1), Refusal::feed_not_enabled);
  ASSERT_EQ(mill.ask(RequestKind::mode, static_cast<double>(image::Mode::home)), Refusal::none);
  EXPECT_EQ(mill.ask(RequestKind::home), Refusal::feed_not_enabled);
  EXPECT_TRUE(mill.standing());
  EXPECT_TRUE(mill.axis("X").enabled) << "the drives stay on";

  door(true);
  ASSERT_EQ(mill.ask(RequestKind::mode, static_cast<double>(image::Mode::manual)), Refusal::none);
  ASSERT_EQ(mill.ask(RequestKind::jog_increment, 100.0, 0), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.axis("X").command > 5.0; }, 5.0));
  mill.control().world().set_input("door_closed", false);
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
  EXPECT_LT(mill.axis("X").command, 99.0);
  door(true);
  EXPECT_TRUE(mill.standing()) << "closing it moves nothing by hand";
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, stop_of_the_operator_leaves_the_axes_on_the_path) {
  Moving mill;
  ASSERT_EQ(mill.ask(RequestKind::stop), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == ProcessState::idle && mill.standing(); }, 2.0));
  EXPECT_LT(off_line(mill.image()), 1e-4);
  EXPECT_GT(mill.axis("X").command, 10.0);
  EXPECT_EQ(mill.judge().verdict(), "");
  EXPECT_EQ(mill.alarms(axis::alarm::kFollowingError), 0);
}

TEST(Faults, quick_stop_of_the_operator_is_an_alarm_and_takes_the_drives_own_way) {
  Moving mill;
  ASSERT_EQ(mill.ask(RequestKind::quick_stop), Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 2.0));
  mill.run(0.5);
  EXPECT_EQ(mill.alarms(cycle::alarm::kOperatorQuickStop), 1) << mill.alarm_list();
  EXPECT_EQ(mill.process().state, ProcessState::stopped_by_alarm);
  const double x = mill.true_position(0);
  mill.run(0.5);
  EXPECT_NEAR(mill.true_position(0), x, 0.01);
}

TEST(Faults, hard_limit_permits_motion_only_away_from_it_and_slowly) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.ask(RequestKind::mode, static_cast<double>(Mode::manual));
  ASSERT_EQ(mill.ask(RequestKind::jog_increment, 50.0, 0), Refusal::none);
  mill.run(0.3);
  ASSERT_EQ(mill.control().world().play_input("x_limit_plus", {1.0}), mock::World::Played::done);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(axis::alarm::kHardLimitPlus) > 0; }, 0.5))
      << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
  EXPECT_LT(mill.axis("X").command, 45.0);
  mill.ask(RequestKind::reset);
  mill.run(0.3);
  EXPECT_EQ(mill.ask(RequestKind::jog_increment, 1.0, 0), Refusal::on_hard_limit);
  ASSERT_EQ(mill.ask(RequestKind::jog_increment, -2.0, 0), Refusal::none) << mill.alarm_list();
  double fastest = 0.0;
  mill.after_cycle = [&] { fastest = std::max(fastest, std::abs(mill.axis("X").command_velocity)); };
  mill.run(0.5);
  EXPECT_GT(fastest, 1.0);
  EXPECT_LE(fastest, 10.0 * 1.001) << "slowly away from the limit";
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, axis_that_is_not_homed_jogs_slowly_and_refuses_auto_by_name) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.power_on()) << mill.alarm_list();
  mill.ask(RequestKind::mode, static_cast<double>(Mode::automatic));
  EXPECT_EQ(mill.ask(RequestKind::start), Refusal::not_homed);
  mill.ask(RequestKind::mode, static_cast<double>(Mode::manual));
  ASSERT_EQ(mill.ask(RequestKind::jog_increment, 3.0, 1), Refusal::none);
  double fastest = 0.0;
  mill.after_cycle = [&] { fastest = std::max(fastest, std::abs(mill.axis("Y").command_velocity)); };
  mill.run(1.0);
  EXPECT_GT(fastest, 5.0);
  EXPECT_LE(fastest, 10.0 * 1.001);
}

TEST(Faults, an_axis_that_does_not_stand_yet_is_named_where_it_refuses_the_next_jog) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::mode, static_cast<double>(Mode::manual)), Refusal::none);
  ASSERT_EQ(mill.ask(RequestKind::jog_continuous, 1.0, 1), Refusal::none);
  mill.run(0.05);
  ASSERT_EQ(mill.ask(RequestKind::jog_stop, 0.0, 1), Refusal::none);
  ASSERT_EQ(mill.ask(RequestKind::jog_continuous, -1.0, 1), Refusal::axis_moves);
  EXPECT_EQ(mill.answer().axis, 1);
}

TEST(Faults, continuous_jog_without_keep_alive_begins_to_stop_within_100_ms) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.ask(RequestKind::mode, static_cast<double>(Mode::manual));
  ASSERT_EQ(mill.ask(RequestKind::jog_continuous, 1.0, 0), Refusal::none);
  for (int i = 0; i < 20; ++i) {
    mill.post(RequestKind::keep_alive);
    mill.run(0.05);
  }
  EXPECT_NEAR(mill.axis("X").command_velocity, 100.0, 1e-6) << "kept alive it runs on";
  mill.run(0.11);
  EXPECT_LT(mill.axis("X").command_velocity, 100.0);
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Faults, one_living_hand_keeps_no_other_jog_alive) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.ask(RequestKind::mode, static_cast<double>(Mode::manual));
  const auto say = [&mill](std::uint32_t client, RequestKind kind, int axis, double value = 0.0) {
    image::Request r;
    r.kind = kind;
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    r.client = client;
    mill.post(r);
  };
  say(1, RequestKind::jog_continuous, 0, 1.0);
  say(2, RequestKind::jog_continuous, 1, -1.0);
  for (int i = 0; i < 20; ++i) {
    say(2, RequestKind::keep_alive, i % 2 == 0 ? 1 : -1);
    say(2, RequestKind::keep_alive, 0);
    mill.run(0.05);
  }
  EXPECT_EQ(mill.axis("X").command_velocity, 0.0) << "the hand on X is dead";
  EXPECT_EQ(mill.axis("X").jog_end, image::JogEnd::silent);
  EXPECT_NEAR(mill.axis("Y").command_velocity, -100.0, 1e-6) << "and Y goes on in its own";
  say(1, RequestKind::jog_stop, 1, 1.0);
  mill.run(0.02);
  EXPECT_NEAR(mill.axis("Y").command_velocity, -100.0, 1e-6) << "nor ends a dead hand another's jog";
  mill.run(0.2);
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 1.0));
}

TEST(Faults, the_jog_button_of_the_plc_keeps_no_jog_of_a_client_alive) {
  Mill mill(kLine);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.ask(RequestKind::mode, static_cast<double>(Mode::manual));
  ASSERT_EQ(mill.ask(RequestKind::jog_continuous, 1.0, 0), Refusal::none);
  mill.run(0.05);
  const image::Place button = image::field(image::kAxisFields, "jog_plus", image::axis_base(0));
  image::Request force;
  force.kind = RequestKind::force;
  force.packet = static_cast<std::uint8_t>(button.packet);
  force.format = static_cast<std::uint8_t>(button.format);
  force.index = button.index;
  force.value = 1.0;
  mill.post(force);
  mill.run(1.0);
  EXPECT_EQ(mill.axis("X").command_velocity, 0.0);
  EXPECT_EQ(mill.axis("X").jog_end, image::JogEnd::silent);
}

}  // namespace
}  // namespace servogate::machine_run
