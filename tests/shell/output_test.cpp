// SPDX-License-Identifier: Apache-2.0
// Standard output that cannot be written, that nobody reads, or that is not there.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <regex>
#include <sstream>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

constexpr const char* kPrinting[] = {"version",
                                     "version --json",
                                     "--help",
                                     "run --help",
                                     "check $MILL",
                                     "check $MILL $BRACKET --json",
                                     "canon $MILL $BRACKET",
                                     "plc run blink.st --cycles 3",
                                     "run $MILL short.nc --virtual --quiet --json"};

class Output : public ::testing::Test {
 protected:
  Output() {
    desk_.write("blink.st", "PROGRAM P\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\n");
    desk_.write("short.nc", "N10 G90 G94 G71\nN20 G1 X5 F3000\nN30 M30\n");
  }
  Desk desk_;
};

TEST_F(Output, that_finds_no_room_is_an_infrastructure_error_with_a_sentence) {
  for (const char* arguments : kPrinting) {
    const Ended e = desk_.line(std::string("$SG ") + arguments + " > /dev/full");
    EXPECT_EQ(e.code, 4) << arguments;
    EXPECT_TRUE(e.err_has("cannot write to standard output: No space left on device [cli.output-lost]"))
        << arguments << ": " << e.err;
  }
  const Ended russian = desk_.line("$SG version > /dev/full", "ru_RU.UTF-8");
  EXPECT_TRUE(russian.err_has("не удаётся записать в стандартный вывод: на носителе нет места"))
      << russian.err;
}

TEST_F(Output, into_a_state_directory_that_cannot_be_is_refused_before_anything_moves) {
  const Ended e = desk_.line("$SG run $MILL short.nc --virtual --state /proc/x --report report.json");
  EXPECT_EQ(e.code, 4);
  EXPECT_TRUE(e.err_has("cannot write --state /proc/x")) << e.err;
  EXPECT_FALSE(e.err_has("done:")) << e.err;
}

TEST_F(Output, that_was_closed_is_said_as_well) {
  const Ended e = desk_.line("$SG version >&-");
  EXPECT_EQ(e.code, 4);
  EXPECT_TRUE(e.err_has("Bad file descriptor")) << e.err;
}

TEST_F(Output, that_was_closed_does_not_go_into_a_file_that_the_run_opens) {
  const Ended e = desk_.line("$SG run $MILL short.nc --virtual --quiet --trace t.csv --json >&-");
  EXPECT_EQ(e.code, 4) << e.err;
  const std::string trace = desk_.text("t.csv");
  EXPECT_EQ(trace.substr(0, 7), "t,feed,") << trace.substr(0, 200);
  EXPECT_EQ(trace.find("schema"), std::string::npos);
}

TEST_F(Output, that_nobody_reads_any_more_ends_a_command_quietly_with_its_own_code) {
  for (const char* arguments : kPrinting) {
    const Ended e = desk_.line(std::string("{ $SG ") + arguments + "; echo code $? >&2; } | head -c 1");
    EXPECT_EQ(e.err, "code 0\n") << arguments;
  }
}

TEST_F(Output, that_nobody_reads_any_more_ends_a_long_listing_early) {
  const Ended e = desk_.line("{ $SG plc run blink.st --cycles 1000000000; echo code $? >&2; } | head -2");
  EXPECT_EQ(e.code, 0) << "it went on to the end";
  EXPECT_EQ(e.err, "code 0\n");
}

TEST_F(Output, of_progress_that_nobody_reads_does_not_end_a_run) {
  const Ended e =
      desk_.line("{ $SG run $MILL short.nc --virtual --report r.json; echo $? > code; } 2>&1 | true");
  EXPECT_EQ(desk_.text("code"), "0\n") << e.err;
  EXPECT_NE(desk_.text("r.json").find("\"finished\": true"), std::string::npos);
}

TEST(Help, of_every_command_is_in_the_users_language) {
  Desk desk;
  const std::regex english_words("([a-z]+ ){3,}");
  for (const char* command :
       {"",          "version",   "run",         "up",           "status",     "home",      "jog",
        "zero",      "mdi",       "load",        "start",        "step",       "hold",      "resume",
        "reset",     "override",  "power",       "input",        "alarms",     "down",      "check",
        "canon",     "replay",    "plc",         "plc run",      "plc check",  "plc test",  "plc list",
        "plc watch", "plc force", "plc load",    "can",          "can bus",    "can check", "drive",
        "sim",       "dump",      "play",        "scan",         "sdo",        "od",        "lss",
        "nmt",       "modbus",    "modbus read", "modbus write", "modbus scan"}) {
    const Ended e = desk.line(std::string("$SG ") + command + " --help", "ru_RU.UTF-8");
    EXPECT_EQ(e.code, 0) << command;
    std::istringstream lines(e.out);
    for (std::string line; std::getline(lines, line);)
      if (line.find("Пример: ") == std::string::npos && !line.starts_with("Использование: ")) {
        EXPECT_FALSE(std::regex_search(line, english_words)) << command << ": " << line;
      }
  }
}

/// Runs that end before their first cycle, with the code of what they say.
struct NoRun {
  const char* line;
  int code;
  const char* error;
};

constexpr NoRun kNoRuns[] = {
    {"$SG run $MILL none.nc", 2, "cli.cannot-read"},
    {"$SG run broken.toml $BRACKET", 2, ""},
    {"$SG run $MILL $BRACKET --dialect esperanto", 2, "cli.unknown-dialect"},
};

TEST(Outputs, of_a_run_that_never_began_are_written_and_do_not_look_like_those_of_an_older_one) {
  const Desk desk;
  desk.write("broken.toml", "schema = 1\n[machine\n");
  for (const NoRun& n : kNoRuns) {
    for (const char* name : {"r.json", "t.csv", "p.html"}) desk.write(name, "an older run");
    const Ended e = desk.line(std::string(n.line) + " --report r.json --trace t.csv --html p.html");
    EXPECT_EQ(e.code, n.code) << n.line << e.err;
    const auto report = nlohmann::json::parse(desk.text("r.json"), nullptr, false);
    ASSERT_TRUE(report.is_object()) << n.line << desk.text("r.json");
    EXPECT_EQ(report["finished"], false) << n.line;
    EXPECT_EQ(report["cycles"], 0) << n.line;
    if (*n.error != '\0') {
      EXPECT_EQ(report["error"]["code"], n.error) << n.line;
    } else {
      EXPECT_FALSE(report["findings"].empty()) << n.line;
    }
    EXPECT_EQ(desk.text("t.csv").rfind("t,feed,line", 0), 0u) << n.line;
    EXPECT_EQ(desk.text("t.csv").find('\n'), desk.text("t.csv").size() - 1) << "a header, no rows";
    EXPECT_NE(desk.text("p.html").find("<html"), std::string::npos) << n.line;
  }
}

TEST(Outputs, nothing_is_written_over_a_file_that_the_command_reads_even_if_that_is_broken) {
  const Desk desk;
  desk.write("broken.toml", "schema = 1\n[machine\n");
  EXPECT_EQ(desk.line("$SG run broken.toml --report broken.toml").code, 2);
  EXPECT_EQ(desk.text("broken.toml"), "schema = 1\n[machine\n");
}

TEST(Speed, of_virtual_time_and_real_time_exclude_one_another) {
  const Desk desk;
  const Ended e = desk.line("$SG up $MILL --speed 2 --realtime");
  EXPECT_EQ(e.code, 2);
  EXPECT_TRUE(e.err_has("--speed")) << e.err;
}

}  // namespace
}  // namespace servogate::shell
