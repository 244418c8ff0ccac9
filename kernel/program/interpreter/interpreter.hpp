// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/program/execution/state/machine.hpp"
#include "kernel/program/execution/state/step.hpp"
#include "kernel/program/geometry/frame.hpp"
#include "kernel/program/reading/loader.hpp"
#include "kernel/program/reading/program_text.hpp"

namespace servogate::program {

/// What the operator has set for a whole program. The program's own words come after it.
struct OperatorSwitches {
  std::uint16_t skip_levels = 0;  ///< bit 0: blocks marked with / are skipped; bit n: those with /n
  bool dry_run = false;           ///< feed motions run at rapid speed
  friend bool operator==(const OperatorSwitches&, const OperatorSwitches&) = default;
};

/// The interpreter of one process: a value that can be copied at any time (restart, retrace, look-ahead).
class Interpreter {
 public:
  /// Reads the program text whole. Syntax findings come out of next() when the block is reached, and all
  /// together from findings().
  Interpreter(std::string_view dialect, MachineModel machine, Tables tables, std::string file_name,
              ProgramText text, ProgramLoader loader, const Position& start, int process = 0);
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
  /// How far each axis of the machine still has to go in its block, mm or degrees, as the packets of the next
  /// next() are; programs may read it.
  void look_at(const Position& to_go);
  /// The probe of the last Probe command has touched with the axes at `at`, machine coordinates.
  void probed(const Position& at);
  /// Before the first next(): what the operator has set.
  void set_switches(const OperatorSwitches& switches);
  /// Before the first next(): whether the first spindle is its rotary axis.
  void set_spindle_axis(bool on);
  /// Number of the origin in force of an axis.
  int origin(int axis) const;
  /// Length of the tool in force along an axis, wear included, mm.
  double tool_length(int axis) const;
  /// The way from programmed to machine coordinates that is in force, behind the last command of next().
  const Frame& frame() const;
  /// A feed per revolution is in force (G95), a cutting speed (G96).
  bool feed_per_revolution() const;
  bool cutting_speed() const;
  /// Row of the tool table in force, 0: none.
  int corrector() const;
  /// The axis across the plane in force, -1: the machine has none there.
  int depth_axis() const;
  /// The next commands come first, then those of the program; next() gives nothing but `refused` where that
  /// is set. For a program that begins in its middle (restart.hpp).
  void begin_with(std::vector<Command> commands, std::optional<text::Finding> refused = std::nullopt);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::program
