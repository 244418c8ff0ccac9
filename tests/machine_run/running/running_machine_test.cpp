// SPDX-License-Identifier: Apache-2.0
// A whole machine through bench::Machine only, as benchmarks, bench and scenarios see it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "firmware_if/canopen/302/boot_detail.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using fault::Device;
using fault::Fault;
using fault::Kind;

std::unique_ptr<gateway::RunningMachine> running(const machine::LoadResult& loaded) {
  std::vector<text::Finding> findings;
  auto machine = gateway::RunningMachine::compose(loaded, nullptr, {}, findings);
  EXPECT_NE(machine, nullptr) << (findings.empty() ? "" : findings.front().str(text::Language::english));
  return machine;
}

std::unique_ptr<gateway::RunningMachine> mill() { return running(machine::load(mill_file())); }

void run(bench::Machine& machine, int cycles) {
  for (int n = 0; n < cycles; ++n) ASSERT_TRUE(machine.step());
}

bool online(const bench::Machine& machine, int axis) {
  return machine.image().axes[static_cast<std::size_t>(axis)].drive.online;
}

TEST(RunningMachine, takes_every_fault_of_the_vocabulary_on_a_device_that_it_happens_to) {
  const std::pair<Device, const char*> devices[] = {
      {Device::drive, "can.x"},     {Device::node, "can.x"}, {Device::bus, "can"},
      {Device::station, "panel"},   {Device::chip, "gpio"},  {Device::input, "estop_chain_ok"},
      {Device::control, "control"},
  };
  const auto machine = mill();
  run(*machine, 1000);
  for (const fault::KindRow& row : fault::kinds())
    for (const auto& [device, name] : devices) {
      if (!row.happens_to(device)) continue;
      std::string why;
      EXPECT_TRUE(machine->inject(name, {.kind = row.kind, .duration_ns = 20 * image::kMillisecond}, why))
          << row.name << " on " << name << ": " << text::in_language(why, text::Language::english);
      run(*machine, 40);
      EXPECT_TRUE(machine->clear(name, {}, why));
    }
}

TEST(RunningMachine, names_what_there_is_when_a_fault_is_put_on_nothing_or_on_the_wrong_thing) {
  const auto machine = mill();
  std::string why;
  EXPECT_FALSE(machine->inject("can.w", {.kind = Kind::silent}, why));
  const std::string nothing = text::in_language(why, text::Language::english);
  EXPECT_NE(nothing.find("can.x"), std::string::npos) << nothing;
  EXPECT_NE(nothing.find("estop_chain_ok"), std::string::npos) << nothing;
  EXPECT_FALSE(machine->inject("panel", {.kind = Kind::over_current}, why));
  const std::string wrong = text::in_language(why, text::Language::english);
  EXPECT_NE(wrong.find("silent, exception, slow, corrupt"), std::string::npos) << wrong;
  EXPECT_FALSE(machine->inject("can", {.kind = Kind::drop, .sender = 99}, why));
  EXPECT_FALSE(machine->clear("nobody", {}, why));
}

TEST(RunningMachine, an_unplugged_drive_is_lost_for_as_long_as_the_fault_lasts) {
  const auto machine = mill();
  run(*machine, 2000);
  ASSERT_TRUE(online(*machine, 0));
  std::string why;
  ASSERT_TRUE(machine->inject("can.x", {.kind = Kind::unplug, .duration_ns = image::kSecond}, why));
  run(*machine, 900);
  EXPECT_FALSE(online(*machine, 0));
  EXPECT_GT(machine->alarms().count, 0);
  run(*machine, 4000);
  EXPECT_TRUE(online(*machine, 0)) << "it is plugged in again by itself";
}

int alarms(bench::Machine& machine, image::AlarmNumber number) {
  const cycle::AlarmSnapshot& all = machine.alarms();
  int n = 0;
  for (int i = 0; i < all.count; ++i) n += all.records[static_cast<std::size_t>(i)].number == number;
  return n;
}

TEST(RunningMachine, a_dead_drive_is_lost_and_boots_again_without_its_power_when_it_is_back) {
  Mill mill;
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_TRUE(mill.axis("X").enabled);
  std::string why;
  ASSERT_TRUE(mill.machine().inject("can.x", {.kind = Kind::kill, .duration_ns = image::kSecond}, why))
      << why;
  mill.run(0.9);
  EXPECT_FALSE(mill.axis("X").drive.online);
  EXPECT_GT(mill.alarms(cycle::alarm::kNodeLost) + mill.alarms(axis::alarm::kPdoMissing), 0)
      << mill.alarm_list();
  EXPECT_TRUE(mill.standing());
  EXPECT_TRUE(mill.until([&] { return mill.axis("X").drive.online; }, 10.0)) << mill.alarm_list();
  mill.run(1.0);
  EXPECT_FALSE(mill.axis("X").enabled) << "nobody has switched it on again";
  EXPECT_FALSE(mill.axis("X").homed) << "its incremental encoder has lost the place";
}

