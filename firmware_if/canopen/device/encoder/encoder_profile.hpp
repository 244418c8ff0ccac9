// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/canopen/device/node/slave.hpp"

namespace servogate::canopen {

/// What an absolute rotary encoder can tell apart.
struct EncoderResolution {
  std::uint32_t counts_per_rev = 8192;  ///< 1 to 2^31
  std::uint16_t revolutions = 4096;     ///< at least 1; times counts_per_rev at most 2^32 - 1
};

/// The rows 6000h-6506h, and 1800h-1A01h with the default PDOs of the profile: TPDO 1 the position every 100
/// ms and when it changes, TPDO 2 the position with every SYNC. They replace those of
/// communication_objects(). Source: CiA 406. Not real-time safe.
std::vector<ObjectSpec> encoder_objects(NodeId node, const EncoderResolution& resolution);

/// An absolute encoder behind its objects: code sequence, scaling, preset, alarms. Source: CiA 406. All but
/// the constructor is real-time safe.
class EncoderProfile final : public DeviceProfile {
 public:
  EncoderProfile(ObjectDictionary& dictionary, const EncoderResolution& resolution);

  /// Where the shaft stands, in counts of the disc from its zero, over any number of turns.
  void set_position(std::int64_t counts) noexcept { counts_ = counts; }
  std::int64_t position() const noexcept { return counts_; }
  /// The disc cannot be read: alarm "position error".
  void set_unreadable(bool unreadable) noexcept { unreadable_ = unreadable; }

  /// Every millisecond, before the slave's tick().
  void tick(image::Nanoseconds now) noexcept;

  AbortCode before_write(ObjectDictionary::Slot slot, std::int64_t value) noexcept override;
  void after_write(ObjectDictionary::Slot slot) noexcept override;

 private:
  std::int64_t scaled() const noexcept;
  std::int64_t range() const noexcept;
  void show() noexcept;

  ObjectDictionary& dictionary_;
  EncoderResolution resolution_;
  std::int64_t counts_ = 0, shown_counts_ = 0;
  std::int64_t offset_ = 0;  ///< of the preset, added to what is scaled
  bool unreadable_ = false;
  std::int64_t last_ = 0;
  image::Nanoseconds last_ns_ = -1;
};

}  // namespace servogate::canopen
