// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "firmware_if/pendant/layout.hpp"

namespace servogate::pendant {

inline constexpr std::size_t kLongestReport = 64;  ///< bytes; full speed USB, HID 1.11

/// What a hand does at a pendant, as one report says it.
struct Reading {
  std::uint32_t buttons = 0;  ///< bit n: Layout::buttons[n] is pressed
  int axis = -1;              ///< index in Layout::axes, -1: off, or a place that the layout does not know
  int step = -1;              ///< index in Layout::steps, -1: none, or no selector
  int counts = 0;             ///< of the wheel since the last report
  int ring = 0;               ///< of the spring-loaded ring, - counter-clockwise
  bool asleep = false;        ///< it has just been switched off: nothing else of this is said
  friend bool operator==(const Reading&, const Reading&) = default;
};

/// Reads reports of one pendant, one after the other. The layout outlives it. real-time safe.
class ReportReader {
 public:
  explicit ReportReader(const Layout& layout) noexcept : layout_(&layout) {}

  /// A pendant with two selectors, none of which stands anywhere (0), is being switched off; LinuxCNC,
  /// xhc-whb04b-6/usb.h, "empty package". What it sends next is read as a report and has to be passed over.
  /// nullopt: it is no report of this pendant: its length, its number, or the code of a key that there is
  /// not.
  std::optional<Reading> read(std::span<const std::uint8_t> report) noexcept;
  /// The pendant was away: what its counter says next is its new beginning.
  void restart() noexcept { counter_.reset(); }

 private:
  bool read_keys(std::span<const std::uint8_t> report, Reading& out) const noexcept;

  const Layout* layout_;
  std::optional<std::uint8_t> counter_;
};

/// Makes reports of one pendant: what is simulated of it. The layout outlives it. real-time safe.
class ReportWriter {
 public:
  explicit ReportWriter(const Layout& layout) noexcept : layout_(&layout) {}

  struct Bytes {
    std::array<std::uint8_t, kLongestReport> bytes{};
    std::size_t size = 0;
    std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), size}; }
  };
  /// Of more pressed buttons than the report has room for the first ones are told.
  Bytes write(const Reading& reading) noexcept;

 private:
  const Layout* layout_;
  std::uint8_t counter_ = 0;
};

}  // namespace servogate::pendant
