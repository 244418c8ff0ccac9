// SPDX-License-Identifier: Apache-2.0
// What the control refuses, it refuses with a sentence that names the range, and without having changed
// anything.
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <iterator>

#include "machine/state/state_lock.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

struct Refused {
  std::vector<std::string> arguments;
  int exit;
  std::string said;
};

class Refusals : public ::testing::Test {
 protected:
  Refusals() {
    shell_.up();
    shell_.ready();
    EXPECT_EQ(shell_.run({"mdi", "G0 X10", "--wait"}).exit, 0);
    EXPECT_TRUE(shell_.until([](const json& s) { return s["state"] == "ended"; }));
  }
  /// Mode, positions, origin: what a refusal must not touch.
  json kept() {
    const json s = shell_.status();
    json out{s["mode"], s["state"], s["program"]};
    for (const json& a : s["axes"]) out.push_back(a["command"]);
    return out;
  }
  void expect(const Refused& r) {
    const json before = kept();
    const Outcome o = shell_.run(r.arguments);
    EXPECT_EQ(o.exit, r.exit) << r.said << ": " << o.err;
    EXPECT_NE(o.err.find(r.said), std::string::npos) << o.err;
    EXPECT_LT(o.err.size(), 300u) << o.err;
    EXPECT_EQ(kept(), before) << r.said;
  }
  Shell shell_;
};

TEST_F(Refusals, name_the_range_of_a_number_that_is_too_large_or_none) {
  const Refused refused[] = {
      {{"zero", "X", "1e300"}, 1, "X cannot be given the value 1e+300 mm: from -99999.999 to 99999.999 mm"},
      {{"zero", "X", "-1e300"}, 1, "from -99999.999 to 99999.999 mm"},
      {{"zero", "X", "nan"}, 2, "'nan' is not a number"},
      {{"zero", "X", "inf"}, 2, "'inf' is not a number"},
      {{"zero", "X", "1e999"}, 2, "'1e999' is not a number"},
      {{"jog", "X", "+1e300"}, 1, "X cannot jog by 1e+300 mm: from -600 to 600 mm is possible"},
      {{"jog", "X", "-601mm"}, 1, "from -600 to 600 mm is possible"},
      {{"jog", "X", "+nan"}, 2, "'+nan' is not a distance"},
      {{"jog", "X", "+inf"}, 2, "'+inf' is not a distance"},
      {{"input", "air_pressure", "1e99"}, 2, "'air_pressure' cannot be 1e+99: from 0 to 32767 is possible"},
      {{"input", "air_pressure", "-1"}, 2, "from 0 to 32767 is possible"},
      {{"input", "air_pressure", "40000"}, 2, "from 0 to 32767 is possible"},
      {{"input", "air_pressure", "nan"}, 2, "takes: POINT on | off | auto | NUMBER"},
      {{"input", "air_pressure", "1.5"}, 2, "'air_pressure' cannot be 1.5: its register holds 1 or 2"},
      {{"input", "air_pressure", "0.999"}, 2, "its register holds 0 or 1"},
      {{"input", "door_closed", "5"}, 2, "'door_closed' is on or off (1 or 0), not 5"},
      {{"override", "200"}, 1, "a feed override of 200 % is not possible: 0 to 150 %"},
      {{"override", "1e300"}, 1, "0 to 150 %"},
      {{"override", "-1"}, 1, "0 to 150 %"},
  };
  for (const Refused& r : refused) expect(r);
  EXPECT_EQ(shell_.run({"input", "air_pressure", "32767"}).exit, 0);
  EXPECT_EQ(shell_.run({"input", "door_closed", "1"}).exit, 0);
}

TEST_F(Refusals, leave_the_mode_as_it_was) {
  ASSERT_EQ(shell_.status()["mode"], "mdi");
  ASSERT_EQ(shell_.run({"input", "x_limit_plus", "on"}).exit, 0);
  ASSERT_TRUE(shell_.until([](const json& s) { return s["axes"][0]["on_limit"] == 1; }));
  expect({{"jog", "X", "+1mm"}, 1, "X is on its limit switch"});
  expect({{"jog", "X", "+"}, 1, "X is on its limit switch"});
  expect({{"start"}, 1, "no program is loaded"});
  expect({{"step"}, 1, "no program is loaded"});
  ASSERT_EQ(shell_.run({"power", "off"}).exit, 0);
  expect({{"home"}, 1, "is not ready"});
  expect({{"jog", "Y", "+1mm"}, 1, "Y is not ready"});
  ASSERT_EQ(shell_.ask({{"cmd", "jog"}, {"axis", "Y"}, {"value", 1e300}})["code"], "gate.jog_range");
  EXPECT_EQ(shell_.status()["mode"], "mdi");
}

TEST_F(Refusals, of_a_typed_block_do_not_leave_it_for_a_later_start) {
  ASSERT_EQ(shell_.run({"jog", "Y", "+1mm", "--wait"}).exit, 0);
  ASSERT_EQ(shell_.run({"power", "off"}).exit, 0);
  expect({{"mdi", "G0 X20"}, 1, "is not ready"});
  EXPECT_EQ(shell_.status()["mode"], "manual");
}

