// SPDX-License-Identifier: Apache-2.0
// Prints cycle time and virtual speed of whole machines: the example mill, and eight axes with CANopen master
// and PLC.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/cycle/cycle_times.hpp"
#include "gateway/benchmark/eight_axes.hpp"
#include "gateway/control/run/running_machine.hpp"

namespace {

using namespace servogate;

/// A machine with its program, ready to be measured.
std::unique_ptr<bench::Machine> running(const machine::LoadResult& machine, const std::string& program) {
  std::vector<text::Finding> findings;
  auto running = gateway::RunningMachine::compose(machine, nullptr, {}, findings);
  const bool good = running != nullptr && running->load(program, findings);
  for (const text::Finding& f : findings) std::fprintf(stderr, "%s\n", f.str().c_str());
  if (!good) std::exit(2);
  return running;
}

machine::LoadResult load_or_exit(const std::string& path) {
  machine::LoadResult loaded = machine::load(path);
  for (const text::Finding& f : loaded.findings)
    if (f.severity == text::Severity::error) std::fprintf(stderr, "%s\n", f.str().c_str());
  if (!loaded.ok()) std::exit(2);
  return loaded;
}

void print(const char* what, const bench::CycleCost& c) {
  std::printf("%-44s p50 %6.2f us   p99 %6.2f us   p99.9 %7.2f us   %7.0f x real time%s\n", what, c.p50_us,
              c.p99_us, c.p999_us, c.virtual_speed, c.finished ? "" : "   NOT FINISHED");
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 5;
  const std::string source = SERVOGATE_SOURCE_DIR;
  std::printf(
      "Median of %d runs; Cycle::step() only, simulated devices not counted; virtual speed with them, no "
      "trace.\n",
      runs);

  const machine::LoadResult mill = load_or_exit(source + "/examples/mill/machine.toml");
  print("example mill, 3 axes, spindle, PLC",
        bench::median_of(runs, [&] { return running(mill, source + "/examples/mill/bracket.nc"); }));

  const auto folder =
      std::filesystem::temp_directory_path() / ("servogate-bench-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "eight.nc") << gateway::eight_axis_program();
  std::ofstream(folder / "eight.toml") << gateway::eight_axis_machine("eight.st");
  for (const int statements : {0, 1000}) {
    std::ofstream(folder / "eight.st") << gateway::eight_axis_logic(statements);
    const machine::LoadResult eight = load_or_exit((folder / "eight.toml").string());
    const std::string what =
        "8 axes, 3 segments, " + (statements == 0 ? std::string("PLC of enables alone")
                                                  : "PLC of " + std::to_string(statements) + " statements");
    print(what.c_str(),
          bench::median_of(runs, [&] { return running(eight, (folder / "eight.nc").string()); }));
  }
  std::filesystem::remove_all(folder);
  std::printf(
      "Aims: p99 of 8 axes at most 5 us without and 8 us with a PLC, 1000 x real time for the mill. Known: 3 "
      "axes of motion alone p99 14-45 us elsewhere; others run at 1 x.\n");
}
