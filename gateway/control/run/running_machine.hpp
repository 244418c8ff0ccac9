// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/machine.hpp"
#include "drivers/notice.hpp"
#include "gateway/control/compose/control.hpp"
#include "gateway/control/compose/program/program_check.hpp"
#include "gateway/control/run/announce.hpp"
#include "gateway/control/run/block_journal.hpp"
#include "gateway/control/run/can_log.hpp"
#include "gateway/control/run/capture/machine_capture.hpp"
#include "gateway/control/run/clock_kind.hpp"
#include "gateway/control/run/record_file.hpp"
#include "gateway/control/run/retained_keeper.hpp"
#include "gateway/control/run/session.hpp"
#include "machine/state/state.hpp"
#include "machine/state/state_lock.hpp"

namespace servogate::gateway {

class PacedLoop;
class RealtimeLoop;

/// What a machine has learned: its state directory, held as long as this lives.
struct HeldState {
  std::string folder;  ///< empty: nothing is kept
  machine::StateLock lock;
  machine::MachineState state;
  bool fell_back = false;  ///< something in it was damaged, and is as it was before

  /// Takes and reads a folder; empty: none. nullptr: somebody else holds it (`taken`), or one of `findings`
  /// is an error; warnings come with it, too.
  static std::unique_ptr<HeldState> hold(const std::string& folder, const std::vector<std::string>& axes,
                                         drivers::Notice& taken, std::vector<text::Finding>& findings);
};

/// How time passes: as asked, else virtual where the machine file says so and nothing is real. unset: virtual
/// time is asked for on a bus that has its own, and `refusal` says so.
ClockKind clock_of(const machine::MachineConfig& machine, ClockKind asked, drivers::Notice& refusal);

/// How a machine is run.
struct RunSettings {
  ClockKind clock = ClockKind::virtual_time;
  /// Virtual time: machine seconds per wall-clock second; 0: it moves in step() only.
  double pace = 0.0;
  double time_scale = 1.0;                ///< Cycle::time_scale() where it is not the pace
  std::string record = {}, can_log = {};  ///< file and folder; empty: none
  Announce announce = {};                 ///< what it has to say while it runs
  cycle::InputSource* source = nullptr;   ///< the inputs come from a record: no device is opened
  /// Virtual time: who reads ahead beside the cycles; empty: round_worker().
  std::function<std::unique_ptr<RoundWorker>()> worker = {};
};

/// A machine put together, with all that a run of it needs: what it has learned, its loop, its record and
/// logs, and who watches it. Every command, benchmark and test that runs a machine has one of these.
class RunningMachine final : public bench::Machine {
 public:
  /// Nothing moves yet. nullptr: `findings` says why (see Control::compose); warnings come with it, too.
  /// `state`, nullptr: nothing was learned, nothing is kept.
  static std::unique_ptr<RunningMachine> compose(const machine::LoadResult& loaded,
                                                 std::unique_ptr<HeldState> state,
                                                 const RunSettings& settings,
                                                 std::vector<text::Finding>& findings);
  ~RunningMachine() override;

  /// Statistics, trace and picture from the next cycle on. Before the first.
  Session& watch(const Outputs& outputs);
  /// A capture of chosen values from the next cycle on. Before the first. False: refused, `why` says why.
  bool capture(const CaptureRequest& request, drivers::Notice& why);
  /// After close_files(): the capture has written its file.
  bool captured() const noexcept { return capture_ != nullptr && capture_->files() > 0; }
  /// Writes the last seconds into `folder` at each alarm. Before the first cycle.
  void keep_black_box(const std::string& folder);
  /// Starts the loop of a machine that moves by itself; nothing in virtual time without a pace. False: the
  /// system refuses real time. `refusals`: why, or what it goes on without.
  bool begin(std::vector<drivers::Notice>& refusals);
  /// Ends that loop, and leaves buses that others go on with (Control::take_leave). Files stay open.
  void stop();
  /// What closing a file brought to light.
  struct Lost {
    std::string path, why;
  };
  /// Closes trace, record and logs, after stop(); what could not be written. What was learned stays to be
  /// kept by keep() or by whoever else knows it.
  std::vector<Lost> close_files();
  /// Writes what the machine has learned, the PLC's retained variables last; empty: done, else what went
  /// wrong. After stop(); nothing without a folder.
  std::string keep();
  /// Only the PLC's retained variables, where somebody else keeps the rest.
  std::string keep_retained() { return keeper_.close(); }

  /// One cycle without the world and reading ahead: of a replay, whose owner does both by the record.
  bool cycle();

  // bench::Machine
  bool step() override;
  const image::ProcessImage& image() const override;
  const cycle::AlarmSnapshot& alarms() override;
  image::Nanoseconds cycle_duration_ns() const override;
  bool post(const image::Request& request) override { return control_->cycle().post(request); }
  bool take(image::Answer& answer) override { return control_->cycle().take_answer(answer); }
  bool load(const std::string& program, std::vector<text::Finding>& findings, int process = 0) override;
  bool play(const std::string& point, std::optional<double> value, std::string& why) override;
  bool inject(std::string_view device, const fault::Fault& fault, std::string& why) override {
    return control_->faults().inject(device, fault, why);
  }
  bool possible(std::string_view device, const fault::Fault* fault, std::string& why) const override {
    return control_->faults().possible(device, fault, why);
  }
  bool clear(std::string_view device, std::optional<fault::Kind> kind, std::string& why) override {
    return control_->faults().clear(device, kind, why);
  }
  std::string report() const override;

  Control& control() noexcept { return *control_; }
  const Control& control() const noexcept { return *control_; }
  const machine::MachineConfig& machine() const noexcept { return control_->machine(); }
  /// In which blocks the programs are.
  BlockJournal& journal() noexcept { return journal_; }
  /// What it had learned when it was composed.
  const machine::MachineState& learned() const noexcept { return state_->state; }
  /// It moves in a loop of its own.
  bool moves_by_itself() const noexcept { return settings_.clock != ClockKind::virtual_time || paced(); }
  /// Late cycles: of real time, and by a fault.
  std::int64_t overruns() const noexcept;

 private:
  RunningMachine(std::unique_ptr<HeldState> state, const RunSettings& settings,
                 std::unique_ptr<Control> control);
  bool paced() const noexcept { return settings_.pace > 0.0; }
  void wait_for_room();
  bool move_on(image::Nanoseconds late_ns);
  bool move_world();
  bool begin_realtime(std::vector<drivers::Notice>& refusals);
  void after_cycle(image::Nanoseconds late_ns) noexcept;

  std::unique_ptr<HeldState> state_;
  RunSettings settings_;
  std::unique_ptr<Control> control_;
  std::unique_ptr<RecordWriter> record_;
  std::unique_ptr<CanLog> can_log_;
  std::unique_ptr<MachineCapture> capture_, black_box_;
  bool record_broken_ = false;  ///< and said so
  std::string trace_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<image::ProcessImage> image_;  ///< newest whole one of a machine that moves by itself
  cycle::AlarmSnapshot alarms_;
  BlockJournal journal_;
  std::atomic<std::int64_t> late_cycles_{0};  ///< of virtual time
  RetainedKeeper keeper_;
  std::unique_ptr<PacedLoop> paced_loop_;
  std::unique_ptr<RealtimeLoop> realtime_loop_;
};

}  // namespace servogate::gateway
