// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/canopen/302/boot_step.hpp"
#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/402/drive_profile.hpp"

namespace servogate::canopen {

/// One thing to do while a node boots.
struct BootAction {
  enum class Kind : std::uint8_t {
    reset,          ///< NMT reset communication, then wait for the boot-up message
    write,          ///< download `value`
    read,           ///< upload; keep it in `keep`, compare it under `mask` (0: any value is right)
    read_text,      ///< upload a string and compare it with `data`
    jump_if_equal,  ///< upload; equal to `value`: leave out `jump` actions. A missing object is another value
    jump_unless_equal,  ///< the same where it is not equal
    find_in_list,   ///< upload sub-index 0 and then the entries of an array until one is `value`; without the
                    ///< object nothing is looked for
    await_flash,    ///< upload the flash status until it is no longer at work, and see that it has no error
    await_boot_up,  ///< wait for the boot-up message
    await_sync,     ///< wait until SYNC runs, see SegmentConfig::sync_counter_overflow
    start,          ///< NMT start, then wait for a heartbeat with state Operational
  };
  /// Where a read value goes.
  enum class Keep : std::uint8_t {
    nothing,
    device_type,
    vendor_id,
    product_code,
    revision,
    serial,
    error_code
  };

  Kind kind = Kind::write;
  BootStep step = BootStep::settings;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 0;  ///< of the object: 1, 2 or 4
  std::uint32_t value = 0;
  std::uint32_t mask = 0;
  bool optional = false;  ///< "object (or subindex) does not exist" is no failure
  Keep keep = Keep::nothing;
  std::vector<std::uint8_t> data = {};  ///< write: instead of `value`, any length
  std::uint16_t jump = 0;
};

/// The boot of one node as a list: identity first, then configuration with every value read back, then
/// start. PDOs are written in the order of CiA 301, 7.5.2.36: switch off, count 0, entries, count,
/// communication, switch on. Not real-time safe.
std::vector<BootAction> boot_plan(const NodeConfig& node, const SegmentConfig& segment);

/// Value and exponent of 60C2h for a cycle: value * 10^exponent seconds, value at most 255. Starts at the
/// drive's base exponent and takes a finer one where that cannot hold the cycle (0.5 ms: 5 * 10^-4). False:
/// no exponent does.
bool interpolation_time(image::Nanoseconds cycle_ns, std::int8_t base, std::uint8_t& value,
                        std::int8_t& exponent);

}  // namespace servogate::canopen
