// SPDX-License-Identifier: Apache-2.0
// A rotary axis without ends of travel counts on over its turns, and people read it within one.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

class RollOver : public ::testing::Test {
 protected:
  /// The example with four axes, A with these ends of travel.
  void begin(const std::string& travel) {
    std::ifstream in(Shell::example("four-axis-mill/machine.toml"));
    std::string machine{std::istreambuf_iterator<char>(in), {}};
    const std::string name = "four-axis mill";  // the shell asks the socket of the mill
    machine.replace(machine.find(name), name.size(), "three-axis mill");
    const std::string ends = "travel_min = \"-360 deg\"\ntravel_max = \"360 deg\"\n";
    const std::size_t at = machine.find(ends);
    ASSERT_NE(at, std::string::npos);
    machine.replace(at, ends.size(), travel);
    const std::filesystem::path logic = Shell::example("four-axis-mill/mill.st");
    std::filesystem::copy_file(logic, shell_.folder() / "mill.st");
    const std::string file = (shell_.folder() / "machine.toml").string();
    std::ofstream(file) << machine;
    shell_.up_file(file, {"--virtual", "--speed", "20"});
    good({"power", "on"});
  }
  void good(std::vector<std::string> words) {
    words.insert(words.end(), {"--socket", shell_.socket()});
    const Outcome o = shell_.run(words);
    ASSERT_EQ(o.exit, 0) << words[0] << ": " << o.out << o.err;
  }
  void turn(const std::string& degrees) { good({"mdi", "G91 G0 A" + degrees, "--wait"}); }
  json axis() { return shell_.status()["axes"][3]; }

  Shell shell_;
};

TEST_F(RollOver, shows_an_endless_axis_within_its_turn_in_both_coordinates) {
  begin("travel_min = \"0 deg\"\ntravel_max = \"0 deg\"\n");
  turn("250");
  turn("250");
  ASSERT_EQ(axis()["letter"], "A");
  EXPECT_NEAR(axis()["command"], 140.0, 1e-6) << "500 degrees";
  EXPECT_NEAR(axis()["position"], 140.0, 0.1);
  EXPECT_NEAR(axis()["work"], 140.0, 0.1);
  turn("-141");
  EXPECT_NEAR(axis()["command"], 359.0, 1e-6);
  turn("-358");
  turn("-2");
  EXPECT_NEAR(axis()["command"], 359.0, 1e-6) << "one degree before its zero, and not -1";
  turn("1");
  EXPECT_EQ(axis()["command"], 0.0) << "a whole turn is none";
  good({"zero", "A", "350"});
  EXPECT_NEAR(axis()["work"], 350.0, 0.1);
  turn("20");
  EXPECT_NEAR(axis()["work"], 10.0, 0.1);
  EXPECT_NEAR(axis()["command"], 20.0, 1e-6);
}

TEST_F(RollOver, shows_every_turn_of_an_axis_that_has_ends) {
  begin("travel_min = \"-720 deg\"\ntravel_max = \"720 deg\"\n");
  turn("500");
  EXPECT_NEAR(axis()["command"], 500.0, 1e-6);
  turn("-700");
  EXPECT_NEAR(axis()["command"], -200.0, 1e-6);
}

}  // namespace
}  // namespace servogate::gateway::testing
