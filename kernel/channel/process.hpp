// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "kernel/channel/feeder.hpp"
#include "kernel/channel/handshake.hpp"
#include "kernel/channel/motion/cutting_times.hpp"
#include "kernel/channel/motion/way_back.hpp"
#include "kernel/channel/neighbours.hpp"
#include "kernel/channel/probing.hpp"
#include "kernel/cycle/boundary/participants.hpp"
#include "kernel/path/follower.hpp"

namespace servogate::channel {

struct ProcessConfig {
  int index = 0;
  path::Config path;  ///< path axes, limits, period
  AxisMap axes;
  double handshake_timeout_s = 10.0;
  double in_position_timeout_s = 5.0;             ///< of the wait at exact stops, beside the axis' own alarm
  std::optional<axis::SwitchPlace> probe;         ///< TRUE while it is deflected
  std::optional<image::LatchSource> probe_latch;  ///< the axes' drives latch its touches
  Meeting* meeting = nullptr;  ///< of all processes, outlives this one; nullptr: it is the only one
  ProgramSupplier supplier;    ///< of programs for the others
};

/// One process: the feeder outside the cycle and the follower with its handshakes inside, joined by a Link.
///
/// Thread contract: load(), set_manual_block() and work() on one thread outside the cycle (in virtual time
/// the cycle's own thread, between cycles); everything of ProcessInCycle on the cycle's thread.
class Process final : public cycle::ProcessInCycle {
 public:
  explicit Process(const ProcessConfig& config);
  ~Process() override;

  // -- outside the cycle
  /// Makes a program ready for start; not while one is read (Feeder::reads()). What MDI has in force goes.
  void load(InterpreterFactory factory);
  /// As load(); what MDI has in force stays, with these tables from now on.
  void load(InterpreterFactory factory, program::Tables tables);
  /// The same program with other tables: what the status shows of the last run stays.
  void renew(InterpreterFactory factory, program::Tables tables);
  /// The next run of the program begins as this one does, in its middle; the one after as before.
  void restart(RestartFactory once);
  program::Interpreter manual_interpreter(const program::Position& at) const {
    return feeder_.manual_interpreter(at);
  }
  void forget_manual();
  void set_manual_block(std::string block);
  /// The next start in MDI mode measures, instead of a block; once. Behind it the axes stand where they
  /// began.
  void set_touch(const TouchOrder& order);
  /// What it has found; for any thread outside the cycle.
  Touches::Found touches() const { return feeder_.touches().found(); }
  /// How often one of the above was called; the cycle sees it as the last of its crossings.
  std::uint64_t changes() const noexcept { return changes_.load(std::memory_order_acquire); }
  /// Reads ahead and plans; see Feeder::work().
  bool work() { return feeder_.work(); }
  /// Virtual time: reading ahead beside the cycles, on another thread or not, with the same results. Between
  /// begin_beside() and end_beside(), called between two cycles by the cycle's thread, work_beside() may be
  /// called on another thread: it sees what the cycle has given back as it was at the begin, and the cycle
  /// sees what has been published at the end. Orders wait for the end.
  Reading reading() const { return feeder_.reading(follower_.driven()); }
  /// For how long the cycle needs nothing of what reading beside it gives, see Feeder::spare().
  double spare() const { return feeder_.spare(follower_.driven()); }
  void begin_beside() noexcept;
  void work_beside(double seconds) { feeder_.work_beside(seconds); }
  void end_beside() noexcept;
  const Feeder& feeder() const noexcept { return feeder_; }
  /// For any thread outside the cycle.
  const CuttingTimes& cutting() const noexcept { return cutting_; }
  /// For any thread outside the cycle.
  const ProgramTexts& texts() const noexcept { return feeder_.texts(); }

