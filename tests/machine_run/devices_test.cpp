// SPDX-License-Identifier: Apache-2.0
// Inputs and outputs open by a table: what no row opens is refused at its place, by `check` and by compose()
// with the same words.
#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "gateway/control/compose/devices/device_table.hpp"
#include "gateway/control/compose/devices/open_devices.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

machine::LoadResult mill_with_url(const std::string& from, const std::string& to) {
  return changed_mill(
      [&](std::string& text) { replace(text, "url = \"" + from + "\"", "url = \"" + to + "\""); });
}

std::string lines_of(const std::vector<text::Finding>& findings) {
  std::string lines;
  for (const text::Finding& f : findings) lines += f.str(text::Language::english) + "\n";
  return lines;
}

TEST(Devices, whose_url_no_row_opens_are_refused_by_check_and_by_compose_with_the_same_words) {
  for (const auto& [from, to, kind] : {std::tuple{"mock:gpio", "nothing:gpio", "station 'gpio'"},
                                       {"mock:gpio", "mock:", "station 'gpio'"},
                                       {"mock:panel", "tcp10.0.0.5", "line 'panel'"}}) {
    const machine::LoadResult loaded = mill_with_url(from, to);
    std::vector<text::Finding> checked, composed;
    EXPECT_FALSE(gateway::check_devices(loaded, checked)) << to;
    EXPECT_EQ(gateway::Control::compose(loaded, composed), nullptr) << to;
    EXPECT_EQ(lines_of(checked), lines_of(composed));
    ASSERT_EQ(checked.size(), 1u);
    EXPECT_GT(checked[0].line, 0);
    const std::string words = checked[0].str(text::Language::english);
    EXPECT_NE(words.find(std::string(kind) + ": nothing opens '" + to + "'"), std::string::npos) << words;
    EXPECT_NE(words.find("mock:NAME"), std::string::npos) << words;
    EXPECT_FALSE(gateway::Control::infrastructure(composed)) << "the file is wrong, not the computer";
  }
}

TEST(Devices, of_the_example_are_its_chip_and_its_line_in_the_order_of_the_file) {
  const machine::LoadResult loaded = machine::load(source("examples/mill/machine.toml"));
  const auto world = gateway::simulated_world(loaded);
  std::vector<text::Finding> findings;
  EXPECT_TRUE(gateway::check_devices(loaded, findings));
  EXPECT_EQ(gateway::open_devices(loaded, *world, false, findings).size(), 2u);
  EXPECT_TRUE(findings.empty()) << lines_of(findings);
}

TEST(Devices, have_one_row_for_each_scheme_of_a_kind) {
  std::set<std::pair<int, std::string_view>> seen;
  for (const gateway::DeviceRow& row : gateway::device_rows()) {
    EXPECT_TRUE(seen.emplace(static_cast<int>(row.kind), row.scheme).second) << row.scheme;
    EXPECT_TRUE(row.scheme.ends_with(':')) << row.scheme;
  }
}

TEST(Devices, a_line_whose_host_is_not_there_opens_and_its_stations_are_lost) {
  // Port 9 of loopback: nobody listens there, and if somebody does it is no Modbus.
  const machine::LoadResult loaded = mill_with_url("mock:panel", "tcp:127.0.0.1:9");
  EXPECT_FALSE(loaded.machine.nothing_real());
  Mill mill(loaded, {});
  mill.run(0.5);
  EXPECT_GT(mill.alarms(image::alarm::kSourceBad), 0) << mill.alarm_list();
  EXPECT_EQ(mill.control().world().line_of("panel"), nullptr) << "nothing is simulated in its place";
}

TEST(Devices, a_chip_that_vanishes_is_the_first_fault_and_what_goes_with_it_its_consequence) {
  Mill mill("N10 G90 G94 G71\nN20 G1 X100 F3000\nN30 M30\n");
  ASSERT_TRUE(mill.make_ready() && mill.ask(image::RequestKind::start) == cycle::Refusal::none);
  mill.run(0.5);
  mill.control().world().chip("gpio")->plug(false);
  ASSERT_TRUE(mill.until([&] { return mill.alarms(cycle::alarm::kEmergencyStop) > 0; }, 1.0));
  const auto history = mill.control().cycle().alarms().history();
  EXPECT_EQ(history.front().number, image::alarm::kSourceBad);
  EXPECT_NE(image::render(history.front(), mill.control().alarm_names(), text::Language::english)
                .find("gpio: lost"),
            std::string::npos);
  for (const image::AlarmRecord& r : history) EXPECT_EQ(r.first_fault, history.front().sequence) << r.number;
  EXPECT_EQ(mill.judge().verdict(), "");
}

TEST(Devices, a_serial_device_that_is_not_there_is_refused_by_the_computer_with_what_mends_it) {
  std::vector<text::Finding> findings;
  EXPECT_EQ(gateway::Control::compose(mill_with_url("mock:panel", "rtu:/dev/no-such-line"), findings),
            nullptr);
  EXPECT_TRUE(gateway::Control::infrastructure(findings));
  EXPECT_NE(
      lines_of(findings).find("line 'panel': there is no /dev/no-such-line: is the adapter plugged in?"),
      std::string::npos)
      << lines_of(findings);
}

TEST(Devices, that_are_real_do_not_live_in_virtual_time) {
  const machine::LoadResult loaded = mill_with_url("mock:panel", "tcp:127.0.0.1:9");
  drivers::Notice refusal;
  EXPECT_EQ(gateway::clock_of(loaded.machine, gateway::ClockKind::virtual_time, refusal),
            gateway::ClockKind::unset);
  EXPECT_NE(refusal.entry, nullptr);
  EXPECT_EQ(gateway::clock_of(loaded.machine, gateway::ClockKind::unset, refusal),
            gateway::ClockKind::realtime);
}

}  // namespace
}  // namespace servogate::machine_run
