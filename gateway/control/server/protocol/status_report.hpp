// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/modbus/line_counters.hpp"
#include "gateway/control/history/event_log.hpp"
#include "gateway/control/run/words/ready_words.hpp"
#include "gateway/control/run/words/stop_words.hpp"
#include "gateway/control/run/words/wait_words.hpp"
#include "gateway/control/server/protocol/plc_reply.hpp"
#include "report/report.hpp"

namespace servogate::gateway {

/// One process of a running control: its part of the image, and what that means in words.
struct ProcessReport {
  image::ProcessStatus status;
  std::string program;               ///< that is loaded; empty: none
  int blocks = 0, lines = 0;         ///< of its file
  std::optional<std::string> block;  ///< that was typed and is under way
  std::optional<StopWords> stop;
  std::string file;           ///< of the block in motion; empty: none, or a typed one
  std::string text;           ///< of the block in motion, as it stands in the program; empty: none
  int corrector = 0;          ///< row of the tool table in force by hand, 0: none
  double rotation_deg = 0.0;  ///< of the coordinates
  std::string message;
  std::optional<WaitWords> wait;
  /// Places that the last touch by hand has found, as people see them.
  struct Touched {
    std::string axis;
    std::vector<double> places;
  };
  std::optional<Touched> touched;
};

/// One axis; places are as people see them.
struct AxisReport {
  std::string letter, unit;
  bool diameter = false, auxiliary = false;
  double command = 0.0, position = 0.0;  ///< in `unit`, a diameter on a diameter axis
  double work = 0.0;                     ///< in the coordinates of the program: origin, tool, rotation
  double to_go = 0.0;                    ///< of the motion under way
  double beside = 0.0;                   ///< how far it was jogged away from a held program
  int origin = -1;        ///< number of the one in force by hand, -1: no program moves the axis
  image::AxisImage axis;  ///< in radius
  std::string jog_end;    ///< why its last jog ended; empty: it goes on, or there was none
  std::string
      gear_master;  ///< as the machine file names it, of the gear in force or asked for last; or empty
  std::string gear_refusal;  ///< why that was not engaged; empty: it was
};

/// What turns a spindle: a drive on a bus, an inverter on a Modbus line, or outputs without feedback.
enum class SpindleSupplier : std::uint8_t { drive, inverter, outputs };
struct SpindleReport {
  image::SpindleImage spindle;
  SpindleSupplier supplier = SpindleSupplier::drive;
  std::string place;          ///< "can.spindle", "cabinet.vfd", or the point of its speed
  bool gears = false;         ///< it has gear ranges
  std::string gear;           ///< name of the one in force; empty: none, or it changes
  std::string axis;           ///< letter of the rotary axis that it is now; empty: it is a spindle
  std::optional<bool> rests;  ///< none: its drive does not answer
};

struct BusNodeReport {
  int node = 0;
  std::string name;
  image::BusNodeStatus told;
};
struct BusReport {
  std::string name, url, place;
  std::vector<BusNodeReport> nodes;
};

/// A unit of a Modbus line.
struct ModbusUnitReport {
  std::string station;
  int unit = 0;
  image::IoSource health;
  double age_s = 0.0;  ///< of its oldest data; without meaning before the first ones
};
/// A Modbus line with its units, and what happened on it since the control began.
struct ModbusLineReport {
  std::string name, url;
  std::optional<modbus::LineCounters> counters;
  std::vector<ModbusUnitReport> units;
};

/// A GPIO chip. Its errors: accesses that failed, edges that were lost, transitions that no encoder makes.
struct ChipReport {
  std::string station, url;
  image::IoSource health;
};

struct AlarmRow {
  report::AlarmEntry entry;
  std::string reaction;
};

/// What somebody waits for that takes long.
struct WorkReport {
  std::string what, name;
  double for_s = 0.0;
};

/// State of a running control: modes, program, axes, spindles, buses, lines, alarms, and what waits for whom.
struct StatusReport {
  std::string machine;
  double time_s = 0.0;
  bool homing = false, ending = false;
  std::vector<std::string> homing_left;
  std::vector<ProcessReport> processes;
  std::vector<AxisReport> axes;
  std::vector<SpindleReport> spindles;
  std::vector<BusReport> buses;
  std::vector<ModbusLineReport> modbus;
  std::vector<ChipReport> chips;
  std::vector<AlarmRow> alarms;
  std::vector<MissingCondition> missing;
  std::vector<WorkReport> works;
  std::vector<ForcedValue> forced;
  std::string plc_held_by;  ///< empty: nobody
  text::Language language = text::Language::english;
};

/// Active alarms with cause and remedy, and what the processes wait for.
struct AlarmReport {
  std::vector<AlarmRow> alarms;
  std::vector<WaitWords> waits;
  text::Language language = text::Language::english;
};

/// The last events of the history, oldest first.
struct HistoryReport {
  std::vector<history::Event> events;
  std::string problem;  ///< why its file is not written any more; empty: it is
  text::Language language = text::Language::english;
};

/// A Modbus line that is real.
struct LineReport {
  std::string name, url, place;
};

/// Who holds which buses, with their nodes, and which lines.
struct HeldBuses {
  bool run = false;  ///< it is a `servogate run`
  std::string machine;
  std::vector<BusReport> buses;
  std::vector<LineReport> lines;
};

}  // namespace servogate::gateway
