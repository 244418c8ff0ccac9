// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/control/compose/control.hpp"
#include "kernel/cycle/boundary/inputs.hpp"
#include "machine/state/state.hpp"

namespace servogate::gateway {

/// What a record says of its run: one JSON line at the head of the file. The cycles follow in chunks, between
/// them what was loaded and typed before they saw it, with the text of the programs; each chunk with a
/// checksum that continues the one before, and an empty chunk at the end: nothing can be cut off or changed
/// unnoticed.
struct RecordHeader {
  std::string machine, machine_sha256;
  machine::MachineState state;  ///< as the run found it; the run itself may change the state directory
  image::Nanoseconds period_ns = 0;
  double time_scale = 1.0;  ///< Cycle::time_scale()
};

/// Writes the inputs of every cycle, and what was loaded beside them, to a file on a thread of its own.
class RecordWriter final : public cycle::InputTap, public ProgramChangeTap {
 public:
  RecordWriter(const std::string& path, const RecordHeader& header);
  ~RecordWriter() override;
  /// real-time safe; a full queue drops the cycle and damages the record (lost()).
  void take(const cycle::CycleInputs& inputs) noexcept override;
  /// Any thread but the cycle's; what take() sees of it later stands behind it in the file.
  void take(const ProgramChange& change) override;
  void take(const plc::LogicChange& change) override;
  void take_subprogram(int process, std::string_view name, std::string_view text) override;
  /// Blocks until take() is sure to succeed; for virtual time.
  void wait_for_room();
  /// Writes what is queued and closes the file. The error (also: cycles were lost), empty: none.
  std::string close();
  /// The file is not written any more, or lacks cycles. real-time safe.
  bool broken() const noexcept { return failed_.load(std::memory_order_relaxed) || lost() != 0; }
  std::uint64_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  void drain();
  void write_loaded(std::string& cycles);
  void write_chunk(std::string& bytes);
  struct Queue;
  std::unique_ptr<Queue> queue_;
  std::atomic<bool> stop_{false}, failed_{false};
  std::atomic<std::uint64_t> lost_{0};
  std::string error_;
  std::mutex loaded_mutex_;
  std::vector<std::string> loaded_;          ///< chunks to be written before the next cycle
  std::shared_ptr<const ProgramFile> file_;  ///< whose text was written last
  std::thread thread_;
};

/// Begins the record of a control that nobody has changed or stepped so far. `machine_file`: the path that it
/// was loaded from; `state`: what it was given.
std::unique_ptr<RecordWriter> begin_record(const std::string& path, const std::string& machine_file,
                                           const machine::MachineState& state, Control& control);

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
  /// What was loaded and typed, in its order: the n-th change of a process is made before the first cycle
  /// whose inputs have seen n changes. Programs and subprograms have the texts that they had then.
  std::vector<ProgramChange> changes(const machine::MachineConfig& machine) const;
  /// What was prepared for the PLC, each before the cycle whose requests name its number.
  const std::vector<plc::LogicChange>& logic_changes() const noexcept { return logic_changes_; }
  /// True once next() has met the place where the record is cut off or changed.
  bool damaged() const noexcept { return damaged_; }
  /// Byte of the file at which the first unsound chunk begins; meaningful when damaged().
  std::size_t damaged_at() const noexcept { return damaged_at_; }

 private:
  bool read_head(const std::string& line, std::string& error);
  void read_chunks(std::string_view all, std::size_t at);
  bool read_chunk(std::string_view bytes);
  bool read_change(std::string_view bytes);
  bool read_logic_change(std::string_view bytes);
  void look_ahead() noexcept;

  RecordHeader header_;
  std::vector<std::uint8_t> bytes_;
  std::vector<ProgramChange> changes_;
  std::vector<plc::LogicChange> logic_changes_;
  std::vector<std::shared_ptr<ProgramFile>> files_;  ///< of the changes; their models are the machine's
  using Texts = std::map<std::string, std::string, std::less<>>;
  std::array<std::shared_ptr<Texts>, image::kMaxProcesses> subprograms_;  ///< of each process' newest file
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
