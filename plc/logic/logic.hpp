// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "firmware_if/image/logic.hpp"
#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"
#include "plc/engine/scan_watch.hpp"
#include "plc/engine/transfer.hpp"
#include "plc/logic/logic_change.hpp"
#include "plc/logic/retained_memory.hpp"

namespace servogate::plc {

/// A program with everything that belongs to it.
struct LogicProgram {
  LogicProgram(std::shared_ptr<const Image> image, std::vector<SourceFile> files,
               std::uint32_t its_number = 0)
      : engine(std::move(image)),
        retained(engine.retain_bytes()),
        sources(std::move(files)),
        number(its_number) {}
  Engine engine;
  RetainedMemory retained;
  std::vector<SourceFile> sources;
  std::uint32_t number;               ///< of the request that brought it, 0: from the start
  std::vector<image::Place> dropped;  ///< written by the program before and not by this one
  /// Retained values that this program has no variable for, oldest first: they are kept for one that has.
  std::vector<Retained> aside;
};

/// What somebody wants to see of one scan: bytes of the engine's memory, all of the same scan.
struct LogicSample {
  struct Range {
    std::uint32_t address = 0, size = 0;
  };
  std::vector<Range> ranges;
  std::vector<std::uint8_t> bytes;        ///< the ranges one behind the other
  const LogicProgram* program = nullptr;  ///< that the ranges belong to; set by ask()
  bool profile = false;                   ///< measure every call of a block in this scan
  std::vector<Times> blocks, tasks;
  image::CycleTime at;
  ScanResult result;
};

/// The PLC as the cycle's logic: its faults become alarms, its retained variables leave the cycle after every
/// scan that was whole, and what is to change of it comes in between two scans.
///
/// Threads: scan() and order() are the cycle's; program() may be asked by any; the rest belongs to one thread
/// outside (or under a lock).
class Logic final : public image::Logic {
 public:
  /// `stopwatch` outlives it; tasks and blocks are measured with it, and nothing depends on what it says.
  Logic(std::shared_ptr<const Image> image, std::vector<SourceFile> sources, const image::Clock& stopwatch);
  ~Logic() override;
  /// real-time safe.
  void scan(image::ProcessImage& image, image::Notices& notices) noexcept override;
  /// Carries out the change that prepare() has made ready under the request's index, or holds the program,
  /// lets it scan, and lets it go (RequestKind::logic_scan). real-time safe.
  bool order(const image::Request& request) noexcept override;

  /// The scan of the cycle that was just run was ended from outside. real-time safe.
  bool scan_ended() const noexcept { return ended_; }
  /// real-time safe.
  void end_next_scan() noexcept override { watch_.end_next(); }
  /// Where scans are ended from outside.
  ScanWatch& scan_watch() noexcept { return watch_; }

  /// The engine before the first cycle.
  Engine& engine() noexcept { return shown_->engine; }
  /// Keeps a retained value that the program has no variable for; before the first cycle.
  void set_aside(Retained value) { shown_->aside.push_back(std::move(value)); }
  /// The program that runs, as far as the outside knows it.
  std::shared_ptr<const LogicProgram> program() const;
  /// Numeric value of a variable of `program`, NaN where another one runs meanwhile. Only the cycle's thread,
  /// between two cycles or behind a scan. real-time safe.
  double number(const LogicProgram& program, const Handle& handle) const noexcept;
  /// What stopped the program, with task, file and line, from a record of kPlcBudget or kPlcFault; empty when
  /// another program runs meanwhile. Not real-time safe.
  std::string fault_words(const image::AlarmRecord& record, text::Language language) const;

  /// What a change comes to; of load, what would be kept.
  struct Plan {
    bool possible = false;  ///< false: `findings` of the compiler, or no such variable or value
    std::vector<text::Finding> findings;
    std::size_t kept = 0;
    std::vector<std::string> fresh, given_up;  ///< variables by name
    std::vector<std::string> forces_lost;      ///< forced variables that the new program has not
    /// Retained variables: whose value is kept for a program that has them, is there again, is lost.
    std::vector<std::string> set_aside, taken_back, lost;
  };
  /// Makes a change ready for the request with its number; `compiled`: the program of a load. Not real-time
  /// safe.
  Plan prepare(const LogicChange& change, CompileResult compiled);
  /// Takes back what the gate has refused.
  void withdraw(std::uint32_t number);
  /// Takes note of what the cycle has carried out. Not real-time safe.
  void settle();
  /// Names and values of forced variables, as far as settle() knows.
  const std::vector<std::pair<std::string, std::string>>& forced() const noexcept { return forced_; }

  /// Has the next scan fill a sample, which stays the cycle's until it is filled or taken back. One at a
  /// time. Not real-time safe.
  void ask(LogicSample& sample);
  bool filled(const LogicSample& sample) const noexcept {
    return filled_.load(std::memory_order_acquire) == &sample;
  }
  /// Takes the sample back that was asked for. False: the cycle has begun with it, and fills it in this scan.
  bool take_back() noexcept { return wanted_.exchange(nullptr) != nullptr; }

 private:
  struct Prepared;
  static constexpr std::size_t kSlots = 16;
  using Slots = std::array<std::atomic<Prepared*>, kSlots>;

  Plan prepare_load(const LogicChange& change, Prepared& out, CompileResult compiled);
  void sort_retained(Plan& plan, Engine& engine) const;
  bool carry_out(Prepared& change) noexcept;
  bool hold(const image::Request& request) noexcept;
  void stand_still(image::ProcessImage& image) noexcept;
  ScanResult run_program(image::ProcessImage& image) noexcept;
  void raise_fault(const ScanResult& result, image::Notices& notices) const noexcept;
  void fill(LogicSample& sample, const image::CycleTime& now, const ScanResult& result) noexcept;

  const image::Clock& stopwatch_;
  ScanWatch watch_;
  LogicProgram* running_;  ///< the cycle's
  bool faulted_ = false;
  bool ended_ = false;  ///< in this cycle
  bool drops_ = false;  ///< the next scan is the first one of a program that came later
  // Held for single scans: what the program writes is kept here, and off in the packets.
  bool held_ = false;
  bool begins_ = false;             ///< the next cycle is the first one that is held
  bool given_back_ = true;          ///< the packets hold what the program has written
  std::uint32_t steps_ = 0;         ///< scans that are still to be run
  image::Nanoseconds held_ns_ = 0;  ///< so far the program's time is behind
  image::Packets kept_;
  ScanResult last_;
  Slots ready_{}, done_{};
  std::atomic<LogicSample*> wanted_{nullptr}, filled_{nullptr};

  mutable std::mutex mutex_;  ///< of shown_
  std::shared_ptr<LogicProgram> shown_;
  std::vector<std::pair<std::string, std::string>> forced_;
};

}  // namespace servogate::plc
