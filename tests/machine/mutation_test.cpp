// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "machine/consequences.hpp"
#include "machine/load.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

constexpr std::uint64_t kSeed = 20240611;

/// Random edits of the kind that people and disks make.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string mutate(std::string text) {
    const int edits = 1 + static_cast<int>(random_() % 4);
    for (int i = 0; i < edits; ++i) edit(text);
    return text;
  }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  std::pair<std::size_t, std::size_t> line(const std::string& text) {
    const std::size_t at = below(text.size());
    const std::size_t begin = text.rfind('\n', at) == std::string::npos ? 0 : text.rfind('\n', at);
    const std::size_t end = std::min(text.find('\n', begin + 1), text.size());
    return {begin, end - begin};
  }

  void edit(std::string& text) {
    static constexpr const char* kTokens[] = {"0",
                                              "-1",
                                              "1e308",
                                              "nan",
                                              "inf",
                                              "\"\"",
                                              "[]",
                                              "{}",
                                              "true",
                                              "SK512.LI",
                                              "SA8191",
                                              "= ",
                                              "[[axis]]\n",
                                              "#",
                                              "\"",
                                              "'",
                                              "9223372036854775807",
                                              "\"1 mm\"",
                                              "\"5 s\"",
                                              "can.z",
                                              "[axis.home]\n",
                                              "\xff",
                                              "gear = [0, 0]\n",
                                              "vertical = true\n"};
    switch (below(7)) {
      case 0:
        text[below(text.size())] = static_cast<char>(random_() % 256);
        return;
      case 1: {
        const auto [begin, size] = line(text);
        text.erase(begin, size);
        return;
      }
      case 2: {
        const auto [begin, size] = line(text);
        text.insert(below(text.size()), text.substr(begin, size));
        return;
      }
      case 3:
        text.insert(below(text.size()), kTokens[below(std::size(kTokens))]);
        return;
      case 4: {  // a value replaced
        const std::size_t equals = text.find("= ", below(text.size()));
        if (equals == std::string::npos) return;
        const std::size_t end = std::min(text.find('\n', equals), text.size());
        text.replace(equals + 2, end - equals - 2, kTokens[below(std::size(kTokens))]);
        return;
      }
      case 5:
        if (random_() % 8 == 0) text.resize(below(text.size()) + 1);
        return;
      default: {  // two letters changed places: the usual typing error
        const std::size_t at = below(text.size() - 1);
        std::swap(text[at], text[at + 1]);
      }
    }
  }

  std::mt19937_64 random_;
};

/// True when every error has a file, a line and a column inside the text.
void check_findings(const LoadResult& r, const std::string& text, std::uint64_t seed) {
  const auto lines = static_cast<int>(std::count(text.begin(), text.end(), '\n')) + 1;
  for (const text::Finding& f : r.findings) {
    ASSERT_FALSE(f.file.empty()) << seed;
    ASSERT_NE(f.entry, nullptr) << seed;
    ASSERT_GE(f.line, 1) << seed << ": " << f.str(text::Language::english);
    ASSERT_GE(f.column, 1) << seed << ": " << f.str(text::Language::english);
    if (f.file == r.machine.file) {
      ASSERT_LE(f.line, lines) << seed;
    }
    ASSERT_FALSE(f.str(text::Language::russian).empty()) << seed;
  }
}

TEST(MutatedMachineFile, never_crashes_and_every_finding_has_a_place) {
  const std::string original = test::example("mill");
  const std::string path = test::source("examples/mill/machine.toml");
  int accepted = 0;
  constexpr int kCases = 8000;
  for (int i = 0; i < kCases; ++i) {
    const std::uint64_t seed = kSeed + static_cast<std::uint64_t>(i);
    const std::string text = Mutator(seed).mutate(original);
    const LoadResult r = parse(text, path);
    check_findings(r, text, seed);
    if (r.ok()) ++accepted;
    // Consequences take any result.
    for (const Consequence& c : consequences(r)) ASSERT_FALSE(c.str(text::Language::english).empty()) << seed;
  }
  RecordProperty("seed", static_cast<int>(kSeed));
  RecordProperty("accepted", accepted);
  // Edits in comments and names are harmless, most others are not: both kinds have to occur.
  EXPECT_GT(accepted, kCases / 50);
  EXPECT_LT(accepted, kCases * 3 / 4);
}

TEST(MutatedMachineFile, an_accepted_file_is_safe_to_run) {
  const std::string original = test::example("mill");
  const std::string path = test::source("examples/mill/machine.toml");
  for (int i = 0; i < 2500; ++i) {
    const std::uint64_t seed = kSeed + 100000 + static_cast<std::uint64_t>(i);
    const LoadResult r = parse(Mutator(seed).mutate(original), path);
    if (!r.ok()) continue;
    for (const AxisConfig& a : r.machine.axes) {
      ASSERT_GT(a.lead, 0.0) << seed;
      ASSERT_GT(a.counts_per_rev, 0) << seed;
      ASSERT_GT(a.gear[0], 0) << seed;
      ASSERT_GT(a.gear[1], 0) << seed;
      ASSERT_TRUE(std::isfinite(a.counts_per_unit())) << seed;
      ASSERT_GT(a.max_velocity, 0.0) << seed;
      ASSERT_GT(a.max_acceleration, 0.0) << seed;
      ASSERT_GT(a.max_jerk, 0.0) << seed;
      ASSERT_TRUE(a.travel_min < a.travel_max || a.endless()) << seed;
      ASSERT_TRUE(!a.vertical || a.brake.present()) << seed;
      ASSERT_NE(r.machine.node(a.drive), nullptr) << seed;
    }
    ASSERT_GT(r.machine.control.contour_tolerance, 0.0) << seed;
    if (!r.machine.safety.estop.empty()) {
      int station = -1;
      ASSERT_NE(r.machine.point(r.machine.safety.estop, &station), nullptr) << seed;
      ASSERT_NE(r.machine.stations[static_cast<std::size_t>(station)].kind, StationKind::modbus) << seed;
    }
  }
}

TEST(MutatedMachineFile, every_cut_off_file_ends_in_a_finding_or_a_whole_table) {
  const std::string original = test::example("lathe");
  for (std::size_t n = 0; n < original.size(); n += 7) {
    const std::string text = original.substr(0, n);
    check_findings(parse(text, test::source("examples/lathe/machine.toml")), text, n);
  }
}

}  // namespace
}  // namespace servogate::machine
