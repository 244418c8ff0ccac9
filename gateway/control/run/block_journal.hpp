// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "firmware_if/image/process_image.hpp"
#include "kernel/program/commands/canonical.hpp"

namespace servogate::gateway {

/// In which block each process' program is, kept beyond the end of this process, however it comes: the cycle
/// writes into locked shared memory, which outlives `kill -9`, and a thread writes what changed to the state
/// directory every 100 ms, which outlives a loss of power.
class BlockJournal {
 public:
  /// The block in which a program was when it did not come to its end.
  struct Block {
    std::string program, dialect;  ///< path and language of the file
    std::int64_t executed = 0;     ///< of the block, counted through loops and subprograms
    int line = 0, file = 0;        ///< of the block in motion, as image::ProcessStatus has them
    program::Position stands{};    ///< place on the path in its last cycle, machine coordinates
    bool from_disk = false;        ///< up to 100 ms older than the end
  };

  /// Takes over what was left in `folder`, the state directory; empty: nothing outlives this object.
  BlockJournal(const std::string& folder, int processes);
  ~BlockJournal();
  BlockJournal(const BlockJournal&) = delete;

  /// The next runs of a process are of this program; another one than before forgets where that one was.
  /// While none runs. Not for the cycle.
  void loaded(int process, const std::string& program, const std::string& dialect);
  /// The next run begins with this executed block. While none runs. Not for the cycle.
  void begins_with(int process, std::int64_t executed);
  /// Behind each cycle, by whoever owns the loop. real-time safe.
  void note(const image::ProcessImage& image) noexcept;
  /// nullopt: the last program of the process came to its end, or none ever ran. Not for the cycle.
  std::optional<Block> interrupted(int process) const;

 private:
  struct Memory;
  void keep();

  int processes_;
  Memory* memory_ = nullptr;
  std::unique_ptr<Memory> own_;  ///< where there is no shared memory
  std::string shared_;           ///< name of the shared memory
  int file_ = -1;
  std::uint64_t generation_ = 0;
  bool from_disk_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace servogate::gateway
