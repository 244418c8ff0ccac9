// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>

#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/canopen/301/sdo_codec.hpp"
#include "firmware_if/canopen/302/boot_step.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/drive_link.hpp"

namespace servogate::canopen {

enum class BusEventKind : std::uint8_t {
  none,
  node_booted,        ///< all boot steps done, process data runs
  boot_failed,        ///< `boot` says the step, what was expected and what came
  emcy,               ///< `emcy`; error code 0: the error is gone
  error_history,      ///< 1003h:`pdo` has an error code (`emcy`) of which no message has come
  heartbeat_lost,     ///< no heartbeat for `got` ms, allowed are `expected`
  node_restarted,     ///< a boot-up message of a node that was running
  node_left,          ///< heartbeat shows another NMT state (`got`) than Operational
  pdo_missing,        ///< process data (TPDO `pdo`) missing for `got` cycles
  pdo_short,          ///< a TPDO with `got` bytes where `expected` are mapped (`frame`)
  sdo_failed,         ///< an object read or written while running: `boot.index`, `boot.abort`
  refused,            ///< the drive does not follow a transition: `refusal`, `statusword`
  handover_held,      ///< the command is `got` counts off the actual position at Operation enabled; target is
                      ///< held
  not_interpolating,  ///< in interpolated position mode the drive does not show bit 12 of the statusword for
                      ///< `got` ms, allowed are `expected`; `statusword`
  foreign_frame,      ///< somebody else leads nodes on the bus: NMT, SYNC, RPDO ... that we did not send
                      ///< (`frame`)
  foreign_request,    ///< somebody else asks a node of ours by SDO (`frame`)
  lead_lost,     ///< the control stood still for `got` ms, and another one leads the bus by `frame`: we are
                 ///< silent
  unknown_node,  ///< heartbeat or EMCY of a node that is not configured
  send_failed,  ///< the transmit queue was full `got` times since this was said last; `frame` was dropped, or
                ///< waits where the service repeats it
  bus_state,    ///< `bus_state` is the new one
};

/// Something that happened on a bus segment. Plain data, real-time safe to write and copy.
struct BusEvent {
  BusEventKind kind = BusEventKind::none;
  std::int16_t segment = 0;
  NodeId node = 0;  ///< 0: concerns the segment
  std::int64_t cycle = 0;
  image::Nanoseconds t_ns = 0;
  BootReport boot;
  Emcy emcy;
  std::uint16_t statusword = 0;
  image::DriveRefusal refusal;
  image::CanState bus_state = image::CanState::error_active;
  std::int64_t expected = 0;
  std::int64_t got = 0;
  std::uint8_t pdo = 0;  ///< 1-4; PdoWatch::kSdo; of error_history a sub-index
  struct {
    std::uint32_t id = 0;
    std::uint8_t length = 0;
    std::array<std::uint8_t, 8> data{};
  } frame;
};

/// Bounded ring, one writer (the cycle) and one reader (any other thread). A full ring drops the newest event
/// and counts it. Both ends are real-time safe.
class BusEventRing {
 public:
  static constexpr std::uint32_t kCapacity = 256;

  bool push(const BusEvent& event) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    events_[head % kCapacity] = event;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  bool pop(BusEvent& event) noexcept {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    event = events_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  /// Events dropped since the start.
  std::uint32_t lost() const noexcept { return lost_.load(std::memory_order_relaxed); }

 private:
  std::array<BusEvent, kCapacity> events_{};
  std::atomic<std::uint32_t> head_{0}, tail_{0}, lost_{0};
};

struct DriveProfile;

/// Key of the event's sentence in the text table ("can-heartbeat-lost"). real-time safe.
const text::Entry& bus_event_entry(const BusEvent& event) noexcept;

/// The event as a sentence that names node, object, what was expected and what came. `node_name` is how the
/// machine file calls the node; `profile` (may be null) knows the drive's own error texts. Not real-time
/// safe.
std::string describe(const BusEvent& event, std::string_view node_name, const DriveProfile* profile,
                     text::Language language);

/// The drive's own words for an error code, otherwise those of the standard. Not real-time safe.
std::string describe_error_code(std::uint16_t code, const DriveProfile* profile, text::Language language);

}  // namespace servogate::canopen
