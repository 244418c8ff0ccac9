// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "firmware_if/image/alarms/alarm_text.hpp"
#include "gateway/control/compose/alarms/alarm_rooms.hpp"
#include "gateway/control/compose/bus_tap.hpp"
#include "gateway/control/compose/can_supplier.hpp"
#include "gateway/control/compose/can_transport.hpp"
#include "gateway/control/compose/devices/open_devices.hpp"
#include "gateway/control/compose/program/program_change.hpp"
#include "gateway/control/compose/reading_beside.hpp"
#include "gateway/control/compose/simulated/machine_faults.hpp"
#include "gateway/control/compose/simulated/world_setup.hpp"
#include "kernel/channel/process.hpp"
#include "kernel/cycle/boundary/clocks.hpp"
#include "kernel/cycle/executive.hpp"
#include "machine/load.hpp"
#include "machine/state/state.hpp"
#include "plc/logic/logic.hpp"

namespace servogate::gateway {

/// A whole machine put together from its file: cycle, axes, PLC, processes, buses real or simulated. The one
/// place where rooms meet. Who owns a Control owns its loop: RunningMachine.
class Control {
 public:
  /// Puts the machine together. nullptr when something is wrong with it (`findings` says what: PLC program, a
  /// bus or device that cannot be opened). With `source` devices are not opened: the inputs come from a
  /// record.
  static std::unique_ptr<Control> compose(const machine::LoadResult& loaded,
                                          std::vector<text::Finding>& findings,
                                          cycle::InputSource* source = nullptr);
  ~Control();

  /// Brings the simulated world to the beginning of the next cycle, before it. How late that cycle comes by a
  /// fault (late_cycle), 0: on time; the world has lived through that, too, and in real time the owner of the
  /// loop waits so much longer.
  image::Nanoseconds advance_world();
  /// Reads ahead in all processes, before a cycle; in real time its own thread calls it again and again.
  /// False: nothing more can be read before the cycle goes on.
  bool read_ahead();

  /// From now on read_for_cycle() reads ahead, and `worker` does what can be done beside the cycles.
  void read_with(std::unique_ptr<RoundWorker> worker);
  /// Virtual time: reads ahead before a cycle, as far as ReadingBeside does.
  void read_for_cycle() { beside_->before_cycle(cycle_->count()); }

  /// As long as it is held no process reads ahead, and what they have read may be looked at. Any thread
  /// outside the cycle.
  std::unique_lock<std::mutex> stop_reading();
  /// Changes what a process will run, and shows it to the tap; any thread outside the cycle. False, and
  /// nothing changed: its program is being read just now.
  bool change(const ProgramChange& change);
  /// The program that another process' program has given this one since the last call; nullptr: none. Any
  /// thread outside the cycle.
  std::shared_ptr<const ProgramFile> take_given(int process);
  /// What the newest program of a process was given to begin with, where another process' program gave it:
  /// that one's tables as they stood. nullopt: the machine's. Any thread outside the cycle.
  std::optional<program::Tables> given_tables(int process);
  /// Its program has unloaded itself, and none has been loaded since.
  bool unloaded(int process) const { return processes_[static_cast<std::size_t>(process)]->unloaded(); }
  /// Compiles another PLC program for this machine. Any thread; ended by `stop`, and after kCompilePatience
  /// by an error.
  plc::CompileResult compile(const std::vector<plc::SourceFile>& files, const std::stop_token& stop) const;
  /// Makes a change of the PLC ready for the request of its number, and shows it to the tap; `compiled`: what
  /// compile() made of the files of a load. Only with a PLC; any one thread outside the cycle.
  plc::Logic::Plan prepare(const plc::LogicChange& change, plc::CompileResult compiled = {});
  /// A number for the next one.
  std::uint32_t next_logic_change() noexcept { return ++logic_changes_; }
  /// For records; before the first change.
  void attach(ProgramChangeTap* tap) noexcept { change_tap_ = tap; }
  /// Takes over the references of absolute encoders that were kept; before the first cycle.
  void restore_references(const machine::MachineState& state);
  /// The tool that was in the spindle is there still; its lengths count from the next T on. Before the first
  /// cycle.
  void restore_tool(const machine::MachineState& state);
  /// Gives the PLC the retained values that were kept; before the first cycle. Warns of each that the program
  /// has no variable of that name and type for.
  std::vector<text::Finding> restore_retained(const machine::MachineState& state);

