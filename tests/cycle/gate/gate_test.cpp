// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/cycle/gate/rig.hpp"
#include "tests/property_seed.hpp"

namespace servogate::cycle {
namespace {

using image::Asker;
using image::AxisOwner;
using image::Format;
using image::Packet;
using image::Place;
using image::ProcessState;
using image::Reaction;
using image::Request;
using image::RequestKind;
using Gate = test::GateRig;

TEST_F(Gate, lets_every_request_pass_on_a_machine_that_is_ready) {
  EXPECT_EQ(ask(RequestKind::power, -1, 1), Refusal::none);
  EXPECT_EQ(ask(RequestKind::home), Refusal::none);
  EXPECT_EQ(ask(RequestKind::home, 1), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, -2.5), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 1), Refusal::none);
  EXPECT_EQ(ask(RequestKind::keep_alive, 0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_stop, 0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::zero, 0, 12), Refusal::none);
  EXPECT_EQ(ask(RequestKind::mode, -1, 2), Refusal::none);
  EXPECT_EQ(ask(RequestKind::start), Refusal::none);
  EXPECT_EQ(ask(RequestKind::step), Refusal::none);
  EXPECT_EQ(ask(RequestKind::override_feed, -1, 1.5), Refusal::none);
  EXPECT_EQ(english(), "");
}

TEST_F(Gate, always_lets_a_stop_pass_whoever_asks_and_whatever_is_wrong) {
  context_.reaction = Reaction::power_off;
  context_.first_alarm = alarm::kPlcFault;
  context_.homing_runs = context_.manual_held = true;
  context_.holder = Asker::pendant;
  image_.processes[0].state = ProcessState::running;
  for (int a = 0; a <= static_cast<int>(Asker::bench); ++a)
    for (const RequestKind k :
         {RequestKind::hold, RequestKind::stop, RequestKind::quick_stop, RequestKind::jog_stop})
      EXPECT_EQ(ask(k, -1, 0, static_cast<Asker>(a)), Refusal::none) << a << " " << static_cast<int>(k);
  for (const RequestKind k : {RequestKind::reset, RequestKind::acknowledge, RequestKind::power})
    EXPECT_EQ(ask(k, -1, 0), Refusal::none);
}

TEST_F(Gate, refuses_auto_by_name_while_an_axis_is_not_homed_but_lets_it_jog) {
  not_homed(1);
  EXPECT_EQ(ask(RequestKind::start), Refusal::not_homed);
  EXPECT_EQ(english(), "Y is not homed: run `servogate home Y` first");
  EXPECT_EQ(russian(), "Y не выведена в ноль: сначала выполните `servogate home Y`");
  EXPECT_EQ(ask(RequestKind::zero, 1), Refusal::not_homed);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::home, 1), Refusal::none);
}

TEST_F(Gate, names_the_axis_that_is_without_power_or_without_feed_enable) {
  axes_[1].request_power(false);
  run(20);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0), Refusal::not_powered);
  EXPECT_EQ(ask(RequestKind::home), Refusal::not_powered);
  EXPECT_EQ(answer_.axis, 1);
  EXPECT_EQ(ask(RequestKind::start), Refusal::not_powered);
  axes_[1].request_power(true);
  run(20);
  set(1, "feed_enable", false);
  run(1);
  EXPECT_EQ(ask(RequestKind::jog_continuous, 1, 1), Refusal::feed_not_enabled);
  EXPECT_EQ(english(),
            "Y: the PLC does not permit motion: Y.feed_enable is FALSE (an open door, for example; the PLC "
            "program shows the reason)");
}

TEST_F(Gate, tells_who_wants_to_move_an_axis_that_is_being_switched_off_to_wait) {
  ASSERT_TRUE(axes_[1].jog_increment(20.0));
  run(30);
  axes_[1].request_power(false);
  run(1);
  for (const RequestKind k : {RequestKind::home, RequestKind::start, RequestKind::step, RequestKind::power})
    EXPECT_EQ(ask(k, -1, k == RequestKind::power ? 1.0 : 0.0), Refusal::switching_off);
  EXPECT_EQ(english(),
            "Y is still being switched off: wait until the drives are off, then `servogate power on`");
}

