// SPDX-License-Identifier: Apache-2.0
// Same inputs at the same cycles, same bytes; on another processor the path within 1 nm.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/machine_run/rig/programs.hpp"
#include "tests/places/places.hpp"
#include "tests/property_seed.hpp"

namespace servogate::machine_run {
namespace {

// glibc 2.33 and later name the features like this; without FMA and AVX2 libm takes its plain variants.
const Environment kWithoutFma{{"GLIBC_TUNABLES", "glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2"}};

bool processor_has_fma() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("fma") != 0;
#else
  return false;
#endif
}

std::string bracket_trace(const Scratch& scratch, const std::string& name,
                          const Environment& environment = {}) {
  const std::string path = scratch.path(name);
  const Ending e = servogate({"run", source("examples/mill/machine.toml"), source("examples/mill/bracket.nc"),
                              "--virtual", "--trace", path, "-q"},
                             environment);
  EXPECT_EQ(e.code, 0) << e.err;
  return path;
}

struct Function {
  const char* name;
  double (*call)(double);
  double low, high;
};
constexpr Function kFunctions[] = {
    {"sin", std::sin, -10, 10},
    {"cos", std::cos, -10, 10},
    {"tan", std::tan, -1.5, 1.5},
    {"asin", std::asin, -1, 1},
    {"acos", std::acos, -1, 1},
    {"atan", std::atan, -10, 10},
    {"exp", std::exp, -20, 20},
    {"log", std::log, 1e-6, 1e6},
    {"sqrt", std::sqrt, 0, 1e6},
    {"cbrt", std::cbrt, 0, 1e6},
    {"floor", std::floor, -9, 9},
    {"rint", std::rint, -9, 9},
    {"sinh", std::sinh, -5, 5},
    {"tanh", std::tanh, -5, 5},
    {"log10", std::log10, 1e-6, 1e6},
    {"exp2", std::exp2, -20, 20},
    {"log2", std::log2, 1e-6, 1e6},
    {"pow", [](double x) { return std::pow(x, 1.7); }, 0, 1e3},
    {"atan2", [](double x) { return std::atan2(x, 1.3); }, -10, 10},
    {"hypot", [](double x) { return std::hypot(x, 1.3); }, -10, 10},
    {"fmod", [](double x) { return std::fmod(x, 1.3); }, -10, 10},
};

/// One line a function: its name and a hash of what it gives for many arguments.
std::string fingerprint() {
  std::ostringstream out;
  for (const Function& f : kFunctions) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> argument(f.low, f.high);
    std::uint64_t hash = 1469598103934665603u;
    for (int i = 0; i < 200000; ++i) {
      const double y = f.call(argument(random));
      std::uint64_t bits = 0;
      std::memcpy(&bits, &y, sizeof bits);
      hash = (hash ^ bits) * 1099511628211u;
    }
    out << f.name << ' ' << std::hex << hash << std::dec << '\n';
  }
  return out.str();
}

// Run by the next test in a process of its own, with another libm.
TEST(Determinism, DISABLED_prints_the_fingerprint_of_libm) {
  if (const char* path = std::getenv("SERVOGATE_FINGERPRINT")) std::ofstream(path) << fingerprint();
}

TEST(Determinism, libm_without_fma_gives_other_last_bits_so_the_masked_run_means_something) {
  if (!processor_has_fma()) GTEST_SKIP() << "this processor has no FMA to mask";
  const Scratch scratch;
  const std::string path = scratch.path("fingerprint");
  // The other process is no share of the tests.
  const std::string command = "env -u GTEST_TOTAL_SHARDS -u GTEST_SHARD_INDEX GLIBC_TUNABLES=" + kWithoutFma.at("GLIBC_TUNABLES") +
                              " SERVOGATE_FINGERPRINT=" + path + " '" + tests::binary_dir() +
                              "/tests/machine_run/test_machine_run'"
                              " --gtest_also_run_disabled_tests"
                              " --gtest_filter='*DISABLED_prints_the_fingerprint*' > /dev/null 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::istringstream here(fingerprint()), masked(read_all(path));
  std::string name, a, other, b, differing;
  while (here >> name >> a && masked >> other >> b) {
    ASSERT_EQ(name, other);
    if (a != b) differing += name + " ";
  }
  std::printf("libm functions that differ without FMA: %s\n", differing.c_str());
  RecordProperty("differing", differing);
  EXPECT_NE(differing, "") << "the tunable masks nothing: the masked run below would prove nothing";
}

TEST(Determinism, flags_forbid_fused_and_native_arithmetic) {
  std::istringstream commands(read_all(tests::binary_dir() + "/compile_commands.json"));
  int compilations = 0;
  for (std::string line; std::getline(commands, line);) {
    if (line.find("\"command\"") == std::string::npos || line.find(".cpp.o") == std::string::npos) continue;
    ++compilations;
    EXPECT_NE(line.find("-ffp-contract=off"), std::string::npos) << line;
    for (const char* wrong : {"-march=native", "-mfma", "-ffast-math", "-Ofast", "-funsafe-math"})
      EXPECT_EQ(line.find(wrong), std::string::npos) << line;
  }
  EXPECT_GT(compilations, 100);
}

