// SPDX-License-Identifier: Apache-2.0
#include "machine/tables/exchange.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

const std::vector<std::string> kAxes{"X", "Z"};

program::Tables sample() {
  program::Tables t;
  t.origins = {{1, {{"X", 100.5}, {"Z", -2.0}}}, {7, {{"Z", 1.0 / 3.0}}}};
  t.correctors[3] = {
      "mill, \"roughing\"", {{"Z", 85.0}}, {{"Z", -0.01}}, 5.0, 0.02, {}, 0.0, 0, 60.0, 12.5, 12};
  t.correctors[12] = {"insert", {{"X", 12.5}, {"Z", 40.0}}, {}, 0.4, 0.0, {}, 0.0, 3};
  return t;
}

std::string lines(const std::vector<text::Finding>& findings) {
  return test::lines_of(findings, text::Language::english);
}

TEST(Exchange, gives_back_from_csv_the_limits_of_wear_in_columns_of_their_own) {
  program::Tables tables = sample();
  tables.correctors[12].wear_limit = {{"X", 0.2}};
  tables.correctors[12].radius_wear_limit = 0.05;
  const std::string csv = to_csv(tables, TableKind::tools, kAxes);
  EXPECT_NE(csv.find("wear_Z,radius_wear_limit,wear_limit_X,wear_limit_Z\r\n"), std::string::npos) << csv;
  program::Tables read;
  std::vector<text::Finding> findings;
  ASSERT_TRUE(read_exchange(csv, "t.csv", TableKind::tools, kAxes, read, findings)) << lines(findings);
  EXPECT_EQ(read.correctors, tables.correctors);
}

TEST(Exchange, gives_back_from_csv_what_was_written_into_it) {
  for (const TableKind kind : {TableKind::origins, TableKind::tools}) {
    program::Tables read;
    std::vector<text::Finding> findings;
    ASSERT_TRUE(read_exchange(to_csv(sample(), kind, kAxes), "t.csv", kind, kAxes, read, findings))
        << lines(findings);
    if (kind == TableKind::origins)
      EXPECT_EQ(read.origins, sample().origins);
    else
      EXPECT_EQ(read.correctors, sample().correctors);
  }
}

TEST(Exchange, writes_csv_with_a_column_an_axis) {
  EXPECT_EQ(to_csv(sample(), TableKind::tools, kAxes),
            "tool,name,radius,radius_wear,quadrant,life_min,used_min,alternate,X,Z,wear_X,wear_Z\r\n"
            "3,\"mill, \"\"roughing\"\"\",5,0.02,0,60,12.5,12,,85,,-0.01\r\n"
            "12,insert,0.4,0,3,0,0,0,12.5,40,,\r\n");
}

TEST(Exchange, reads_the_tool_table_of_linuxcnc_as_its_documentation_has_it) {
  program::Tables read;
  std::vector<text::Finding> findings;
  ASSERT_TRUE(read_exchange(
      "; a comment\nT1 P17 Z0.511 D0.125  ;1/8 end mill\nt21 P2 X-3 Z+1.5 D12.5 I95 J155 Q2\r\n\n",
      "tool.tbl", TableKind::tools, kAxes, read, findings))
      << lines(findings);
  ASSERT_EQ(read.correctors.size(), 2u);
  EXPECT_EQ(read.correctors.at(1).name, "1/8 end mill");
  EXPECT_EQ(read.correctors.at(1).length_of("Z"), 0.511);
  EXPECT_EQ(read.correctors.at(1).radius, 0.0625);
  EXPECT_EQ(read.correctors.at(21).length_of("X"), -3.0);
  EXPECT_EQ(read.correctors.at(21).quadrant, 2);
}

TEST(Exchange, gives_back_from_linuxcnc_the_lengths_with_their_wear) {
  program::Tables read;
  std::vector<text::Finding> findings;
  ASSERT_TRUE(read_exchange(to_linuxcnc(sample(), kAxes), "t.tbl", TableKind::tools, kAxes, read, findings))
      << lines(findings);
  EXPECT_DOUBLE_EQ(read.correctors.at(3).length_of("Z"), 84.99);
  EXPECT_DOUBLE_EQ(read.correctors.at(3).radius, 5.02);
  EXPECT_EQ(read.correctors.at(12).length_of("X"), 12.5);
}

