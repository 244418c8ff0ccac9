// SPDX-License-Identifier: Apache-2.0
// What holds for every language: its test programs, damaged at random, end inside of the travel with an error
// that has its place, and a copy of the interpreter goes on as the original does.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

class Language : public testing::TestWithParam<const char*> {};

std::vector<CaseFile> cases_of(const std::string& folder) {
  std::vector<CaseFile> cases;
  for (const std::string& path : case_paths(servogate::tests::source_dir() + "/tests/program/" + folder))
    cases.push_back(read_case(path));
  return cases;
}

/// A piece taken out, doubled, put elsewhere, or a character changed.
std::string damaged(std::string text, const std::vector<CaseFile>& others, std::mt19937_64& random) {
  const auto pick = [&](std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(random() % n); };
  for (std::size_t times = 1 + pick(4); times > 0; --times) {
    const std::size_t at = pick(text.size()), length = pick(12);
    const std::string piece = text.substr(at, length);
    switch (pick(4)) {
      case 0:
        text.erase(at, length);
        break;
      case 1:
        text.insert(pick(text.size()), piece);
        break;
      case 2: {
        const std::string& other = others[pick(others.size())].program;
        text.insert(at, other.substr(pick(other.size()), length));
        break;
      }
      default:
        if (!text.empty()) text[at] = "GXZR0159.-=(),$~ \nNLMH:"[pick(23)];
        break;
    }
  }
  return text;
}

TEST_P(Language, ends_its_damaged_programs_inside_of_the_travel_and_names_the_place) {
  const std::vector<CaseFile> cases = cases_of(GetParam());
  ASSERT_FALSE(cases.empty());
  std::mt19937_64 random(servogate::test::property_seed());
  int errors = 0, finished = 0;
  for (int i = 0; i < 3'000; ++i) {
    const CaseFile& c = cases[static_cast<std::size_t>(random() % cases.size())];
    const std::string text = damaged(c.program, cases, random);
    Interpreter run(c.dialect, c.machine, c.tables, "p.nc", text, c.loader(), c.start);
    Interpreter copy(run);
    for (const text::Finding& finding : run.findings()) ASSERT_GT(finding.line, 0) << text;
    std::vector<std::string> letters;
    for (const auto& axis : c.machine.axes) letters.push_back(axis.letter);
    std::vector<std::string> first, second;
    const auto error = run_dry(
        run,
        [&](const Command& command) {
          first.push_back(to_json(command, letters, run.files()));
          for (std::size_t a = 0; a < c.machine.axes.size(); ++a) {
            EXPECT_LE(run.position()[a], c.machine.axes[a].travel_max + 1e-5) << text;
            EXPECT_GE(run.position()[a], c.machine.axes[a].travel_min - 1e-5) << text;
          }
          return first.size() < 300;
        },
        3'000);
    run_dry(
        copy,
        [&](const Command& command) {
          second.push_back(to_json(command, letters, copy.files()));
          return second.size() < 300;
        },
        3'000);
    ASSERT_EQ(first, second) << text;
    finished += error ? 0 : 1;
    if (!error) continue;
    ++errors;
    ASSERT_GT(error->line, 0) << text;
    ASSERT_EQ(std::string::npos, error->str(text::Language::english).find('{')) << text;
  }
  EXPECT_GT(errors, 300);
  EXPECT_GT(finished, 100);
}

INSTANTIATE_TEST_SUITE_P(All, Language, testing::Values("nc110", "fenix", "sinumerik"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace servogate::program::tests
