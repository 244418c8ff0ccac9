// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/places/places.hpp"
#include "tests/program/case_judge.hpp"

/// docs/coverage/: what of a language is proved, made from a run of the cases that name its rows.
namespace servogate::program::tests {
namespace {

const std::string kTree = servogate::tests::source_dir();

/// A language whose checklist is complete.
struct Checklist {
  const char* name;  ///< folder of its cases
  const char* page;
  const char* title;  ///< as people write it
  std::size_t rows;
};
constexpr Checklist kChecklists[] = {{"nc110", "nc110", "NC-110", 284 + 202},
                                     {"fenix", "fenix", "Fenix", 159},
                                     {"sinumerik", "sinumerik808d", "SINUMERIK 808D, ISO dialect", 276}};

std::string folder_of(const Checklist& list) { return kTree + "/tests/program/" + list.name; }
std::string page_of(const Checklist& list) { return kTree + "/docs/coverage/" + list.page + ".md"; }
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

std::vector<Row> read_rows(const Checklist& list) {
  std::vector<Row> rows;
  std::ifstream in(folder_of(list) + "/rows.txt");
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

std::string document(const Checklist& list, const std::vector<Row>& rows) {
  std::map<std::string, int> count;
  std::string table;
  for (const Row& row : rows) {
    const std::string state = state_of(row);
    ++count[state.substr(0, 4)];
    table += "| " + row.number + " | " + row.feature + " | " + tests_of(row) + " | " + state + " |\n";
  }
  std::string out =
      "# " + std::string(list.title) +
      ": what is proved\n\n"
      "Made by the run of `tests/program` (`SERVOGATE_UPDATE=1 build/release/tests/program/test_program "
      "--gtest_filter=*Coverage.*`);\n"
      "do not edit. A row is a feature of the programmer's manual. A name alone is a file of "
      "`tests/program/" +
      list.name +
      "` (without `.test`),\n"
      "which was run for this page; a path is a test of another room, which that room runs. `fail`: no test "
      "proves the row.\n\n";
  out += "pass " + std::to_string(count["pass"]) + ", waits " + std::to_string(count["wait"]) + ", fail " +
         std::to_string(count["fail"]) + " of " + std::to_string(rows.size()) + "\n\n";
  return out + "| # | feature | test | pass |\n|---|---|---|---|\n" + table;
}

class Coverage : public ::testing::TestWithParam<Checklist> {};
INSTANTIATE_TEST_SUITE_P(Languages, Coverage, ::testing::ValuesIn(kChecklists),
                         [](const auto& each) { return std::string(each.param.name); });

TEST_P(Coverage, of_a_language_is_a_page_that_says_what_its_cases_prove) {
  const Checklist& list = GetParam();
  std::vector<Row> rows = read_rows(list);
  ASSERT_EQ(rows.size(), list.rows);
  std::map<std::string, Row*> by_number;
  for (Row& row : rows) by_number[row.number] = &row;
  ASSERT_EQ(by_number.size(), rows.size());
  for (const std::string& path : case_paths(folder_of(list))) {
    const CaseFile c = read_case(path);
    if (c.rows.empty()) continue;
    const bool passes = failures_of(c).empty();
    const std::string name = std::filesystem::relative(path, folder_of(list)).replace_extension().string();
    for (const std::string& number : c.rows) {
      ASSERT_TRUE(by_number.contains(number)) << path << ": no row " << number;
      by_number[number]->tests.push_back(name);
      by_number[number]->passes = by_number[number]->passes && passes;
    }
  }
  const std::string made = document(list, rows);
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) std::ofstream(page_of(list)) << made;
  EXPECT_TRUE(made == content_of(page_of(list)))
      << page_of(list) << ": SERVOGATE_UPDATE=1 writes the page anew";
}

TEST_P(Coverage, names_tests_of_other_rooms_that_stand_in_the_tree) {
  for (const Row& row : read_rows(GetParam()))
    EXPECT_TRUE(row.passes) << row.number << ": a test that it names does not stand in its file";
}

}  // namespace
}  // namespace servogate::program::tests
