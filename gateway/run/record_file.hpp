// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "gateway/machine/state.hpp"
#include "kernel/cycle/inputs.hpp"

namespace servogate::gateway {

/// What a record says of its run: one JSON line at the head of the file. The cycles follow in chunks, each
/// with a checksum that continues the one before, and an empty chunk at the end: nothing can be cut off or
/// changed unnoticed.
struct RecordHeader {
  std::string machine, machine_sha256;
  std::string program, program_sha256;
  std::string dialect;
  machine::MachineState state;  ///< as the run found it; the run itself may change the state directory
  image::Nanoseconds period_ns = 0;
};

/// Writes the inputs of every cycle to a file on a thread of its own.
class RecordWriter final : public cycle::InputTap {
 public:
  RecordWriter(const std::string& path, const RecordHeader& header);
  ~RecordWriter() override;
  /// real-time safe; a full queue drops the cycle and damages the record (lost()).
  void take(const cycle::CycleInputs& inputs) noexcept override;
  /// Blocks until take() is sure to succeed; for virtual time.
  void wait_for_room();
  /// Writes what is queued and closes the file. The error (also: cycles were lost), empty: none.
  std::string close();
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  void drain();
  void write_chunk(std::vector<std::uint8_t>& bytes);
  struct Queue;
  std::unique_ptr<Queue> queue_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> lost_{0};
  std::string error_;
  std::thread thread_;
};

/// A record read back: its header, and its cycles with the next one to look at before it is given.
class RecordReader final : public cycle::InputSource {
 public:
  /// False: `error` says why, in both languages or the user's (not readable, not a record, of another schema,
  /// damaged before its first cycle).
  bool open(const std::string& path, std::string& error);
  const RecordHeader& header() const noexcept { return header_; }
  /// The next cycle's inputs; nullptr: the record has ended.
  const cycle::CycleInputs* next() const noexcept { return has_next_ ? &next_ : nullptr; }
  bool give(cycle::CycleInputs& inputs) noexcept override;
  /// True once next() has met the place where the record is cut off or changed.
  bool damaged() const noexcept { return damaged_; }
  /// Byte of the file at which the first unsound chunk begins; meaningful when damaged().
  std::size_t damaged_at() const noexcept { return damaged_at_; }

 private:
  bool read_head(const std::string& line, std::string& error);
  void read_chunks(const std::string& content, std::size_t at);
  void look_ahead() noexcept;

  RecordHeader header_;
  std::vector<std::uint8_t> bytes_;
  std::unique_ptr<cycle::InputDecoder> decoder_;
  cycle::CycleInputs next_;
  std::int64_t expected_ = 0;  ///< number of the next cycle
  std::uint32_t checksum_ = 0;
  std::size_t damaged_at_ = 0;
  bool whole_ = false;  ///< the end mark was there
  bool has_next_ = false;
  bool damaged_ = false;
};

}  // namespace servogate::gateway
