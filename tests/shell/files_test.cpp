// SPDX-License-Identifier: Apache-2.0
// Paths of the command line that lead to no sensible file.
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

/// What stands where a file is expected, and what is said of it.
constexpr struct {
  const char* name;
  const char* said;
} kStrange[] = {{"/dev/zero", "not a regular file but a device"},
                {"pipe", "not a regular file but a pipe"},
                {"folder", "not a regular file but a folder"},
                {"nothing", "No such file or directory"}};

class Files : public ::testing::Test {
 protected:
  Files() {
    EXPECT_EQ(desk_.line("mkfifo pipe && mkdir folder && cp ${MILL%/*}/mill.st .").code, 0);
    desk_.write("one.nc", "N10 G0 X1\nN20 M30\n");
  }
  void expect(const std::string& line, const std::string& said) {
    const Ended e = desk_.line(line);
    EXPECT_EQ(e.code, 2) << line << ": " << e.err;
    EXPECT_TRUE(e.err_has(said)) << line << ": " << e.err.substr(0, 500);
  }
  Desk desk_;
};

TEST_F(Files, that_are_devices_pipes_or_folders_are_refused_as_machine_files) {
  for (const auto& strange : kStrange)
    for (const char* command : {"check @", "run @ --virtual", "up @ --virtual", "canon @ one.nc",
                                "plc check mill.st --machine @"}) {
      std::string line = std::string("$SG ") + command;
      line.replace(line.find('@'), 1, strange.name);
      expect(line, strange.said);
    }
}

TEST_F(Files, that_are_devices_pipes_or_folders_are_refused_as_programs_sources_and_records) {
  for (const auto& strange : kStrange)
    for (const char* command : {"check $MILL @", "run $MILL @ --virtual", "canon $MILL @", "plc run @",
                                "plc check @", "replay @"}) {
      std::string line = std::string("$SG ") + command;
      line.replace(line.find('@'), 1, strange.name);
      expect(line, strange.said);
    }
}

TEST_F(Files, that_are_too_large_are_refused_before_they_are_read) {
  ASSERT_EQ(desk_
                .line("truncate -s 5M machine.toml && truncate -s 300M big.nc && truncate -s 20M big.st && "
                      "truncate -s 5G big.record")
                .code,
            0);
  expect("$SG check machine.toml", "larger than 4 MiB");
  expect("$SG run $MILL big.nc --virtual", "larger than 256 MiB");
  expect("$SG plc check big.st", "larger than 16 MiB");
  expect("$SG replay big.record", "not a record of servogate");  // a record may be as large
}

TEST_F(Files, that_a_machine_file_names_are_met_with_the_same_care) {
  ASSERT_EQ(desk_
                .line("cp $MILL m.toml && mkdir devices && mkfifo devices/servo-cia402.toml && "
                      "sed 's/\"mill.st\"/\"pipe\"/' m.toml > n.toml && rm -r devices.none 2>/dev/null; true")
                .code,
            0);
  const Ended device = desk_.line("$SG check m.toml");
  EXPECT_EQ(device.code, 1) << "the machine file itself can be read: " << device.err;
  EXPECT_TRUE(
      device.err_has("servo-cia402.toml:1:1: error: the file cannot be read: not a regular file but a pipe"))
      << device.err;
  ASSERT_EQ(desk_.line("rm -r devices").code, 0);
  const Ended logic = desk_.line("$SG check n.toml");
  EXPECT_EQ(logic.code, 1);
  EXPECT_TRUE(logic.err_has("file \"pipe\" cannot be read: not a regular file but a pipe")) << logic.err;
}

TEST_F(Files, of_a_replay_that_compares_with_an_endless_trace_is_refused) {
  ASSERT_EQ(desk_.line("$SG run $MILL one.nc --virtual --quiet --record r").code, 0);
  expect("$SG replay r --against /dev/zero", "cannot read /dev/zero: not a regular file but a device");
}

