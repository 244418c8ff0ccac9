// SPDX-License-Identifier: Apache-2.0
// Command lines that mean nothing: each is named, in the user's language, with what was probably meant.
#include <gtest/gtest.h>

#include <string>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

struct Wrong {
  const char* line;
  const char* english;
  const char* russian;
};

constexpr Wrong kWrong[] = {
    {"$SG", "a command is missing", "не указана команда"},
    {"$SG plc", "a command is missing; `servogate plc --help`", "не указана команда"},
    {"$SG chek", "unknown command 'chek'; did you mean 'check'?",
     "неизвестная команда «chek»; имелось в виду «check»?"},
    {"$SG statsu", "did you mean 'status'?", "имелось в виду «status»?"},
    {"$SG plc chekc x.st", "unknown command 'plc chekc'; did you mean 'plc check'?",
     "имелось в виду «plc check»"},
    {"$SG --verison", "unknown command '--verison'; did you mean 'version'?",
     "неизвестная команда «--verison»"},
    {"$SG run $MILL \"\"", "`servogate run`: PROGRAM is empty", "«servogate run»: PROGRAM пуст"},
    {"$SG run $MILL --trace \"\"", "`servogate run`: --trace is empty", "«servogate run»: --trace пуст"},
    {"$SG run $MILL --virtual=1", "--virtual takes no value", "ключ --virtual не принимает значения"},
    {"$SG help chek", "unknown command 'chek'; did you mean 'check'?", "неизвестная команда «chek»"},
    {"$SG drive mock:can --node 127", "outside 1 to 126 (node-ID)", "вне пределов от 1 до 126"},
    {"$SG transmogrify", "unknown command 'transmogrify'; `servogate --help` lists them",
     "неизвестная команда «transmogrify»; их перечисляет"},
    {"$SG run $MILL --trcae x.csv", "`servogate run` has no option '--trcae'; did you mean '--trace'?",
     "у «servogate run» нет ключа «--trcae»; имелось в виду «--trace»?"},
    {"$SG run --virtul", "has no option '--virtul'; did you mean '--virtual'?", "нет ключа «--virtul»"},
    {"$SG run $MILL --qqqqqqqqqq", "`servogate run` has no option '--qqqqqqqqqq' [",
     "нет ключа «--qqqqqqqqqq» ["},
    {"$SG run", "`servogate run` needs MACHINE", "для «servogate run» нужен аргумент MACHINE"},
    {"$SG canon $MILL", "`servogate canon` needs PROGRAM", "нужен аргумент PROGRAM"},
    {"$SG jog X", "`servogate jog` needs DISTANCE", "нужен аргумент DISTANCE"},
    {"$SG jog X -1mm -2mm", "does not take '-2mm'", "не принимает «-2mm»"},
    {"$SG version now", "`servogate version` does not take 'now'", "«servogate version» не принимает «now»"},
    {"$SG run $MILL --trace", "--trace needs a value", "ключу --trace нужно значение"},
    {"$SG run $MILL --trace a --trace b", "--trace may be given once only",
     "--trace можно указать только один раз"},
    {"$SG run $MILL --virtual --realtime", "exclude one another", "исключают друг друга"},
    {"$SG run $MILL --realtime=perhaps", "--realtime: 'perhaps' is not one of strict, best-effort",
     "--realtime: «perhaps» не входит в список"},
    {"$SG run $MILL --override 151", "--override: '151' is outside 0 to 150 %",
     "--override: «151» вне пределов от 0 до 150 %"},
    {"$SG run $MILL --override nan", "--override: 'nan' is outside 0 to 150 %", "«nan» вне пределов"},
    {"$SG run $MILL --override fast", "--override: 'fast' is no number", "--override: «fast» — не число"},
    {"$SG up $MILL --speed 0", "--speed: '0' is outside 0.001 to 100000 times real time",
     "--speed: «0» вне пределов от 0.001 до 100000 × реального времени"},
    {"$SG up $MILL --speed -1", "--speed: '-1' is outside 0.001 to 100000", "«-1» вне пределов"},
    {"$SG plc run a.st --cycles 0", "--cycles: '0' is outside 1 to 1000000000 cycles",
     "--cycles: «0» вне пределов от 1 до 1000000000 циклов"},
    {"$SG plc run a.st --cycles 1.5", "--cycles: '1.5' is no whole number",
     "--cycles: «1.5» — не целое число"},
    {"$SG plc run a.st --cycles 99999999999999999999", "is outside 1 to 1000000000 cycles", "вне пределов"},
    {"$SG plc run a.st --cycle-ms 1e300", "--cycle-ms: '1e300' is outside 0.001 to 60000 ms",
     "--cycle-ms: «1e300» вне пределов от 0.001 до 60000 мс"},
};

TEST(Help, is_what_help_asks_for_too) {
  const Desk desk;
  for (const char* words : {"", "run", "plc run", "can bus"}) {
    const Ended asked = desk.line("$SG help " + std::string(words));
    EXPECT_EQ(asked.code, 0) << words;
    EXPECT_EQ(asked.out, desk.line("$SG " + std::string(words) + " --help").out) << words;
  }
}

TEST(Words, that_mean_nothing_are_named_in_the_users_language_in_one_short_line) {
  const Desk desk;
  for (const Wrong& wrong : kWrong) {
    const Ended english = desk.line(wrong.line), russian = desk.line(wrong.line, "ru_RU.UTF-8");
    EXPECT_EQ(english.code, 2) << wrong.line;
    EXPECT_EQ(russian.code, 2) << wrong.line;
    EXPECT_TRUE(english.err_has(wrong.english)) << wrong.line << ": " << english.err;
    EXPECT_TRUE(russian.err_has(wrong.russian)) << wrong.line << ": " << russian.err;
    for (const Ended& e : {english, russian}) {
      EXPECT_EQ(e.out, "") << wrong.line;
      EXPECT_EQ(e.err.find('\n'), e.err.size() - 1) << wrong.line << ": " << e.err;
      EXPECT_LT(e.err.size(), 300u) << wrong.line << ": " << e.err;
    }
  }
}

TEST(Words, behind_an_optional_value_are_not_taken_for_it) {
  const Desk desk;
  desk.write("one.nc", "N10 G0 X1\nN20 M30\n");
  const Ended e = desk.line("$SG run $MILL --realtime none.nc");
  EXPECT_TRUE(e.err_has("none.nc:1:1: error: cannot read the file")) << e.err;
}

TEST(Words, of_the_help_name_each_argument_as_it_is_written) {
  const Desk desk;
  const Ended home = desk.line("$SG home --help");
  EXPECT_TRUE(home.out_has("[AXIS...]")) << home.out;
  EXPECT_FALSE(home.out_has("......")) << home.out;
  EXPECT_TRUE(desk.line("$SG jog --help").out_has("AXIS DISTANCE")) << "two arguments";
  EXPECT_TRUE(desk.line("$SG zero --help").out_has("AXIS [VALUE]"));
}

}  // namespace
}  // namespace servogate::shell