  // -- in the cycle
  void published(std::span<std::uint64_t> counts) const noexcept override;
  void interpolate(cycle::ProcessContext& context) noexcept override;
  bool order(const image::Request& request, cycle::ProcessContext& context) noexcept override;
  cycle::Beside beside(const cycle::ProcessContext& context) const noexcept override;
  void leave_path(int axis, cycle::ProcessContext& context) noexcept override;
  bool loaded() const noexcept override {
    return programs_.load(std::memory_order_acquire) != released_.load(std::memory_order_relaxed);
  }
  /// Its program has unloaded itself. Any thread.
  bool unloaded() const noexcept { return released_.load(std::memory_order_relaxed) != 0 && !loaded(); }
  bool wish(image::Request& request) noexcept override;
  void answered(const image::Answer& answer) noexcept override;
  /// mm by which the last tap went beyond its depth; negative: it did not reach it. In the cycle's thread.
  double tap_overshoot() const noexcept { return tap_overshoot_; }
  bool stopping() const noexcept override { return stopping_.load(std::memory_order_relaxed); }
  bool holding() const noexcept override { return running_ && held_ && !follower_.at_rest(); }

 private:
  enum class Stage : std::uint8_t { none, entered, handshaking, waiting };
  /// The ways across the real-time line, in the order of published().
  enum Crossing : std::uint8_t { kTrack, kEvents, kAtOnce, kWay, kPrograms, kChanges };
  static_assert(kChanges + 1 == kCrossingsEach);

  /// An axis of the path that this process moves.
  struct OwnAxis {
    std::uint8_t path, machine;
  };

  static constexpr std::size_t kMostFunctions = 8;  ///< typed beside a held program, under way and to come

  /// What the rest of a held program counts on.
  struct Held {
    std::array<double, path::kMaxAxes> place{};    ///< of the path's axes, machine coordinates
    std::array<double, path::kMaxAxes> on_path{};  ///< the same, or where a way along the path has led to
    std::array<axis::SpindleMode, image::kMaxSpindles> mode{};
    std::array<double, image::kMaxSpindles> rpm{};
    std::int32_t tool = 0;
    Event event;  ///< at which the path rests, with its stage
    Stage stage = Stage::none;
    double waited_s = 0.0;
    image::ProcessState state = image::ProcessState::running;
    std::uint8_t surface_spindle = 0;
    double surface_speed = 0.0, surface_limit = 0.0, surface_center = 0.0;
  };

  /// Along the path of the held program.
  struct Retrace {
    std::uint32_t number = 0;  ///< of the last way
    bool away = false;         ///< the axes stand back on the path
    bool moves = false;        ///< a way is asked for or under way, the axes are the process'
    bool begun = false;        ///< the feeder has begun it
    bool forward = false;
    bool ends = false;    ///< it ends as soon as it is at rest
    bool capped = false;  ///< no faster than its feed, whatever the override
    double behind = 0.0;  ///< path to where the program was held
    double feed = 0.0;
    path::Tag tag;  ///< where it stands
    double to_go = 0.0;
  };

