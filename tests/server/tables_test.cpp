// SPDX-License-Identifier: Apache-2.0
// Origins and tools through the command line: figures, touch-off, undo, exchange, and where the axes are in
// the coordinates of the program.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class Tables : public ::testing::Test {
 protected:
  void begin(const std::string& machine = "mill") {
    shell_.up(machine, {"--virtual", "--speed", "20", "--state", (shell_.folder() / "state").string()});
    shell_.ready();
  }
  Outcome run(const std::vector<std::string>& words) { return shell_.run(words); }
  Outcome good(const std::vector<std::string>& words) {
    Outcome o = run(words);
    EXPECT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
    return o;
  }
  json axis(const std::string& letter) {
    const json status = shell_.status();
    for (const json& a : status["axes"])
      if (a["letter"] == letter) return a;
    return {};
  }
  std::string file(const char* name) const { return (shell_.folder() / name).string(); }

  Shell shell_;
};

TEST_F(Tables, are_set_listed_and_cleared_by_number) {
  begin();
  EXPECT_TRUE(contains(good({"origin", "list"}).out, "the table of origins is empty"));
  EXPECT_EQ(good({"origin", "set", "1", "X100", "Y50"}).out, "origin 1: X 100 mm, Y 50 mm\n");
  good({"origin", "set", "1", "Y=-12.5"});
  good({"tool", "set", "3", "length=85", "radius=5", "name=end mill"});
  EXPECT_EQ(good({"origin", "list"}).out, "origin 1: X 100 mm, Y -12.5 mm\n");
  EXPECT_EQ(good({"tool", "list"}).out, "tool 3: end mill, length Z 85 mm, radius 5 mm\n");
  const json listed = json::parse(good({"tool", "list", "--json"}).out);
  EXPECT_EQ(listed["tools"][0]["length"]["Z"], 85.0);
  EXPECT_EQ(listed["origins"][0]["values"]["X"], 100.0);
  EXPECT_TRUE(contains(shell_.text("state/origins.toml"), "1 = { X = 100.0, Y = -12.5 }")) << "saved at once";
  good({"tool", "clear", "3"});
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "is empty"));
  good({"tool", "undo"});
  EXPECT_TRUE(contains(good({"tool", "list"}).out, "end mill"));
}

TEST_F(Tables, take_lengths_in_inches_and_no_angles) {
  begin();
  EXPECT_EQ(good({"origin", "set", "1", "X4in", "Y50mm"}).out, "origin 1: X 101.6 mm, Y 50 mm\n");
  EXPECT_EQ(good({"tool", "set", "3", "length=2in", "diameter=0.5in", "life=60"}).out,
            "tool 3: length Z 50.8 mm, radius 6.35 mm, used for 0 of 60 min\n");
  EXPECT_EQ(run({"tool", "set", "3", "life=60in"}).exit, 2);
  EXPECT_EQ(run({"origin", "set", "1", "X4ft"}).exit, 2);
}

TEST_F(Tables, refuse_what_is_wrong_and_say_what_is_possible) {
  begin();
  const struct {
    std::vector<std::string> words;
    const char* said;
  } rows[] = {{{"origin", "set", "1"}, "no value was given"},
              {{"origin", "set", "1", "Q5"}, "'Q' is no value of origin; possible are X, Y, Z"},
              {{"origin", "set", "1", "X1e9"}, "is outside -99999.999 to 99999.999"},
              {{"origin", "set", "1", "X0,5"}, "has a decimal comma; write X0.5"},
              {{"origin", "set", "one", "X5"}, "'one' is not a number of a row"},
              {{"origin", "set", "12345", "X5"}, "a number of origin is a whole one from 0 to 9999"},
              {{"tool", "set", "0", "length=5"}, "a number of tool is a whole one from 1 to 9999"},
              {{"tool", "set", "1", "quadrant=12"}, "quadrant = 12 is outside 0 to 9"},
              {{"tool", "here", "1", "radius=3"}, "'radius' has no place that could be touched"},
              {{"origin", "clear", "7"}, "origin 7 is not in the table; it has no row"},
              {{"tool", "undo"}, "there is no change to undo"},
              {{"origin", "change", "7"}, "`origin` takes: list | set"}};
  for (const auto& row : rows) {
    const Outcome o = run(row.words);
    EXPECT_NE(o.exit, 0) << row.said;
    EXPECT_TRUE(contains(o.err, row.said)) << row.said << "\n" << o.err;
  }
}

