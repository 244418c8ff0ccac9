// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gateway/compose/control.hpp"
#include "gateway/compose/program/program_check.hpp"
#include "gateway/machine/state/state.hpp"
#include "gateway/server/plc/plc_desk.hpp"

namespace servogate::gateway {

/// A Control that stays: its program, its learned state, and who speaks to it. Everything here is for one
/// thread outside the cycle (the server's), except that the loop's owner runs the Control itself.
class Resident {
 public:
  /// `speed`: machine seconds per wall-clock second.
  Resident(Control& control, machine::MachineState state, std::string state_path, double speed = 1.0);

  /// Posts one request and waits for the gate's answer, at most `patience_ms`. False: no answer in time.
  bool ask(image::Request request, image::Answer& answer, int patience_ms = 2000);
  /// Posts without waiting for the answer (keep-alive, stops).
  void tell(image::Request request);

  /// How a load went.
  enum class Load {
    done,
    not_opened,  ///< the file cannot be read, or its language is not known
    has_errors,  ///< of the program
    busy         ///< a program has begun meanwhile
  };
  /// Loads a program that nothing can be proven wrong of with the tables as they are (prove_program);
  /// findings are returned. Unless `done`, the one loaded before stays.
  Load load(const std::string& path, const std::string& dialect, std::vector<text::Finding>& findings);
  /// Takes over what the last run changed in the tables, before the next one starts.
  void take_tables();
  /// What this block gives in the present modal state of MDI, before anything moves: warnings, and last the
  /// error that keeps it from running.
  std::vector<text::Finding> check_block(const std::string& block);
  /// Errors of the loaded program since its tables (origins, tools) changed behind the load: it is not given
  /// to the process until they are gone. Empty: none.
  const std::vector<text::Finding>& refused() const noexcept { return refused_; }
  /// The block that the next start in MDI mode runs.
  void set_manual_block(const std::string& block);
  /// The block that was typed last.
  const std::string& manual_block() const noexcept { return manual_block_; }
  /// MDI begins with the power-on modes again.
  void forget_modes();

  /// What zero() did.
  struct Zeroed {
    int origin = 0;      ///< number of the origin in force
    double place = 0.0;  ///< machine coordinate of its zero now, mm or degrees (radius)
  };
  /// Gives the present position of an axis a value (as programs write it: a diameter on a diameter axis) in
  /// the origin in force, after the gate has agreed.
  Zeroed zero(int axis, double value);

  /// Writes what has been learned (homing, origins, tool); empty: done, otherwise what went wrong.
  std::string save();
  /// Called now and then by the server's thread: saves when an axis has found its reference or a program has
  /// ended. Empty: fine.
  std::string look_after();

  /// The control comes to its end: nothing is begun any more.
  void set_ending() noexcept { ending_ = true; }
  bool ending() const noexcept { return ending_; }
  /// A program is under way (running, held or waiting).
  bool busy();
  /// It has been ended, and its path is not at rest yet.
  bool stopping() const;
  /// What is under way is a block typed by hand, not the loaded program.
  bool typed();
  /// A program is stepped through block by block.
  bool steps();
  /// Path of the loaded program; empty: none.
  const std::string& program() const noexcept { return file_->path; }
  /// Of the loaded program's file: blocks, and lines.
  int blocks() const noexcept { return blocks_; }
  int lines() const noexcept { return lines_; }
  double speed() const noexcept { return speed_; }
  /// Folder of what is learned; empty: nothing is kept.
  const std::string& state_path() const noexcept { return state_path_; }
  PlcDesk& plc() noexcept { return plc_; }
  Control& control() noexcept { return control_; }
  /// Newest whole image and alarms.
  const image::ProcessImage& image();
  const cycle::AlarmSnapshot& alarms();

 private:
  bool arm(ProgramChange::Kind kind);
  void prove_again();
  ProgramCheck prove(const ProgramFile& file);
  void catch_up();
  program::Position position();
  std::uint32_t homed();

  Control& control_;
  machine::MachineState state_;
  std::string state_path_;
  double speed_;
  std::shared_ptr<const ProgramFile> file_;
  program::Tables proven_;  ///< with which file_ was last looked through
  std::vector<text::Finding> refused_;
  int blocks_ = 0, lines_ = 0;
  std::string manual_block_;
  std::uint32_t homed_seen_ = 0;
  bool busy_seen_ = false, ending_ = false;
  std::uint64_t next_id_ = 1;
  image::ProcessImage image_;
  cycle::AlarmSnapshot alarms_;
  PlcDesk plc_{*this};
};

}  // namespace servogate::gateway
