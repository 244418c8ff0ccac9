// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Emergency producer with error register 1001h, history 1003h, COB-ID 1014h and inhibit time 1015h.
/// Source: CiA 301, 7.2.7. real-time safe but for the constructor.
class EmcyProducer {
 public:
  explicit EmcyProducer(ObjectDictionary& dictionary);

  void connect(image::CanBus* bus) noexcept { bus_ = bus; }
  /// EMCY is allowed in Pre-operational and Operational; kept back elsewhere.
  void set_allowed(bool allowed) noexcept { allowed_ = allowed; }

  /// An error has come: register, history and message. An error that is present already is not told again.
  void raise(std::uint16_t error_code, std::uint8_t register_bits, std::uint32_t detail = 0) noexcept;
  /// A message without a state behind it (a warning): history and message, the register stays.
  void notify(std::uint16_t error_code, std::uint32_t detail = 0) noexcept;
  /// An error has gone: the message 0000h with what remains in the register. Nothing when it was not present.
  void clear(std::uint16_t error_code) noexcept;
  void clear_all() noexcept;
  bool present(std::uint16_t error_code) const noexcept;
  bool any() const noexcept { return active_count_ > 0; }

  /// Sends what the inhibit time kept back.
  void tick(image::Nanoseconds now) noexcept;
  /// Empties the history (a write of 0 to 1003h:00).
  void clear_history() noexcept;
  /// As after power-on (a reset): no error, nothing to send. The history lies in the dictionary and is reset
  /// with it.
  void reset() noexcept;

 private:
  static constexpr std::size_t kActive = 16, kQueue = 16;
  static constexpr std::uint8_t kHistory = 8;
  struct Active {
    std::uint16_t code = 0;
    std::uint8_t bits = 0;
  };
  void update_register() noexcept;
  void remember(std::uint16_t error_code, std::uint32_t detail) noexcept;
  void queue(std::uint16_t error_code, std::uint32_t detail) noexcept;
  void flush() noexcept;

  ObjectDictionary& dictionary_;
  std::int64_t& register_;
  std::int64_t& cob_id_;
  std::int64_t& inhibit_;  ///< multiples of 100 us
  image::CanBus* bus_ = nullptr;
  bool allowed_ = false;
  std::array<Active, kActive> active_{};
  std::size_t active_count_ = 0;
  std::array<Emcy, kQueue> waiting_{};
  std::size_t waiting_count_ = 0;
  image::Nanoseconds now_ = 0;
  image::Nanoseconds not_before_ = 0;
};

}  // namespace servogate::canopen