TEST_F(Gate, lets_nothing_move_while_a_fault_is_active_but_warnings_do_not_matter) {
  context_.reaction = Reaction::warn;
  context_.first_alarm = alarm::kStarved;
  EXPECT_EQ(ask(RequestKind::start), Refusal::none);
  context_.reaction = Reaction::stop_at_block_end;
  EXPECT_EQ(ask(RequestKind::start), Refusal::alarm_active);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::none);
  context_.reaction = Reaction::stop_axes;
  context_.first_alarm = axis::alarm::kFollowingError;
  for (const RequestKind k : {RequestKind::start, RequestKind::step, RequestKind::home})
    EXPECT_EQ(ask(k), Refusal::alarm_active);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::alarm_active);
  EXPECT_EQ(ask(RequestKind::power, -1, 1.0), Refusal::alarm_active);
  EXPECT_EQ(english(), "alarm 1001 is active: remove its cause and reset first");
  context_.first_alarm = alarm::kEmergencyStop;
  EXPECT_EQ(ask(RequestKind::power, -1, 1.0), Refusal::emergency_stop);
}

TEST_F(Gate, keeps_manual_motion_and_programs_apart) {
  for (const ProcessState s : {ProcessState::running, ProcessState::held, ProcessState::waiting}) {
    image_.processes[0].state = s;
    EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::program_runs);
    EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 1.0), Refusal::program_runs);
    EXPECT_EQ(ask(RequestKind::home), Refusal::program_runs);
    EXPECT_EQ(ask(RequestKind::zero, 0), Refusal::program_runs);
    EXPECT_EQ(ask(RequestKind::mode, -1, 1), Refusal::program_runs);
    EXPECT_EQ(ask(RequestKind::start), s == ProcessState::running ? Refusal::program_runs : Refusal::none);
  }
  for (const ProcessState s : {ProcessState::idle, ProcessState::ended, ProcessState::stopped_by_alarm}) {
    image_.processes[0].state = s;
    EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::none);
    EXPECT_EQ(ask(RequestKind::resume), Refusal::program_does_not_run);
  }
  ASSERT_TRUE(axes_[0].jog_increment(20.0));
  run(30);
  EXPECT_EQ(ask(RequestKind::start), Refusal::axis_moves);
  EXPECT_EQ(english(), "X moves: wait until it stands");
  EXPECT_EQ(ask(RequestKind::home), Refusal::axis_moves);
  EXPECT_EQ(ask(RequestKind::zero, 0), Refusal::axis_moves);
}

TEST_F(Gate, lets_a_program_that_waits_at_M00_or_at_a_block_end_go_on) {
  image_.processes[0].state = ProcessState::waiting;
  image_.processes[0].mode = image::Mode::step;
  for (const RequestKind k : {RequestKind::start, RequestKind::step, RequestKind::resume})
    EXPECT_EQ(ask(k), Refusal::none);
}

TEST_F(Gate, does_not_step_a_program_that_was_started_as_a_whole) {
  image_.processes[0].mode = image::Mode::automatic;
  for (const ProcessState s : {ProcessState::held, ProcessState::waiting}) {
    image_.processes[0].state = s;
    EXPECT_EQ(ask(RequestKind::step), Refusal::not_stepping) << english();
    EXPECT_EQ(ask(RequestKind::resume), Refusal::none);
  }
}

TEST_F(Gate, homes_the_axes_of_a_mask_and_refuses_a_mask_of_axes_that_do_not_exist) {
  EXPECT_EQ(ask(RequestKind::home, -1, 1.0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::home, -1, 65536.0 * 65536.0), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::home, -1, -1.0), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::home, -1, 0.5), Refusal::bad_value);
  image::Request request;
  request.kind = RequestKind::home;
  request.value = 5.0;
  EXPECT_EQ(homing_mask(request, axes_), 5u);
  request.value = 0.0;
  EXPECT_EQ(homing_mask(request, axes_), 3u);
  request.axis = 2;
  EXPECT_EQ(homing_mask(request, axes_), 4u);
}

TEST_F(Gate, resumes_and_steps_only_a_program_that_is_held) {
  image_.processes[0].state = ProcessState::running;
  EXPECT_EQ(ask(RequestKind::resume), Refusal::program_not_held);
  EXPECT_EQ(ask(RequestKind::step), Refusal::program_runs);
  image_.processes[0].state = ProcessState::held;
  image_.processes[0].mode = image::Mode::step;
  EXPECT_EQ(ask(RequestKind::resume), Refusal::none);
  EXPECT_EQ(ask(RequestKind::step), Refusal::none);
  context_.reaction = Reaction::stop_on_path;
  EXPECT_EQ(ask(RequestKind::resume), Refusal::alarm_active);
}

