// SPDX-License-Identifier: Apache-2.0
// What a run is to write is looked at before anything moves.
#include <gtest/gtest.h>

#include "machine/files/output_files.hpp"
#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

class Written : public ::testing::Test {
 protected:
  Written() {
    desk_.write("one.nc", "N10 G0 X1\nN20 M30\n");
    EXPECT_EQ(desk_.line("mkdir folder && cp $MILL machine.toml && cp ${MILL%/*}/mill.st .").code, 0);
  }
  /// A run that must not begin.
  void refused(const std::string& options, int code, const std::string& said) {
    const Ended e = desk_.line("$SG run machine.toml one.nc --virtual --json " + options);
    EXPECT_EQ(e.code, code) << options << ": " << e.err;
    EXPECT_TRUE(e.err_has(said)) << options << ": " << e.err;
    EXPECT_TRUE(e.out.starts_with("{\"error\":")) << "it has run: " << options;
  }
  Desk desk_;
};

TEST_F(Written, files_need_a_folder_that_exists_and_may_be_written_to) {
  for (const char* option : {"--trace", "--report", "--html", "--record"}) {
    const std::string o = option;
    refused(o + " none/f", 4, "cannot write " + o + " none/f: the folder 'none' does not exist");
    refused(o + " folder", 4, "cannot write " + o + " folder: Is a directory");
    refused(o + " one.nc/f", 4, "Not a directory");
    refused(o + " /proc/f", 4, "cannot write " + o + " /proc/f: ");
  }
  refused("--state one.nc/state", 4, "cannot write --state");
  refused("--state one.nc", 4, "Not a directory");
}

TEST_F(Written, files_are_not_the_same_file_twice) {
  refused("--trace f --report f", 2, "--trace and --report are one file, f");
  refused("--trace folder/../f --html f", 2, "are one file");
  ASSERT_EQ(desk_.line("touch g && ln -s g h").code, 0);
  refused("--html g --record h", 2, "--html and --record are one file, h");
  // Only asked: a device may take several outputs.
  EXPECT_FALSE(files::problem_of_outputs({{"--trace", "/dev/null"}, {"--report", "/dev/null"}}, {}));
}

TEST_F(Written, files_that_are_pipes_or_links_stay_what_they_are) {
  ASSERT_EQ(desk_.line("mkfifo pipe && touch page && ln -s page link").code, 0);
  const Ended e = desk_.line(
      "cat pipe > copy & $SG run machine.toml one.nc --virtual -q --report pipe --html link; code=$?; wait; "
      "exit $code");
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(desk_.line("test -p pipe && test -L link && test -s page && test -s copy").code, 0);
  EXPECT_EQ(desk_.text("copy").substr(0, 1), "{") << "the report went through the pipe";
}

TEST_F(Written, files_never_overwrite_what_the_run_reads) {
  const std::string machine = desk_.text("machine.toml"), logic = desk_.text("mill.st");
  refused("--html machine.toml", 2, "--html would overwrite the machine file, machine.toml");
  refused("--trace ./one.nc", 2, "--trace would overwrite the part program, ./one.nc");
  refused("--report mill.st", 2, "--report would overwrite the PLC program, mill.st");
  EXPECT_EQ(desk_.text("machine.toml"), machine);
  EXPECT_EQ(desk_.text("mill.st"), logic);
  EXPECT_EQ(desk_.text("one.nc"), "N10 G0 X1\nN20 M30\n");
}

TEST_F(Written, files_leave_nothing_behind_when_they_are_only_looked_at) {
  refused("--trace t.csv --html none/h.html", 4, "the folder 'none' does not exist");
  EXPECT_FALSE(desk_.has("t.csv"));
}

TEST_F(Written, files_that_find_no_room_end_with_four) {
  const Ended e = desk_.line("$SG run machine.toml one.nc --virtual -q --trace /dev/full");
  EXPECT_EQ(e.code, 4);
  EXPECT_TRUE(e.err_has("cannot write /dev/full: No space left on device")) << e.err;
}

TEST_F(Written, a_replay_overwrites_neither_its_record_nor_what_it_compares_with) {
  ASSERT_EQ(desk_.line("$SG run machine.toml one.nc --virtual -q --trace t.csv --record r").code, 0);
  EXPECT_EQ(desk_.line("$SG replay r --trace r").code, 2);
  EXPECT_EQ(desk_.line("$SG replay r --against t.csv --trace t.csv").code, 2);
  EXPECT_EQ(desk_.line("echo mine > t.csv.replay; $SG replay r --against t.csv").code, 0);
  EXPECT_EQ(desk_.text("t.csv.replay"), "mine\n");
}

TEST_F(Written, the_report_says_where_it_comes_from) {
  ASSERT_EQ(desk_.line("$SG run machine.toml one.nc --virtual -q --report r.json").code, 0);
  const std::string report = desk_.text("r.json");
  for (const char* part :
       {"\"transport\": \"mock:can\"", "\"protocol\": \"canopen\"", "\"transport\": \"mock:gpio\"",
        "\"protocol\": \"gpio\"", "\"transport\": \"mock:panel\"", "\"protocol\": \"modbus\"",
        "\"clock\": \"virtual\"", "\"dialect\": \"nc110\"", "\"kernel\": \"Linux", "\"one.nc\"",
        "\"--report\""})
    EXPECT_NE(report.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace servogate::shell
