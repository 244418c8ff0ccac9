// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "gateway/control/compose/setup/axis_setup.hpp"
#include "gateway/control/compose/setup/canopen_setup.hpp"
#include "tests/places/places.hpp"

namespace servogate::gateway {
namespace {

/// The example lathe with another gear, encoder and unit of the spindle's speed.
machine::LoadResult lathe(const std::string& spindle_keys, bool in_rpm, std::int64_t motor_counts = 0) {
  std::ifstream in(tests::source_dir() + "/examples/lathe/machine.toml");
  std::ostringstream text;
  text << in.rdbuf();
  std::string machine = text.str();
  const std::string encoder = "counts_per_rev = 65536\n";
  const auto at = machine.find(encoder, machine.find("[[spindle]]"));
  EXPECT_NE(at, std::string::npos);
  machine.replace(at, encoder.size(), spindle_keys);
  machine::LoadResult loaded = machine::parse(machine, tests::source_dir() + "/examples/lathe/machine.toml");
  loaded.devices.at("spindle-cia402").behaviour.velocity_in_rpm = in_rpm;
  loaded.devices.at("spindle-cia402").motor.counts_per_rev = motor_counts;
  return loaded;
}

/// What 60FFh asks of the motor, in rpm, when the spindle is to turn at 1000.
double motor_rpm(const machine::LoadResult& loaded) {
  const axis::SpindleConfig spindle = spindle_config(loaded, loaded.machine.spindles[0]);
  const canopen::SegmentConfig segment = segment_config(loaded, 0);
  for (const canopen::NodeConfig& node : segment.nodes) {
    if (node.target != canopen::DriveTarget::spindle) continue;
    const double counts_s = 1000.0 / 60.0 * static_cast<double>(spindle.counts_numerator) /
                            static_cast<double>(spindle.counts_denominator);
    const double written = counts_s / node.profile.velocity_unit_counts_s;
    const bool in_rpm = loaded.devices.at("spindle-cia402").behaviour.velocity_in_rpm;
    return in_rpm ? written : written * 60.0 / static_cast<double>(node.profile.counts_per_rev);
  }
  ADD_FAILURE() << "no node drives the spindle";
  return 0.0;
}

TEST(SpindleGear, turns_the_motor_twice_as_fast_behind_two_to_one_in_either_unit_of_its_speed) {
  for (const bool in_rpm : {false, true}) {
    SCOPED_TRACE(in_rpm ? "60FFh in rpm" : "60FFh in counts/s");
    EXPECT_NEAR(motor_rpm(lathe("counts_per_rev = 65536\n", in_rpm)), 1000.0, 0.01);
    EXPECT_NEAR(motor_rpm(lathe("counts_per_rev = 65536\ngear = [2, 1]\n", in_rpm)), 2000.0, 0.01);
    EXPECT_NEAR(motor_rpm(lathe("counts_per_rev = 65536\ngear = [1, 2]\n", in_rpm)), 500.0, 0.01);
    EXPECT_NEAR(motor_rpm(lathe("gear = [2, 1]\n", in_rpm, 4096)), 2000.0, 0.01)
        << "the drive counts at its motor";
  }
}

}  // namespace
}  // namespace servogate::gateway