TEST_F(Gate, wants_a_program_the_right_mode_and_the_permission_to_start) {
  image_.processes[0].mode = image::Mode::manual;
  EXPECT_EQ(ask(RequestKind::start), Refusal::wrong_mode);
  EXPECT_EQ(english(), "not possible in mode MANU");
  image_.processes[0].mode = image::Mode::automatic;
  EXPECT_EQ(ask(RequestKind::start), Refusal::none);
  context_.start_permitted = false;
  EXPECT_EQ(ask(RequestKind::start), Refusal::start_not_permitted);
  context_.program_loaded = false;
  EXPECT_EQ(ask(RequestKind::start), Refusal::no_program);
}

TEST_F(Gate, blocks_everybody_but_the_one_who_holds_manual_control) {
  context_.manual_held = true;
  context_.holder = Asker::pendant;
  for (const Asker a : {Asker::command_line, Asker::page, Asker::plc, Asker::scenario}) {
    EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0, a), Refusal::manual_held);
    EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 1.0, a), Refusal::manual_held);
    EXPECT_EQ(ask(RequestKind::keep_alive, 0, 0.0, a), Refusal::manual_held)
        << "nobody may keep another's jog alive";
    EXPECT_EQ(ask(RequestKind::home, -1, 0.0, a), Refusal::manual_held);
    EXPECT_EQ(ask(RequestKind::start, -1, 0.0, a), Refusal::manual_held);
    EXPECT_EQ(ask(RequestKind::mode, -1, 2.0, a), Refusal::manual_held);
  }
  EXPECT_EQ(english(), "the pendant holds manual control");
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0, Asker::pendant), Refusal::none);
  EXPECT_EQ(ask(RequestKind::keep_alive, 0, 0.0, Asker::pendant), Refusal::none);
}

TEST_F(Gate, leaves_a_continuous_jog_to_the_hand_that_began_it) {
  image_.axes[0].hand = {Asker::command_line, 7};
  ASSERT_TRUE(axes_[0].jog_continuous(1, image_.now.t_ns));
  const auto of = [this](std::uint32_t client, RequestKind kind, int axis, double value) {
    Request r;
    r.kind = kind;
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    r.client = client;
    answer_ = decide(r, context_);
    return static_cast<Refusal>(answer_.refusal);
  };
  EXPECT_EQ(of(8, RequestKind::keep_alive, 0, 0.0), Refusal::jogged_by_another);
  EXPECT_EQ(english(),
            "another client is jogging X: wait until it stops, or stop the axis (`servogate hold`)");
  EXPECT_EQ(of(8, RequestKind::jog_continuous, 0, 1.0), Refusal::jogged_by_another);
  EXPECT_EQ(of(8, RequestKind::jog_increment, 0, 1.0), Refusal::jogged_by_another);
  EXPECT_EQ(of(8, RequestKind::jog_continuous, 0, -1.0), Refusal::none) << "the executive stops it";
  EXPECT_EQ(of(8, RequestKind::jog_continuous, 1, 1.0), Refusal::none) << "another axis";
  EXPECT_EQ(of(8, RequestKind::jog_stop, 0, 0.0), Refusal::none) << "a stop is everybody's right";
  EXPECT_EQ(of(7, RequestKind::keep_alive, 0, 0.0), Refusal::none);
  EXPECT_EQ(of(7, RequestKind::jog_continuous, 0, 1.0), Refusal::none);
}

TEST_F(Gate, permits_on_a_hard_limit_only_the_way_back) {
  set(0, "limit_plus", true);
  run(1);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::on_hard_limit);
  EXPECT_EQ(
      english(),
      "X is on its limit switch: it can only be jogged away from it (`servogate jog`), so + is not possible");
  EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 1.0), Refusal::on_hard_limit);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, -1.0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0), Refusal::none);
}

TEST_F(Gate, permits_at_a_travel_limit_only_the_way_back) {
  ASSERT_TRUE(axes_[0].jog_increment(-1000.0));
  for (int i = 0; i < 20'000 && axes_[0].moving(); ++i) run(1);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, -1.0), Refusal::at_soft_limit);
  EXPECT_EQ(english(), "X is at its travel limit -300 mm already");
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::none);
}

