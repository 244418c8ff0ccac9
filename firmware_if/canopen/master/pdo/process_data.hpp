// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// Where an object lies in a node's PDOs. Not mapped: pdo is -1.
struct PdoField {
  std::int8_t pdo = -1;
  std::uint8_t offset = 0;  ///< first bit
  std::uint8_t bits = 0;
  bool mapped() const noexcept { return pdo >= 0; }
  /// Its bits, right-aligned.
  std::uint64_t mask() const noexcept {
    return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  }
};

/// First place of an object in a set of PDOs. real-time safe.
PdoField find_field(const std::array<PdoWanted, 4>& pdos, std::uint16_t index,
                    std::uint8_t subindex = 0) noexcept;

/// The bytes of a node's PDOs, both ways. All but the constructor is real-time safe.
class ProcessData {
 public:
  /// A value that nobody gives in the cycle, and that the profile's settings have, is sent as it stands
  /// there.
  ProcessData(const DriveProfile& profile, image::Nanoseconds cycle_ns);

  enum class Taken : std::uint8_t { stored, too_short, not_used };
  /// Stores TPDO `number` (1-4), or what stands for it. A frame shorter than its mapping is not stored.
  Taken take(int number, const image::CanFrame& frame) noexcept;
  /// Marks everything received so far as old.
  void end_of_cycle() noexcept { fresh_ = {}; }
  /// Forgets what was received and what is to be sent.
  void clear() noexcept;

  /// The PDO with this field has come since end_of_cycle().
  bool fresh(const PdoField& field) const noexcept { return field.mapped() && fresh_[index_of(field)]; }
  std::uint64_t raw(const PdoField& field) const noexcept {
    return field.mapped() ? received_[index_of(field)] >> field.offset & field.mask() : 0;
  }
  std::int64_t number(const PdoField& field) const noexcept { return sign_extend(raw(field), field.bits); }

  /// Writes a value of an RPDO; nothing happens for an object that is not mapped.
  void set(const PdoField& field, std::uint64_t value) noexcept {
    if (!field.mapped()) return;
    std::uint64_t& data = rpdo_[index_of(field)].data;
    data = (data & ~(field.mask() << field.offset)) | (value & field.mask()) << field.offset;
  }
  /// What set() has given last.
  std::uint64_t to_send(const PdoField& field) const noexcept {
    return field.mapped() ? rpdo_[index_of(field)].data >> field.offset & field.mask() : 0;
  }
  /// RPDO `number` (1-4) of a node when it is to be sent in this cycle: every n-th cycle by transmission type
  /// n, nodes staggered; types 0, 254 and 255 when the data has changed, and often enough for the drive's
  /// deadline.
  bool due(int number, NodeId node, std::int64_t cycle, image::Nanoseconds now) const noexcept;
  image::CanFrame frame(int number, NodeId node) const noexcept;
  /// TPDO `number` comes when it is asked for (types 252, 253), and that is due now; nodes staggered. Type
  /// 252 was sampled at the last SYNC.
  bool ask_due(int number, NodeId node, std::int64_t cycle) const noexcept {
    const std::int64_t every = ask_every_[static_cast<std::size_t>(number - 1)];
    return every > 0 && (cycle + node) % every == 0;
  }
  /// The remote frame that asks for TPDO `number`.
  image::CanFrame request(int number, NodeId node) const noexcept;
  /// While `held`, the RPDO with this field is not sent.
  void hold(const PdoField& field, bool held) noexcept {
    if (field.mapped()) rpdo_[index_of(field)].held = held;
  }
  /// What stands in the RPDO with this field has been sent.
  bool delivered(const PdoField& field) const noexcept {
    if (!field.mapped()) return false;
    const Rpdo& pdo = rpdo_[index_of(field)];
    return pdo.ever_sent && pdo.sent == pdo.data;
  }
  /// The bus has taken RPDO `number`.
  void sent(int number, image::Nanoseconds now) noexcept;
  /// Bytes mapped in TPDO `number`.
  std::uint8_t tpdo_bytes(int number) const noexcept {
    return tpdo_bytes_[static_cast<std::size_t>(number - 1)];
  }

 private:
  static std::size_t index_of(const PdoField& field) noexcept { return static_cast<std::size_t>(field.pdo); }

  struct Rpdo {
    std::uint8_t bytes = 0;
    std::uint8_t type = 1;
    image::Nanoseconds refresh_ns = 0;
    std::uint64_t data = 0, sent = 0;  ///< little-endian, as a mapping counts its bits
    std::uint64_t constant = 0;        ///< of the settings
    bool ever_sent = false, held = false;
    image::Nanoseconds sent_ns = 0;
  };
  std::array<Rpdo, 4> rpdo_{};
  std::array<std::uint8_t, 4> tpdo_bytes_{};
  std::array<std::int64_t, 4> ask_every_{};  ///< cycles; 0: it comes by itself
  std::array<std::uint64_t, 4> received_{};
  std::array<bool, 4> fresh_{};
};

}  // namespace servogate::canopen
