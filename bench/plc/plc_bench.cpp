// SPDX-License-Identifier: Apache-2.0
// Cost of PLC statements against the same compiled from C++, and of compiling. Prints a table, or one JSON
// object with --json. The least of many runs counts: everything above it is somebody else's work.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string>

#include "bench/plc/by_hand.hpp"
#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"

namespace {

using namespace servogate;
using SteadyClock = std::chrono::steady_clock;

template <typename F>
double least_ns(int runs, F f) {
  double best = 1e18;
  for (int i = 0; i < runs; ++i) {
    const auto begin = SteadyClock::now();
    f();
    best = std::min(best, std::chrono::duration<double, std::nano>(SteadyClock::now() - begin).count());
  }
  return best;
}

std::string and_program(int statements) {
  std::string text = "PROGRAM Main\nVAR\n";
  for (int i = 0; i < bench::Signals::kCount; ++i) text += "v" + std::to_string(i) + " : BOOL := TRUE;\n";
  text += "END_VAR\n";
  for (int i = 0; i < statements; ++i) {
    const int n = i % 250;
    text +=
        "v" + std::to_string(n + 2) + " := v" + std::to_string(n) + " AND v" + std::to_string(n + 1) + ";\n";
  }
  return text + "END_PROGRAM\n";
}

constexpr const char* kMixed = R"(PROGRAM Main
VAR button : BOOL := TRUE; last, edge, lamp : BOOL; count : INT; limit : INT := 100;
  level : LREAL; gain : LREAL := 0.25; started, elapsed : TIME; i : INT; END_VAR
FOR i := 1 TO 1000 DO
  edge := button AND NOT last;
  last := button;
  IF edge THEN started := TIME(); END_IF;
  elapsed := TIME() - started;
  lamp := elapsed >= T#500ms;
  IF count < limit THEN count := count + 1; ELSE count := 0; END_IF;
  level := level + gain * (INT_TO_LREAL(count) - level);
END_FOR;
END_PROGRAM
)";

double scan_ns(const std::string& text) {
  const auto compiled = plc::compile({{"bench.st", text}}, {}, {});
  if (!compiled.ok()) {
    for (const auto& f : compiled.findings) std::fprintf(stderr, "%s\n", f.str().c_str());
    std::exit(1);
  }
  plc::Engine engine(compiled.image);
  image::Packets packets;
  std::int64_t t = 0;
  return least_ns(3000, [&] { engine.scan(packets, t += image::kMillisecond); });
}

}  // namespace

int main(int argc, char** argv) {
  const bool json = argc > 1 && std::strcmp(argv[1], "--json") == 0;
  const double empty = scan_ns("PROGRAM Main\nEND_PROGRAM\n");
  const double vm = scan_ns(and_program(10'000));
  bench::Signals signals{};
  const double hand = least_ns(3000, [&] { bench::ten_thousand_by_hand(signals); });
  const double mixed_vm = scan_ns(kMixed);
  bench::Mixed mixed;
  std::int64_t t = 0;
  const double mixed_hand = least_ns(3000, [&] {
    t += image::kMillisecond;
    for (int i = 0; i < 1000; ++i) {
      bench::mixed_by_hand(mixed, t);
      asm volatile("" : : "r"(&mixed) : "memory");
    }
  });
  const std::string source = and_program(10'000);
  const double compile = least_ns(5, [&] { plc::compile({{"bench.st", source}}, {}, {}); });
  if (json) {
    std::printf(
        "{\"schema\":1,\"empty_scan_ns\":%.1f,\"and_ns\":%.3f,\"and_10000_us\":%.2f,\"and_by_hand_ns\":%.3f,"
        "\"and_ratio\":%.2f,\"mixed_ns\":%.2f,\"mixed_by_hand_ns\":%.2f,\"mixed_ratio\":%.2f,"
        "\"compile_lines_per_s\":%.0f}\n",
        empty, vm / 1e4, vm / 1e3, hand / 1e4, vm / hand, mixed_vm / 1e3, mixed_hand / 1e3,
        mixed_vm / mixed_hand, 1e4 / (compile * 1e-9));
    return 0;
  }
  std::printf("empty scan                     %10.1f ns\n", empty);
  std::printf("c := a AND b                   %10.3f ns   aim <= 3    by hand %.3f ns, ratio %.2f\n",
              vm / 1e4, hand / 1e4, vm / hand);
  std::printf("10 000 such statements         %10.2f us   aim <= 30\n", vm / 1e3);
  std::printf("mixed cycle (9 statements)     %10.2f ns               by hand %.2f ns, ratio %.2f\n",
              mixed_vm / 1e3, mixed_hand / 1e3, mixed_vm / mixed_hand);
  std::printf("compiling                      %10.0f lines/s\n", 1e4 / (compile * 1e-9));
  return 0;
}
