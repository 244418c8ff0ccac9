// SPDX-License-Identifier: Apache-2.0
// A drive of the machine whose PDO map cannot be written, simulated after its device file: with the mode that
// is declared for such drives (`fixed_pdo_map`), and a listener on the wire.
#include <gtest/gtest.h>

#include <memory>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using cycle::Refusal;
using image::RequestKind;

constexpr const char* kLine = "N10 G90 G94 G71\nN20 G1 X80 Y60 F6000\nN30 G1 X10 Y20\nN40 M30\n";

const std::string kUsual = "\"6041:00/16\", \"6064:00/32\"",
                  kOdd = "\"6064:00/32\", \"603F:00/16\", \"6041:00/16\"";

/// Counts what is asked of the maps 1600h-1603h and 1A00h-1A03h of node 1.
struct MapRequests final : mock::CanMonitor {
  int writes = 0, reads = 0;
  void on_wire(const mock::CanFrame& f, int, image::Nanoseconds, image::Nanoseconds,
               Outcome outcome) noexcept override {
    const int index = f.data[1] | f.data[2] << 8;
    if (f.id != 0x601 || outcome != Outcome::received ||
        (index >> 2 != 0x1600 >> 2 && index >> 2 != 0x1A00 >> 2))
      return;
    writes += f.data[0] >> 5 == 1;
    reads += f.data[0] >> 5 == 2;
  }
};

/// The example mill in a folder of its own, where X has a device file of its own.
struct FixedMap : testing::Test {
  Scratch scratch;
  MapRequests seen;
  std::unique_ptr<Mill> mill;

  machine::LoadResult machine_with(bool fixed, const std::string& status) {
    std::string device = read_all(source("devices/servo-cia402.toml"));
    if (fixed) replace(device, "[behaviour]\n", "[behaviour]\nfixed_pdo_map = true\n");
    replace(device, "\"6041:00/16\", \"6064:00/32\"", status);
    scratch.write("servo-odd.toml", device);
    std::string text = read_all(source("examples/mill/machine.toml"));
    replace(text, "\"mill.st\"", "\"" + source("examples/mill/mill.st") + "\"");
    replace(text, "name = \"x\"\nid = 1\ndevice = \"servo-cia402\"",
            "name = \"x\"\nid = 1\ndevice = \"servo-odd\"");
    return machine::parse(text, scratch.path("machine.toml"));
  }
  void start(const machine::LoadResult& machine) {
    for (const text::Finding& f : machine.findings)
      EXPECT_NE(f.severity, text::Severity::error) << f.str(text::Language::english);
    ASSERT_TRUE(machine.ok());
    mill = std::make_unique<Mill>(machine, kLine);
    seen = {};
    mill->control().world().wire(0)->set_monitor(&seen);
  }
};

TEST_F(FixedMap, is_read_and_not_written_and_the_machine_runs_its_program) {
  ASSERT_NO_FATAL_FAILURE(start(machine_with(true, kUsual)));
  ASSERT_TRUE(mill->until([&] { return mill->axis("X").drive.online; }, 15.0)) << mill->alarm_list();
  EXPECT_EQ(seen.writes, 0);
  EXPECT_EQ(seen.reads, 6) << "two maps of a count and two entries";
  ASSERT_TRUE(mill->make_ready()) << mill->alarm_list();
  ASSERT_EQ(mill->ask(RequestKind::start), Refusal::none);
  ASSERT_TRUE(mill->until([&] { return mill->axis("X").command > 50.0; }, 20.0)) << mill->alarm_list();
  ASSERT_TRUE(mill->until([&] { return mill->process().state == image::ProcessState::ended; }, 60.0))
      << mill->alarm_list();
  mill->run(0.2);
  EXPECT_NEAR(mill->true_position(0), 10.0, 0.01);
  EXPECT_EQ(mill->judge().verdict(), "");
}

TEST_F(FixedMap, of_another_order_serves_as_well_as_one_that_is_written) {
  for (const bool fixed : {false, true}) {
    ASSERT_NO_FATAL_FAILURE(start(machine_with(fixed, kOdd)));
    ASSERT_TRUE(mill->make_ready()) << mill->alarm_list();
    EXPECT_EQ(seen.writes == 0, fixed);
    EXPECT_EQ(seen.reads, 7);
    mill->run(0.2);
    EXPECT_NEAR(mill->axis("X").actual, mill->true_position(0), 0.01);
  }
}

}  // namespace
}  // namespace servogate::machine_run
