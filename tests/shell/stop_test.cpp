// SPDX-License-Identifier: Apache-2.0
// Ctrl-C before anything moves: exit code 3 and a sentence, from the first moment on.
#include <gtest/gtest.h>

#include <string>

#include "tests/shell/line.hpp"

namespace servogate::shell {
namespace {

/// Waits until the process $p is the program, no longer the shell that became it, and has taken SIGINT over,
/// which is its first act.
const std::string kTakenOver =
    "until grep -q '^servogate$' /proc/$p/comm && grep -q '^SigCgt:.*[2367abef]$' /proc/$p/status; do :; "
    "done; ";
/// The same, then sends it.
const std::string kInterrupt = kTakenOver + "kill -INT $p; wait $p; echo code $?";

/// Reading it takes seconds, and the signal comes at its begin.
std::string long_program() {
  std::string program;
  for (int n = 0; n < 1'500'000; ++n) program += "G1 X" + std::to_string(n % 200) + " F6000\n";
  return program + "M30\n";
}

TEST(Interrupt, of_a_run_that_still_reads_its_program_ends_it_at_once_with_3_and_a_sentence) {
  const Desk desk;
  desk.write("long.nc", long_program());
  const Ended e = desk.line("$SG run $MILL long.nc --virtual --report r.json & p=$!; " + kInterrupt);
  EXPECT_EQ(e.out, "code 3\n") << e.err;
  EXPECT_TRUE(e.err_has("stopped by the operator before anything had begun")) << e.err;
  // A busy computer may deliver the signal late: what there is of a report then says that nothing was done.
  if (desk.has("r.json") && !desk.text("r.json").empty()) {
    EXPECT_NE(desk.text("r.json").find("\"finished\": false"), std::string::npos) << desk.text("r.json");
  }
  const Ended russian = desk.line("$SG run $MILL long.nc --virtual & p=$!; " + kInterrupt, "ru_RU.UTF-8");
  EXPECT_TRUE(russian.err_has("остановлено оператором: ещё ничего не началось")) << russian.err;
}

TEST(Interrupt, of_a_command_with_json_leaves_its_object_from_the_first_moment_on) {
  const Desk desk;
  desk.write("long.nc", long_program());
  const Ended e = desk.line("$SG run $MILL long.nc --virtual --json > said & p=$!; " + kInterrupt);
  EXPECT_EQ(e.out, "code 3\n") << e.err;
  EXPECT_EQ(desk.text("said"),
            "{\"error\":{\"code\":\"cli.stopped\",\"text\":\"stopped by the operator before anything had "
            "begun\"},\"exit\":3,\"schema\":1}\n");
  EXPECT_TRUE(e.err_has("stopped by the operator before anything had begun")) << e.err;
}

TEST(Interrupt, at_any_moment_of_a_run_with_json_leaves_one_whole_object) {
  const Desk desk;
  for (int ms = 0; ms < 150; ms += 6) {
    const Ended e = desk.line("$SG run $MILL $BRACKET --virtual --json -q > said & p=$!; " + kTakenOver +
                              "sleep " + std::to_string(ms * 1e-3) +
                              "; kill -INT $p; wait $p; echo code $?; python3 -m json.tool said > whole; "
                              "echo $?");
    EXPECT_TRUE(e.out == "code 3\n0\n" || e.out == "code 0\n0\n") << ms << " ms: " << e.out << e.err;
  }
}

TEST(Interrupt, of_a_run_before_its_first_block_says_so) {
  const Desk desk;
  desk.write("short.nc", "N10 G0 X1\nN20 M30\n");
  const Ended e = desk.line(
      "$SG run $MILL short.nc --realtime=best-effort -q --trace t.csv & p=$!; until [ -s t.csv ]; do :; "
      "done; "
      "kill -INT $p; wait $p; echo code $?");
  EXPECT_EQ(e.out, "code 3\n") << e.err;
  EXPECT_TRUE(e.err_has("stopped by the operator before")) << e.err;
}

TEST(Interrupt, of_a_client_whose_control_does_not_answer_ends_it_with_3) {
  const Desk desk;
  desk.write("silent.py",
             "import socket, time\ns = socket.socket(socket.AF_UNIX)\ns.bind('silent.sock')\ns.listen()\n"
             "c, _ = s.accept()\nc.recv(4096)\nopen('asked', 'w').close()\ntime.sleep(60)\n");
  const Ended e = desk.line(
      "python3 silent.py & k=$!; until [ -S silent.sock ]; do sleep 0.01; done; $SG status --socket "
      "silent.sock & "
      "p=$!; until [ -e asked ]; do sleep 0.01; done; kill -INT $p; wait $p; echo code $?; kill $k");
  EXPECT_EQ(e.out, "code 3\n") << e.err;
  EXPECT_TRUE(e.err_has("the control carries on with what it was asked to do")) << e.err;
}

TEST(Broken, program_without_a_single_block_done_counts_none) {
  const Desk desk;
  // What a place of a packet holds is known when the program runs, so nobody can say before that it is wrong.
  desk.write("wrong.nc", "N10 E30=9000+SK400.IN\nN20 XE30\nN30 M30\n");
  const Ended e = desk.line("$SG run $MILL wrong.nc --virtual");
  EXPECT_EQ(e.code, 1);
  EXPECT_TRUE(e.err_has("broken off: 1 of about")) << "the first block was done: " << e.err;
  desk.write("one.nc", "N10 X9000\n");
  const Ended one = desk.line("$SG run $MILL one.nc --virtual");
  EXPECT_EQ(one.code, 1) << one.err;
  EXPECT_FALSE(one.err_has(" of about ")) << one.err;
}

TEST(Start, of_a_run_with_an_open_emergency_stop_chain_says_that_and_the_remedy) {
  const Desk desk;
  const Ended made = desk.line(
      "d=$(dirname $MILL); cp -r $d mill; sed -i 's/^operator_closes = .*/operator_closes = []/' "
      "mill/machine.toml");
  ASSERT_EQ(made.code, 0) << made.err;
  const Ended e = desk.line("$SG run mill/machine.toml $BRACKET --virtual");
  EXPECT_EQ(e.code, 1);
  EXPECT_TRUE(e.err_has("the emergency-stop chain is open: estop_chain_ok (SA17.BL) is FALSE")) << e.err;
  EXPECT_TRUE(e.err_has("operator_closes")) << e.err;
  EXPECT_FALSE(e.err_has(" of about ")) << e.err;
}

}  // namespace
}  // namespace servogate::shell
