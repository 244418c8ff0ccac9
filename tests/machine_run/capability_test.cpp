// SPDX-License-Identifier: Apache-2.0
// What a program asks for and the machine cannot do: said alike before and while it runs.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using nlohmann::json;

const std::string kMill = source("examples/mill/machine.toml"),
                  kLathe = source("examples/lathe/machine.toml");

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(Capability, is_said_by_check_canon_and_run_with_the_same_words_and_ends_nothing) {
  const Scratch scratch;
  const std::string program =
      scratch.write("fast.nc", "N10 S7000 M3\nN20 S10\nN30 G0 X10\nN40 G1 X20 F40000\nN50 X30\nM5\nM30\n");
  const std::string sentences[] = {
      program + ":1:5: warning: S7000 is above the 6000 rpm of the spindle: it turns at 6000 [P808]",
      program + ":2:5: warning: S10 is below the 50 rpm of the spindle: it turns at 50 [P809]",
      program +
          ":4:12: warning: F40000 asks for 40000 mm/min; in line 4 the axes reach 30000 mm/min (X), the "
          "motion is as fast as that [P813]"};
  const std::string report = scratch.path("report.json");
  const Ending check = servogate({"check", kMill, program}), canon = servogate({"canon", kMill, program}),
               run = servogate({"run", kMill, program, "--report", report});
  for (const Ending* e : {&check, &canon, &run}) {
    EXPECT_EQ(e->code, 0) << e->err;
    for (const std::string& sentence : sentences)
      EXPECT_NE(e->err.find(sentence), std::string::npos) << e->err;
  }
  EXPECT_EQ(count(check.err, "P808"), 1);
  EXPECT_EQ(count(canon.out, "warning"), 0) << "standard output holds commands only";
  const json made = json::parse(read_all(report));
  EXPECT_TRUE(made["finished"].get<bool>());
  const json& alarms = made["alarms"];
  ASSERT_EQ(alarms.size(), 3u) << alarms.dump(1);
  for (const json& a : alarms) EXPECT_EQ(a["number"], 4012) << a.dump(1);
  EXPECT_NE(alarms[0]["text"].get<std::string>().find("S7000 is above"), std::string::npos)
      << alarms[0].dump(1);
}

TEST(Capability, that_is_missing_altogether_is_an_error_before_anything_of_the_block) {
  const Scratch scratch;
  const std::string tool = scratch.write("tool.nc", "N10 G0 X60 Z100\nN20 X50 T4.4\nM30\n");
  const std::string said = tool + ":2:9: error: T4: the magazine of this machine has 3 places [P811]";
  const Ending check = servogate({"check", kLathe, tool});
  EXPECT_EQ(check.code, 1);
  EXPECT_NE(check.err.find(said), std::string::npos) << check.err;
  const Ending run = servogate({"run", kLathe, tool});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
  const std::string surface = scratch.write("surface.nc", "G96 S100 M3\nM30\n");
  const Ending mill = servogate({"check", kMill, surface});
  EXPECT_EQ(mill.code, 1);
  EXPECT_NE(mill.err.find(surface + ":1:5: error: S100: a cutting speed (G96) needs an axis"),
            std::string::npos)
      << mill.err;
}

TEST(Capability, names_correctors_that_the_kept_tool_table_does_not_hold) {
  const Scratch scratch;
  const std::string program = scratch.write("tools.nc", "T1.1\nT2.2\nM30\n");
  const std::string state = scratch.path("state");
  // The first run leaves an empty table behind, which says nothing about tools.
  ASSERT_EQ(servogate({"run", kMill, program, "--state", state}).code, 0);
  EXPECT_EQ(count(servogate({"run", kMill, program, "--state", state}).err, "P812"), 0);
  std::string tools = read_all(state + "/tools.toml");
  const std::size_t line = tools.find('\n');
  ASSERT_NE(line, std::string::npos);
  scratch.write("state/tools.toml",
                "checksum = \"none\"" + tools.substr(line) +
                    "\n[[tool]]\nnumber = 1\nlength = { Z = 120.0 }\n");
  const Ending run = servogate({"run", kMill, program, "--state", state});
  EXPECT_EQ(run.code, 0) << run.err << read_all(state + "/tools.toml");
  EXPECT_NE(run.err.find(program + ":2:1: warning: the corrector 2 is not in the tool table"),
            std::string::npos)
      << run.err;
  EXPECT_EQ(run.err.find(program + ":1:1: warning"), std::string::npos) << run.err;
}

TEST(Capability, goes_by_the_kept_origins_and_tools_alike_in_check_canon_and_run) {
  const Scratch scratch;
  const std::string mill = changed_mill(scratch, "state = \"state\"", "state = \"kept\"");
  const std::string kept = scratch.path("kept"),
                    inside = scratch.write("inside.nc", "T1.1 M6\nG0 X10\nM30\n"),
                    outside = scratch.write("outside.nc", "G0 X20\nM30\n");
  std::filesystem::create_directory(kept);
  scratch.write("kept/origins.toml",
                "checksum = \"none\"\nschema = 1\npart = \"origins\"\n[origins]\n\"0\" = { X = 285.0 }\n");
  scratch.write("kept/tools.toml",
                "checksum = \"none\"\nschema = 1\npart = \"tools\"\ntool_in_spindle = "
                "0\n[[tool]]\nnumber = 1\nlength = { X = 3.5 }\n");
  const Ending canon = servogate({"canon", mill, inside});
  EXPECT_EQ(canon.code, 0) << canon.err;
  EXPECT_NE(canon.out.find("\"to\":{\"X\":298.5,"), std::string::npos) << canon.out;
  const Ending check = servogate({"check", mill, inside, "--json"});
  EXPECT_EQ(json::parse(check.out)["programs"][0]["extents"]["X"]["max"], 298.5) << check.err;
  const std::string beyond = outside + ":1:4: error: X would go to 305, the travel ends at 300 [P701]";
  for (const std::vector<std::string>& line : {std::vector<std::string>{"check", mill, outside},
                                               {"canon", mill, outside},
                                               {"run", mill, outside, "--state", kept}}) {
    const Ending e = servogate(line);
    EXPECT_EQ(e.code, 1) << line[0];
    EXPECT_NE(e.err.find(beyond), std::string::npos) << line[0] << ": " << e.err;
  }
}

}  // namespace
}  // namespace servogate::machine_run
