// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/compose/program/program_check.hpp"
#include "gateway/control/history/machine_watch.hpp"
#include "gateway/control/run/announce.hpp"
#include "gateway/control/server/resident/work/outcome.hpp"
#include "gateway/control/server/resident/work/works.hpp"
#include "gateway/control/server/resident/request_desk.hpp"
#include "machine/state/state.hpp"

namespace servogate::gateway {

/// A Control that stays: its program, its learned state, and who speaks to it. Everything here is for one
/// thread outside the cycle (the desk's) unless it says otherwise; the loop's owner runs the Control itself.
class Resident {
 public:
  /// `speed`: machine seconds per wall-clock second.
  Resident(Control& control, machine::MachineState state, std::string state_path, double speed = 1.0);

  /// Who hears what cannot be kept or does not rest. Before anybody asks.
  void announce_to(Announce announce) { announce_ = std::move(announce); }
  const Announce& announce() const noexcept { return announce_; }
  /// From here on the history has what happens to the machine and who asks for what. Before anybody asks;
  /// `log` outlives this.
  void keep_history(history::EventLog& log);
  /// nullptr: none is kept.
  history::EventLog* history() const noexcept { return history_; }

  /// The way to the gate. Any thread.
  RequestDesk& requests() noexcept { return requests_; }
  /// Posts one request of a client and waits for the gate's answer and the image that shows what it did.
  RequestDesk::Outcome ask(const image::Request& request, image::Answer& answer, const Asked& asked);

  /// A program on its way to be loaded: begin_load(), read_and_prove(), finish().
  struct Load {
    enum class End {
      done,
      not_opened,    ///< the file cannot be read, or its language is not known
      has_errors,    ///< of the program
      busy,          ///< a program has begun meanwhile
      other_tables,  ///< the tables with which it was proven have changed meanwhile
    };
    std::string path, dialect;
    program::Tables tables;
    program::Position at{};
    std::shared_ptr<ProgramFile> file = std::make_shared<ProgramFile>();
    bool opened = false;
    std::vector<text::Finding> findings;
    int blocks = 0, lines = 0;
  };
  Load begin_load(std::string path, std::string dialect);
  /// Reads the program and looks through it with the tables as they were (prove_program). Any thread; throws
  /// Cancelled.
  void read_and_prove(Load& load, const std::stop_token& stop) const;
  /// Loads it unless something is wrong; then the one loaded before stays.
  Load::End finish(Load& load);

  /// The loaded program, to be looked through with other tables.
  struct Proof {
    std::shared_ptr<const ProgramFile> file;
    program::Tables tables;
    program::Position at{};
    std::vector<text::Finding> errors;
  };
  /// Reads what the last run changed in the tables.
  void read_tables();
  /// The same before the next one starts, and the program goes by them. Where it has to be proven first, only
  /// behind proven().
  std::optional<Proof> take_tables();
  /// The program goes by the tables as they are now; the same.
  std::optional<Proof> renew_tables();
  /// Any thread; throws Cancelled.
  void prove(Proof& proof, const std::stop_token& stop) const;
  void proven(const Proof& proof);

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

  /// Gives the present position of an axis a value (as programs write it: a diameter on a diameter axis) in
  /// the origin in force, after the gate has agreed.
  Zeroed zero(int axis, double value);

  /// What has been learned (homing, origins, tool); nullopt: nothing yet, or nothing is kept.
  std::optional<machine::MachineState> to_save();
  /// Writes it; empty: done, otherwise what went wrong. One thread at a time.
  std::string write(const std::optional<machine::MachineState>& state) const;
  std::string save() { return write(to_save()); }
  /// Called now and then: what is to be done when an axis has found its reference or a program has ended.
  std::vector<Work> look_after();

  /// The control comes to its end: nothing is begun any more. Any thread.
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
  /// What clients wait for that takes long.
  Works& works() noexcept { return works_; }
  Control& control() noexcept { return control_; }
  /// Newest whole image and alarms.
  const image::ProcessImage& image();
  const cycle::AlarmSnapshot& alarms();

 private:
  bool arm(ProgramChange::Kind kind);
  void catch_up();
  Work prove_later(Proof proof);
  Work save_later();
  program::Position position();
  std::uint32_t homed();

  Announce announce_;
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
  bool busy_seen_ = false, unsaved_ = false, saving_ = false;
  bool own_tables_ = false;  ///< they were changed here, and no process has them yet
  std::atomic<bool> ending_{false};
  RequestDesk requests_;
  image::ProcessImage image_;
  cycle::AlarmSnapshot alarms_;
  history::EventLog* history_ = nullptr;
  history::MachineWatch watch_{control_};
  Works works_;
};

}  // namespace servogate::gateway
