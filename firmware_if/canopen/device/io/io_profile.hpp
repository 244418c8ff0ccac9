// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/device/io/io_objects.hpp"
#include "firmware_if/canopen/device/node/slave.hpp"

namespace servogate::canopen {

/// A generic I/O module behind its objects. Source: CiA 401-1. All but the constructor is real-time safe.
class IoProfile final : public DeviceProfile {
 public:
  static constexpr std::size_t kGroups = 8, kChannels = 12;

  /// `filter_ns`: how long a line has to keep its level where 6003h asks for its filter.
  IoProfile(ObjectDictionary& dictionary, const IoTerminals& terminals, image::Nanoseconds filter_ns);

  // The terminals.
  void set_digital(std::uint8_t line, bool level) noexcept;
  void set_analogue(std::uint8_t channel, std::int16_t value) noexcept;
  bool digital(std::uint8_t line) const noexcept;
  std::int16_t analogue(std::uint8_t channel) const noexcept { return analogue_out_[channel]; }

  /// Every millisecond, before the slave's tick(): inputs through filter and polarity into the objects.
  void tick(image::Nanoseconds now) noexcept;

  bool is_event(ObjectDictionary::Slot slot, std::int64_t sent, std::int64_t now) noexcept override;
  void after_write(ObjectDictionary::Slot slot) noexcept override;
  void on_abort_connection(std::uint16_t error_code) noexcept override;
  void on_reset() noexcept override;

 private:
  struct Line {
    bool level = false, seen = false;  ///< on the terminal, and behind the filter
    image::Nanoseconds since = 0;
  };
  std::int64_t at(std::uint16_t index, std::size_t i) const noexcept {
    return dictionary_.get(index, static_cast<std::uint8_t>(i + 1));
  }
  void put_group(std::size_t group, std::uint8_t bits, std::uint8_t mask) noexcept;
  bool digital_event(std::uint8_t group, std::uint8_t sent, std::uint8_t now) const noexcept;
  bool analogue_event(std::uint8_t channel, std::int64_t sent, std::int64_t now) const noexcept;

  ObjectDictionary& dictionary_;
  IoTerminals terminals_;
  image::Nanoseconds filter_ns_;
  std::array<Line, 8 * kGroups> lines_{};
  std::array<std::int16_t, kChannels> analogue_in_{}, analogue_out_{};
  std::array<std::uint8_t, kGroups> digital_out_{};  ///< on the terminals
};

}  // namespace servogate::canopen
