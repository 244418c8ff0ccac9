// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

inline constexpr int kPdos = 4;                 ///< of each direction
inline constexpr std::uint8_t kPdoEntries = 8;  ///< mapped objects of one

/// CAN identifiers that no configurable object (SYNC, TIME, EMCY, PDO) may use. Source: CiA 301, 7.3.5, table
/// "Restricted CAN-IDs".
constexpr bool restricted_cob_id(std::uint32_t id) noexcept {
  return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
         (id >= 0x601 && id <= 0x67F) || id >= 0x6E0;
}

/// Whether a PDO parameter (1400h-1403h, 1600h-1603h, 1800h-1803h, 1A00h-1A03h) may take this value now,
/// after CiA 301, 7.5.2.35-38: identifiers change only while the PDO is invalid, mappings only while it is
/// invalid and :00 is 0. real-time safe.
///   0601 0000h  mapping of a valid PDO, or of one whose :00 is not 0
///   0602 0000h, 0609 0011h  mapped object or sub-index does not exist
///   0604 0041h  it may not be mapped in this direction
///   0604 0042h  more than 64 bits or more than eight objects
///   0607 0010h  the length in the mapping is not the object's
///   0609 0030h  restricted or changed identifier, reserved transmission type, inhibit time of a valid PDO
AbortCode check_pdo_parameter(const ObjectDictionary& dictionary, std::uint16_t index, std::uint8_t subindex,
                              std::uint32_t value) noexcept;

/// What a device lets its master change of its PDO maps (1600h-1603h, 1A00h-1A03h). COB-IDs, transmission
/// types and times can be written with all of them.
enum class MapAccess : std::uint8_t {
  variable,  ///< everything, as CiA 301 has it
  whole,     ///< :00 takes 0 and its own count, an entry its own value; else 0604 0041h
  fixed,     ///< nothing: 0601 0002h
};

/// Whether the device lets this value be written at all; its own maps are the defaults of `dictionary`.
/// real-time safe.
AbortCode check_pdo_map_access(const ObjectDictionary& dictionary, MapAccess access, std::uint16_t index,
                               std::uint8_t subindex, std::uint32_t value) noexcept;

/// Objects of a mapping with their places in the dictionary, for the cyclic path.
class MappedObjects {
 public:
  struct Field {
    ObjectDictionary::Slot slot = ObjectDictionary::kNone;  ///< kNone: a gap
    std::uint8_t offset = 0, bits = 0;
    bool is_signed = false;
  };
  /// Reads 1600h+n or 1A00h+n.
  void load(const ObjectDictionary& dictionary, std::uint16_t mapping_index) noexcept;
  std::uint8_t bytes() const noexcept { return bytes_; }
  const Field* begin() const noexcept { return fields_.data(); }
  const Field* end() const noexcept { return fields_.data() + count_; }

 private:
  std::array<Field, kPdoEntries> fields_{};
  std::uint8_t count_ = 0, bytes_ = 0;
};

/// Who is told of values that a PDO brought.
class PdoSink {
 public:
  virtual ~PdoSink() = default;
  virtual void pdo_wrote(ObjectDictionary::Slot slot) noexcept = 0;
};

/// Who knows which change of a value is an event.
class PdoEvents {
 public:
  virtual ~PdoEvents() = default;
  virtual bool is_event(ObjectDictionary::Slot slot, std::int64_t sent, std::int64_t now) noexcept = 0;
};

/// One RPDO. real-time safe.
class ReceivePdo {
 public:
  /// Reads its parameters again (a reset, a change of 1400h or 1600h).
  void configure(const ObjectDictionary& dictionary, int number) noexcept;
  bool valid() const noexcept { return valid_; }
  std::uint32_t id() const noexcept { return id_; }
  bool synchronous() const noexcept { return type_ <= 240; }

  enum class Result : std::uint8_t { kept, apply_now, too_short };
  /// Takes a frame's content; a synchronous one waits for SYNC.
  Result accept(const image::CanFrame& frame, image::Nanoseconds now) noexcept;
  /// Content that came since the last apply().
  bool pending() const noexcept { return pending_; }
  /// Moves the content into the dictionary; values out of an object's range are left out.
  void apply(ObjectDictionary& dictionary, PdoSink& sink) noexcept;

  /// The deadline :05 passed without a PDO since the last one.
  bool late(image::Nanoseconds now) const noexcept { return deadline_ > 0 && now > deadline_; }
  /// It was late, and is until the next frame.
  void note_late() noexcept {
    deadline_ = 0;
    overdue_ = true;
  }
  bool overdue() const noexcept { return overdue_; }
  /// Its last frame was too short.
  bool was_short() const noexcept { return was_short_; }
  /// Entering Operational: nothing has come yet.
  void start() noexcept {
    pending_ = overdue_ = was_short_ = false;
    deadline_ = 0;
  }

 private:
  MappedObjects objects_;
  bool valid_ = false, overdue_ = false, was_short_ = false;
  std::uint32_t id_ = 0;
  std::uint8_t type_ = 255;
  image::Nanoseconds timeout_ = 0, deadline_ = 0;
  bool pending_ = false;
  std::uint64_t content_ = 0;
};

/// One TPDO. real-time safe.
class TransmitPdo {
 public:
  void configure(const ObjectDictionary& dictionary, int number, image::Nanoseconds now) noexcept;
  bool valid() const noexcept { return valid_; }
  std::uint32_t id() const noexcept { return id_; }
  /// A remote request is answered: bit 30 of the COB-ID allows it, and type 252 has something to send.
  bool remote_allowed() const noexcept { return remote_allowed_ && (type_ != 252 || stored_once_); }
  bool event_driven() const noexcept { return valid_ && type_ >= 254; }

  /// Entering Operational: counters begin anew and an event-driven PDO is due.
  void start(image::Nanoseconds now) noexcept;
  /// SYNC with its counter (0: none). True: to be sent now. Type 252 stores what a remote request will get.
  bool due_at_sync(const ObjectDictionary& dictionary, std::uint8_t counter) noexcept;
  /// Every millisecond. True: an event or the event timer makes it due and the inhibit time is over.
  bool due_by_event(const ObjectDictionary& dictionary, PdoEvents& events, image::Nanoseconds now) noexcept;
  /// Samples and sends; of type 252 what the last SYNC has stored.
  void send(const ObjectDictionary& dictionary, image::CanBus& bus, image::Nanoseconds now) noexcept;

 private:
  std::uint64_t sample(const ObjectDictionary& dictionary) const noexcept;

  MappedObjects objects_;
  bool valid_ = false, remote_allowed_ = false, sent_once_ = false, stored_once_ = false;
  std::uint32_t id_ = 0;
  std::uint8_t type_ = 255, sync_start_ = 0, syncs_ = 0;
  bool waiting_for_start_ = false;
  image::Nanoseconds inhibit_ = 0, event_timer_ = 0, last_sent_ = 0;
  std::uint64_t last_content_ = 0, stored_ = 0;
};

}  // namespace servogate::canopen