  bool start(bool manual_data, bool block_by_block, cycle::ProcessContext& c) noexcept;
  void run_on() noexcept;
  // process_beside.cpp
  bool rests_for_operator() const noexcept;
  void step_aside(cycle::ProcessContext& c) noexcept;
  bool come_back(cycle::ProcessContext& c) noexcept;
  void add_function(const image::Request& request, cycle::ProcessContext& c) noexcept;
  void work_beside(cycle::ProcessContext& c) noexcept;
  void forget_beside() noexcept;
  void show_beside(cycle::ProcessContext& c) const noexcept;
  // process_retrace.cpp
  bool go_along(bool forward, const image::Request& request, cycle::ProcessContext& c) noexcept;
  std::uint64_t way_published() const noexcept;
  void hold_way(const cycle::ProcessContext& c) noexcept;
  void follow_way(cycle::ProcessContext& c) noexcept;
  void end_way(cycle::ProcessContext& c) noexcept;
  void leave(image::ProcessState state, cycle::ProcessContext& c) noexcept;
  void find_own_axes(const cycle::ProcessContext& c) noexcept;
  std::span<const OwnAxis> own_axes() const noexcept { return {own_.data(), own_count_}; }
  bool acquire(cycle::ProcessContext& c) noexcept;
  void release(cycle::ProcessContext& c) noexcept;
  /// What is published, as far as the cycle may know it.
  struct Shown {
    std::uint64_t entries = 0, events = 0, at_once = 0;
  };
  Shown shown() const noexcept;
  std::uint64_t look(const cycle::ProcessContext& c) noexcept;
  void show_motion(const path::Sample& sample, image::ProcessStatus& status) noexcept;
  void show_event(const Event& event, image::ProcessStatus& status) const noexcept;
  void forget_run(image::ProcessStatus& status) const noexcept;
  image::Wait wait(const path::Sample& sample, const cycle::ProcessContext& c) const noexcept;
  image::Wait wait_for_go_on(const cycle::ProcessContext& c) const noexcept;
  image::Wait wait_at_event(const cycle::ProcessContext& c) const noexcept;
  image::Wait wait_on_path(const cycle::ProcessContext& c) const noexcept;
  static image::Wait wait_for_change(const axis::Spindle* turns) noexcept;
  static image::Wait wait_for_step(const axis::Spindle* follower) noexcept;
  image::Wait wait_for_position(const cycle::ProcessContext& c) const noexcept;
  void apply_at_once(cycle::ProcessContext& c) noexcept;
  void apply_hold(cycle::ProcessContext& c) noexcept;
  // process_wheel.cpp
  void watch_wheel(cycle::ProcessContext& c) noexcept;
  double by_wheel(double ratio, const cycle::ProcessContext& c) const noexcept;
  bool rests_for_wheel(const path::Sample& sample, const cycle::ProcessContext& c) const noexcept;
  double way_by_wheel(double ratio, const cycle::ProcessContext& c) noexcept;
  void apply_reaction(cycle::ProcessContext& c) noexcept;
  image::Stop stop_without_alarm(const cycle::ProcessContext& c) const noexcept;
  void drive_axes(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  void watch_geared(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  void at_stop(cycle::ProcessContext& c) noexcept;
  void at_event(std::uint32_t id, cycle::ProcessContext& c) noexcept;
  bool execute(const Event& event, cycle::ProcessContext& c) noexcept;
  // process_masters.cpp
  path::MasterReading master(const cycle::ProcessContext& c) const noexcept;
  void follow_master(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  void raise_of_motion(image::AlarmNumber number, double value, double limit, cycle::ProcessContext& c,
                       int axis = -1) noexcept;
  bool passes_mark(const Event& event, cycle::ProcessContext& c) noexcept;
  void tell_of_master(const path::ByMaster& master, const axis::Spindle* turns,
                      cycle::ProcessContext& c) noexcept;
  void order_tap(const path::ByMaster& master, axis::Spindle& turns) noexcept;
  bool arm_probe(const Event& event, cycle::ProcessContext& c) noexcept;
  std::uint32_t own_mask() const noexcept;
  void disarm_drives(cycle::ProcessContext& c) noexcept;
  bool miss_probe(const Event& event, cycle::ProcessContext& c) noexcept;
  void watch_idle_probe(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  void watch_probe(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  // process_neighbours.cpp
  bool start_other(const Event& event, cycle::ProcessContext& c) noexcept;
  bool meet(const Event& event) noexcept;
  void forget_neighbours() noexcept;
  bool handshake(HandshakeWord word, std::int32_t code, double value, const Event& event,
                 cycle::ProcessContext& c) noexcept;
  bool order_spindle(const Event& event, cycle::ProcessContext& c) noexcept;
  bool couple_spindles(const Event& event, cycle::ProcessContext& c) noexcept;
  bool change_spindle(const Event& event, cycle::ProcessContext& c) noexcept;
  void return_spindles(cycle::ProcessContext& c) noexcept;
  static bool is_spindle(int axis, const cycle::ProcessContext& c) noexcept;
  const axis::Spindle* out_of_step(const cycle::ProcessContext& c) const noexcept;
  void end_couplings(cycle::ProcessContext& c) noexcept;
  bool in_position(cycle::ProcessContext& c) const noexcept;
  void surface_speed(cycle::ProcessContext& c) noexcept;
  void stop_spindles(cycle::ProcessContext& c) noexcept;
  /// The n-th spindle of this process, in the machine's order; nullptr: it has none.
  axis::Spindle* spindle(std::size_t n, const cycle::ProcessContext& c) const noexcept;
  void write_status(const path::Sample& sample, cycle::ProcessContext& c) noexcept;
  void raise(image::AlarmNumber number, const Event& event, double value, double limit,
             cycle::ProcessContext& c, int axis = -1) noexcept;
  bool operator_waits() const noexcept {
    return stage_ == Stage::waiting &&
           (event_.kind == EventKind::stop || event_.kind == EventKind::optional_stop ||
            event_.kind == EventKind::block_end);
  }
  double seconds(const cycle::ProcessContext& c) const noexcept { return c.image.now.period_s(); }

  ProcessConfig config_;
  Link link_;
  Feeder feeder_;
  std::optional<Shown> shown_then_;  ///< beside the cycle more is being published
  path::Follower follower_, back_;   ///< on the program's path, and on a way along it
  Handshake handshake_;
  std::uint32_t base_;                      ///< of the process' block in K
  std::atomic<std::uint64_t> programs_{0};  ///< loaded so far
  std::atomic<std::uint64_t> changes_{0};
  std::atomic<std::uint64_t> released_{0};  ///< of programs_: so many, and its program has unloaded itself

  Meeting alone_{1};
  Meeting& meeting_;
  enum class StartOther : std::uint8_t { none, loading, wished, started, refused };
  StartOther start_other_ = StartOther::none;
  std::uint64_t programs_of_other_ = 0;  ///< before it was given another one
  std::uint64_t run_of_programs_ = 0;    ///< programs_, when the run under way began
  bool manual_data_ = false;             ///< the run is a typed block
  std::array<OwnAxis, path::kMaxAxes> own_{};
  std::size_t own_count_ = 0;
  std::uint32_t taken_ = 0;  ///< axes, as bits, that an electronic gear took in this run: it has lost them
  bool taken_told_ = false;
  bool running_ = false;               ///< a program is under way, held or waiting
  std::atomic<bool> stopping_{false};  ///< it ends as soon as the path is at rest
  image::ProcessState after_stop_ = image::ProcessState::idle;
  image::ProcessState state_ = image::ProcessState::idle;
  image::Mode mode_ = image::Mode::off;
  bool held_ = false;  ///< hold of the operator or the PLC, until start or resume
  bool block_by_block_ = false;
  bool go_on_ = false;  ///< start or step while an event waits for the operator
  double override_ = 1.0;
  bool override_effective_ = true;  ///< a program may say that it does not count
  double asked_ratio_ = 1.0;        ///< of the feed, before the wheel of the path
  bool by_wheel_ = false;           ///< the wheel is chosen
  bool wheel_rests_ = false;        ///< image::PathWheel::rests
  bool wheel_lost_told_ = false, wheel_fast_told_ = false;
  bool spindle_turned_ = false;  ///< the turn by an angle that the path waits for has been ordered
  Stage stage_ = Stage::none;
  Event event_;
  double waited_s_ = 0.0;
  bool aside_ = false;  ///< the program is held, and its axes are the operator's
  WayBack way_;
  Retrace retrace_;
  std::optional<image::Request> forward_;  ///< the way forward, as soon as the axes are back on the path
  CuttingTimes cutting_;
  std::int32_t row_ = 0;  ///< of the tool table that cuts; 0: the tool's own
  Held held_as_;
  std::array<Event, kMostFunctions> functions_{};  ///< the first is under way
  std::size_t function_count_ = 0;
  std::uint8_t surface_spindle_ = 0;  ///< of this process, that turns by a cutting speed
  double surface_speed_ = 0.0, surface_limit_ = 0.0, surface_center_ = 0.0;
  bool on_master_ = false;  ///< a motion by the spindle's angle is under way
  bool tapping_ = false, tap_halted_ = false, master_told_ = false;
  std::int8_t tap_turn_ = 0;  ///< how the spindle was turned last for the tap under way
  double tap_rpm_ = 0.0;      ///< as it turned before
  double tap_overshoot_ = 0.0;
  double mark_ = -1.0;  ///< part of a revolution in the last cycle of a wait for the mark
  Probing probing_;
  bool probe_told_ = false;  ///< why it does not measure
  double last_speed_ = -1.0;
  path::Tag shown_;               ///< of the motion that the status has shown
  double to_go_ = 0.0;            ///< path to the end of its element
  std::uint32_t generation_ = 0;  ///< of the run under way, or the last one
  bool started_ = false;          ///< in this cycle: what is visible still speaks of the run before
  bool forget_ = false;           ///< the run ends by a reset
  std::uint64_t programs_seen_ = 0;
  std::uint32_t starved_ = 0;
  std::uint64_t at_once_read_ = 0, events_read_ = 0;
  std::uint64_t at_once_end_ = 0, events_end_ = 0;  ///< how far they may be read in this cycle
};

}  // namespace servogate::channel
