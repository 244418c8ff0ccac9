// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/program/canonical.hpp"

namespace servogate::program {

/// What an interpreter must know of the machine. Filled from the machine file by the gateway.
struct MachineModel {
  struct Axis {
    std::string letter;
    bool rotary = false;
    bool diameter = false;
    bool alternative_inch = false;
    double travel_min = -1e9, travel_max = 1e9;  ///< mm or degrees; lathe X as radius
    double rapid = 0.0;                          ///< largest speed, mm/s or degrees/s; 0: not known
  };
  std::vector<Axis> axes;
  int spindles = 1;
  double spindle_min_rpm = 0.0;  ///< of the spindle that S speaks to; 0: as slow as one likes
  double spindle_max_rpm = 0.0;  ///< 0: not known, S is not compared with it
  int tool_places = 0;           ///< of the magazine or turret: T takes 0 to this number; 0: not known
  double contour_tolerance_mm = 0.01;
  /// Power-on modes and values in the dialect's own words, e.g. {"G94", "G97", "G90", "G71"}; the values of
  /// its variables by their names.
  std::vector<std::string> power_on;
  std::map<std::string, double> variables;
  std::vector<int> synchronous_m;  ///< reserved for dialects that let the machine builder choose
  /// A place that part programs must not write, and the name of who writes it (an input, the control).
  struct Protected {
    image::Place place;
    std::string owner;
  };
  std::vector<Protected> protected_places;
  std::uint32_t k_bytes = image::kPacketKDefaultSize;  ///< sizes of the packets of a dry run (check, canon)
  std::uint32_t syvar_bytes = image::kSyvarDefaultSize;
};

/// Tables an interpreter reads and, for some words, changes; kept in the state directory by the gateway.
struct Tables {
  struct Corrector {
    std::map<std::string, double> length;  ///< axis letter to mm
    double diameter = 0.0;
    bool operator==(const Corrector&) const = default;
  };
  std::map<int, std::map<std::string, double>> origins;  ///< number to axis letter to mm
  std::map<int, Corrector> correctors;
  bool operator==(const Tables&) const = default;
};

/// Another program, and where people find it.
struct LoadedProgram {
  LoadedProgram(std::string text_, std::string path_ = {}) : text(std::move(text_)), path(std::move(path_)) {}
  std::string text;
  std::string path;  ///< as findings name it; empty: the name by which it was called
};
/// Gives another program by its name (a subprogram), nullopt when there is none.
using ProgramLoader = std::function<std::optional<LoadedProgram>(std::string_view name)>;

/// A power-on mode or value of the machine file that the language cannot take. Its program does not run.
struct SettingFault {
  int mode = -1;         ///< index in MachineModel::power_on, -1: it is a variable
  std::string variable;  ///< its name in MachineModel::variables
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
};

/// The interpreter has to know packet places as they are when all motion before it has ended: finish it, take
/// a snapshot of the packets in the cycle, then call next() again with them.
struct NeedsSync {
  int line = 0;
};
/// A program error: the commands before it stay valid, nothing after it is read.
struct Error {
  text::Finding finding;
};
using Step = std::variant<Command, NeedsSync, Error>;

/// What the operator has set for a whole program. The program's own words  come after it.
struct OperatorSwitches {
  std::uint16_t skip_levels = 0;  ///< bit 0: blocks marked with / are skipped; bit n: those with /n
  bool dry_run = false;           ///< feed motions run at rapid speed
};

/// The interpreter of one process: a value that can be copied at any time (restart, retrace, look-ahead).
class Interpreter {
 public:
  /// Reads the program text whole. Syntax findings come out of next() when the block is reached, and all
  /// together from findings().
  Interpreter(std::string_view dialect, MachineModel machine, Tables tables, std::string file_name,
              std::string text, ProgramLoader loader, const Position& start, int process = 0);
  Interpreter(const Interpreter&);
  Interpreter& operator=(const Interpreter&);
  Interpreter(Interpreter&&) noexcept;
  Interpreter& operator=(Interpreter&&) noexcept;
  ~Interpreter();

  /// The next canonical command. `packets`: the shared memories as this process may see them now;
  /// `synchronised`: true when all motion before this point has ended and `packets` is a snapshot taken after
  /// that. Writes that do not wait for the motion come out as WritePlace with synchronous = false. Not
  /// real-time safe. Never throws on bad programs. After End or Error it keeps returning the same.
  Step next(const image::Packets& packets, bool synchronised);

  /// After an Error of a block: goes on behind it as if that block had not been there, so that `check` finds
  /// what else is wrong. False where nothing can follow. What comes then is no program that a machine may
  /// run.
  bool pass_over_error();

  /// All findings that reading alone can give (syntax, unknown words, impossible combinations), for `check`.
  std::vector<text::Finding> findings() const;
  /// What is wrong with the machine's power-on modes and variables in this language.
  std::vector<SettingFault> setting_faults() const;
  /// What the program has asked for so far and the control does otherwise: S beyond the spindle's range, F
  /// beyond the axes' speeds, a corrector that the tool table does not hold, a feed per revolution without a
  /// spindle that turns. Each place once, in the order of execution, at most 20 places of a kind; only grows,
  /// but for mdi(), which begins anew.
  const std::vector<text::Finding>& warnings() const;
  /// Path of a file met so far (index = Command::file) as people open it; findings name it so.
  const std::string& path(int file) const;
  /// Column of what moves an axis (-1: none in particular) in a block of a file met so far: the axis' word,
  /// or where the block begins.
  int column(int file, int line, int axis) const;
  /// The machine it was made for.
  const MachineModel& machine() const;
  /// Names of the files met so far, index = Command::file.
  const std::vector<std::string>& files() const;
  /// Position at which the next motion starts: the end of the last motion command, absolute machine
  /// coordinates.
  const Position& position() const;
  /// Tables with the changes that the program made.
  const Tables& tables() const;
  /// Blocks in the main program, and blocks executed so far, for progress.
  int block_count() const;
  long long executed() const;
  /// The program has read a place of a packet: what it does from there on may depend on the machine.
  bool machine_read() const;
  /// Executes one block typed by the operator (MDI) in the present modal state; then next() returns its
  /// commands and End.
  void mdi(std::string_view block);
  /// The axes stand at `at` now, whoever moved them: the next motion starts there. Modes and origins stay.
  void reposition(const Position& at);
  /// Takes over tables that somebody else changed; origins in force move with their rows.
  void adopt(Tables tables);
  /// Changes the origin in force of an axis so that the present position is `value` in programmed coordinates
  /// (mm or degrees; of a diameter axis the radius), in the table too.
  void preset(int axis, double value);
  /// Before the first next(): what the operator has set.
  void set_switches(const OperatorSwitches& switches);
  /// Number of the origin in force of an axis.
  int origin(int axis) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names of the dialects that this build reads: "nc110", ...
std::vector<std::string> dialects();

/// Letters that name an axis in programs of `dialect`, in alphabetical order; empty for one that this build
/// does not read. Not real-time safe.
std::string axis_letters(std::string_view dialect);

}  // namespace servogate::program
