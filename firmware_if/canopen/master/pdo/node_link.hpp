// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/master/pdo/pdo_watch.hpp"
#include "firmware_if/canopen/master/pdo/process_data.hpp"
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
  /// Which of them are missing, and for how long.
  virtual PdoWatch::Overdue overdue() const noexcept = 0;
  /// An emergency message of the node.
  virtual void on_emcy(std::uint16_t /*error_code*/) noexcept {}

  /// Starts the next SDO access that is due, if there is one. `sdo` must be idle.
  virtual void start_access(image::Nanoseconds /*now*/, SdoClient& /*sdo*/) noexcept {}
  /// Takes the result of the access started last. False when the node refused it or did not answer.
  virtual bool finish_access(const SdoClient& /*sdo*/) noexcept { return true; }
  virtual bool access_running() const noexcept { return false; }
  virtual std::uint16_t statusword() const noexcept { return 0; }
};

}  // namespace servogate::canopen