TEST_F(Gate, lets_only_one_homing_run) {
  context_.homing_runs = true;
  EXPECT_EQ(ask(RequestKind::home), Refusal::homing_runs);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0), Refusal::homing_runs);
  EXPECT_EQ(ask(RequestKind::start), Refusal::homing_runs);
}

TEST_F(Gate, respects_an_axis_that_belongs_to_the_plc_or_the_bench) {
  ASSERT_TRUE(axes_[1].acquire(AxisOwner::plc));
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0), Refusal::axis_owned);
  EXPECT_EQ(english(), "Y belongs to the PLC");
  EXPECT_EQ(ask(RequestKind::start), Refusal::axis_owned);
  EXPECT_EQ(ask(RequestKind::jog_increment, 1, 1.0, Asker::plc), Refusal::none);
}

TEST_F(Gate, refuses_values_axes_and_processes_that_do_not_exist) {
  EXPECT_EQ(ask(RequestKind::none), Refusal::unknown_request);
  EXPECT_EQ(ask(static_cast<RequestKind>(200)), Refusal::unknown_request);
  EXPECT_EQ(ask(RequestKind::jog_increment, 2, 1.0), Refusal::no_such_axis);
  EXPECT_EQ(ask(RequestKind::jog_increment, -1, 1.0), Refusal::no_such_axis);
  EXPECT_EQ(ask(RequestKind::home, 7), Refusal::no_such_axis);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 0.0), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, std::numeric_limits<double>::quiet_NaN()), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 2.0), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::override_feed, -1, 1.51), Refusal::override_range);
  EXPECT_EQ(answer_.limit, 1.5);
  EXPECT_EQ(ask(RequestKind::mode, -1, 8), Refusal::bad_value);
  EXPECT_EQ(ask(RequestKind::mode, -1, 1.5), Refusal::bad_value);
  Request r;
  r.kind = RequestKind::start;
  r.process = 3;
  EXPECT_EQ(decide(r, context_).refusal, static_cast<std::uint16_t>(Refusal::no_such_process));
}

TEST_F(Gate, names_the_range_of_a_jog_a_zero_and_an_override_in_the_units_that_people_use) {
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 600.0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, -600.1), Refusal::jog_range);
  EXPECT_EQ(english(), "X cannot jog by -600.1 mm: from -600 to 600 mm is possible");
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1e300), Refusal::jog_range);
  EXPECT_EQ(english(), "X cannot jog by 1e+300 mm: from -600 to 600 mm is possible");
  EXPECT_EQ(ask(RequestKind::zero, 1, 99'999.999), Refusal::none);
  EXPECT_EQ(ask(RequestKind::zero, 1, -1e300), Refusal::zero_range);
  EXPECT_EQ(english(), "Y cannot be given the value -1e+300 mm: from -99999.999 to 99999.999 mm is possible");
  EXPECT_EQ(render(answer_, {"X", "C"}, text::Language::russian, {"mm", "deg"}),
            "C не может получить значение -1e+300 deg: возможно от -99999.999 до 99999.999 deg");
  EXPECT_EQ(ask(RequestKind::override_feed, -1, 2.0), Refusal::override_range);
  EXPECT_EQ(english(), "a feed override of 200 % is not possible: 0 to 150 %");
  axis::AxisConfig endless = axes_[0].config();
  endless.rotary = true;
  endless.travel_limited = false;
  axes_[0].configure(endless, 0);
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1e6), Refusal::jog_range);
}

TEST_F(Gate, decides_on_a_mode_together_with_the_request_that_needs_it) {
  const auto with_mode = [&](RequestKind kind, image::Mode mode, int axis = -1, double value = 0.0) {
    Request r;
    r.kind = kind;
    r.mode = static_cast<std::int8_t>(mode);
    r.axis = static_cast<std::int8_t>(axis);
    r.value = value;
    answer_ = decide(r, context_);
    return static_cast<Refusal>(answer_.refusal);
  };
  image_.processes[0].mode = image::Mode::manual;
  EXPECT_EQ(ask(RequestKind::start), Refusal::wrong_mode);
  EXPECT_EQ(with_mode(RequestKind::start, image::Mode::automatic), Refusal::none);
  EXPECT_EQ(with_mode(RequestKind::start, image::Mode::home), Refusal::wrong_mode);
  EXPECT_EQ(with_mode(RequestKind::jog_increment, image::Mode::manual, 0, 1.0), Refusal::none);
  EXPECT_EQ(with_mode(RequestKind::home, image::Mode::home), Refusal::none);
  EXPECT_EQ(with_mode(RequestKind::hold, image::Mode::home), Refusal::bad_value) << "a stop needs no mode";
  EXPECT_EQ(with_mode(RequestKind::home, static_cast<image::Mode>(9)), Refusal::bad_value);
  image_.processes[0].state = ProcessState::held;
  EXPECT_EQ(with_mode(RequestKind::start, image::Mode::automatic), Refusal::program_runs)
      << "the mode does not change under a program";
  EXPECT_EQ(with_mode(RequestKind::start, image::Mode::manual), Refusal::none) << "it is the mode in force";
}

