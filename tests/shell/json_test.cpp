// SPDX-License-Identifier: Apache-2.0
// `--json`: what a program reads of a command, also where it fails before it has done anything.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

using nlohmann::json;

struct Failing {
  const char* line;
  int code;
  const char* error;  ///< code of the sentence
};

constexpr Failing kFailing[] = {
    {"$SG statsu --json", 2, "cli.unknown-command"},
    {"$SG run --json", 2, "cli.missing"},
    {"$SG run none.toml --json", 2, "machine.file_missing"},
    {"$SG run $MILL none.nc --json", 2, "cli.cannot-read"},
    {"$SG run $MILL --dialect esperanto --json", 2, "cli.unknown-dialect"},
    {"$SG canon $MILL none.nc --json", 2, "cli.cannot-read"},
    {"$SG status --socket none.sock --json", 4, "client.no-connection"},
    {"$SG jog X far --socket none.sock --json", 2, "client.bad-number"},
    {"$SG plc watch --socket none.sock --json", 4, "client.no-connection"},
    {"$SG plc check none.st --json", 2, "cli.cannot-read"},
    {"$SG replay none.rec --json", 2, "replay.no-record"},
};

TEST(Json, of_a_command_that_fails_before_its_work_is_one_object_with_the_error) {
  const Desk desk;
  for (const Failing& f : kFailing) {
    const Ended e = desk.line(f.line);
    EXPECT_EQ(e.code, f.code) << f.line << ": " << e.err;
    const json said = json::parse(e.out, nullptr, false);
    ASSERT_TRUE(said.is_object()) << f.line << ": " << e.out << e.err;
    EXPECT_EQ(said["exit"], f.code) << f.line;
    EXPECT_EQ(said["schema"], 1) << f.line;
    EXPECT_EQ(said["error"]["code"], f.error) << f.line;
    const std::string text = said["error"]["text"];
    EXPECT_FALSE(text.empty()) << f.line;
    EXPECT_TRUE(e.err_has(text)) << f.line << ": the same as people read: " << e.err;
  }
  EXPECT_EQ(desk.line("$SG run none.toml").out, "") << "without --json only people are told";
}

TEST(Json, of_a_run_whose_program_is_wrong_is_its_report_with_the_findings) {
  const Desk desk;
  desk.write("wrong.nc", "N10 G0 (\n");
  const Ended e = desk.line("$SG run $MILL wrong.nc --json");
  EXPECT_EQ(e.code, 1) << e.err;
  const json report = json::parse(e.out, nullptr, false);
  ASSERT_TRUE(report.is_object()) << e.out;
  EXPECT_EQ(report["finished"], false);
  EXPECT_EQ(report["cycles"], 0);
  ASSERT_FALSE(report["findings"].empty());
  EXPECT_EQ(report["findings"][0]["line"], 1);
}

TEST(Json, is_taken_by_canon_which_prints_nothing_else) {
  const Desk desk;
  desk.write("one.nc", "N10 G0 X1\nN20 M30\n");
  const Ended plain = desk.line("$SG canon $MILL one.nc"), asked = desk.line("$SG canon $MILL one.nc --json");
  EXPECT_EQ(asked.code, 0) << asked.err;
  EXPECT_EQ(asked.out, plain.out);
}

TEST(Json, of_plc_check_holds_the_findings) {
  const Desk desk;
  desk.write("good.st", "PROGRAM Good\nVAR a : BOOL; END_VAR\na := TRUE;\nEND_PROGRAM\n");
  desk.write("bad.st", "PROGRAM Bad\nVAR a : BOOL; END_VAR\na := b;\nEND_PROGRAM\n");
  const json good = json::parse(desk.line("$SG plc check good.st --json").out, nullptr, false);
  ASSERT_TRUE(good.is_object());
  EXPECT_EQ(good["errors"], 0);
  const Ended e = desk.line("$SG plc check bad.st --json");
  EXPECT_EQ(e.code, 1);
  const json bad = json::parse(e.out, nullptr, false);
  ASSERT_TRUE(bad.is_object()) << e.out;
  EXPECT_EQ(bad["errors"], 1);
  EXPECT_EQ(bad["findings"][0]["line"], 3);
}

TEST(Json, of_up_says_that_it_is_up_and_how_it_went_down) {
  const Desk desk;
  const Ended e = desk.line(
      "$SG up $MILL --virtual --socket s.sock --json > up.json & "
      "until $SG status --socket s.sock > status.txt 2>&1; do sleep 0.05; done; "
      "$SG down --socket s.sock && wait $!");
  ASSERT_EQ(e.code, 0) << e.err;
  const std::string said = desk.text("up.json");
  const std::size_t first = said.find('\n');
  const json up = json::parse(said.substr(0, first), nullptr, false);
  const json down = json::parse(said.substr(first + 1), nullptr, false);
  ASSERT_TRUE(up.is_object() && down.is_object()) << said;
  EXPECT_EQ(up["schema"], 1);
  EXPECT_EQ(up["event"], "up");
  EXPECT_EQ(up["socket"], "s.sock");
  EXPECT_EQ(up["clock"], "virtual");
  EXPECT_EQ(down["event"], "down");
  EXPECT_EQ(down["at_rest"], true);
  EXPECT_EQ(down["exit"], 0);
}

TEST(Dialect, that_nobody_knows_is_wrong_use_with_and_without_a_program) {
  const Desk desk;
  desk.write("one.nc", "N10 G0 X1\nN20 M30\n");
  for (const char* line : {"$SG run $MILL --dialect foo", "$SG run $MILL one.nc --dialect foo",
                           "$SG check $MILL --dialect foo", "$SG canon $MILL one.nc --dialect foo"}) {
    const Ended e = desk.line(line);
    EXPECT_EQ(e.code, 2) << line;
    EXPECT_TRUE(e.err_has("dialect 'foo' is not known; known: ")) << line << ": " << e.err;
  }
}

TEST(Socket, in_a_folder_that_does_not_exist_is_refused_and_makes_none) {
  const Desk desk;
  const Ended e = desk.line("$SG up $MILL --virtual --socket nix/x/y.sock");
  EXPECT_EQ(e.code, 4);
  EXPECT_TRUE(e.err_has("folder nix/x does not exist")) << e.err;
  EXPECT_FALSE(desk.has("nix"));
  EXPECT_TRUE(
      desk.line("$SG up $MILL --virtual --socket nix/x/y.sock", "ru_RU.UTF-8").err_has("каталога nix/x нет"));
}

}  // namespace
}  // namespace servogate::shell
