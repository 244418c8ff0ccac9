// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <memory>
#include <mutex>
#include <vector>

#include "gateway/command/bench/bus_drive.hpp"

namespace servogate::gateway::command {

/// Several drives in the same cycles, each led by a run in a thread of its own: what all of them ask for goes
/// out with one SYNC, and no cycle begins before every run that is still there has asked. Where one run ends
/// early, all do. Not real-time safe.
class DriveSeats {
 public:
  explicit DriveSeats(BusDrive& drives);
  DriveSeats(const DriveSeats&) = delete;
  DriveSeats& operator=(const DriveSeats&) = delete;

  /// A drive for one run; valid as long as this lives.
  bench::BenchDrive& seat(std::size_t axis) { return *seats_[axis]; }
  /// The run of this seat can begin. True: so could all of them before this cycle, and they begin with it.
  bool may_begin(std::size_t axis);
  /// The other runs end, as if the operator had ended them.
  void end_all();
  /// The run of this seat asks for nothing any more. Once for each seat, at its end.
  void leave(std::size_t axis);

 private:
  class Seat;
  bool cycle(std::size_t axis, const bench::DriveAsk& ask, bench::DriveAnswer& answer);
  bool ended();
  void exchange_when_all_asked();

  BusDrive& drives_;
  std::mutex lock_;
  std::condition_variable next_;
  std::vector<bench::DriveAsk> asks_;
  std::vector<bench::DriveAnswer> answers_;
  std::size_t present_, asked_ = 0;
  std::uint64_t round_ = 0;
  std::vector<bool> ready_;
  bool all_ready_ = false, gone_ = false, ended_ = false;
  std::vector<std::unique_ptr<bench::BenchDrive>> seats_;
};

}  // namespace servogate::gateway::command
