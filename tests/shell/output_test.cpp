// SPDX-License-Identifier: Apache-2.0
// Standard output that cannot be written, that nobody reads, or that is not there.
#include <gtest/gtest.h>

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
  const Ended e =
      desk_.line("{ $SG plc run blink.st --cycles 1000000000; echo code $? >&2; } | head -2", "C", 60.0);
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
       {"",        "version",   "run",      "up",       "status",    "home",      "jog",      "zero",
        "mdi",     "load",      "start",    "step",     "hold",      "resume",    "reset",    "override",
        "power",   "input",     "alarms",   "down",     "check",     "canon",     "replay",   "plc",
        "plc run", "plc check", "plc test", "plc list", "plc watch", "plc force", "plc load", "can",
        "can bus", "can check", "drive",    "sim",      "dump",      "play",      "scan",     "sdo",
        "od",      "lss",       "nmt"}) {
    const Ended e = desk.line(std::string("$SG ") + command + " --help", "ru_RU.UTF-8");
    EXPECT_EQ(e.code, 0) << command;
    std::istringstream lines(e.out);
    for (std::string line; std::getline(lines, line);)
      if (line.find("Пример: ") == std::string::npos && !line.starts_with("Использование: ")) {
        EXPECT_FALSE(std::regex_search(line, english_words)) << command << ": " << line;
      }
  }
}

}  // namespace
}  // namespace servogate::shell