  cycle::Cycle& cycle() noexcept { return *cycle_; }
  const machine::MachineConfig& machine() const noexcept { return loaded_.machine; }
  /// With its device files.
  const machine::LoadResult& loaded() const noexcept { return loaded_; }
  /// Its symbol table, made once.
  const std::vector<image::Symbol>& symbols() const noexcept { return symbols_; }
  channel::Process& process(int index) { return *processes_[static_cast<std::size_t>(index)]; }
  mock::World& world() noexcept { return *world_; }
  /// Faults on what is simulated, by name.
  MachineFaults& faults() noexcept { return *faults_; }
  plc::Logic* logic() noexcept { return logic_.get(); }
  const std::vector<std::unique_ptr<CanSupplier>>& suppliers() const noexcept { return suppliers_; }
  /// Where what its master sends and hears can be observed, by bus.
  const std::vector<std::unique_ptr<BusTap>>& taps() const noexcept { return taps_; }
  /// Real time: the cycle that step() is about to run was due at this time of `clock`. From the first call on
  /// every SYNC is timed. real-time safe.
  void open_cycle(const image::Clock& clock, image::Nanoseconds due_ns) noexcept;
  /// Real time, behind every step: a scan of the PLC that took longer than [plc] watchdog is an alarm, and so
  /// is one that was ended from outside. real-time safe.
  void watch_logic() noexcept;
  /// Real time: a scan that has not come back after this time is ended from outside: half a second, or
  /// [plc] watchdog where that allows more. real-time safe.
  image::Nanoseconds longest_scan_ns() const noexcept;
  /// When the present cycle was due; nullopt: in virtual time.
  std::optional<image::Nanoseconds> due_ns() const noexcept { return due_ns_; }
  /// Behind the last cycle, by whoever owned the loop: drives that others go on to speak with no longer miss
  /// this control (canopen::Segment::leave()). Takes as long as the drives need to answer, 0.5 s at most;
  /// nothing on buses that end with this process.
  void take_leave();
  /// Names for the sentences of alarms.
  image::AlarmNames alarm_names() const;
  /// True when nothing real can move.
  bool nothing_real() const { return loaded_.machine.nothing_real(); }
  /// True when composing failed because of the computer (a bus or device that cannot be opened), not
  /// of a file.
  static bool infrastructure(const std::vector<text::Finding>& findings);
  /// The transport of a bus that somebody else may use at any moment, too; nullptr: a mock bus, and one in
  /// lockstep, whose participants are known before time begins.
  const CanTransport* shared_bus(std::size_t bus) const noexcept;
  /// What happened on a Modbus line so far; nullopt: it is not open. From any thread.
  std::optional<modbus::LineCounters> counters(const machine::LineConfig& line) const noexcept;
  /// Frames that the transport of a bus knows to be lost, by bus.
  std::uint64_t frames_lost(std::size_t bus) const noexcept;

 private:
  explicit Control(const machine::LoadResult& loaded);
  const machine::DeviceConfig* device_of(const image::AlarmRecord& record) const;
  const machine::NodeConfig* node_of(const image::PartPlace& place) const;
  std::unique_ptr<AlarmRooms> alarm_rooms() const;
  bool compile_logic(std::vector<text::Finding>& findings);
  bool carry_out(const ProgramChange& change);
  channel::Supply supply(int from, int to, const std::string& name);
  bool open_buses(std::vector<text::Finding>& findings, bool replay);
  void await_grants(image::Nanoseconds t);

  machine::LoadResult loaded_;
  const std::vector<image::Symbol> symbols_;
  std::unique_ptr<AlarmRooms> alarm_rooms_;  ///< outlives the cycle
  std::unique_ptr<mock::World> world_;
  std::unique_ptr<MachineFaults> faults_;
  std::vector<OpenDevice> devices_;            ///< of no bus, in the order of the file
  std::vector<CanTransport> transports_;       ///< by bus; without a bus of its own where it is a mock
  std::vector<std::unique_ptr<BusTap>> taps_;  ///< by bus
  std::vector<std::unique_ptr<CanSupplier>> suppliers_;
  std::optional<image::Nanoseconds> due_ns_;
  image::Nanoseconds world_ahead_ns_ = 0;  ///< what late cycles let the world live longer
  cycle::MonotonicClock stopwatch_;
  std::unique_ptr<plc::Logic> logic_;
  channel::Meeting meeting_;
  std::vector<std::unique_ptr<channel::Process>> processes_;
  /// The program of each process, and whether another one gave it.
  struct Program {
    std::shared_ptr<const ProgramFile> file;
    bool given = false;
    std::optional<program::Tables> tables;
  };
  std::vector<Program> programs_;
  bool replay_ = false;  ///< what programs load is in the record
  std::mutex reading_;
  ProgramChangeTap* change_tap_ = nullptr;
  std::uint32_t logic_changes_ = 0;
  std::unique_ptr<cycle::Cycle> cycle_;
  std::unique_ptr<ReadingBeside> beside_;  ///< nullptr: not in virtual time
};

}  // namespace servogate::gateway
