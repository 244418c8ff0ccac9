// SPDX-License-Identifier: Apache-2.0
// `servogate bench` against drives in other processes, seen only through the bus.
#include <cmath>
#include <filesystem>
#include <numbers>

#include "tests/bench/random_plant.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/property_seed.hpp"

namespace servogate::canopen_tools {
namespace {

constexpr const char* kEnvelope = " --travel -100..500 --speed 20 --torque 4.8 --time 120 --listen 0.1";

/// A bus in granted time with one drive on it; what the bench says of it.
class Lockstep : public Workbench {
 protected:
  json identified(const mock::PlantConfig& plant, int number) {
    const std::string at = std::to_string(number);
    const std::string socket = path("lockstep" + at);
    const std::string url = "lockstep:unix:" + socket + "/can0";
    const usercan::Process bus({"can", "bus", "can0", "--listen", "unix:" + socket, "--lockstep", "2"});
    EXPECT_TRUE(bus.says("can0"));
    const usercan::Process drive({"drive", url, "--node", "5", "--plant", bench::plant_words(plant)});
    EXPECT_TRUE(drive.says("node 5"));
    return facts("bench identify " + url + " 5" + kEnvelope + " --out run" + at + " --i-may-move");
  }
};

void expect_within(const json& found, double truth, const char* what) {
  ASSERT_TRUE(found.is_number()) << what;
  EXPECT_NEAR(found.get<double>(), truth, 0.03 * std::abs(truth)) << what;
}

TEST_F(Lockstep, random_plants_in_other_processes_are_identified_within_three_per_cent) {
  std::mt19937_64 random(test::property_seed());
  for (int i = 0; i < 2; ++i) {  // half a minute each; tests/bench has ten
    const mock::PlantConfig p = bench::random_plant(random, i % 2 == 1);
    SCOPED_TRACE(bench::plant_words(p));
    const json found = identified(p, i);
    ASSERT_EQ(found["trip"], "none");
    EXPECT_EQ(found["off"], true);
    expect_within(found["inertia_kg_m2"], p.inertia_kg_m2 + p.load_inertia_kg_m2, "inertia");
    expect_within(found["friction"]["coulomb_nm"], p.coulomb_friction_nm, "Coulomb");
    expect_within(found["friction"]["viscous_nm_s_rad"], p.viscous_friction_nm_s, "viscous");
    ASSERT_EQ(found.contains("coupling"), p.stiffness_nm_rad > 0.0);
    if (p.stiffness_nm_rad == 0.0) continue;
    const double turn = 2.0 * std::numbers::pi;
    expect_within(found["coupling"]["antiresonance_hz"],
                  std::sqrt(p.stiffness_nm_rad / p.load_inertia_kg_m2) / turn, "antiresonance");
    expect_within(found["coupling"]["resonance_hz"],
                  std::sqrt(p.stiffness_nm_rad * (1.0 / p.load_inertia_kg_m2 + 1.0 / p.inertia_kg_m2)) / turn,
                  "resonance");
  }
}

class Bench : public Workbench {};

TEST_F(Bench, what_does_not_fit_into_the_envelope_does_not_move) {
  drives("5");
  const std::string rest = " --speed 5 --torque 1 --listen 0.1 --i-may-move --out ";
  const Ended far =
      tool("bench run $BUS 5 --signal trapezoid --loop position --amplitude 3 --duration 5 --travel -1..2" +
           rest + "far");
  EXPECT_EQ(far.code, 1);
  EXPECT_NE(far.err.find("--travel"), std::string::npos) << far.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6064")["value"], 0);
  const Ended unasked =
      tool("bench run $BUS 5 --signal step --loop velocity --travel -1..2 --speed 5 --torque 1 --out no");
  EXPECT_EQ(unasked.code, 2);
  EXPECT_NE(unasked.err.find("--i-may-move"), std::string::npos) << unasked.err;
  EXPECT_FALSE(std::filesystem::exists(path("no")));
}

}  // namespace
}  // namespace servogate::canopen_tools
