// SPDX-License-Identifier: Apache-2.0
// As many processes as a machine may have, an axis each: one starts the others, and they meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

constexpr std::array<char, 5> kLetters{'X', 'Y', 'Z', 'U', 'V'};
static_assert(kLetters.size() == image::kMaxProcesses);

constexpr double kDigit = 1e-3;  ///< mm: the trace has counts of the drive

std::string number(std::size_t n) { return std::to_string(n + 1); }

/// Five axes at 2 ms, one for each process.
std::string machine_text() {
  std::string out =
      "schema = 1\nname = \"five processes\"\n[control]\ncycle_time = \"2 ms\"\nprocesses = 5\ndialect = "
      "\"nc110\"\n"
      "power_on = [\"G94\"]\n[plc]\nsources = [\"five.st\"]\n[safety]\nestop = \"estop_chain_ok\"\n"
      "[[bus]]\nname = \"can\"\nurl = \"mock:can\"\nbit_rate = \"1 Mbit/s\"\n";
  for (std::size_t n = 0; n < kLetters.size(); ++n)
    out += "[[bus.node]]\nname = \"n" + number(n) + "\"\nid = " + number(n) + "\ndevice = \"servo-cia402\"\n";
  for (std::size_t n = 0; n < kLetters.size(); ++n)
    out += std::string("[[axis]]\nletter = \"") + kLetters[n] + "\"\nprocess = " + number(n) +
           "\ndrive = \"can.n" + number(n) +
           "\"\nlead = \"10 mm/rev\"\ncounts_per_rev = 131072\nmax_velocity = \"200 mm/s\"\n"
           "max_acceleration = \"1000 mm/s2\"\nmax_jerk = \"10000 mm/s3\"\ntravel_min = \"0 mm\"\n"
           "travel_max = \"300 mm\"\nfollowing_error_stop = \"1 mm\"\nfollowing_error_velocity = \"4 ms\"\n"
           "[axis.home]\nmethod = \"none\"\n";
  return out +
         "[[station]]\nname = \"gpio\"\nkind = \"gpio\"\nurl = \"mock:gpio\"\n"
         "points = [{ name = \"estop_chain_ok\", channel = \"di0\", place = \"SA0\" }]\n"
         "[simulation]\noperator_closes = [\"estop_chain_ok\"]\n";
}

std::string logic_text() {
  std::string out =
      "PROGRAM Main\nMC.estop_ok := MC.estop_chain;\nMC.power_on := MC.power_request AND MC.estop_ok;\n";
  for (std::size_t n = 0; n < kLetters.size(); ++n) {
    const std::string axis(1, kLetters[n]), nc = n == 0 ? "NC" : "NC" + number(n);
    out += axis + ".enable := MC.power_on;\n" + axis + ".feed_enable := TRUE;\n" + nc +
           ".feed_enable := TRUE;\n" + nc + ".read_in_enable := TRUE;\n" + nc + ".m_ack := " + nc +
           ".m_strobe;\n";
  }
  return out + "END_PROGRAM\n";
}

TEST(FiveProcesses, are_started_by_one_move_at_once_and_all_meet_again) {
  Scratch scratch;
  const std::string machine = scratch.write("machine.toml", machine_text());
  scratch.write("five.st", logic_text());
  std::string main;
  for (std::size_t n = 1; n < kLetters.size(); ++n) {
    // Each has a way of its own length, so that the last one is waited for.
    scratch.write("P" + number(n) + ".nc", std::string("(WAI,1)\nG1 ") + kLetters[n] +
                                               std::to_string(60 + 20 * n) + " F3000\n#(SND,1)\n(REL)\n");
    main += "(EXE," + number(n) + ",P" + number(n) + ")\n";
  }
  for (std::size_t n = 1; n < kLetters.size(); ++n) main += "(SND," + number(n) + ")\n";
  main += "G1 X60 F3000\n";
  for (std::size_t n = 1; n < kLetters.size(); ++n) main += "(WAI," + number(n) + ")\n";
  const std::string program = scratch.write("MAIN.nc", main + "G1 X10\nM30\n"), trace = scratch.path("t.csv");
  const Ending run = servogate(
      {"run", machine, program, "--virtual", "--state", scratch.path("state"), "--trace", trace, "--quiet"});
  ASSERT_EQ(run.code, 0) << run.out << run.err;

  const TraceFile rows(trace);
  std::vector<std::size_t> columns;
  for (const char letter : kLetters) columns.push_back(rows.column(std::string(1, letter) + ".cmd"));
  bool all_at_once = false, x_went_on = false;
  for (std::size_t r = 1; r < rows.rows(); ++r) {
    const auto moves = [&](std::size_t c) { return rows.at(r, c) != rows.at(r - 1, c); };
    all_at_once = all_at_once || std::all_of(columns.begin(), columns.end(), moves);
    x_went_on = x_went_on || rows.at(r, columns[0]) < rows.at(r - 1, columns[0]);
    if (!x_went_on) continue;
    for (std::size_t n = 1; n < columns.size(); ++n)
      ASSERT_NEAR(rows.at(r, columns[n]), 60.0 + 20.0 * static_cast<double>(n), kDigit)
          << "X waits for " << kLetters[n];
  }
  EXPECT_TRUE(all_at_once);
  EXPECT_TRUE(x_went_on);
  EXPECT_NEAR(rows.at(rows.rows() - 1, columns[0]), 10.0, kDigit);
}

}  // namespace
}  // namespace servogate::machine_run
