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
#include "gateway/compose/control.hpp"
#include "gateway/compose/program/program_file.hpp"

namespace {

using namespace servogate;

constexpr int kMeasuredCycles = 8;  ///< each so-many-th, as a virtual run does

/// A composed machine behind the interface that the bench knows.
class ComposedMachine final : public bench::Machine {
 public:
  ComposedMachine(const machine::LoadResult& loaded, const std::string& program_path) {
    std::vector<text::Finding> findings;
    control_ = gateway::Control::compose(loaded, findings);
    for (const text::Finding& f : findings) std::fprintf(stderr, "%s\n", f.str().c_str());
    if (control_ == nullptr || gateway::open_program(loaded.machine, program_path, "", program_) != 0)
      std::exit(2);
    control_->process(0).load([this, program_path](const program::Position& start) {
      return program::Interpreter(program_.dialect, program_.model, {}, program_path, program_.text,
                                  program_.loader, start);
    });
    control_->world().close_operator_points();
    control_->cycle().measure_every(kMeasuredCycles);
  }
  void step() override { control_->step(); }
  const image::ProcessImage& image() const override { return control_->cycle().image(); }
  bool post(const image::Request& request) override { return control_->cycle().post(request); }
  image::Nanoseconds cycle_duration_ns() const override {
    return control_->cycle().measured() ? control_->cycle().duration_ns() : -1;
  }
  bool inject(std::string_view device, std::string_view fault) override {
    mock::SimulatedDrive* drive = control_->world().drive(device);
    const auto kind = mock::drive_fault_kind(fault);
    if (drive == nullptr || !kind) return false;
    mock::DriveFault f;
    f.kind = *kind;
    drive->inject(f);
    return true;
  }

 private:
  std::unique_ptr<gateway::Control> control_;
  gateway::ProgramFile program_;
};

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
  print("example mill, 3 axes, spindle, PLC", bench::median_of(runs, [&] {
          return std::make_unique<ComposedMachine>(mill, source + "/examples/mill/bracket.nc");
        }));

  const auto folder =
      std::filesystem::temp_directory_path() / ("servogate-bench-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "eight.st") << gateway::eight_axis_logic();
  std::ofstream(folder / "eight.nc") << gateway::eight_axis_program();
  std::ofstream(folder / "eight.toml") << gateway::eight_axis_machine("eight.st");
  const machine::LoadResult eight = load_or_exit((folder / "eight.toml").string());
  print("8 axes, 3 segments, PLC of 1000 statements", bench::median_of(runs, [&] {
          return std::make_unique<ComposedMachine>(eight, (folder / "eight.nc").string());
        }));
  std::filesystem::remove_all(folder);
  std::printf(
      "Aims: p99 below 10 us for 8 axes, 300 x real time for the mill. Known: 3 axes of motion alone p99 "
      "14-45 us "
      "elsewhere; others run at 1 x.\n");
}
