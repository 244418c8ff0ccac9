// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/305/lss_frame.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/time.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

enum class LssStatus : std::uint8_t {
  idle,
  busy,
  done,
  no_answer,  ///< nobody answered where somebody should
  refused,    ///< `error` and `specific` say why
};
struct LssResult {
  LssStatus status = LssStatus::idle;
  LssCommand command = LssCommand::switch_global;
  std::uint8_t error = 0;     ///< of the device: 1 out of range or not supported, 2 memory, 255 `specific`
  std::uint8_t specific = 0;  ///< the manufacturer's error
  std::uint32_t value = 0;    ///< what was inquired
  LssIdentity identity;       ///< what fastscan found
};
/// Why a device refused, in words; never null. real-time safe.
const text::Entry& lss_error_text(LssCommand command, std::uint8_t error) noexcept;

/// LSS master: one service at a time, on frames and time. Source: CiA 305. All members are real-time safe.
class LssMaster {
 public:
  /// `timeout`: how long an answer may take. Services without an answer, and the question "is there anybody"
  /// of identification and fastscan, wait as long.
  explicit LssMaster(image::Nanoseconds timeout = 50 * image::kMillisecond) noexcept : timeout_(timeout) {}

  /// Each starts a service; false when one is under way.
  bool switch_global(LssMode mode) noexcept;
  bool switch_selective(const LssIdentity& identity) noexcept;
  /// Part 0-3 of the identity of the one device in configuration state.
  bool inquire(int part) noexcept;
  bool inquire_node() noexcept;
  /// 1-127, or kUnconfiguredNode to take it away.
  bool configure_node(NodeId node) noexcept;
  /// False also when the rate is not in the standard table.
  bool configure_bit_rate(std::uint32_t bit_s) noexcept;
  bool activate_bit_rate(std::uint16_t delay_ms) noexcept;
  bool store() noexcept;
  /// Whether a device of this vendor and product with revision and serial number in these ranges is there:
  /// done or no_answer.
  bool identify(const LssIdentity& lowest, std::uint32_t highest_revision,
                std::uint32_t highest_serial) noexcept;
  /// Whether a device without node-ID is there: done or no_answer.
  bool identify_unconfigured() noexcept;
  /// Finds one device without node-ID; then it is in configuration state. no_answer: there is none. Silence
  /// is an answer here: where nobody answers at first, or a found part is not confirmed, answers may come
  /// later than the timeout. The devices are then told to wait and scanned again, up to kLaterScans times,
  /// each with kLaterFactor times the patience.
  bool fastscan() noexcept;
  static constexpr int kLaterScans = 2;
  static constexpr int kLaterFactor = 4;

  bool busy() const noexcept { return result_.status == LssStatus::busy; }
  const LssResult& result() const noexcept { return result_; }

  /// Sends what is due. True when a frame was given to the bus.
  bool poll(image::Nanoseconds now, image::CanBus& bus) noexcept;
  /// Takes a frame with the identifier 7E4h. True when it belonged to the service.
  bool on_frame(const image::CanFrame& frame) noexcept;

 private:
  enum class Answer : std::uint8_t { none, error_code, value, byte, presence };
  /// What a scan waits for: anybody at all; who has 0 in this bit; that nobody comes late; who has the part.
  enum class Scan : std::uint8_t { reset, bit, quiet, whole };
  static constexpr int kMostFrames = 6;
  bool start(LssCommand command, Answer answer, LssCommand expected) noexcept;
  void add(const LssBytes& bytes) noexcept { frames_[static_cast<std::size_t>(count_++)] = bytes; }
  void begin_scan() noexcept;
  void scan_again() noexcept;
  void ask_scan(std::uint8_t bit, std::uint8_t next) noexcept;
  void scanned(image::Nanoseconds now) noexcept;
  void finish(LssStatus status) noexcept { result_.status = status; }

  image::Nanoseconds timeout_, patience_ = 0;
  LssResult result_;
  Answer answer_ = Answer::none;
  LssCommand expected_ = LssCommand::switched;
  std::array<LssBytes, kMostFrames> frames_{};
  int count_ = 0, sent_ = 0;
  image::Nanoseconds deadline_ = 0;
  bool scanning_ = false, heard_ = false;
  Scan scan_ = Scan::reset;
  std::uint8_t part_ = 0, bit_ = 0;
  int later_scans_ = 0;
};

}  // namespace servogate::canopen
