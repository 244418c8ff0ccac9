// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "gateway/control/compose/program/program_check.hpp"
#include "gateway/control/history/machine_watch.hpp"
#include "gateway/control/run/announce.hpp"
#include "gateway/control/run/block_journal.hpp"
#include "gateway/control/server/resident/request_desk.hpp"
#include "gateway/control/server/resident/work/outcome.hpp"
#include "gateway/control/server/resident/work/works.hpp"
#include "machine/state/state.hpp"

namespace servogate::gateway {

/// A Control that stays: the programs of its processes, its learned state, and who speaks to it. Everything
/// here is for one thread outside the cycle (the desk's) unless it says otherwise; the loop's owner runs the
/// Control itself. Processes count from 0.
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
    int process = 0;
    std::string path, dialect;
    program::Tables tables;
    Start start;
    std::shared_ptr<ProgramFile> file = std::make_shared<ProgramFile>();
    bool opened = false;
    std::vector<text::Finding> findings;
    int blocks = 0, lines = 0;
  };
  Load begin_load(int process, std::string path, std::string dialect);
  /// Reads the program and looks through it with the tables as they were (prove_program). Any thread; throws
  /// Cancelled.
  void read_and_prove(Load& load, const std::stop_token& stop) const;
  /// Loads it unless something is wrong; then the one loaded before stays.
  Load::End finish(Load& load);

  /// Loaded programs, to be looked through with other tables or other axes.
  struct Proof {
    struct Program {
      int process = 0;
      std::shared_ptr<const ProgramFile> file;
      Start start;
      std::vector<text::Finding> errors;
    };
    program::Tables tables;
    std::vector<Program> programs;
  };
  /// Reads what the last runs changed in the tables: what one process changed, the others get.
  void read_tables();
  /// The same before the next one starts in this process, and the programs go by them. What has to be proven
  /// first goes by them only behind proven().
  std::optional<Proof> take_tables(int process);
  /// The programs go by the tables as they are now; the same.
  std::optional<Proof> renew_tables();
  /// The programs have other axes than they were proven with; the same.
  std::optional<Proof> renew_axes();
  /// Any thread; throws Cancelled.
  void prove(Proof& proof, const std::stop_token& stop) const;
  void proven(const Proof& proof);

  /// What a block gives in the present modal state of MDI, before anything moves.
  struct TriedBlock {
    std::vector<program::Command> commands;
    std::vector<text::Finding> findings;  ///< warnings, and last the error that keeps it from running
    bool failed() const { return !findings.empty() && findings.back().severity == text::Severity::error; }
  };
  TriedBlock try_block(int process, const std::string& block);
  /// Errors of the loaded program since its tables (origins, tools) or axes changed behind the load: it is
  /// not given to the process until they are gone. Empty: none.
  const std::vector<text::Finding>& refused(int process) const { return seat(process).refused; }
  /// Coordinates in force: of the block in motion, else those of MDI.
  struct Coordinates {
    program::Frame frame;
    std::array<int, image::kMaxAxes> origin{};  ///< numbers in force in MDI
    int corrector = 0;                          ///< the same
  };
  Coordinates coordinates(int process);
  /// Text of a line of a program's file; empty: there is none.
  std::string line_of(int process, const std::string& file, int line);
  /// Where programs are, for a way back into them; `journal` outlives this.
  void keep_blocks(BlockJournal& journal) noexcept { journal_ = &journal; }
  /// nullopt: nothing was interrupted, or nothing is kept.
  std::optional<BlockJournal::Block> interrupted(int process) const {
    return journal_ != nullptr ? journal_->interrupted(process) : std::nullopt;
  }
  /// A start in the middle of the loaded program: begin_restart(), find(), begin_in_middle().
  struct RestartSearch {
    int process = 0;
    program::RestartAt at;
    std::shared_ptr<const ProgramFile> file;
    program::Tables tables;
    Start start;
    std::shared_ptr<const image::Packets> packets;  ///< as they were when it was asked for
    std::optional<std::variant<program::RestartPoint, text::Finding>> found = std::nullopt;
  };
  RestartSearch begin_restart(int process, const program::RestartAt& at);
  /// Any thread; takes as long as reading the program up to there.
  static void find(RestartSearch& search);
  /// The next start of the process begins there. False: its program is being read just now.
  bool begin_in_middle(const RestartSearch& search, double feed_mm_min, bool confirm);
  /// The block that the next start in MDI mode runs.
  void set_manual_block(int process, const std::string& block);
  /// The next start in MDI mode measures along an axis, once.
  void set_touch(int process, const std::string& axis, const channel::TouchOrder& order);
  /// The block that was typed last.
  const std::string& manual_block(int process) const { return seat(process).manual_block; }
  /// MDI of all processes begins with the power-on modes again.
  void forget_modes();

  /// Gives the present position of an axis a value (as programs write it: a diameter on a diameter axis) in
  /// the origin in force, after the gate has agreed.
  Zeroed zero(int axis, double value);
  /// Origins and tools as they are now.
  const program::Tables& tables();
  /// Puts others in their place, which undo_tables() takes back; renew_tables() gives them to the programs.
  void change_tables(program::Tables changed);
  /// False: nothing was changed since the control began.
  bool undo_tables();
  /// What would make the present position of an axis read `value` (as `zero` takes it): the entry of an
  /// origin with the tool in force, and the length of a tool with the origin in force, mm or degrees.
  struct Touched {
    double origin = 0.0, length = 0.0;
  };
  Touched touch(int axis, double value);

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
  int processes() const noexcept { return static_cast<int>(seats_.size()); }
  /// A program is under way (running, held or waiting).
  bool busy(int process);
  /// In any process.
  bool busy();
  /// It has been ended, and its path is not at rest yet.
  bool stopping(int process) const;
  /// What is under way is a block typed by hand, not the loaded program.
  bool typed(int process);
  /// A program is under way, and is held or waits.
  bool rests(int process);
  /// A program is stepped through block by block.
  bool steps(int process);
  /// Path of the loaded program; empty: none.
  const std::string& program(int process) const { return seat(process).file->path; }
  /// Of the loaded program's file: blocks, and lines.
  int blocks(int process) const { return seat(process).blocks; }
  int lines(int process) const { return seat(process).lines; }
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
  /// The program of one process.
  struct Seat {
    std::shared_ptr<const ProgramFile> file;
    std::optional<program::Tables>
        proven;             ///< with which `file` was last looked through; none: with other axes
    program::Tables given;  ///< what the process knew when it was last read
    std::vector<text::Finding> refused;
    int blocks = 0, lines = 0;
    std::string manual_block;
    std::uint64_t read_at = 0;  ///< what the coordinates of MDI were read behind
    Coordinates manual;
    std::string shown_file, shown_text;  ///< the subprogram whose line was asked for last
    bool busy_seen = false;
    std::map<std::int32_t, double> cut_s;  ///< channel::CuttingTimes as far as it stands in the tables
  };
  const Seat& seat(int process) const { return seats_[static_cast<std::size_t>(process)]; }
  Seat& seat(int process) { return seats_[static_cast<std::size_t>(process)]; }
  bool arm(int process, ProgramChange::Kind kind);
  std::shared_ptr<const ProgramFile> no_program(int process) const;
  void adopt(int process);
  bool adopt_given(int process);
  bool read_tables_of(int process, bool also_read);
  void count_cutting();
  /// `process` gets its tables anew even where it has them, -1: all of them.
  std::optional<Proof> renew(int process);
  Start start_of(int process);
  program::Interpreter reading(int axis, double value, double& length);
  void catch_up();
  Work prove_later(Proof proof);
  Work save_later();
  program::Position position();
  bool spindle_is_axis(int process) const;
  std::uint32_t homed();

  Announce announce_;
  Control& control_;
  machine::MachineState state_;
  std::string state_path_;
  std::vector<program::Tables> past_tables_;  ///< before the changes from here, oldest first
  double speed_;
  std::vector<Seat> seats_;  ///< by process
  std::uint32_t homed_seen_ = 0;
  bool unsaved_ = false, saving_ = false;
  std::atomic<bool> ending_{false};
  RequestDesk requests_;
  image::ProcessImage image_;
  cycle::AlarmSnapshot alarms_;
  history::EventLog* history_ = nullptr;
  BlockJournal* journal_ = nullptr;
  history::MachineWatch watch_{control_, [this](int process) { return manual_block(process); }};
  Works works_;
};

}  // namespace servogate::gateway
