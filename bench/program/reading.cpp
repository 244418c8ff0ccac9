// SPDX-License-Identifier: Apache-2.0
// Lines a second from program text to canonical commands (bench/README.md).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "kernel/program/interpreter/interpreter.hpp"

namespace {

using namespace servogate;

struct Language {
  const char* dialect;
  std::vector<std::string> power_on;
};
const Language kNc110{"nc110", {"G94", "G97", "G90", "G71", "G27"}};
const Language kFenix{"fenix", {}};
const Language kIso{"sinumerik-808d", {"G291"}};

program::MachineModel mill(const Language& language) {
  program::MachineModel machine;
  for (const char* letter : {"X", "Y", "Z"})
    machine.axes.push_back({letter, false, false, false, -300.0, 300.0, 500.0});
  machine.power_on = language.power_on;
  machine.kind = program::MachineModel::Kind::milling;
  if (&language == &kNc110) machine.variables = {{"ERF", 0.01}, {"MCD", 2.0}};
  return machine;
}

/// Of processor time: what else runs on the computer does not count.
double seconds_of_this_thread() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Short straight blocks as CAM systems write them, inside of the travel.
std::string lines_text(int lines, bool numbered) {
  std::string text = "F6000\n";
  char buffer[96];
  for (int i = 0; i < lines; ++i) {
    const double a = 0.001 * i;
    const double x = 200.0 * std::sin(a), y = 200.0 * std::cos(1.3 * a), z = 50.0 * std::sin(0.7 * a);
    if (numbered)
      std::snprintf(buffer, sizeof buffer, "N%d G1 X%.3f Y%.3f Z%.3f\n", i % 10000, x, y, z);
    else
      std::snprintf(buffer, sizeof buffer, "G1 X%.3f Y%.3f\n", x, y);
    text += buffer;
  }
  return text;
}

std::string arcs_text(int lines) {
  std::string text = "F6000\nG0 X20 Y0\n";
  for (int i = 0; i < lines; ++i) text += i % 2 == 0 ? "G3 X-20 Y0 I0 J0\n" : "G3 X20 Y0 I0 J0\n";
  return text;
}

std::string loop_text(int lines) {
  std::string text = "F6000\nE30=0\n\"A\"\n";
  text += "E31=30*COS(E30)\nE32=30*SIN(E30)+2\nG1 XE31 YE32\nE30=E30+0.1\n";
  return text + "(BLT,E30," + std::to_string(lines / 5 / 10) + ",A)\n";
}

/// Blocks a second of one run; `json`: the objects of `servogate canon` are written too.
double rate(const Language& language, const std::string& text, bool json) {
  const auto packets = std::make_unique<image::Packets>();
  const program::MachineModel machine = mill(language);
  const std::vector<std::string> letters = {"X", "Y", "Z"};
  const double start = seconds_of_this_thread();
  program::Interpreter run(language.dialect, machine, {}, "bench.nc", text, {}, program::Position{});
  std::string out;
  std::size_t bytes = 0;
  for (;;) {
    const program::Step step = run.next(*packets, true);
    const auto* command = std::get_if<program::Command>(&step);
    if (command == nullptr) {
      std::fprintf(stderr, "the benchmark failed: %s\n",
                   std::get<program::Error>(step).finding.str(text::Language::english).c_str());
      std::exit(1);
    }
    if (std::holds_alternative<program::End>(command->what)) break;
    if (!json) continue;
    out.clear();
    program::append_json(out, *command, letters, run.files());
    bytes += out.size();
  }
  const double seconds = seconds_of_this_thread() - start;
  if (json && bytes == 0) std::exit(1);
  return static_cast<double>(run.executed()) / seconds;
}

void measure(const char* name, const Language& language, const std::string& text, bool json) {
  std::array<double, 5> rates;
  std::generate(rates.begin(), rates.end(), [&] { return rate(language, text, json); });
  std::sort(rates.begin(), rates.end());
  std::printf("%-44s %12.0f lines/s  (%.0f to %.0f)\n", name, rates[2], rates.front(), rates.back());
}

}  // namespace

/// bench_program [LINES [WORDS]]: only the cases whose name has WORDS in it.
int main(int argc, char** argv) {
  const int lines = argc > 1 ? std::max(1000, std::atoi(argv[1])) : 500'000;
  const std::string only = argc > 2 ? argv[2] : "";
  const auto print = [&](const std::string& name, const std::string& text, bool json = false,
                         const Language& language = kNc110) {
    if (name.find(only) != std::string::npos) measure(name.c_str(), language, text, json);
  };
  print("G1 X Y", lines_text(lines, false));
  print("N G1 X Y Z", lines_text(lines, true));
  for (const Language* language : {&kFenix, &kIso}) {
    const std::string begin = language == &kFenix ? "%\nG90 G94\n" : "";
    print(std::string("G1 X Y, ") + language->dialect, begin + lines_text(lines, false), false, *language);
    print(std::string("N G1 X Y Z, ") + language->dialect, begin + lines_text(lines, true), false, *language);
  }
  print("G3 X Y I J", arcs_text(lines));
  print("loop of expressions, a label and a branch", loop_text(lines));
  print("N G1 X Y Z as JSON lines", lines_text(lines, true), true);
}
