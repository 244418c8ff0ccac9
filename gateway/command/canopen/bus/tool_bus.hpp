// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/inspect/sdo_access.hpp"
#include "gateway/cli/bus_options.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/compose/can_transport.hpp"

namespace servogate::gateway::command {

using canopen::SdoAccess;
using canopen::SdoOutcome;

/// A bus as a command line tool uses it: opened for this command, waiting for answers, in the computer's
/// time, or in lockstep in the time that is granted. Not real-time safe.
class ToolBus final : public SdoAccess {
 public:
  /// nullptr: refused, which has been said; `code` is the exit code then.
  static std::unique_ptr<ToolBus> open(const CanopenBusOptions& options, int& code);

  const std::string& url() const noexcept { return url_; }
  const CanTransport& transport() const noexcept { return transport_; }
  /// bit/s; 1 Mbit/s where the bus has no rate of its own.
  std::uint32_t bit_rate() const noexcept;

  /// Sees every frame that comes. True ends the waiting.
  using Handler = std::function<bool(const image::CanFrame&)>;
  /// Receives for at most `at_most`, less when a signal ends the command or the bus is gone. True: the
  /// handler ended it.
  bool listen(image::Nanoseconds at_most, const Handler& handler);
  /// Monotonic, of the computer or as granted.
  image::Nanoseconds now() const;
  /// Waits until then and leaves what comes meanwhile to be received. False: the bus is gone.
  bool wait_until(image::Nanoseconds t);
  /// From here on a signal ends no waiting: what has to be put in order is.
  void ignore_signals() noexcept { signals_count_ = false; }
  /// Waits until the bus takes the frame. False: it takes none (down, bus-off), or a signal came.
  bool send(const image::CanFrame& frame);
  /// The bus is down, its server has ended, or a signal came: go no further.
  bool over() const;
  bool gone() const { return time_ended_ || transport_.bus->state() == image::CanState::down; }
  bool ended() const noexcept { return signals_.ended(); }

  SdoOutcome read(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex) override;
  SdoOutcome write(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex,
                   std::span<const std::uint8_t> data) override;

  /// At the end of a command: kInfrastructure, said, when the bus is gone or lost frames; kStopped after a
  /// signal; otherwise `code`.
  int finish(int code) const;

 private:
  ToolBus(std::string url, CanTransport transport, const CanopenBusOptions& options);
  void pause(image::Nanoseconds until);
  canopen::SdoClient& client(canopen::NodeId node);
  canopen::SdoStatus run(canopen::NodeId node);

  std::string url_;
  CanTransport transport_;
  EndBySignal signals_;
  bool signals_count_ = true;
  bool time_ended_ = false;  ///< of lockstep
  image::Nanoseconds timeout_;
  bool blocks_;
  std::array<std::optional<canopen::SdoClient>, canopen::kMaxNode + 1> clients_;
};

}  // namespace servogate::gateway::command
