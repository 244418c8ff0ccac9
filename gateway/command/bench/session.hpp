// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "bench/drive/measurement/guard.hpp"
#include "gateway/command/bench/bus_drive.hpp"
#include "gateway/command/bench/limits.hpp"
#include "gateway/control/run/exit_code.hpp"

/// What every command of the bench does around its work. Not real-time safe.
namespace servogate::gateway::command {

inline constexpr double kTurnRad = 2.0 * std::numbers::pi;

/// What a command has to work with.
struct BenchWork {
  const BenchOptions& options;
  bench::Guard& guard;
  BusDrive& drive;
  nlohmann::json& meta;  ///< what it found
  std::string why;       ///< it came to no result: what could not be found
  std::size_t axis = 0;  ///< of the drive's
};

/// Objects of --read before and after a run.
class ReadObjects {
 public:
  /// False: a word names none, which has been said.
  bool set(const BenchOptions& options);
  void read(ToolBus& bus, int node, const char* when);
  /// {"606Ch:00": {"name": ..., "before": ..., "after": ...}}; empty: none was asked for.
  nlohmann::json facts() const;

 private:
  struct One {
    canopen::ObjectAddress at;
    const canopen::ValueType* type;
    std::string name;
    std::string before, after;  ///< JSON text
  };
  std::vector<One> objects_;
};

/// What is needed before a bus is opened.
struct BenchPlan {
  bench::Envelope envelope;
  DriveUse use;
  ReadObjects objects;
  std::optional<RunLimits> limits;
};
/// By the options; nullopt: they are wrong, which has been said.
std::optional<BenchPlan> plan_of(const BenchOptions& options, const DriveUse& use);
/// An idle bus on which a drive may move; nullptr: refused, which has been said, with `code`.
std::unique_ptr<ToolBus> open_bench(const BenchOptions& options, int& code);
/// Makes the directory, boots the drive, does the work inside of the envelope, stops the drive, keeps the run
/// and judges it by its limits. `work` enables the drive itself; false: it came to no result.
int run_on_bus(ToolBus& bus, const char* command, const BenchOptions& options, BenchPlan& plan,
               const std::function<bool(BenchWork&)>& work);
/// Its parts, for a command that leads several drives.
std::unique_ptr<bench::Guard> begin_guard(bench::BenchDrive& drive, const BenchPlan& plan,
                                          const DriveFacts& facts);
/// Live values on standard error.
void watch_live(bench::Guard& guard);
nlohmann::json meta_of(const char* command, const BenchOptions& options, const BusDrive& drive,
                       std::size_t axis = 0);
/// Keeps the run and judges it; its exit code. `off`: the drive has shown that it has no torque.
int finish(BenchWork& work, bool found, const std::optional<RunLimits>& limits, bool off);
/// All of it.
int on_drive(const char* command, const BenchOptions& options, const DriveUse& use,
             const std::function<bool(BenchWork&)>& work);

/// The objects of --record and their data sheet; false: wrong, which has been said.
bool read_record_option(const BenchOptions& options, std::vector<RecordedObject>& out);

/// Whether --inertia is there where the loop needs it; false: not, which has been said.
bool knows_least_load(const BenchOptions& options);
/// Guard::accepts() of a whole signal, of torques by the least load of the options.
bool accepts_signal(bench::Guard& guard, const BenchOptions& options, bench::Loop loop,
                    std::span<const double> set_points);

/// The value of an optional for JSON, null for none.
nlohmann::json optional_number(const std::optional<double>& value);
nlohmann::json optional_number(const std::optional<std::int64_t>& value);
/// What the drive is, for the record of a run.
nlohmann::json drive_json(const DriveFacts& facts);
/// A number of the command line that CLI11 does not read; nullopt: it is none.
std::optional<double> number_word(std::string_view word);

}  // namespace servogate::gateway::command
