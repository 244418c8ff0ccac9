// SPDX-License-Identifier: Apache-2.0
// The catalogue (tests/scenarios) knows every alarm of the product.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>

#include "tests/places/places.hpp"

namespace servogate::scenario {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The first group of every match, as numbers.
std::set<int> numbers(const std::string& text, const std::string& pattern) {
  std::set<int> found;
  const std::regex wanted(pattern);
  for (std::sregex_iterator i(text.begin(), text.end(), wanted), end; i != end; ++i)
    found.insert(std::stoi((*i)[1]));
  return found;
}

fs::path folder() { return fs::path(tests::source_dir()) / "tests/scenarios"; }

/// Alarms that a scenario waits for by name, or that stand in its list of `alarms`.
std::set<int> expected_somewhere() {
  std::set<int> all;
  const std::regex list(R"(alarms = \[([0-9, ]*)\])");
  for (const auto& entry : fs::recursive_directory_iterator(folder())) {
    if (!entry.path().filename().string().ends_with(".scenario.toml")) continue;
    const std::string text = text_of(entry.path());
    all.merge(numbers(text, R"(\balarm = ([0-9]{4}))"));
    for (std::sregex_iterator i(text.begin(), text.end(), list), end; i != end; ++i)
      all.merge(numbers((*i)[1], R"(([0-9]{4}))"));
  }
  return all;
}

/// The rows of the table of alarms without a scenario, with their test.
std::map<int, std::string> without_scenario() {
  std::map<int, std::string> rows;
  const std::string text = text_of(folder() / "alarms/README.md");
  const std::regex row(R"(\| ([0-9]{4}) \| [^|]+ \| ([^| ]+) \|)");
  for (std::sregex_iterator i(text.begin(), text.end(), row), end; i != end; ++i)
    rows[std::stoi((*i)[1])] = (*i)[2];
  return rows;
}

TEST(Catalogue, has_a_scenario_for_every_alarm_or_says_why_not_and_which_test_stands_for_it) {
  const std::set<int> all =
      numbers(text_of(fs::path(tests::source_dir()) / "docs/alarms.md"), R"(### ([0-9]{4}) )");
  ASSERT_GT(all.size(), 60u);
  const std::set<int> expected = expected_somewhere();
  const std::map<int, std::string> excused = without_scenario();
  for (const int number : all)
    EXPECT_NE(expected.contains(number), excused.contains(number))
        << "alarm " << number << " needs a scenario, or a row in tests/scenarios/alarms/README.md, not both";
  for (const auto& [number, test] : excused) {
    EXPECT_TRUE(all.contains(number)) << number << " is no alarm";
    EXPECT_TRUE(fs::exists(fs::path(tests::source_dir()) / test)) << test;
  }
  for (const int number : expected) EXPECT_TRUE(all.contains(number)) << number << " is no alarm";
}

}  // namespace
}  // namespace servogate::scenario
