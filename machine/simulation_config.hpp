// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "machine/config_basics.hpp"

namespace servogate::machine {

/// [[simulation.switch]]: a mock input that follows a simulated axis; TRUE while from <= position <= to.
struct SimulatedSwitch {
  std::string point;
  std::string axis;
  double from = -kNoLimit;
  double to = kNoLimit;
};
/// [[simulation.loop]]: a mock input that follows an output after a delay.
struct SimulatedLoop {
  std::string output;
  std::string input;
  bool inverted = false;
  double delay = 0.0;  ///< s
};
/// [[simulation.indexer]]: a turret or magazine on mock inputs: while `output` is on, the next of `inputs` is
/// TRUE after every `step`, between two of them none for the first half of it.
struct SimulatedIndexer {
  std::string output;
  std::vector<std::string> inputs;
  double step = 0.5;  ///< s from one position to the next
};
/// [[simulation.drive]]: the plant behind a simulated drive. Masses are seen from the motor shaft.
struct SimulatedDrive {
  std::string node;                 ///< "bus.node"
  double start = 0.0;               ///< where the axis stands at power-on, mm from machine zero
  double zero_mark = 0.0;           ///< counts from machine zero to the nearest zero mark in plus direction
  double inertia = 0.0;             ///< kg m2, 0: the device file's
  double friction_coulomb = 0.0;    ///< N m
  double friction_viscous = 0.0;    ///< N m s/rad
  double gravity_torque = 0.0;      ///< N m, vertical axis
  double max_torque = 0.0;          ///< N m, 0: the device file's
  bool absolute_encoder = false;    ///< false: the encoder reads 0 at power-on wherever the axis stands
  double end_stop_min = -kNoLimit;  ///< rigid stops, machine coordinates, mm
  double end_stop_max = kNoLimit;
  double dip_torque = 0.0;     ///< N m against the motion, that comes and goes
  double dip_period = 1.0;     ///< s from one to the next
  double dip_time = 0.1;       ///< s that each lasts
  double encoder_noise = 0.0;  ///< counts that a reading is off at most
};
/// [[simulation.amplifier]]: the motor and amplifier behind a channel of a simulated board.
struct SimulatedAmplifier {
  std::string axis;
  double start = 0.0;           ///< where the axis stands at power-on, mm from machine zero
  double zero_mark = 0.0;       ///< counts from machine zero to the nearest zero mark in plus direction
  double pull_out_speed = 0.0;  ///< rpm beyond which a stepper loses steps; 0: it never does
  double lag = 0.005;           ///< s, time constant of a speed amplifier
  double drift = 0.0;           ///< per cent of the full set-point, of a speed amplifier
};
/// [simulation]: what the mocks do. Without effect on anything that is not a mock.
struct SimulationConfig {
  std::map<std::string, double> initial;  ///< point -> value at start (before `inverted`)
  std::vector<std::string>
      operator_closes;  ///< points that the operator of `run` sets: the emergency-stop chain
  std::vector<SimulatedSwitch> switches;
  std::vector<SimulatedLoop> loops;
  std::vector<SimulatedIndexer> indexers;
  std::vector<SimulatedDrive> drives;
  std::vector<SimulatedAmplifier> amplifiers;
};

}  // namespace servogate::machine