TEST_F(Gate, knows_who_may_ask_for_what) {
  EXPECT_EQ(ask(RequestKind::jog_increment, 0, 1.0, Asker::modbus), Refusal::asker_may_not);
  EXPECT_EQ(english(), "whoever asks here may not ask for `jog`");
  EXPECT_EQ(ask(RequestKind::start, -1, 0.0, Asker::program), Refusal::none) << "in another process";
  EXPECT_EQ(ask(RequestKind::step, -1, 0.0, Asker::program), Refusal::asker_may_not);
  EXPECT_EQ(ask(RequestKind::power, -1, 1.0, Asker::program), Refusal::asker_may_not);
  EXPECT_EQ(ask(RequestKind::start, -1, 0.0, Asker::bench), Refusal::asker_may_not);
  EXPECT_EQ(ask_place(RequestKind::force, {}, Asker::pendant), Refusal::asker_may_not);
  EXPECT_EQ(ask_place(RequestKind::force, {}, Asker::plc), Refusal::asker_may_not);
  EXPECT_EQ(ask(RequestKind::jog_continuous, 0, 1.0, Asker::plc), Refusal::none);
}

TEST_F(Gate, names_the_command_that_helps_where_a_program_is_in_the_way_or_is_not_there) {
  const auto said = [&](RequestKind kind) { return ask(kind), english(); };
  EXPECT_EQ(said(RequestKind::resume), "no program runs: `servogate start` starts the loaded one");
  image_.processes[0].state = ProcessState::running;
  EXPECT_EQ(said(RequestKind::resume), "the program runs and is not held: `servogate hold` holds it");
  EXPECT_EQ(said(RequestKind::home), "a program runs: end it first (`servogate reset`)");
  EXPECT_EQ(russian(), "выполняется программа: сначала завершите её (`servogate reset`)");
  context_.stopping = 1;
  for (const RequestKind k : {RequestKind::start, RequestKind::step, RequestKind::resume, RequestKind::home})
    EXPECT_EQ(said(k), "the program is still stopping: ask again once the axes stand");
}

TEST_F(Gate, writes_the_operators_words_of_k_and_nothing_that_belongs_to_others) {
  using enum image::Format;
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, by, 100, 1}), Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, by, image::kInterfaceBase, 1}),
            Refusal::place_not_writable);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, ch, image::kInterfaceBase - 2, 2}), Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, ch, image::kInterfaceBase - 2, 3}),
            Refusal::place_not_writable);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, bl, (image::kMachineBase + 4) * 8, 1}),
            Refusal::place_not_writable);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, li, image::kMachineBase / 4 + 2, 1}),
            Refusal::place_not_writable)
      << "the counter of a handwheel";
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::k, by, image::kMachineBase + image::kMachineBlock, 1}),
            Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::a, bl, 8, 1}), Refusal::place_not_writable);
  EXPECT_EQ(ask_place(RequestKind::force, {Packet::a, bl, 8, 1}), Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::force, {Packet::a, lr, 127, 1}), Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::force, {Packet::a, lr, 128, 1}), Refusal::place_outside);
  EXPECT_EQ(ask_place(RequestKind::force, {Packet::a, lr, 0x20000000, 1}), Refusal::place_outside)
      << "no wrap-round";
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::v, by, 199, 1}), Refusal::none);
  EXPECT_EQ(ask_place(RequestKind::set_place, {Packet::v, by, 200, 1}), Refusal::place_outside);
}

TEST_F(Gate, has_a_whole_sentence_in_both_languages_for_every_refusal) {
  const auto table = refusal_texts();
  ASSERT_EQ(table.size(), static_cast<std::size_t>(Refusal::gear_off_place) + 1);
  for (std::size_t i = 1; i < table.size(); ++i) {
    image::Answer a;
    a.refusal = static_cast<std::uint16_t>(i);
    a.axis = 0;
    for (const auto language : {text::Language::english, text::Language::russian}) {
      const std::string sentence = render(a, {"X"}, language);
      EXPECT_GT(sentence.size(), 10u) << i;
      EXPECT_EQ(sentence.find('{'), std::string::npos) << sentence;
    }
  }
}

