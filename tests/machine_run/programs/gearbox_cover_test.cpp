// SPDX-License-Identifier: Apache-2.0
// The example of a real shop's size: a cover of a gearbox on a mill, loaded and unloaded by a second process.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

constexpr double kDigit = 1e-3;  ///< mm: the trace has counts of the drives

const std::string kMachine = source("examples/gearbox-cover/machine.toml"),
                  kTables = source("examples/gearbox-cover/tables");

TEST(GearboxCover, is_loaded_cut_and_unloaded_without_an_alarm_and_reports_it) {
  const Scratch scratch;
  const Ending ran = servogate({"run", kMachine, source("examples/gearbox-cover/cover.nc"), "--tables",
                                kTables, "--virtual", "--report", scratch.path("r.json"), "-q"});
  ASSERT_EQ(ran.code, 0) << ran.out << ran.err;
  const auto report = nlohmann::json::parse(read_all(scratch.path("r.json")));
  EXPECT_EQ(report["finished"], true);
  EXPECT_TRUE(report["alarms"].empty()) << report["alarms"].dump();
  EXPECT_GT(report["blocks"], 800) << "of both processes, loops counted each time";
  EXPECT_EQ(report["starved"], 0);
}

/// The part that the loader has in it, with one motion in the place of the job.
std::string loading_only() {
  const std::string job = read_all(source("examples/gearbox-cover/cover.nc"));
  const std::size_t cut = job.find("N20 "), back = job.find("N4451 ");
  EXPECT_TRUE(cut != std::string::npos && back != std::string::npos && cut < back);
  return job.substr(0, cut) + "N20 G0 G79 Z-50\n" + job.substr(back);
}

TEST(GearboxCover, has_its_head_up_and_its_table_still_whenever_the_loader_is_over_it) {
  const Scratch scratch;
  const std::string program = scratch.write("cover.nc", loading_only());
  scratch.write("LOADER.nc", read_all(source("examples/gearbox-cover/LOADER.nc")));
  const Ending ran = servogate(
      {"run", kMachine, program, "--tables", kTables, "--virtual", "--trace", scratch.path("t.csv"), "-q"});
  ASSERT_EQ(ran.code, 0) << ran.out << ran.err;
  const TraceFile trace(scratch.path("t.csv"));
  const std::size_t x = trace.column("X.cmd"), y = trace.column("Y.cmd"), z = trace.column("Z.cmd"),
                    w = trace.column("W.cmd");
  constexpr double kOverTable = 1000.0;  // mm
  int times_over = 0, down = 0;
  for (std::size_t r = 1; r < trace.rows(); ++r) {
    const bool over = trace.at(r, w) > kOverTable && trace.at(r, w) < 1300.0;
    if (over && trace.at(r - 1, w) <= kOverTable) ++times_over;
    if (trace.at(r, z) < -49.9 && trace.at(r - 1, z) >= -49.9) ++down;
    if (!over) continue;
    for (const std::size_t axis : {x, y, z})
      ASSERT_NEAR(trace.at(r, axis), 0.0, kDigit) << trace.names()[axis] << " at " << trace.at(r, 0) << " s";
  }
  EXPECT_EQ(times_over, 2) << "to bring the blank, and to take the cover away";
  EXPECT_EQ(down, 1) << "between them the part is worked on";
  EXPECT_NEAR(trace.at(trace.rows() - 1, w), 0.0, kDigit);
}

}  // namespace
}  // namespace servogate::machine_run
