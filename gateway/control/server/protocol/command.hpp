// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

/// What a client can ask the control for, one type for each command of docs/control-socket.md. Axes are said
/// by their letters, processes by their
/// number from 0 (JSON: from 1); lengths are as programs write them, in the unit of the axis (a diameter on a
/// diameter axis).
namespace servogate::gateway::ask {

// What is looked at.
struct Status {};
struct Buses {};
struct Alarms {};
/// The last events, oldest first.
struct History {
  double count = 100.0;
};
/// An object of a node, read over the bus by the control that holds it. A number out of its range: -1.
struct SdoRead {
  std::string bus;
  int node = -1, index = -1, subindex = -1;
};

// What the machine is to do.
struct Power {
  bool on = false;
};
struct Home {
  std::vector<std::string> axes;  ///< empty: all
};
struct Jog {
  std::string axis;
  double value = 0.0;
  std::string unit;  ///< that was meant; empty: the axis' own
};
/// Until it is stopped or not kept alive any more.
struct JogContinuous {
  std::string axis;
  double value = 0.0;  ///< its sign is the direction
};
/// Gives the present place of an axis this value in the origin in force.
struct Zero {
  std::string axis;
  double value = 0.0;
  std::string unit;
};
/// Origins and tools, all of both tables.
struct Tables {};
enum class Table : std::uint8_t { origin, tool };
/// Values of a row, or where the machine stands now, made to read so (`here`): axis letters, of a tool also
/// length (that of the tool axis), wear, wear_X ..., radius, diameter, radius_wear, quadrant.
struct TableSet {
  std::optional<Table> table;
  int number = -1;
  std::map<std::string, double> values;
  std::optional<std::string> name;  ///< of a tool
  bool here = false;
  std::vector<std::string> inches;  ///< names of values that are lengths in inches
};
struct TableClear {
  std::optional<Table> table;
  int number = -1;
};
/// The tables as they were before the last change from here.
struct TableUndo {};
/// Rows of a file: CSV, or a tool table of LinuxCNC.
struct TableImport {
  std::optional<Table> table;
  std::string file;
};
struct TableExport {
  std::optional<Table> table;
  bool linuxcnc = false;
};
struct Override {
  double percent = 100.0;
  int process = 0;
};
struct Load {
  std::string program, dialect;  ///< dialect empty: the machine's
  int process = 0;
};
struct Start {
  int process = 0;
};
/// Starts the loaded program in its middle.
struct Restart {
  int process = 0;
  std::optional<int> line, number;  ///< of the main program; neither: where it was interrupted
  double feed_mm_min = 500.0;       ///< of the way there
  bool confirm = false;             ///< each step of it waits for start
  bool plan = false;                ///< only says what would be done
};
struct Step {
  int process = 0;
};
struct Mdi {
  std::string block;
  int process = 0;
};
/// Measures along a linear axis with the probe: to its first touch at `feed`, then so many touches at `slow`
/// from `back` further back, and back to where it began. What was found stands in the status.
struct Touch {
  std::string axis;
  double by = 0.0;  ///< from where it stands, with its sign: no further; a diameter on a diameter axis
  double feed_mm_min = 200.0, slow_mm_min = 20.0;
  double back = 2.0;  ///< mm along the axis
  double times = 1.0;
  bool plan = false;  ///< only says what would be done
};
struct Resume {
  int process = 0;
};
/// The axes that were jogged away from a held program return.
struct Return {
  int process = 0;
  std::optional<double> feed_mm_min;  ///< none: the axes' jog speed
};
/// The axes of a held program go back along its path: by a length, or to the begin of so many blocks.
struct Retrace {
  int process = 0;
  std::optional<double> mm, blocks;
  std::optional<double> feed_mm_min;  ///< none: as programmed
};
/// The handwheel that drives a program along its path.
struct PathWheel {
  enum class What : std::uint8_t { choose, leave, turned, here, lost };
  int process = 0;
  What what = What::choose;
  double counts = 0.0;  ///< of `turned`, + forward
};
/// Another process' programs move the axis from now on.
struct Assign {
  std::string axis;
  int process = 0;
};
struct Reset {};
struct Acknowledge {};
/// Plays an input of a simulated station; neither a level nor a number: it follows the world again.
struct Input {
  std::string point;
  std::variant<std::monostate, bool, double> value;
};

/// Writes a number into a place of packet K, as its operator.
struct SetPlace {
  std::string place;  ///< "SK100.IN"
  double value = 0.0;
};

// What takes motion or energy away, or keeps a jog alive.
struct Stop {};
struct QuickStop {};
struct Hold {
  int process = -1;  ///< -1: all, and whatever moves by hand
};
struct JogStop {
  std::optional<std::string> axis;  ///< none: all
};
struct KeepAlive {
  std::optional<std::string> axis;  ///< none: whatever this client jogs
};
/// The end of the control.
struct Down {};

// The PLC.
struct PlcLoad {
  std::vector<std::string> files;  ///< empty: those of the machine file
  bool online = false, while_running = false;
};
struct PlcForce {
  std::string name, value;
  bool stay = false;  ///< beyond the client
};
struct PlcRelease {
  std::string name;  ///< empty: everything
};
struct PlcHold {};
struct PlcStep {
  double scans = 1.0;
};
struct PlcGo {};
struct PlcWatch {
  std::vector<std::string> names;
  bool times = false;               ///< of tasks and blocks, too
  std::optional<std::string> body;  ///< instead of names: a program or an instance, empty: the first program
};
struct PlcList {};

using Command =
    std::variant<Status, Buses, Alarms, History, SdoRead, Power, Home, Jog, JogContinuous, Zero, Override,
                 Load, Start, Restart, Step, Mdi, Touch, Resume, Return, Retrace, Assign, PathWheel, Tables,
                 TableSet, TableClear, TableUndo, TableImport, TableExport, Reset, Acknowledge, Input,
                 SetPlace, Stop, QuickStop, Hold, JogStop, KeepAlive, Down, PlcLoad, PlcForce, PlcRelease,
                 PlcHold, PlcStep, PlcGo, PlcWatch, PlcList>;

template <typename... Kinds>
bool is_any(const Command& command) noexcept {
  return (std::holds_alternative<Kinds>(command) || ...);
}

/// It takes motion or energy away, or keeps a jog alive: it does not wait behind others.
inline bool is_urgent(const Command& command) noexcept {
  const auto* const power = std::get_if<Power>(&command);
  return is_any<Stop, QuickStop, Hold, JogStop, KeepAlive, Down>(command) || (power != nullptr && !power->on);
}
/// What a control still does for its clients while it comes to its end, beside what is urgent.
inline bool only_looks(const Command& command) noexcept {
  return is_any<Status, Buses, Alarms, History, SdoRead, Tables, TableExport, PlcList, PlcWatch, PlcGo>(
      command);
}
inline bool of_plc(const Command& command) noexcept {
  return is_any<PlcLoad, PlcForce, PlcRelease, PlcHold, PlcStep, PlcGo, PlcWatch, PlcList>(command);
}

}  // namespace servogate::gateway::ask