TEST(RunningMachine, a_device_in_the_place_of_another_is_refused_at_its_boot_by_its_identity) {
  machine::LoadResult loaded = machine::load(mill_file());
  loaded.devices.at("servo-cia402").product_code = 4711;
  const auto machine = running(loaded);
  run(*machine, 2000);
  ASSERT_TRUE(online(*machine, 0)) << "the simulated drive is what the device file says";
  std::string why;
  ASSERT_TRUE(machine->inject("can.x",
                              {.kind = Kind::swapped, .duration_ns = 10 * image::kSecond, .value = 815}, why))
      << why;
  run(*machine, 9000);
  EXPECT_FALSE(online(*machine, 0));
  EXPECT_TRUE(online(*machine, 1));
  bool said = false;
  const cycle::AlarmSnapshot& all = machine->alarms();
  for (int i = 0; i < all.count; ++i) {
    const image::AlarmRecord& r = all.records[static_cast<std::size_t>(i)];
    const auto boot = r.detail.get<canopen::BootDetail>();
    said |= r.number == cycle::alarm::kBootFailed && boot && boot->index == 0x1018 && boot->subindex == 2 &&
            r.limit == 4711.0 && r.value == 815.0;
  }
  EXPECT_TRUE(said) << "1018h:02 with what was expected and what came";
  run(*machine, 6000);
  EXPECT_TRUE(online(*machine, 0)) << "the right one is back";
}

TEST(RunningMachine, a_dead_station_comes_back_with_its_outputs_off) {
  const auto machine = mill();
  run(*machine, 2000);
  const mock::ModbusStation* panel = machine->control().world().modbus("panel");
  std::string why;
  ASSERT_TRUE(machine->inject("panel", {.kind = Kind::kill}, why)) << why;
  ASSERT_TRUE(machine->inject("panel", {.kind = Kind::slow, .delay_ns = image::kMillisecond}, why));
  const auto served = panel->requests_served();
  run(*machine, 1000);
  EXPECT_LE(panel->requests_served(), served + 1) << "a dead one is not slow";
  for (std::uint16_t n = 0; n < panel->settings().digital_outputs; ++n) EXPECT_FALSE(panel->output(n)) << n;
  EXPECT_GT(machine->alarms().count, 0);
  ASSERT_TRUE(machine->clear("panel", {}, why));
  run(*machine, 3000);
  EXPECT_GT(panel->requests_served(), served + 10);
}

TEST(RunningMachine, a_cycle_that_comes_too_late_is_counted_and_stops_the_machine_on_its_path) {
  Mill mill("N10 G90 G94 G71\nN20 G1 X200 Y100 F6000\nN30 M30\n");
  mill.machine().watch({});
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  ASSERT_EQ(mill.ask(image::RequestKind::start), cycle::Refusal::none);
  mill.run(0.5);
  ASSERT_GT(mill.process().feed_mm_s, 50.0);
  const auto late = [&](image::Nanoseconds by) {
    std::string why;
    EXPECT_TRUE(mill.machine().inject("control", {.kind = Kind::late_cycle, .delay_ns = by}, why)) << why;
    mill.run(0.01);
    return mill.machine().overruns();
  };
  EXPECT_EQ(late(image::kMillisecond / 2), 0) << "within the period";
  EXPECT_EQ(late(3 * image::kMillisecond / 2), 1);
  EXPECT_EQ(mill.alarms(cycle::alarm::kOverrunLimit), 0) << "counted, and below two periods no alarm";
  EXPECT_GT(mill.process().feed_mm_s, 50.0);
  EXPECT_EQ(late(5 * image::kMillisecond), 2);
  EXPECT_EQ(mill.alarms(cycle::alarm::kOverrunLimit), 1) << mill.alarm_list();
  ASSERT_TRUE(mill.until([&] { return mill.standing(); }, 2.0));
  EXPECT_LT(mill.axis("X").command, 150.0) << "long before the end of the line";
  EXPECT_EQ(mill.judge().verdict(), "");
  EXPECT_EQ(nlohmann::json::parse(mill.machine().report())["overruns"], 2);
}

TEST(RunningMachine, drives_that_wait_longer_for_the_control_than_they_may_let_go) {
  const auto machine = mill();
  run(*machine, 2000);
  ASSERT_TRUE(online(*machine, 0));
  std::string why;
  ASSERT_TRUE(
      machine->inject("control", {.kind = Kind::late_cycle, .delay_ns = 400 * image::kMillisecond}, why));
  run(*machine, 1);
  // 1016h of the drives: they have missed the heartbeat of the control while it did not come.
  EXPECT_NE(machine->control().world().drive("can.x")->nmt_state(), canopen::NmtState::operational);
  run(*machine, 10);
  EXPECT_EQ(alarms(*machine, cycle::alarm::kOverrunLimit), 1);
}

