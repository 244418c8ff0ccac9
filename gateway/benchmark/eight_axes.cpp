// SPDX-License-Identifier: Apache-2.0
#include "gateway/benchmark/eight_axes.hpp"

#include <array>
#include <cmath>

namespace servogate::gateway {

namespace {

constexpr std::array<const char*, 8> kLetters = {"X", "Y", "Z", "U", "V", "W", "P", "Q"};
constexpr int kSegmentOf[8] = {0, 0, 0, 1, 1, 1, 2, 2};

std::string number(double v) {
  std::string s = std::to_string(v);
  return s;
}

}  // namespace

std::string eight_axis_machine(const std::string& plc) {
  std::string t =
      "schema = 1\nname = \"eight axes\"\n[control]\ncycle_time = \"1 ms\"\ndialect = \"nc110\"\n"
      "power_on = [\"G94\", \"G97\", \"G90\", \"G71\", \"G27\"]\nvariables = { ERF = 0.01, MCD = 2 }\n"
      "contour_tolerance = \"0.01 mm\"\n[safety]\nestop = \"estop_chain_ok\"\n[plc]\nsources = [\"" +
      plc + "\"]\n";
  for (int segment = 0; segment < 3; ++segment) {
    t += "[[bus]]\nname = \"can" + std::to_string(segment) + "\"\nurl = \"mock:can" +
         std::to_string(segment) + "\"\nbit_rate = \"1 Mbit/s\"\n";
    for (int a = 0; a < 8; ++a)
      if (kSegmentOf[a] == segment)
        t += "[[bus.node]]\nname = \"a" + std::to_string(a) + "\"\nid = " + std::to_string(a + 1) +
             "\ndevice = \"servo-cia402\"\n";
  }
  for (int a = 0; a < 8; ++a)
    t += std::string("[[axis]]\nletter = \"") + kLetters[static_cast<std::size_t>(a)] + "\"\ndrive = \"can" +
         std::to_string(kSegmentOf[a]) + ".a" + std::to_string(a) +
         "\"\nlead = \"10 mm/rev\"\ncounts_per_rev = 262144\nmax_velocity = \"500 mm/s\"\n"
         "max_acceleration = \"1000 mm/s2\"\nmax_jerk = \"10000 mm/s3\"\ntravel_min = \"-300 mm\"\n"
         "travel_max = \"300 mm\"\nfollowing_error_stop = \"1 mm\"\nfollowing_error_velocity = \"2 ms\"\n"
         "in_position_window = \"0.005 mm\"\n[axis.home]\nmethod = \"none\"\n";
  t += "[[station]]\nname = \"gpio\"\nkind = \"gpio\"\nurl = \"mock:gpio\"\ndevice = \"gpio-chip\"\n"
       "points = [{ name = \"estop_chain_ok\", channel = \"di0\", place = \"SA17\" }]\n"
       "[simulation]\noperator_closes = [\"estop_chain_ok\"]\n";
  return t;
}

std::string eight_axis_logic(int statements) {
  std::string t =
      "PROGRAM Main\n" + std::string(statements > 0 ? "VAR\n  a, b, c : BOOL;\nEND_VAR\n" : "") +
      "MC.estop_ok := estop_chain_ok;\n"
      "MC.power_on := MC.power_request AND MC.estop_ok;\nNC.feed_enable := TRUE;\nNC.read_in_enable := "
      "TRUE;\n"
      "NC.m_ack := NC.m_strobe;\nNC.s_ack := NC.s_strobe;\nNC.t_ack := NC.t_strobe;\n";
  for (const char* letter : kLetters) {
    t += std::string(letter) + ".enable := MC.power_on;\n";
    t += std::string(letter) + ".feed_enable := TRUE;\n";
  }
  if (statements > 0) t += "a := NC.running; b := NC.in_position;\n";
  for (int i = 0; i < statements; ++i) t += "c := a AND b;\n";
  return t + "END_PROGRAM\n";
}

std::string eight_axis_program() {
  std::string t = "G71 G90 G94 G27\nG1 X0 Y0 Z0 U0 V0 W0 P0 Q0 F6000\n";
  for (int i = 1; i <= 2000; ++i) {
    const double s = 0.02 * i;
    t += "X" + number(50.0 * std::sin(s)) + " Y" + number(50.0 - 50.0 * std::cos(s)) + " Z" +
         number(20.0 * std::sin(0.3 * s)) + " U" + number(30.0 * std::sin(0.7 * s)) + " V" +
         number(10.0 * std::sin(1.1 * s)) + " W" + number(15.0 * std::sin(0.5 * s)) + " P" +
         number(25.0 * std::sin(0.2 * s)) + " Q" + number(5.0 * std::sin(1.3 * s)) + "\n";
  }
  return t + "M2\n";
}

}  // namespace servogate::gateway
