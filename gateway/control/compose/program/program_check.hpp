// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>

#include "gateway/control/compose/program/program_file.hpp"
#include "kernel/channel/motion/forecast.hpp"
#include "kernel/program/check/check.hpp"

namespace servogate::gateway {

/// What a program without its machine comes to.
struct ProgramCheck {
  program::CheckReport report;  ///< its findings may begin with that of the file's encoding
  double motion_s = 0.0;        ///< of all motion at an override of 100 %; 0 unless timed or surveyed
  std::vector<path::SlowPlace> slowest;  ///< where most time is lost, only if surveyed
  long long feed_blocks = 0;             ///< elements at feed
  long long stops = 0;                   ///< of them end at rest, whatever follows
  int first_stop = 0;                    ///< line of the first of those, 0: in a subprogram, or there is none
  /// Programs that it starts in other processes (from 0), each once.
  std::set<std::pair<int, std::string>> starts;
  double seconds() const { return motion_s + report.dwell_seconds; }
};

/// Where the axes stand when the program begins, and which of them it may move.
struct Start {
  program::Position at{};
  bool known = false;                      ///< false: they may stand elsewhere by then
  std::optional<std::uint32_t> axes = {};  ///< of the process, as bits; those of the machine file
};
/// Where homing leaves the axes; known where it moves all of them.
Start start_after_homing(const machine::MachineConfig& machine);

/// Thrown by what a stop token has ended.
struct Cancelled {};

/// Runs the program to its end without the machine (program::check_program), from `start`, and asks the
/// channel whether its motion can be driven, and for how long. Throws Cancelled soon after `stop` asks for
/// it. Not real-time safe.
ProgramCheck check_program(const machine::MachineConfig& machine, const ProgramFile& file,
                           const program::Tables& tables, const Start& start, channel::Forecast::Depth depth,
                           const std::stop_token& stop = {});

/// A machine whose programs begin with the modes of a lathe (G95, G96) although no axis has a diameter: says
/// so once, and leaves of what follows from it the first.
void explain_power_on(const machine::MachineConfig& machine, const ProgramFile& file,
                      std::vector<text::Finding>& findings);

/// What is slow for want of a setting: blocks that end at rest because the corner error of the language
/// (ERF) is 0, with the time that the program takes now and would take with 0.01 mm. nullopt: it is not so.
/// Takes as long as a timed check.
std::optional<text::Finding> slow_corners(const machine::MachineConfig& machine, const ProgramFile& file,
                                          const program::Tables& tables, const Start& start,
                                          const ProgramCheck& timed);

/// Adds what is wrong with the programs that this one starts in other processes, and with those that they
/// start, to its findings: errors of reading as they are, those of their runs as warnings. Throws as
/// check_program().
void prove_started(const machine::MachineConfig& machine, const ProgramFile& file,
                   const program::Tables& tables, ProgramCheck& check, const std::stop_token& stop = {});

/// The same for a program that is about to run, with the programs that it starts: an error stays one only
/// where the machine cannot make a difference. One that is met after the program has read a signal, or only
/// from some places of the axes, becomes a warning which says so.
ProgramCheck prove_program(const machine::MachineConfig& machine, const ProgramFile& file,
                           const program::Tables& tables, const Start& start, channel::Forecast::Depth depth,
                           const std::stop_token& stop = {});

}  // namespace servogate::gateway
