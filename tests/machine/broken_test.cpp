// SPDX-License-Identifier: Apache-2.0
// Every NAME.toml of broken/ and broken_devices/ has to give exactly the lines of NAME.expected beside it:
// add a pair of files and it is a test. SERVOGATE_UPDATE=1 writes the .expected files (then read what
// changed).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "machine/device.hpp"
#include "machine/load.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

using test::lines_of;
using test::read_text;
using test::source;

std::vector<std::string> names(const std::string& folder) {
  std::vector<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(source(folder)))
    if (entry.path().extension() == ".toml") out.push_back(entry.path().stem().string());
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<text::Finding> findings_of(const std::string& folder, const std::string& name) {
  const std::string path = source(folder + "/" + name + ".toml");
  return folder.ends_with("devices") ? load_device(path).findings : load(path).findings;
}

class Broken : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(Broken, says_exactly_what_is_expected) {
  const auto& [folder, name] = GetParam();
  const std::vector<text::Finding> findings = findings_of(folder, name);
  const std::string got = lines_of(findings, text::Language::english);
  const std::string expected = source(folder + "/" + name + ".expected");
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) test::write_text(expected, got);
  ASSERT_FALSE(got.empty()) << "this file is not broken";
  EXPECT_EQ(got, read_text(expected));
  for (const text::Finding& f : findings) {
    EXPECT_GT(f.line, 0) << f.str() << ": no line to go to";
    EXPECT_GT(f.column, 0) << f.str() << ": no column to go to";
  }
}

/// In Russian the same findings at the same places, in Russian words, with nothing left open.
TEST_P(Broken, says_it_in_russian_too) {
  const auto& [folder, name] = GetParam();
  for (const text::Finding& f : findings_of(folder, name)) {
    const std::string russian = f.str(text::Language::russian), english = f.str(text::Language::english);
    EXPECT_NE(russian, english);
    // UTF-8 Cyrillic begins with D0 or D1.
    EXPECT_TRUE(russian.find('\xD0') != std::string::npos || russian.find('\xD1') != std::string::npos)
        << russian;
    for (const std::string& said : {russian, english}) {
      EXPECT_EQ(said.find('{'), said.find("{ ")) << said;
      EXPECT_EQ(said.find('\x1f'), std::string::npos) << said;
    }
    const std::string_view severity = f.severity == text::Severity::error ? ": error: " : ": warning: ";
    ASSERT_NE(english.find(severity), std::string::npos);
    EXPECT_EQ(russian.substr(0, russian.find(severity)), english.substr(0, english.find(severity)));
  }
}

std::vector<std::pair<std::string, std::string>> all() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const std::string folder : {"tests/machine/broken", "tests/machine/broken_devices"})
    for (const std::string& name : names(folder)) out.emplace_back(folder, name);
  return out;
}

std::string test_name(const testing::TestParamInfo<std::pair<std::string, std::string>>& file) {
  return (file.param.first.ends_with("devices") ? "device_" : "") + file.param.second;
}

INSTANTIATE_TEST_SUITE_P(Files, Broken, testing::ValuesIn(all()), test_name);

TEST(BrokenFiles, are_at_least_a_hundred_and_cover_most_codes) {
  std::set<std::string_view> codes;
  for (const auto& [folder, name] : all())
    for (const text::Finding& f : findings_of(folder, name)) codes.insert(f.entry->id);
  EXPECT_GE(all().size(), 100u);
  EXPECT_GE(codes.size(), 60u);
}

}  // namespace
}  // namespace servogate::machine