TEST(Exchange, leaves_rows_that_the_file_does_not_name) {
  program::Tables tables = sample();
  std::vector<text::Finding> findings;
  ASSERT_TRUE(read_exchange("origin,X\n2,5\n1,7\n", "o.csv", TableKind::origins, kAxes, tables, findings));
  EXPECT_EQ(tables.origins.at(1), (std::map<std::string, double>{{"X", 7.0}}));
  EXPECT_EQ(tables.origins.at(2), (std::map<std::string, double>{{"X", 5.0}}));
  EXPECT_EQ(tables.origins.at(7), sample().origins.at(7));
}

TEST(Exchange, names_each_mistake_with_its_place_and_changes_nothing) {
  const struct {
    const char *file, *text, *said;
    TableKind kind;
  } rows[] = {
      {"o.csv", "X,Y\n", "o.csv:1:1: error: the first line must begin with `origin`, as origin,X,Z",
       TableKind::origins},
      {"o.csv", "", "o.csv:1:1: error: the first line", TableKind::origins},
      {"o.csv", "origin,Q\n1,2\n", "o.csv:1:8: error: unknown column `Q`; known: origin,X,Z",
       TableKind::origins},
      {"o.csv", "origin,X\n1,2,3\n", "o.csv:2:1: error: 3 fields, and the header has 2", TableKind::origins},
      {"o.csv", "origin,X\n1,2\n1,3\n", "o.csv:3:1: error: number 1 stands in the file twice",
       TableKind::origins},
      {"o.csv", "origin,X\n1,\"2,5\"\n", "o.csv:2:3: error: `X`: '2,5' is not a number", TableKind::origins},
      {"o.csv", "origin,X\n1,1e9\n", "o.csv:2:3: error: `X`: '1e9' is not a number", TableKind::origins},
      {"t.csv", "tool,quadrant\n1,2.5\n", "t.csv:2:3: error: `quadrant`: '2.5' is not a whole number",
       TableKind::tools},
      {"t.csv", "tool,radius\n0,2\n", "t.csv:2:1: error: `tool`: '0' is not a whole number",
       TableKind::tools},
      {"t.tbl", "P1 Z1\n", "t.tbl:1:1: error: the line has no T", TableKind::tools},
      {"t.tbl", "T1 P1 Y5\n", "t.tbl:1:7: error: the machine has no axis Y; it has X,Z", TableKind::tools},
      {"t.tbl", "T1 N5\n", "t.tbl:1:4: error: 'N5' is no word of a LinuxCNC tool table", TableKind::tools},
      {"t.tbl", "T1\n", "t.tbl:1:1: error: a LinuxCNC tool table has no origins", TableKind::origins}};
  for (const auto& row : rows) {
    program::Tables tables = sample();
    std::vector<text::Finding> findings;
    EXPECT_FALSE(read_exchange(row.text, row.file, row.kind, kAxes, tables, findings)) << row.text;
    EXPECT_EQ(tables, sample()) << row.text;
    EXPECT_NE(lines(findings).find(row.said), std::string::npos) << row.said << "\n" << lines(findings);
  }
}

TEST(Exchange, survives_any_text) {
  std::mt19937 random(20251125);
  const std::string letters = "origin,tool\nTPXZDQ;\"0123456789.-+eé \r";
  for (int i = 0; i < 2000; ++i) {
    std::string text = i % 2 == 0 ? "origin,X\n" : "";
    for (unsigned n = random() % 60; n > 0; --n) text += letters[random() % letters.size()];
    program::Tables tables;
    std::vector<text::Finding> findings;
    const bool good =
        read_exchange(text, i % 3 == 0 ? "a.tbl" : "a.csv",
                      i % 2 == 0 ? TableKind::origins : TableKind::tools, kAxes, tables, findings);
    ASSERT_EQ(good, findings.empty()) << text;
  }
}

}  // namespace
}  // namespace servogate::machine