TEST_F(Tables, count_the_minutes_of_a_tool_and_give_a_worn_out_one_its_alternate) {
  begin();
  good({"tool", "set", "2", "length=30", "life=0.05", "alternate=3"});
  good({"tool", "set", "3", "length=40"});
  EXPECT_EQ(good({"tool", "list"}).out,
            "tool 2: length Z 30 mm, used for 0 of 0.05 min, alternate T3\ntool 3: length Z 40 mm\n");
  std::ofstream(file("cut.nc")) << "N10 T2.2 M6\nN20 G0 X0\nN30 G1 X60 F600\nN40 X0\nN50 M30\n";
  good({"load", file("cut.nc")});
  good({"start", "--wait"});
  EXPECT_EQ(shell_.status()["tool"], 2);
  const json tools = shell_.ask({{"cmd", "tables"}})["tools"];
  EXPECT_NEAR(tools[0]["used_min"].get<double>(), 0.2, 0.02) << "12 s at feed";
  good({"start", "--wait"});
  EXPECT_EQ(shell_.status()["tool"], 3) << "the alternate";
  good({"tool", "set", "2", "alternate=0"});
  const Outcome refused = run({"start"});
  EXPECT_EQ(refused.exit, 1);
  EXPECT_TRUE(contains(refused.err, "T2: the tool is worn out")) << refused.err;
  good({"tool", "set", "2", "used=0"});
  good({"start", "--wait"});
  EXPECT_EQ(shell_.status()["tool"], 2);
}

TEST_F(Tables, are_touched_off_where_the_axes_stand_and_the_status_shows_both_coordinates) {
  begin();
  good({"mdi", "G0 X40 Y20 Z-10", "--wait"});
  good({"origin", "here", "1", "X0", "Z12.5"});
  EXPECT_EQ(good({"origin", "list"}).out, "origin 1: X 40 mm, Z -22.5 mm\n");
  good({"mdi", "(UAO,1)", "--wait"});
  EXPECT_NEAR(axis("X")["work"].get<double>(), 0.0, 0.01);
  EXPECT_NEAR(axis("Z")["work"].get<double>(), 12.5, 0.01);
  EXPECT_NEAR(axis("X")["position"].get<double>(), 40.0, 0.01);
  EXPECT_EQ(axis("X")["origin"], 1);
  // The tool's length is what is left between the machine, the origin and the surface.
  good({"tool", "here", "3", "Z2.5"});
  EXPECT_EQ(good({"tool", "list"}).out, "tool 3: length Z 10 mm\n");
  good({"mdi", "T3.3 M6", "--wait"});
  const double z = axis("Z")["position"], work = axis("Z")["work"];
  EXPECT_NEAR(work, z + 22.5 - 10.0, 1e-3) << "the tool's length is in force";
}

TEST_F(Tables, are_not_changed_while_a_program_runs) {
  begin();
  std::ofstream(file("slow.nc")) << "N10 G1 X100 F60\nN20 M30\n";
  good({"load", file("slow.nc")});
  good({"start"});
  ASSERT_TRUE(
      shell_.until([](const json& s) { return s["state"] == "running" && s["axes"][0]["moving"] == true; }));
  const Outcome o = run({"origin", "set", "1", "X5"});
  EXPECT_EQ(o.exit, 1);
  EXPECT_TRUE(contains(o.err, "gate.program_runs")) << o.err;
  EXPECT_EQ(shell_.status()["processes"][0]["text"], "N10 G1 X100 F60") << "the block's own text";
}

TEST_F(Tables, are_exported_and_imported) {
  begin();
  good({"tool", "set", "3", "length=85", "radius=5", "name=end mill"});
  good({"tool", "export", file("tools.csv")});
  good({"tool", "export", file("tool.tbl")});
  EXPECT_TRUE(contains(shell_.text("tool.tbl"), "T3 P3 Z+85.000000 D10.000000 ;end mill"))
      << shell_.text("tool.tbl");
  good({"tool", "clear", "3"});
  good({"tool", "import", file("tools.csv")});
  EXPECT_EQ(good({"tool", "list"}).out, "tool 3: end mill, length Z 85 mm, radius 5 mm\n");
  std::ofstream(file("bad.csv")) << "tool,radius\n4,five\n";
  const Outcome bad = run({"tool", "import", file("bad.csv")});
  EXPECT_EQ(bad.exit, 2);
  EXPECT_TRUE(contains(bad.err, "bad.csv:2:3: error: `radius`: 'five' is not a number")) << bad.err;
}

TEST_F(Tables, of_a_directory_are_read_by_check_canon_and_run_alike) {
  std::filesystem::create_directory(file("tables"));
  std::ofstream(file("tables/origins.toml")) << "schema = 1\n[origins]\n1 = { X = 100 }\n";
  std::ofstream(file("p.nc")) << "(UAO,1)\nG0 X5\nM30\n";
  const std::string mill = Shell::example("mill/machine.toml");
  EXPECT_TRUE(contains(run({"canon", mill, file("p.nc"), "--tables", file("tables")}).out, "\"X\":105"));
  EXPECT_EQ(run({"check", mill, file("p.nc"), "--tables", file("tables")}).exit, 0);
  EXPECT_EQ(run({"run", mill, file("p.nc"), "--virtual", "-q", "--tables", file("tables")}).exit, 0);
  std::ofstream(file("tables/origins.toml")) << "schema = 1\n[origins]\n1 = { Q = 100 }\n";
  for (const char* command : {"canon", "check", "run"}) {
    const Outcome o = run({command, mill, file("p.nc"), "--tables", file("tables")});
    EXPECT_NE(o.exit, 0) << command;
    EXPECT_TRUE(contains(o.err, "origins.toml:3:7: error: the machine has no axis Q")) << command << o.err;
  }
}

}  // namespace
}  // namespace servogate::gateway::testing
