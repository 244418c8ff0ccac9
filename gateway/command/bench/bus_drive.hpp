// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "bench/drive/measurement/bench_drive.hpp"
#include "firmware_if/canopen/master/segment.hpp"
#include "gateway/cli/bench_options.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"

namespace servogate::gateway::command {

/// What a drive says of itself, and its units.
struct DriveFacts {
  double counts_per_rev = 0.0, rated_torque_nm = 0.0;
  std::string name;                                               ///< 1008h; empty: it has none
  std::optional<std::int64_t> vendor, product, revision, serial;  ///< 1018h
  std::optional<std::int64_t> dc_link_mv;                         ///< 6079h
};

/// A drive on a CAN bus, led in csp, csv and cst by the master of the machines. Its torque limit 6072h is
/// that of the envelope as long as this lives, and is then what it was. Not real-time safe.
class BusDrive final : public bench::BenchDrive {
 public:
  /// Reads what the drive is, limits its torque and boots it. nullptr: refused, which has been said; `code`
  /// is the exit code then. `log`: file for every frame in the form of candump; empty: none.
  static std::unique_ptr<BusDrive> open(ToolBus& bus, const BenchOptions& options, const std::string& log,
                                        int& code);
  ~BusDrive() override;

  const DriveFacts& facts() const noexcept { return facts_; }
  double period_s() const noexcept override;
  bool cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) override;
  bool ended() const override { return bus_.ended(); }
  /// Cycles that began later than half a cycle.
  int late_cycles() const noexcept { return late_; }

 private:
  class Tap;
  BusDrive(ToolBus& bus, const BenchOptions& options, DriveFacts facts, const std::string& log);
  bool boot();

  ToolBus& bus_;
  canopen::NodeId node_;
  image::Nanoseconds period_ns_;
  DriveFacts facts_;
  std::unique_ptr<Tap> tap_;
  std::unique_ptr<canopen::Segment> segment_;
  std::unique_ptr<image::ProcessImage> image_;
  image::Nanoseconds start_ns_ = 0;
  std::optional<std::int64_t> zero_counts_;
  std::optional<std::int64_t> torque_limit_before_;
  std::string said_;  ///< of the bus's events, the last
  int late_ = 0;
};

}  // namespace servogate::gateway::command
