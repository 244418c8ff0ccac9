// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Reads what a node has put into its error history 1003h since it was read last: after an emergency message,
/// and after a fault of which no message came. A device without the object is asked once. Source: CiA 301,
/// 7.5.2.4. All members are real-time safe.
class ErrorHistory {
 public:
  /// Entries read of one event, the newest ones.
  static constexpr std::uint8_t kMost = 4;
  /// What happens together is read together.
  static constexpr image::Nanoseconds kSettleNs = 20 * image::kMillisecond;

  /// The node has booted: what it remembers now is old.
  void restart() noexcept { *this = {}; }
  /// The node was found with an error that nothing else names: what it remembers is new, too. False: it has
  /// been read before.
  bool tell_all() noexcept {
    if (known_) return false;
    known_ = std::uint8_t{0};
    return true;
  }
  /// Something has happened to the node.
  void on_error(image::Nanoseconds now) noexcept {
    if (!wanted_) due_ns_ = now + kSettleNs;
    wanted_ = true;
  }
  /// Starts the next access that is due; false: none is. `sdo` must be idle.
  bool start(image::Nanoseconds now, SdoClient& sdo) noexcept;
  bool running() const noexcept { return running_; }

  struct Entry {
    std::uint8_t subindex = 0;  ///< 1 is the newest
    std::uint16_t error_code = 0;
  };
  /// Takes the result of the access that start() began. An entry that is new, if that was one.
  std::optional<Entry> finish(const SdoClient& sdo) noexcept;

 private:
  bool missing_ = false;  ///< the device has no 1003h
  bool wanted_ = false;
  bool running_ = false;
  std::optional<std::uint8_t> known_;  ///< entries when it was read last; nullopt: never
  std::uint8_t next_ = 0, left_ = 0;   ///< sub-index, and how many from there on are new
  image::Nanoseconds due_ns_ = 0;
};

}  // namespace servogate::canopen
