// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/process_image.hpp"

namespace servogate::channel {

/// The words that the PLC acknowledges.
enum class HandshakeWord : std::uint8_t { m, s, t, h };

/// Hands one M, S, T or H word to the PLC through packet K: code, strobe, wait for the acknowledgement, drop
/// the strobe, wait until the acknowledgement falls too. All real-time safe.
class Handshake {
 public:
  enum class State : std::uint8_t { idle, waiting, done, unknown, timed_out };

  /// Begins. `code` = M, H or tool number; `value` = spindle speed of an S word, corrector of a T word.
  void begin(HandshakeWord word, std::int32_t code, double value, double timeout_s) noexcept;
  /// One cycle on the interface of the process whose block begins at byte `base` of K.
  /// `held`: nobody is to hurry, the time does not count.
  State step(image::ProcessImage& image, std::uint32_t base, bool held = false) noexcept;
  /// Drops strobe and waiting at once (reset, emergency stop).
  void cancel(image::ProcessImage& image, std::uint32_t base) noexcept;
  bool active() const noexcept { return phase_ != Phase::idle; }
  HandshakeWord word() const noexcept { return word_; }
  double waited_s() const noexcept { return waited_s_; }

 private:
  enum class Phase : std::uint8_t { idle, clear, strobe, release };

  Phase phase_ = Phase::idle;
  HandshakeWord word_ = HandshakeWord::m;
  std::int32_t code_ = 0;
  double value_ = 0.0;
  double timeout_s_ = 0.0;
  double waited_s_ = 0.0;
  bool unknown_ = false;
};

}  // namespace servogate::channel
