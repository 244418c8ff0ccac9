// SPDX-License-Identifier: Apache-2.0
// Every NAME.scenario.toml of wrong/ has to give exactly the lines of NAME.expected beside it: add a pair of
// files and it is a test. SERVOGATE_UPDATE=1 writes the .expected files (then read what changed).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "bench/scenario/reading/read_scenario.hpp"
#include "tests/places/places.hpp"

namespace servogate::scenario {
namespace {

const std::string kFolder = tests::source_dir() + "/tests/scenario/wrong/";

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".scenario.toml")) out.push_back(name.substr(0, name.find('.')));
  }
  std::sort(out.begin(), out.end());
  return out;
}

class Wrong : public testing::TestWithParam<std::string> {};

TEST_P(Wrong, says_exactly_what_is_expected_in_both_languages) {
  const std::string path = kFolder + GetParam() + ".scenario.toml",
                    expected = kFolder + GetParam() + ".expected";
  std::vector<text::Finding> findings;
  EXPECT_TRUE(read_scenarios(path, content(path), 1, findings).empty());
  std::string got;
  for (text::Finding& f : findings) {
    EXPECT_GT(f.line, 0) << f.str();
    f.file = GetParam();
    const std::string english = f.str(text::Language::english), russian = f.str(text::Language::russian);
    got += english + "\n";
    EXPECT_NE(english, russian);
    for (const std::string& said : {english, russian}) EXPECT_EQ(said.find("{0}"), std::string::npos) << said;
  }
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) std::ofstream(expected, std::ios::binary) << got;
  ASSERT_FALSE(got.empty()) << "nothing is wrong with this file";
  EXPECT_EQ(got, content(expected));
}

INSTANTIATE_TEST_SUITE_P(Files, Wrong, testing::ValuesIn(names()), [](const auto& i) { return i.param; });

std::vector<Scenario> read(std::string_view text, std::uint64_t seed = 1) {
  std::vector<text::Finding> findings;
  auto scenarios = read_scenarios("/folder/a.scenario.toml", text, seed, findings);
  for (const text::Finding& f : findings) ADD_FAILURE() << f.str();
  return scenarios;
}

TEST(Reading, a_case_puts_its_values_where_their_names_stand) {
  const auto s = read(R"(
schema = 1
title = "feed"
machine = "$kind/machine.toml"
cases = [{kind = "mill", percent = 50}, {kind = "lathe", percent = 120}]
[[step]]
do = "override $percent %"
[[step]]
expect = {signal = "NC.override", equals = "$percent", tolerance = 0.1}
)");
  ASSERT_EQ(s.size(), 2u);
  EXPECT_EQ(s[0].name, "feed [kind=mill, percent=50]");
  EXPECT_EQ(s[1].machine, "/folder/lathe/machine.toml");
  EXPECT_EQ(std::get<Do>(s[1].steps[0].what).words, "override 120 %");
  const Expect& expect = std::get<Expect>(s[1].steps[1].what);
  EXPECT_EQ(std::get<double>(expect.condition.value.is), 120.0) << "a whole value keeps its type";
}

TEST(Reading, what_is_drawn_depends_on_the_seed_alone) {
  constexpr std::string_view kText = R"(
schema = 1
title = "chance"
machine = "m.toml"
[[step]]
never = {alarm = 1001}
always = true
[random]
runs = 3
steps = 50
[[random.action]]
weight = 3
do = "jog X $d mm"
range = {d = [-20, 20]}
[[random.action]]
do = "hold"
)";
  const auto once = read(kText, 7), again = read(kText, 7), other = read(kText, 1000);
  ASSERT_EQ(once.size(), 3u);
  int jogs = 0;
  bool differs = false;
  for (std::size_t run = 0; run < 3; ++run) {
    ASSERT_EQ(once[run].steps.size(), 51u);
    for (std::size_t n = 1; n < 51; ++n) {
      const auto words = [&](const auto& list) { return std::get<Do>(list[run].steps[n].what).words; };
      EXPECT_EQ(words(once), words(again));
      EXPECT_EQ(once[run].steps[n].time, again[run].steps[n].time);
      differs = differs || words(once) != words(other);
      if (words(once) == "hold") continue;
      ++jogs;
      const int d = std::stoi(words(once).substr(6));
      EXPECT_GE(d, -20);
      EXPECT_LE(d, 20);
    }
  }
  EXPECT_TRUE(differs);
  EXPECT_GT(jogs, 90) << "three times as often as the other";
}

TEST(Reading, given_of_an_included_file_comes_first) {
  const std::string folder = testing::TempDir();
  std::ofstream(folder + "/ready.toml")
      << "machine = \"mill.toml\"\ntimeout = \"9 s\"\n[[given]]\ndo = \"ready\"\n";
  std::vector<text::Finding> findings;
  const auto s = read_scenarios(
      folder + "/a.scenario.toml",
      "schema = 1\ntitle = \"t\"\ninclude = \"ready.toml\"\n[[given]]\ndo = \"hold\"\n[[step]]\n"
      "expect = {no_alarm = true}\n",
      1, findings);
  ASSERT_EQ(s.size(), 1u);
  EXPECT_EQ(s[0].timeout, 9 * image::kSecond);
  ASSERT_EQ(s[0].given.size(), 2u);
  EXPECT_EQ(std::get<Do>(s[0].given[0].what).words, "ready");
  EXPECT_TRUE(std::get<Do>(s[0].given[0].what).wait) << "what is given is waited for";
}

}  // namespace
}  // namespace servogate::scenario
