// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <string>
#include <vector>

#include "firmware_if/canopen/master/segment_load.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/load.hpp"

namespace servogate::machine {

/// What the numbers of a machine file mean, one sentence: "X: 1 mm = 26214.4 counts; 500 mm/s = 3000 rpm".
struct Consequence {
  std::string subject;  ///< axis letter, "bus can", point name
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  std::map<std::string, double> figures;  ///< the numbers behind the sentence, for --json
  std::string str(text::Language language = text::user_language()) const;
};

/// Nodes of a bus as the CANopen master wants them, in the order of the file, without targets.
/// Nodes whose device file could not be read are left out.
std::vector<canopen::NodeConfig> planned_nodes(const LoadResult& loaded, const BusConfig& bus);

/// What the control sends on a bus beside process data, as the file wants it.
canopen::SegmentServices planned_services(const BusConfig& bus);

/// Planned load of a segment with its devices' PDO maps.
canopen::SegmentLoad segment_load(const LoadResult& loaded, const BusConfig& bus);

/// Time between two looks at the signals of a station, s; 0: they are read in the cycle itself.
double read_every(const LoadResult& loaded, const StationConfig& station);
/// Time from the cycle that works the brake of an axis until its output has the command, at the latest, s; 0:
/// it has none. Process data of every n-th SYNC leave within n cycles and act at the SYNC behind them.
double brake_command_time(const LoadResult& loaded, const AxisConfig& axis);
/// Time between two set-points of a drive that only answers SDO, in seconds, at best; 0: it has process data,
/// or there is no such node ("bus.node").
double sdo_round(const LoadResult& loaded, const std::string& reference);
/// How far a drive that forms its motion by itself (profile position) is behind the set-points of its axis at
/// full speed: the way on which it would stop, and that of the time between two set-points. mm or degrees.
double own_motion_lag(const LoadResult& loaded, const AxisConfig& axis);

/// Sentences for `servogate check MACHINE`, in the order of the file. Takes any result, also one with errors.
std::vector<Consequence> consequences(const LoadResult& loaded);
/// {"schema":1,"machine":"...","consequences":[{"subject":...,"text":...,"figures":{...}}]}
std::string to_json(const LoadResult& loaded, const std::vector<Consequence>& lines,
                    text::Language language = text::user_language());
/// Findings as JSON objects {"file","line","column","severity","code","text"}, for --json of every command.
std::string to_json(const std::vector<text::Finding>& findings,
                    text::Language language = text::user_language());

}  // namespace servogate::machine
