// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/drive/measurement/bench_drive.hpp"
#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/master/segment.hpp"
#include "gateway/cli/bench_options.hpp"
#include "gateway/command/bench/recorded_object.hpp"
#include "gateway/command/bench/stop_key.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "report/statistics.hpp"

namespace servogate::gateway::command {

/// What a drive says of itself, and its units.
struct DriveFacts {
  double counts_per_rev = 0.0, rated_torque_nm = 0.0;
  std::string name;                                               ///< 1008h; empty: it has none
  std::optional<std::int64_t> vendor, product, revision, serial;  ///< 1018h
  std::optional<std::int64_t> dc_link_mv;                         ///< 6079h
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

/// A drive on a CAN bus, led by the master of the machines. Its torque limit 6072h is that of the envelope as
/// long as this lives; this and what else is written is then what it was. Not real-time safe.
class BusDrive final : public bench::BenchDrive {
 public:
  /// Reads what the drive is, limits its torque and boots it. nullptr: refused, which has been said; `code`
  /// is the exit code then. `log`: file for every frame in the form of candump; empty: none.
  static std::unique_ptr<BusDrive> open(ToolBus& bus, const BenchOptions& options, const DriveUse& use,
                                        const std::string& log, int& code);
  ~BusDrive() override;

  const DriveFacts& facts() const noexcept { return facts_; }
  double period_s() const noexcept override;
  bool cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) override;
  bool ended() const override { return bus_.ended() || (use_.key_ends && key_.pressed()); }
  const StopKey& key() const noexcept { return key_; }
  const ObjectRecorder& recorder() const noexcept { return recorder_; }
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
  BusDrive(ToolBus& bus, const BenchOptions& options, const DriveUse& use, DriveFacts facts,
           const std::string& log);
  bool boot();
  void exchange(image::Nanoseconds due, const bench::DriveAsk& ask, bench::DriveAnswer& answer);
  /// Writes an object of up to four bytes and remembers what it was. Empty: done, or the drive does not have
  /// it; otherwise why not.
  std::string change(std::uint16_t index, std::int64_t value);

  ToolBus& bus_;
  canopen::NodeId node_;
  image::Nanoseconds period_ns_;
  DriveUse use_;
  DriveFacts facts_;
  StopKey key_;
  ObjectRecorder recorder_;
  std::unique_ptr<Tap> tap_;
  std::unique_ptr<canopen::Segment> segment_;
  std::unique_ptr<image::ProcessImage> image_;
  image::Nanoseconds begin_ns_ = 0;   ///< of times that are told
  image::Nanoseconds start_ns_ = 0;   ///< the same, behind by what the computer has stood still
  image::Nanoseconds opened_ns_ = 0;  ///< the SYNC before
  std::optional<std::int64_t> zero_counts_;
  struct Changed {
    std::uint16_t index;
    std::vector<std::uint8_t> before;
  };
  std::vector<Changed> changed_;
  std::string said_;  ///< of the bus's events, the last
  int late_ = 0;
};

}  // namespace servogate::gateway::command
