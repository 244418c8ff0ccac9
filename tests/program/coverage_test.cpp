// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/places/places.hpp"
#include "tests/program/case_judge.hpp"

/// docs/coverage/nc110.md: what of the language is proved, made from a run of the cases that name its rows.
namespace servogate::program::tests {
namespace {

const std::string kTree = servogate::tests::source_dir();
const std::string kRows = kTree + "/tests/program/nc110/rows.txt";
const std::string kDocument = kTree + "/docs/coverage/nc110.md";
constexpr std::size_t kTestsNamed = 3;

/// One row of the checklist: `A22 | feature | test: FILE Suite.name | waits: WHAT`.
struct Row {
  std::string number, feature, waits;
  std::vector<std::string> tests;
  bool passes = true;
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::string content_of(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A test of another room, whose own run judges it: it has to stand in the tree.
bool stands(const std::string& test) {
  std::istringstream in(test);
  std::string file, name;
  in >> file >> name;
  const std::size_t point = name.find('.');
  if (point == std::string::npos) return false;
  const std::string text = content_of(kTree + "/" + file);
  for (const char* macro : {"TEST(", "TEST_F(", "TEST_P("})
    if (text.find(macro + name.substr(0, point) + ", " + name.substr(point + 1) + ")") != std::string::npos)
      return true;
  return false;
}

std::vector<Row> read_rows() {
  std::vector<Row> rows;
  std::ifstream in(kRows);
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    Row row;
    std::string field;
    if (!std::getline(fields, row.number, '|') || !std::getline(fields, row.feature, '|')) continue;
    row.number = trimmed(row.number);
    row.feature = trimmed(row.feature);
    while (std::getline(fields, field, '|')) {
      field = trimmed(field);
      if (field.starts_with("waits: ")) row.waits = field.substr(7);
      if (field.starts_with("test: ")) {
        row.tests.push_back(field.substr(6));
        row.passes = row.passes && stands(row.tests.back());
      }
    }
    rows.push_back(row);
  }
  return rows;
}

std::string tests_of(const Row& row) {
  std::string out;
  for (std::size_t i = 0; i < std::min(row.tests.size(), kTestsNamed); ++i)
    out += (i == 0 ? "" : ", ") + row.tests[i];
  if (row.tests.size() > kTestsNamed) out += ", +" + std::to_string(row.tests.size() - kTestsNamed);
  return out.empty() ? "none" : out;
}

std::string state_of(const Row& row) {
  if (row.tests.empty() || !row.passes) return "fail";
  return row.waits.empty() ? "pass" : "waits: " + row.waits;
}

std::string document(const std::vector<Row>& rows) {
  std::map<std::string, int> count;
  std::string table;
  for (const Row& row : rows) {
    const std::string state = state_of(row);
    ++count[state.substr(0, 4)];
    table += "| " + row.number + " | " + row.feature + " | " + tests_of(row) + " | " + state + " |\n";
  }
  std::string out =
      "# NC-110: what is proved\n\n"
      "Made by the run of `tests/program` (`SERVOGATE_UPDATE=1 build/release/tests/program/test_program "
      "--gtest_filter=Coverage.*`);\n"
      "do not edit. A row is a feature of the programmer's manual. A name alone is a file of "
      "`tests/program/nc110` (without `.test`),\n"
      "which was run for this page; a path is a test of another room, which that room runs. `fail`: no test "
      "proves the row.\n\n";
  out += "pass " + std::to_string(count["pass"]) + ", waits " + std::to_string(count["wait"]) + ", fail " +
         std::to_string(count["fail"]) + " of " + std::to_string(rows.size()) + "\n\n";
  return out + "| # | feature | test | pass |\n|---|---|---|---|\n" + table;
}

TEST(Coverage, the_page_says_what_the_cases_prove) {
  std::vector<Row> rows = read_rows();
  ASSERT_EQ(rows.size(), 284u + 202u);
  std::map<std::string, Row*> by_number;
  for (Row& row : rows) by_number[row.number] = &row;
  ASSERT_EQ(by_number.size(), rows.size());
  const std::string folder = kTree + "/tests/program/nc110";
  for (const std::string& path : case_paths(folder)) {
    const CaseFile c = read_case(path);
    if (c.rows.empty()) continue;
    const bool passes = failures_of(c).empty();
    const std::string name = std::filesystem::relative(path, folder).replace_extension().string();
    for (const std::string& number : c.rows) {
      ASSERT_TRUE(by_number.contains(number)) << path << ": no row " << number;
      by_number[number]->tests.push_back(name);
      by_number[number]->passes = by_number[number]->passes && passes;
    }
  }
  const std::string made = document(rows);
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) std::ofstream(kDocument) << made;
  EXPECT_TRUE(made == content_of(kDocument)) << kDocument << ": SERVOGATE_UPDATE=1 writes the page anew";
}

TEST(Coverage, tests_of_other_rooms_that_rows_name_stand_in_the_tree) {
  for (const Row& row : read_rows())
    EXPECT_TRUE(row.passes) << row.number << ": a test that it names does not stand in its file";
}

}  // namespace
}  // namespace servogate::program::tests
