// SPDX-License-Identifier: Apache-2.0
// What a newcomer is told: by `check`, by page and JSON of a run that came to nothing, by the small examples.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using nlohmann::json;

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n'), begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin);
}

TEST(Verdict, page_and_json_of_a_refused_program_begin_with_the_reason) {
  const Scratch scratch;
  const std::string nc = scratch.write("far.nc", "N10 G90 G71 G94\nN20 G1 X99999 F100\nN30 M30\n");
  const Ending e =
      servogate({"run", mill_file(), nc, "--virtual", "--json", "--html", scratch.path("far.html")});
  EXPECT_NE(e.code, 0);
  const json report = json::parse(e.out);
  EXPECT_FALSE(report["finished"]);
  EXPECT_EQ(report["verdict"]["outcome"], "refused");
  const std::string why = report["verdict"]["text"];
  EXPECT_TRUE(says(why, "far.nc:2")) << why;
  EXPECT_TRUE(says(why, "99999")) << why;
  if (std::system("node --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "no node here; install nodejs to run the page's script in this test";
  std::string capital = why;
  capital[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(capital[0])));
  const json expected{{"tolerance", 0},
                      {"start", 0},
                      {"card", "0"},
                      {"samples", json::array()},
                      {"peaks", json::object()},
                      {"shown", {capital, "far.nc:2"}}};
  scratch.write("expected.json", expected.dump());
  EXPECT_EQ(std::system(("node " + source("tests/report/page_smoke.js ") + scratch.path("far.html") + " " +
                         scratch.path("expected.json"))
                            .c_str()),
            0)
      << "the page shows the reason, and nothing that is no number";
}

TEST(Verdict, of_a_run_that_finished_says_so_and_where_its_files_are) {
  const Scratch scratch;
  const std::string nc = scratch.write("end.nc", "N10 M30\n");
  const Ending e =
      servogate({"run", mill_file(), nc, "--virtual", "--json", "--trace", scratch.path("end.csv")});
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(json::parse(e.out)["verdict"]["outcome"], "finished");
  EXPECT_TRUE(says(e.err, "written: " + scratch.path("end.csv"))) << e.err;
}

TEST(Verdict, of_a_run_that_waited_for_ever_has_its_remedy) {
  const Scratch scratch;
  const std::string nc = scratch.write("stop.nc", "N10 M0\nN20 M30\n");
  const Ending e = servogate({"run", mill_file(), nc, "--virtual", "--json", "--patience", "1"});
  const json verdict = json::parse(e.out)["verdict"];
  EXPECT_EQ(verdict["outcome"], "waited");
  EXPECT_TRUE(says(verdict["remedy"], "servogate up")) << verdict;
}

TEST(Check, refuses_a_machine_without_plc_which_can_never_start) {
  const Scratch scratch;
  std::string text = read_all(source("examples/minimal/machine.toml"));
  const std::string plc = "[plc]\nsources = [\"minimal.st\"]\n";
  ASSERT_TRUE(says(text, plc));
  text.replace(text.find(plc), plc.size(), "");
  const Ending e = servogate({"check", scratch.write("machine.toml", text)});
  EXPECT_EQ(e.code, 1);
  EXPECT_TRUE(says(e.err, "error: [plc] names no sources")) << e.err;
  EXPECT_EQ(last_line(e.out), "1 error, 4 warnings") << e.out;
}

TEST(Check, ends_with_what_all_of_it_comes_to) {
  const Scratch scratch;
  const std::string nc = scratch.write("far.nc", "N10 G1 X99999 F100\nN20 M30\n");
  const Ending e = servogate({"check", mill_file(), nc});
  EXPECT_EQ(last_line(e.out), "1 error, no warnings") << e.out;
  EXPECT_FALSE(says(servogate({"check", mill_file(), nc, "--json"}).out, "no warnings"));
}

TEST(Check, of_an_axis_without_end_says_so_instead_of_a_travel) {
  const Scratch scratch;
  std::string text = read_all(source("examples/four-axis-mill/machine.toml"));
  for (const std::string line : {"travel_min = \"-360 deg\"\n", "travel_max = \"360 deg\"\n"}) {
    ASSERT_TRUE(says(text, line));
    text.replace(text.find("360", text.find(line)), 3, "0");
  }
  scratch.write("mill.st", read_all(source("examples/four-axis-mill/mill.st")));
  const std::string nc = scratch.write("turn.nc", "N10 G91 G94\nN20 G1 A720 F3600\nN30 M30\n");
  const Ending e = servogate({"check", scratch.write("machine.toml", text), nc});
  EXPECT_TRUE(says(e.out, "  A: 0 to 720 deg, without end\n")) << e.out << e.err;
}

class SmallExample : public ::testing::TestWithParam<const char*> {};

TEST_P(SmallExample, has_no_errors_and_runs_to_its_end) {
  const std::string program = source(std::string("examples/") + GetParam());
  const std::string machine = program.substr(0, program.rfind('/')) + "/machine.toml";
  const Ending check = servogate({"check", machine, program});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_TRUE(last_line(check.out).starts_with("no errors")) << check.out;
  const Ending e = servogate({"run", machine, program, "--json"});
  EXPECT_EQ(e.code, 0) << e.err;
  const json report = json::parse(e.out);
  EXPECT_TRUE(report["finished"]);
  EXPECT_TRUE(report["alarms"].empty()) << report["alarms"];
  EXPECT_LT(report["segments"][0]["load"], 0.8);
}

INSTANTIATE_TEST_SUITE_P(Newcomer, SmallExample,
                         ::testing::Values("minimal/square.nc", "two-axis-lathe/pin.nc",
                                           "four-axis-mill/star.nc", "retrofit/pocket.nc"));

}  // namespace
}  // namespace servogate::machine_run