TEST_F(Files, that_may_not_be_read_are_told_from_those_that_are_wrong) {
  desk_.write("broken.toml", "schema = \n");
  EXPECT_EQ(desk_.line("$SG check broken.toml").code, 1) << "a check that failed";
  for (const char* command :
       {"run broken.toml --virtual", "up broken.toml --virtual", "canon broken.toml one.nc"})
    EXPECT_EQ(desk_.line(std::string("$SG ") + command).code, 2) << command;
  desk_.write("bad.st", "PROGRAM P\nVAR n : INT; END_VAR\nn := TRUE;\nEND_PROGRAM\n");
  EXPECT_EQ(desk_.line("$SG plc check bad.st").code, 1) << "a check that failed";
  EXPECT_EQ(desk_.line("$SG plc run bad.st").code, 2);
  const Ended json = desk_.line("$SG check $MILL nothing.nc one.nc --json");
  EXPECT_EQ(json.code, 2) << json.err;
  EXPECT_TRUE(json.out_has("\"one.nc\"")) << "the others are checked all the same";
  if (geteuid() == 0) return;  // who may read everything
  EXPECT_EQ(desk_.line("chmod 0 one.nc; $SG check $MILL one.nc").code, 2);
}

TEST_F(Files, are_complained_of_in_russian_to_a_russian) {
  const Ended e = desk_.line("$SG check pipe", "ru_RU.UTF-8");
  EXPECT_TRUE(e.err_has("файл не читается: не обычный файл, а канал")) << e.err;
  const Ended missing = desk_.line("$SG check $MILL none.nc", "ru_RU.UTF-8");
  EXPECT_TRUE(missing.err_has("нет такого файла или каталога")) << missing.err;
}

TEST(ProgramFile, that_is_not_utf8_is_said_by_check_with_the_encoding_that_it_looks_like) {
  const struct {
    const char *encoding, *capitals, *small;
  } texts[] = {
      {"CP1251", "; \312\316\320\317\323\321, \302\322\316\320\300\337 \323\321\322\300\315\316\302\312\300",
       "; \304\345\362\340\353\374: \352\360\373\370\352\340, \342\362\356\360\340\377 "
       "\363\361\362\340\355\356\342\352\340"},
      {"CP866", "; \212\216\220\217\223\221, \202\222\216\220\200\237 \223\221\222\200\215\216\202\212\200",
       "; \204\245\342\240\253\354: \252\340\353\350\252\240, \242\342\256\340\240\357 "
       "\343\341\342\240\255\256\242\252\240"},
      {"KOI8-R", "; \353\357\362\360\365\363, \367\364\357\362\341\361 \365\363\364\341\356\357\367\353\341",
       "; \344\305\324\301\314\330: \313\322\331\333\313\301, \327\324\317\322\301\321 "
       "\325\323\324\301\316\317\327\313\301"}};
  const Desk desk;
  for (const auto& t : texts)
    for (const std::string remark : {t.capitals, t.small}) {
      desk.write("old.nc", "G90 G0 X1\n" + remark + "\nM30\n");
      const Ended e = desk.line("$SG check $MILL old.nc");
      EXPECT_EQ(e.code, 0) << e.err;
      EXPECT_TRUE(
          e.err_has("old.nc:2:1: warning: the text is not UTF-8 but looks like " + std::string(t.encoding)))
          << e.err;
      EXPECT_TRUE(e.err_has("iconv -f " + std::string(t.encoding) + " -t UTF-8")) << e.err;
    }
  desk.write("old.nc", "G90 G0 X1\n; 90\260\nM30\n");
  EXPECT_TRUE(desk.line("$SG check $MILL old.nc").err_has("iconv -f CP1251 -t UTF-8 (or CP866, KOI8-R)"));
  EXPECT_TRUE(desk.line("$SG check $MILL old.nc", "ru_RU.UTF-8").err_has("(или CP866, KOI8-R)"));
}

}  // namespace
}  // namespace servogate::shell