/// The cycles in which each signal of a trace changes. Signals are the columns that only ever hold 0 and 1.
std::map<std::string, std::vector<long>> events(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  const auto cells = [](const std::string& text) {
    std::vector<std::string> out;
    std::istringstream in(text);
    for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
    return out;
  };
  const std::vector<std::string> names = cells(line);
  std::vector<std::vector<long>> changes(names.size());
  std::vector<std::string> before(names.size());
  std::vector<bool> signal(names.size(), true);
  for (long row = 0; std::getline(file, line); ++row) {
    const std::vector<std::string> now = cells(line);
    for (std::size_t c = 0; c < std::min(now.size(), names.size()); ++c) {
      signal[c] = signal[c] && (now[c] == "0" || now[c] == "1");
      if (signal[c] && row > 0 && now[c] != before[c]) changes[c].push_back(row);
      before[c] = now[c];
    }
  }
  std::map<std::string, std::vector<long>> out;
  for (std::size_t c = 0; c < names.size(); ++c)
    if (signal[c]) out[names[c]] = changes[c];
  return out;
}

TEST(Determinism, two_runs_of_the_bracket_are_equal_byte_by_byte_and_without_fma_within_a_nanometre) {
  const Scratch scratch;
  const std::string first = bracket_trace(scratch, "first.csv");
  {
    const std::string second = bracket_trace(scratch, "second.csv");
    EXPECT_TRUE(read_all(first) == read_all(second)) << "two equal runs differ";
    std::remove(second.c_str());
  }
  if (!processor_has_fma()) GTEST_SKIP() << "the run without FMA: this processor has none";
  const std::string masked = bracket_trace(scratch, "masked.csv", kWithoutFma);
  std::ifstream a(first), b(masked);
  std::string la, lb;
  std::getline(a, la);
  std::getline(b, lb);
  ASSERT_EQ(la, lb);
  // Columns: t, feed, line, then X.cmd, X.act, Y.cmd ...; the set-points of three axes are looked at.
  double worst = 0.0;
  long rows = 0, differing_rows = 0, rows_a = 0, rows_b = 0;
  for (;; ++rows) {
    const bool ga = static_cast<bool>(std::getline(a, la)), gb = static_cast<bool>(std::getline(b, lb));
    rows_a += ga;
    rows_b += gb;
    if (!ga || !gb) break;
    if (la == lb) continue;
    ++differing_rows;
    const auto cells = [](const std::string& line) {
      std::vector<double> v;
      std::istringstream in(line);
      for (std::string cell; std::getline(in, cell, ',') && v.size() < 9;) v.push_back(std::stod(cell));
      return v;
    };
    const std::vector<double> va = cells(la), vb = cells(lb);
    for (const std::size_t c : {3u, 5u, 7u}) worst = std::max(worst, std::abs(va[c] - vb[c]));
  }
  EXPECT_LE(std::abs(rows_a - rows_b), 1) << "the end comes more than a cycle earlier or later";
  EXPECT_LE(worst, 1e-6) << "mm";
  const auto here = events(first), there = events(masked);
  std::size_t compared = 0;
  ASSERT_EQ(here.size(), there.size());
  for (const auto& [signal, cycles] : here) {
    const std::vector<long>& others = there.at(signal);
    ASSERT_EQ(cycles.size(), others.size()) << signal;
    for (std::size_t n = 0; n < cycles.size(); ++n, ++compared)
      EXPECT_LE(std::abs(cycles[n] - others[n]), 1) << signal << " in cycle " << cycles[n];
  }
  EXPECT_GT(compared, 100u) << "switches, strobes, lamps";
  std::printf("without FMA: %zu events within a cycle; %ld of %ld rows differ, the path by at most %.3g nm\n",
              compared, differing_rows, rows, worst * 1e6);
}

struct Seen {
  std::vector<double> numbers;
  bool operator==(const Seen&) const = default;
};

Seen drive_through(unsigned seed) {
  Mill mill(kShortProgram);
  Seen seen;
  mill.after_cycle = [&] {
    for (int a = 0; a < mill.image().axis_count; ++a) {
      seen.numbers.push_back(mill.image().axes[static_cast<std::size_t>(a)].command);
      seen.numbers.push_back(mill.image().axes[static_cast<std::size_t>(a)].actual);
    }
    seen.numbers.push_back(mill.process().feed_mm_s);
    seen.numbers.push_back(mill.process().line);
  };
  EXPECT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(image::RequestKind::start), cycle::Refusal::none);
  // An operator with restless hands.
  std::mt19937 random(seed);
  while (mill.process().state != image::ProcessState::ended && seen.numbers.size() < 2'000'000) {
    mill.run(0.001 * static_cast<double>(random() % 300));
    switch (random() % 4) {
      case 0:
        mill.post(image::RequestKind::hold);
        break;
      case 1:
        mill.post(image::RequestKind::override_feed, 0.01 * static_cast<double>(10 + random() % 141));
        break;
      default:
        mill.post(image::RequestKind::resume);
        break;
    }
    image::Answer answer;
    while (mill.control().cycle().take_answer(answer)) {
    }
  }
  EXPECT_EQ(mill.process().state, image::ProcessState::ended) << mill.alarm_list();
  EXPECT_EQ(mill.judge().verdict(), "");
  return seen;
}

TEST(Determinism, two_machines_in_one_process_do_the_same_under_the_same_hands) {
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  const Seen a = drive_through(seed), b = drive_through(seed);
  EXPECT_TRUE(a == b) << "seed " << seed;
  EXPECT_GT(a.numbers.size(), 10000u);
}

}  // namespace
}  // namespace servogate::machine_run