TEST(RunningMachine, frames_of_one_sender_are_dropped_on_a_bus_and_those_of_others_are_not) {
  const auto machine = mill();
  run(*machine, 2000);
  std::string why;
  ASSERT_TRUE(machine->inject("can", {.kind = Kind::drop, .sender = 1, .count = 0}, why));
  run(*machine, 1000);
  EXPECT_FALSE(online(*machine, 0));
  EXPECT_TRUE(online(*machine, 1));
  ASSERT_TRUE(machine->clear("can", Kind::drop, why));
  run(*machine, 4000);
  EXPECT_TRUE(online(*machine, 0));
}

TEST(RunningMachine, the_end_of_one_fault_of_a_station_leaves_another_in_force) {
  const auto machine = mill();
  run(*machine, 2000);
  const mock::ModbusStation* panel = machine->control().world().modbus("panel");
  ASSERT_NE(panel, nullptr);
  std::string why;
  ASSERT_TRUE(machine->inject("panel", {.kind = Kind::slow, .duration_ns = 100 * image::kMillisecond}, why));
  ASSERT_TRUE(machine->inject("panel", {.kind = Kind::silent}, why));
  run(*machine, 300);
  ASSERT_TRUE(panel->fault());
  EXPECT_EQ(panel->fault()->kind, fault::Kind::silent);
  ASSERT_TRUE(machine->clear("panel", Kind::silent, why));
  run(*machine, 1);
  EXPECT_FALSE(panel->fault());
}

TEST(RunningMachine, a_stuck_input_stays_whatever_is_played_and_a_silent_station_is_an_alarm) {
  const auto machine = mill();
  run(*machine, 2000);
  const image::Place chain = place_of(machine->control(), "estop_chain_ok");
  ASSERT_TRUE(machine->image().packets.bit(chain));
  std::string why;
  ASSERT_TRUE(machine->inject("estop_chain_ok", {.kind = Kind::stuck, .level = false}, why));
  run(*machine, 100);
  EXPECT_FALSE(machine->image().packets.bit(chain));
  ASSERT_TRUE(machine->clear("estop_chain_ok", Kind::stuck, why));
  run(*machine, 100);
  EXPECT_TRUE(machine->image().packets.bit(chain));
  const int before = machine->alarms().count;
  ASSERT_TRUE(machine->inject("panel", {.kind = Kind::silent}, why));
  run(*machine, 3000);
  EXPECT_GT(machine->alarms().count, before);
}

class MovesByItself : public ::testing::TestWithParam<gateway::RunSettings> {};

TEST_P(MovesByItself, and_step_waits_for_news_while_faults_and_requests_come_from_outside) {
  std::vector<text::Finding> findings;
  const auto machine =
      gateway::RunningMachine::compose(machine::load(mill_file()), nullptr, GetParam(), findings);
  ASSERT_NE(machine, nullptr);
  std::vector<drivers::Notice> refusals;
  ASSERT_TRUE(machine->begin(refusals));
  const auto until = [&](const std::function<bool()>& met) {
    for (int n = 0; n < 3000; ++n) {
      if (met()) return true;
      machine->step();
    }
    return false;
  };
  EXPECT_TRUE(until([&] { return online(*machine, 0); }));
  std::string why;
  ASSERT_TRUE(machine->inject("can.x", {.kind = Kind::unplug, .duration_ns = image::kSecond}, why));
  EXPECT_TRUE(until([&] { return !online(*machine, 0); }));
  EXPECT_GT(machine->alarms().count, 0);
  EXPECT_TRUE(until([&] { return online(*machine, 0); }));
  image::Request reset;
  reset.id = 7;
  reset.kind = image::RequestKind::reset;
  ASSERT_TRUE(machine->post(reset));
  image::Answer answer;
  EXPECT_TRUE(until([&] { return machine->take(answer); }));
  EXPECT_EQ(answer.id, 7u);
  machine->stop();
  EXPECT_TRUE(machine->close_files().empty());
}

INSTANTIATE_TEST_SUITE_P(RunningMachine, MovesByItself,
                         ::testing::Values(gateway::RunSettings{.pace = 10.0},
                                           gateway::RunSettings{
                                               .clock = gateway::ClockKind::realtime_best_effort}),
                         [](const auto& named) { return named.index == 0 ? "paced" : "real_time"; });

TEST(RunningMachine, loads_plays_and_reports) {
  const Scratch scratch;
  const auto machine = mill();
  machine->watch({});
  std::vector<text::Finding> findings;
  EXPECT_FALSE(machine->load(scratch.write("bad.nc", "N10 G1 X99999 F100\nN20 M30\n"), findings));
  EXPECT_FALSE(findings.empty());
  EXPECT_TRUE(machine->load(scratch.write("good.nc", "N10 M30\n"), findings));
  std::string why;
  EXPECT_TRUE(machine->play("door_closed", 0.0, why)) << why;
  EXPECT_FALSE(machine->play("no_such_point", 0.0, why));
  EXPECT_NE(why.find("no_such_point"), std::string::npos);
  run(*machine, 100);
  const auto report = nlohmann::json::parse(machine->report());
  EXPECT_EQ(report["cycles"], 100);
  EXPECT_FALSE(report["finished"]);
}

}  // namespace
}  // namespace servogate::machine_run
