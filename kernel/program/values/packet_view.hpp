// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/packets.hpp"

namespace servogate::program {

/// The packets as the program sees them while it is read ahead: the snapshot handed in, and over it the
/// program's own writes that take effect at once but have not come back in a snapshot yet.
class PacketView {
 public:
  static constexpr std::size_t kMaxPending = 256;

  /// The snapshot for the coming reads; it must outlive them. `fresh`: it holds all own writes handed out so
  /// far.
  void look_at(const image::Packets& packets, bool fresh) {
    packets_ = &packets;
    if (fresh) pending_.clear();
  }
  /// True when own writes have piled up and a synchronised snapshot should come first.
  bool full() const noexcept { return pending_.size() >= kMaxPending; }

  /// Throws ProgramError when the place lies outside of its packet or holds characters.
  double number(const image::Place& place, int column) const;
  /// Characters of a CH place. Throws ProgramError when it lies outside.
  std::string text(const image::Place& place, int column) const;

  /// Checks a write: inside of the packet, in the range of the format; returns the value as stored (whole
  /// formats are rounded to nearest). Throws ProgramError.
  double storable(const image::Place& place, double value, int column) const;
  void check_inside(const image::Place& place, int column) const;
  /// Remembers a write that takes effect at once. The value has to be storable.
  void remember(const image::Place& place, double value, std::string_view characters);

 private:
  struct Pending {
    image::Place place;
    std::array<std::uint8_t, image::kMaxCharacters> bytes{};
  };
  /// The bytes a place touches, own writes laid over the snapshot, at the start of a small packet image.
  void load(const image::Place& place, std::array<std::uint8_t, image::kMaxCharacters>& bytes) const;

  const image::Packets* packets_ = nullptr;
  std::vector<Pending> pending_;
};

}  // namespace servogate::program
