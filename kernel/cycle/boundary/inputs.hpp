// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "firmware_if/image/alarm.hpp"
#include "firmware_if/image/notices.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"

namespace servogate::cycle {

inline constexpr int kCrossingsEach = 6;  ///< ways across the real-time line to one process
inline constexpr int kCrossings = kCrossingsEach * image::kMaxProcesses;
inline constexpr int kRequestsPerCycle = 16;  ///< requests taken in one cycle; more wait for the next one
using image::kNoticesPerCycle;

/// Everything that comes from outside in one cycle. Whoever has these has the run: the rest is a function of
/// them (docs/architecture.md, rule 1).
struct CycleInputs {
  std::int64_t number = 0;
  std::array<image::DriveFeedback, image::kMaxAxes> axes{};
  std::array<image::DriveFeedback, image::kMaxSpindles> spindles{};
  std::array<std::uint8_t, image::kPacketASize> packet_a{};
  std::array<image::IoSource, image::kMaxSources> sources{};
  image::Edges edges;
  std::array<std::uint64_t, kCrossings> visible{};  ///< how far each way was filled
  std::uint8_t request_count = 0;
  std::array<image::Request, kRequestsPerCycle> requests{};
  std::uint8_t notice_count = 0;
  std::array<image::AlarmRecord, kNoticesPerCycle> notices{};  ///< faults reported by buses and devices
  /// The scan of this cycle was ended from outside. Not known before it, so no part of what is written of
  /// this cycle: the notice of it is an input of the next one, and whoever replays looks ahead.
  bool scan_ended = false;
};
inline constexpr double kScanEnded = 1.0;  ///< detail1 of a notice of kPlcWatchdog
/// The inputs of a cycle tell that the scan of the one before was ended from outside.
bool tell_of_ended_scan(const CycleInputs& inputs) noexcept;

/// Takes the inputs of each cycle as they are used. real-time safe.
class InputTap {
 public:
  virtual ~InputTap() = default;
  virtual void take(const CycleInputs& inputs) noexcept = 0;
};

/// Gives recorded inputs instead of real ones. False: the record has ended. real-time safe.
class InputSource {
 public:
  virtual ~InputSource() = default;
  virtual bool give(CycleInputs& inputs) noexcept = 0;
};

/// Writes each cycle's inputs as what changed since the cycle before. Not real-time safe (grows the buffer).
class InputEncoder {
 public:
  void append(const CycleInputs& inputs, std::vector<std::uint8_t>& out);

 private:
  CycleInputs last_;
};

/// Reads what InputEncoder wrote.
class InputDecoder final : public InputSource {
 public:
  explicit InputDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool give(CycleInputs& inputs) noexcept override;
  /// True when the bytes ended inside a cycle or made no sense (a cut or damaged record).
  bool damaged() const noexcept { return damaged_; }
  /// True when nothing is left to read.
  bool at_end() const noexcept { return at_ >= bytes_.size(); }

 private:
  std::uint64_t varint() noexcept;
  void raw(void* to, std::size_t bytes) noexcept;
  void edges() noexcept;

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool damaged_ = false;
  CycleInputs last_;
};

}  // namespace servogate::cycle
