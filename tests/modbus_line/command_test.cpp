// SPDX-License-Identifier: Apache-2.0
// `servogate modbus` as a program of its own.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "tests/modbus_line/rig/units.hpp"
#include "tests/places/places.hpp"

namespace servogate::modbus_line {
namespace {

struct Said {
  int code = -1;
  std::string words;
};

Said servogate(const std::string& arguments) {
  Said said;
  FILE* pipe = popen(("LANG=C " + tests::program() + " modbus " + arguments + " 2>&1").c_str(), "r");
  std::array<char, 256> bytes{};
  while (fgets(bytes.data(), bytes.size(), pipe) != nullptr) said.words += bytes.data();
  const int status = pclose(pipe);
  said.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return said;
}

TEST(ModbusCommand, reads_writes_and_scans_over_tcp) {
  Units units(Units::Wire::tcp, {1, 7});
  units.with(7, [](mock::ModbusStation& s) {
    s.set_input(2, true);
    s.set_analog_input(1, 4711);
  });
  const std::string line = "tcp:127.0.0.1:" + units.port() + " --timeout 2000";
  Said said = servogate("read " + line + " 7 input-registers 0 3");
  EXPECT_EQ(said.code, 0);
  EXPECT_EQ(said.words, "0: 0\n1: 4711\n2: 0\n");
  said = servogate("read " + line + " 7 inputs 2");
  EXPECT_EQ(said.words, "2: 1\n");
  said = servogate("write " + line + " 7 coils 3 1");
  EXPECT_EQ(said.code, 2) << "without --i-may-move";
  EXPECT_FALSE(units.output(7, 3));
  said = servogate("write " + line + " 7 coils 3 1 --i-may-move");
  EXPECT_EQ(said.code, 0) << said.words;
  EXPECT_TRUE(units.output(7, 3));
  said = servogate("write " + line + " 7 registers 0 0x10 32 --i-may-move --json");
  EXPECT_EQ(said.code, 0) << said.words;
  units.with(7, [](const mock::ModbusStation& s) {
    EXPECT_EQ(s.analog_output(0), 16);
    EXPECT_EQ(s.analog_output(1), 32);
  });
  said = servogate("read " + line + " 7 coils 900");
  EXPECT_EQ(said.code, 1);
  EXPECT_NE(said.words.find("it has no such address"), std::string::npos) << said.words;
}

TEST(ModbusCommand, says_who_is_there_and_what_is_wrong) {
  Units units(Units::Wire::rtu, {2, 5});
  const std::string line = "rtu:" + units.device() + " --parity none";
  Said said = servogate("scan " + line + " --from 2 --to 5 --timeout 2000");
  EXPECT_EQ(said.code, 0);
  EXPECT_EQ(said.words, "unit 2 answers\nunit 5 answers\n");
  said = servogate("read " + line + " 9 inputs 0 --timeout 50");
  EXPECT_EQ(said.code, 1);
  EXPECT_NE(said.words.find("unit 9 does not answer within 50 ms"), std::string::npos) << said.words;
  said = servogate("read " + line + " 2 registers 0 126");
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.words.find("at most 125"), std::string::npos) << said.words;
  said = servogate("read nothing:5 2 registers 0");
  EXPECT_EQ(said.code, 2);
  EXPECT_NE(said.words.find("tcp:HOST:PORT"), std::string::npos) << said.words;
  said = servogate("scan rtu:/dev/no-such-line");
  EXPECT_EQ(said.code, 4);
  EXPECT_NE(said.words.find("is the adapter plugged in?"), std::string::npos) << said.words;
}

}  // namespace
}  // namespace servogate::modbus_line
