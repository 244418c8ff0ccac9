// SPDX-License-Identifier: Apache-2.0
// PLC programs and their tests from the shell.
#include <gtest/gtest.h>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

constexpr const char* kBlink = R"(PROGRAM Blink
VAR start, lamp : BOOL; timer : TON; END_VAR
timer(IN := start, PT := T#3ms);
lamp := timer.Q;
END_PROGRAM
)";

TEST(PlcTest, passes_with_0_and_prints_what_passed) {
  Desk desk;
  desk.write("blink.st", kBlink);
  desk.write("blink.test", "source blink.st\ntest it lights\nset start = TRUE\nuntil lamp within 5ms\n");
  const Ended e = desk.line("$SG plc test blink.test");
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(e.out, "passed: it lights\n1 tests, 0 failed\n");
  EXPECT_EQ(e.err, "");
  EXPECT_EQ(desk.line("cd / && $SG plc test " + desk.path("blink.test")).code, 0)
      << "paths are those of the test";
}

TEST(PlcTest, fails_with_1_and_file_line_expected_and_got) {
  Desk desk;
  desk.write("blink.st", kBlink);
  desk.write(
      "blink.test",
      "test it lights at once\nset start = TRUE\nrun 1\nexpect lamp\ntest it is dark\nexpect NOT lamp\n");
  const Ended e = desk.line("$SG plc test blink.st blink.test");
  EXPECT_EQ(e.code, 1);
  EXPECT_TRUE(e.out_has("FAILED: it lights at once\npassed: it is dark\n2 tests, 1 failed\n")) << e.out;
  EXPECT_TRUE(e.err_has(
      "blink.test:4:8: error: expected lamp = TRUE, got FALSE (scan 1, after 0ms) [plc-test-failed]\n"
      " 4 | expect lamp\n   |        ^\n"))
      << e.err;
  const Ended json = desk.line("$SG plc test blink.st blink.test --json");
  EXPECT_EQ(json.code, 1);
  EXPECT_TRUE(json.out_has("\"failed\":1")) << json.out;
  EXPECT_TRUE(json.out_has("\"passed\":false")) << json.out;
}

TEST(PlcTest, tells_a_wrong_test_with_1_and_what_cannot_be_read_with_2) {
  Desk desk;
  desk.write("blink.st", kBlink);
  desk.write("wrong.test", "test a\nrun soon\n");
  desk.write("alone.test", "test a\nrun 1\n");
  desk.write("lost.test", "source nowhere.st\ntest a\nrun 1\n");
  desk.write("broken.st", "PROGRAM Blink lamp := 1; END_PROGRAM");
  EXPECT_EQ(desk.line("$SG plc test blink.st wrong.test").code, 1);
  EXPECT_EQ(desk.line("$SG plc test blink.st").code, 2);
  EXPECT_EQ(desk.line("$SG plc test alone.test").code, 2);
  EXPECT_EQ(desk.line("$SG plc test lost.test").code, 2);
  EXPECT_EQ(desk.line("$SG plc test none.test").code, 2);
  EXPECT_EQ(desk.line("$SG plc test broken.st alone.test").code, 2);
  EXPECT_TRUE(desk.line("$SG plc test blink.st", "ru_RU.UTF-8").err_has("среди файлов нет тестов"));
}

TEST(PlcTest, knows_the_symbols_and_sources_of_a_machine) {
  Desk desk;
  desk.write("mill.test", "test the chain closes\nset estop_chain_ok = TRUE\nrun 1\nexpect MC.estop_ok\n");
  const Ended e = desk.line("$SG plc test mill.test --machine $MILL");
  EXPECT_EQ(e.code, 0) << e.err;
}

TEST(ForcedRun, lists_what_was_forced_in_its_report_and_page) {
  Desk desk;
  const Ended e = desk.line(
      "$SG run $MILL --virtual -q --force lamp_red=TRUE --force Mill.change.alarm=5 --force %MW400=16#FF00 "
      "--report r.json --html h.html --trace t.csv");
  EXPECT_EQ(e.code, 0) << e.err;
  const std::string report = desk.text("r.json");
  const auto written = [&](const std::string& name, const std::string& value) {
    return report.find("\"name\": \"" + name + "\",\n      \"value\": \"" + value + "\"") !=
           std::string::npos;
  };
  EXPECT_TRUE(written("lamp_red", "TRUE")) << report;
  EXPECT_TRUE(written("Mill.change.alarm", "5")) << report;
  EXPECT_TRUE(written("%MW400", "16#FF00")) << report;
  EXPECT_NE(desk.text("h.html").find(R"({"name":"lamp_red","value":"TRUE"})"), std::string::npos);
  EXPECT_EQ(desk.line("awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == \"lamp_red\") c = i } "
                      "NR > 100 && $c != 1 { exit 1 } END { if (!c) exit 2 }' t.csv")
                .code,
            0)
      << "the whole run";
}

TEST(ForcedRun, gives_the_same_bytes_when_its_record_is_replayed) {
  Desk desk;
  EXPECT_EQ(desk.line("$SG run $MILL --virtual -q --force lamp_red=TRUE --force Mill.change.alarm=5 "
                      "--trace t.csv --record r.rec")
                .code,
            0);
  const Ended e = desk.line("$SG replay r.rec --against t.csv");
  EXPECT_EQ(e.code, 0) << e.err;
}

TEST(ForcedRun, says_what_cannot_be_forced_before_anything_moves) {
  Desk desk;
  const auto refused = [&](const std::string& force, int code, const std::string& words) {
    const Ended e = desk.line("$SG run $MILL --virtual -q --force " + force + " --report r.json");
    EXPECT_EQ(e.code, code) << force;
    EXPECT_TRUE(e.err_has(words)) << e.err;
    EXPECT_EQ(desk.text("r.json").find("\"forces\""), std::string::npos) << force;
  };
  refused("lamp_red", 2, "'lamp_red' is not of the form NAME=VALUE");
  refused("lamp_blue=TRUE", 2, "there is no variable or place 'lamp_blue'");
  refused("lamp_red=maybe", 2, "'maybe' is no value for 'lamp_red'");
  refused("Mill.change.alarm=TRUE", 2, "'TRUE' is no value for 'Mill.change.alarm'");
  refused("estop_chain_ok=TRUE", 1, "the control refuses");
}

}  // namespace
}  // namespace servogate::shell