TEST_F(Refusals, of_a_program_that_is_not_there_are_wrong_use) {
  const std::string none = (shell_.folder() / "none.nc").string();
  expect({{"load", none}, 2, "none.nc:1:1: error: cannot read the file: No such file or directory"});
  expect({{"load", "/dev/zero"}, 2, "not a regular file but a device"});
  const json answer = shell_.ask({{"cmd", "load"}, {"program", none}, {"dialect", "klingon"}});
  EXPECT_EQ(answer["exit"], 2);
}

TEST_F(Refusals, of_requests_of_the_wrong_type_move_nothing) {
  const json before = kept();
  EXPECT_EQ(shell_.ask({{"cmd", "home"}, {"axes", "X"}})["exit"], 2) << "one letter is not all axes";
  EXPECT_EQ(shell_.ask({{"cmd", "home"}, {"axes", {{"X", true}}}})["exit"], 2);
  EXPECT_EQ(shell_.ask({{"cmd", "power"}, {"value", 2}})["exit"], 2);
  EXPECT_EQ(shell_.ask({{"cmd", "power"}, {"value", "on"}})["exit"], 2);
  EXPECT_EQ(kept(), before);
}

TEST_F(Refusals, in_russian_name_the_file_and_have_no_english_words) {
  const std::string none = (shell_.folder() / "none.st").string();
  const struct {
    std::vector<std::string> arguments;
    std::string said;
  } rows[] = {
      {{"plc", "load", none}, "не читается " + none + ": нет такого файла или каталога"},
      {{"load", none}, "файл не читается: нет такого файла или каталога"},
      {{"jog", "X", "-601mm"}, "от -600 до 600 мм"},
      {{"zero", "X", "1e300"}, "от -99999.999 до 99999.999 мм"},
      {{"zero", "X", "5inch"}, "«inch» — не единица оси X: её единица — мм"},
      {{"input", "air_pressure", "1.5"}, "«air_pressure» не может быть 1.5: регистр вмещает 1 или 2"}};
  for (const auto& row : rows) {
    const Outcome o = shell_.run(row.arguments, "ru_RU.UTF-8");
    EXPECT_NE(o.exit, 0);
    EXPECT_NE(o.err.find(row.said), std::string::npos) << row.said << "\n" << o.err;
  }
  EXPECT_EQ(shell_.run({"jog", "X", "+1mm", "--no-wait"}, "ru_RU.UTF-8").out, "X перемещается на +1 мм\n");
}

TEST(Inputs, with_fractions_take_the_nearest_step_of_their_register_and_say_which) {
  Shell shell;
  std::ifstream example(Shell::example("mill/machine.toml"));
  std::string machine((std::istreambuf_iterator<char>(example)), {});
  const std::string whole = "channel = \"ai1\", place = \"SA17.IN\"";
  ASSERT_NE(machine.find(whole), std::string::npos);
  machine.replace(machine.find(whole), whole.size(), "channel = \"ai1\", place = \"SA30.RE\", scale = 0.1");
  std::ofstream(shell.folder() / "machine.toml") << machine;
  std::filesystem::copy_file(Shell::example("mill/mill.st"), shell.folder() / "mill.st");
  shell.up_file((shell.folder() / "machine.toml").string(), {"--virtual", "--speed", "20"});
  const struct {
    const char *number, *said;
  } rows[] = {{"1.5", "input air_pressure is 1.5\n"},
              {"1.26", "input air_pressure is 1.3\n"},
              {"1.24", "input air_pressure is 1.2\n"},
              {"0", "input air_pressure is 0\n"}};
  for (const auto& row : rows)
    EXPECT_EQ(shell.run({"input", "air_pressure", row.number}).out, row.said) << row.number;
}

TEST(StateDirectory, belongs_to_one_control_at_a_time) {
  Shell shell;
  const std::string state = (shell.folder() / "state").string(), mill = Shell::example("mill/machine.toml");
  shell.up("mill", {"--virtual", "--speed", "20", "--state", state});
  shell.ready();
  ASSERT_EQ(shell.run({"zero", "X", "5"}).exit, 0);
  const std::string other = (shell.folder() / "other.sock").string();
  for (const std::vector<std::string>& second :
       {std::vector<std::string>{"up", mill, "--virtual", "--state", state, "--socket", other},
        std::vector<std::string>{"run", mill, Shell::example("mill/bracket.nc"), "--virtual", "--state",
                                 state}}) {
    const Outcome o = shell.run(second);
    EXPECT_EQ(o.exit, 4) << o.out;
    EXPECT_NE(o.err.find(state), std::string::npos) << o.err;
    EXPECT_NE(o.err.find("process " + std::to_string(shell.pid())), std::string::npos) << o.err;
  }
  EXPECT_EQ(shell.end(SIGKILL), 128 + SIGKILL) << "a control that is killed";
  machine::StateLock next;
  EXPECT_EQ(next.take(state), "") << "leaves its directory to the next one";
  EXPECT_NE(shell.text("state/origins.toml").find("-5"), std::string::npos);
}

}  // namespace
}  // namespace servogate::gateway::testing
