// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/drive/measurement/bench_drive.hpp"
#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/master/segment.hpp"
#include "gateway/cli/bench_options.hpp"
#include "gateway/command/bench/changed_objects.hpp"
#include "gateway/command/bench/recorded_object.hpp"
#include "gateway/command/bench/stop_key.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "report/statistics.hpp"

namespace servogate::gateway::command {

/// The options as of each drive alone: NODE first, then those of --with, whose directories are in that of the
/// run.
std::vector<BenchOptions> each_drive(const BenchOptions& options);

/// What a drive says of itself, and its units.
struct DriveFacts {
  double counts_per_rev = 0.0, rated_torque_nm = 0.0;
  std::string name;                                               ///< 1008h; empty: it has none
  std::optional<std::int64_t> vendor, product, revision, serial;  ///< 1018h
  std::optional<std::int64_t> dc_link_mv;                         ///< 6079h
  double quick_stop_rev_s2 = 0.0;  ///< how hard its quick stop brakes; 0: it does not say
};

/// What a command does with its drive.
struct DriveUse {
  /// Modes of the three loops, and which of them the drive must have.
  canopen::OperationMode position = canopen::OperationMode::cyclic_sync_position;
  canopen::OperationMode velocity = canopen::OperationMode::cyclic_sync_velocity;
  canopen::OperationMode torque = canopen::OperationMode::cyclic_sync_torque;
  std::uint32_t modes = 0;            ///< canopen::supported_bit()
  double profile_speed_rev_s = 0.0;   ///< 6081h for pp; 0: as it is
  double profile_acceleration = 0.0;  ///< 6083h and 6084h for pp and pv, rev/s2; 0: as it is
  bool moves = true;                  ///< false: it never gets power
  bool key_ends = true;               ///< a key of the terminal ends the run, as Ctrl-C does
  std::vector<RecordedObject> record = {};
};

/// A drive on a CAN bus, or several in the same cycles, led by the master of the machines. Their torque
/// limits 6072h are that of the envelope as long as this lives; this and what else is written is then what it
/// was. As a BenchDrive it is the first of them. Not real-time safe.
class BusDrive final : public bench::BenchDrive {
 public:
  /// Reads what the drives are (--with names those behind the first), limits their torque and boots them.
  /// nullptr: refused, which has been said; `code` is the exit code then. `log`: file for every frame in the
  /// form of candump; empty: none.
  static std::unique_ptr<BusDrive> open(ToolBus& bus, const BenchOptions& options, const DriveUse& use,
                                        const std::string& log, int& code);
  ~BusDrive() override;
  /// Takes the drives out of operation and puts back what was changed; no cycle follows. What takes its time
  /// comes afterwards: drives that wait for a heartbeat would be left alone.
  void leave();
  /// Before a run: undoes what runs that were cut off have left in the drive. False: said.
  static bool put_right(ToolBus& bus, const BenchOptions& options);

  std::size_t count() const noexcept { return axes_.size(); }
  const DriveFacts& facts(std::size_t axis = 0) const noexcept { return axes_[axis].facts; }
  double period_s() const noexcept override;
  bool cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) override;
  bool lives() const override { return bus_.transport().lockstep == nullptr; }
  bool ended() const override { return bus_.ended() || (use_.key_ends && key_.pressed()); }
  const StopKey& key() const noexcept { return key_; }
  const ObjectRecorder& recorder(std::size_t axis = 0) const noexcept { return *axes_[axis].recorder; }
  /// One cycle of all of them, in their order.
  bool cycle_all(std::span<const bench::DriveAsk> asks, std::span<bench::DriveAnswer> answers);
  /// The same for who waits himself until `due` (ns of the computer's clock), with the times of the bus.
  bool cycle_at(image::Nanoseconds due, const bench::DriveAsk& ask, bench::DriveAnswer& answer);
  /// From begin_times() on: SYNC behind the time of its cycle, and from SYNC to the first process data of the
  /// drive, ns.
  void begin_times();
  const report::Histogram& sync_lateness() const;
  const report::Histogram& round_trip() const;
  /// Cycles that began later than half a cycle.
  int late_cycles() const noexcept { return late_; }

 private:
  class Tap;
  struct Axis {
    BenchOptions options;  ///< as of a run of this drive alone
    DriveFacts facts;
    std::unique_ptr<ObjectRecorder> recorder;
    std::unique_ptr<ChangedObjects> changed;
    std::optional<std::int64_t> zero_counts;
  };
  BusDrive(ToolBus& bus, const BenchOptions& options, const DriveUse& use, std::vector<Axis> axes,
           const std::string& log);
  /// Writes the limits of the run into one drive. False: refused, which has been said.
  bool prepare(Axis& axis);
  bool boot();
  void exchange(image::Nanoseconds due, std::span<const bench::DriveAsk> asks,
                std::span<bench::DriveAnswer> answers);
  void read_answer(Axis& axis, const image::DriveFeedback& feedback, bench::DriveAnswer& answer) const;
  void write_command(const Axis& axis, const bench::DriveAsk& ask, image::AxisImage& image) const;

  ToolBus& bus_;
  image::Nanoseconds period_ns_;
  DriveUse use_;
  std::vector<Axis> axes_;
  StopKey key_;
  std::unique_ptr<Tap> tap_;
  std::unique_ptr<canopen::Segment> segment_;
  std::unique_ptr<image::ProcessImage> image_;
  image::Nanoseconds begin_ns_ = 0;   ///< of times that are told
  image::Nanoseconds start_ns_ = 0;   ///< the same, behind by what the computer has stood still
  image::Nanoseconds opened_ns_ = 0;  ///< the SYNC before
  std::string said_;                  ///< of the bus's events, the last
  int late_ = 0;
  bool left_ = false;
};

}  // namespace servogate::gateway::command