TEST_F(Gate, holds_the_plc_with_all_drives_off_and_at_rest_only) {
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::drives_on) << english();
  axes_[0].request_power(false);
  axes_[1].request_power(false);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::drives_on) << "they are not off yet";
  run(2000);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::none) << english();
  axes_[1].request_power(true);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::drives_on) << "wanted, not yet permitted";
  axes_[1].request_power(false);
  image_.spindle_count = 1;
  image_.spindles[0].running = true;
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::drives_on) << "a spindle coasts";
  image_.spindles[0].running = false;
  image_.processes[0].state = ProcessState::held;
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::program_runs);
  image_.processes[0].state = ProcessState::idle;
  context_.homing_runs = true;
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::homing_runs);
  context_.homing_runs = false;
  for (const Asker who : {Asker::pendant, Asker::plc, Asker::modbus, Asker::program})
    EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1, who), Refusal::asker_may_not);
}

TEST_F(Gate, lets_scan_and_go_what_is_held_only) {
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 0), Refusal::logic_not_held);
  Request scans;
  scans.kind = RequestKind::logic_scan;
  scans.value = 2.0;
  scans.index = 1;
  EXPECT_EQ(decide(scans, context_).refusal, static_cast<std::uint16_t>(Refusal::logic_not_held));
  context_.logic_held = true;
  EXPECT_EQ(decide(scans, context_).refusal, 0);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 1), Refusal::logic_held);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 0), Refusal::none);
  EXPECT_EQ(ask(RequestKind::logic_scan, -1, 3), Refusal::bad_value);
  scans.index = 0;
  EXPECT_EQ(decide(scans, context_).refusal, static_cast<std::uint16_t>(Refusal::bad_value));
  scans.index = 100'001;
  EXPECT_EQ(decide(scans, context_).refusal, static_cast<std::uint16_t>(Refusal::bad_value));
}

TEST_F(Gate, answers_any_request_in_any_state_without_going_astray) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937_64 random(seed);
  for (int i = 0; i < 200'000; ++i) {
    Request r;
    r.kind = static_cast<RequestKind>(random() % 36);
    r.asker = static_cast<Asker>(random() % 8);
    r.axis = static_cast<std::int8_t>(random() % 6 - 2);
    r.process = static_cast<std::int8_t>(random() % 4 - 1);
    r.mode = static_cast<std::int8_t>(random() % 256);
    r.packet = static_cast<std::uint8_t>(random() % 5), r.format = static_cast<std::uint8_t>(random() % 9);
    r.index = static_cast<std::uint32_t>(random()), r.length = static_cast<std::uint8_t>(random());
    r.value = std::ldexp(static_cast<double>(random() % 7) - 3.0, static_cast<int>(random() % 20) - 10);
    context_.reaction = static_cast<Reaction>(random() % 7);
    context_.manual_held = random() % 2 != 0;
    context_.holder = static_cast<Asker>(random() % 8);
    context_.homing_runs = random() % 2 != 0;
    context_.stopping = static_cast<std::uint32_t>(random() % 2);
    image_.processes[0].state = static_cast<ProcessState>(random() % 6);
    const image::Answer a = decide(r, context_);
    ASSERT_LT(a.refusal, refusal_texts().size());
    if (r.kind > RequestKind::logic && r.kind <= RequestKind::torque && r.kind != RequestKind::logic_scan) {
      ASSERT_NE(a.refusal, 0) << i << ": there is no auxiliary axis";
    }
    const bool motion = r.kind == RequestKind::home || r.kind == RequestKind::jog_increment ||
                        r.kind == RequestKind::jog_continuous || r.kind == RequestKind::start;
    if (motion && context_.reaction >= Reaction::stop_on_path) {
      ASSERT_NE(a.refusal, 0) << i;
    }
    if (motion && context_.manual_held && context_.holder != r.asker) {
      ASSERT_NE(a.refusal, 0) << i;
    }
    if (motion && context_.homing_runs) {
      ASSERT_NE(a.refusal, 0) << i;
    }
  }
}

}  // namespace
}  // namespace servogate::cycle
