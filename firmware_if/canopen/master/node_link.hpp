// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/master/process_data.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// What stands behind a node that runs: a drive or an I/O module, as its process data and the objects that go
/// over SDO. Everything is real-time safe.
class NodeLink {
 public:
  virtual ~NodeLink() = default;
  virtual ProcessData& process_data() noexcept = 0;
  /// The node has just become operational: everything known of it is void.
  virtual void restart() noexcept = 0;
  /// Evaluates what has come since the last cycle. True: no process data that should have come are missing.
  virtual bool update() noexcept = 0;
  /// Cycles in a row without true from update() after which the node is lost; 0: never.
  virtual std::int64_t missed_limit() const noexcept = 0;
  /// An emergency message of the node.
  virtual void on_emcy(std::uint16_t /*error_code*/) noexcept {}

  /// Starts the next SDO access that is due, if there is one. `sdo` must be idle.
  virtual void start_access(image::Nanoseconds /*now*/, SdoClient& /*sdo*/) noexcept {}
  /// Takes the result of the access started last. False when the node refused it or did not answer.
  virtual bool finish_access(const SdoClient& /*sdo*/) noexcept { return true; }
  virtual bool access_running() const noexcept { return false; }
  virtual std::uint16_t statusword() const noexcept { return 0; }
};

/// Cycles between two TPDOs of this kind; 0: they come when they like. real-time safe.
constexpr std::int64_t cycles_between(const PdoWanted& pdo, image::Nanoseconds cycle_ns) noexcept {
  if (pdo.transmission_type >= 1 && pdo.transmission_type <= 240) return pdo.transmission_type;
  return pdo.event_ms * image::kMillisecond / cycle_ns;
}

}  // namespace servogate::canopen
