// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "gateway/control/server/socket/socket_client.hpp"

namespace servogate::gateway::command {

/// A running control that holds a bus or a line.
struct Holder {
  std::string socket;   ///< path of its control socket
  std::string machine;  ///< name of its machine
  std::string bus;      ///< name of the bus in its machine file
  bool run = false;     ///< it is a `servogate run`, which ends by itself
  /// It does not answer (it is stopped, in a debugger, or hangs), so that it cannot say whether it holds this
  /// bus: it counts as its holder. Only `socket` is known.
  bool silent = false;
  struct Node {
    int id = 0;
    std::string name;
    bool online = false;
    std::optional<canopen::NmtState> state;
  };
  std::vector<Node> nodes;
};

/// The running control or run of this user that holds this bus, however its url is written, or one that does
/// not answer; nullopt: none does.
std::optional<Holder> holder_of(const NamedBus& bus, int patience_ms = 2000);
/// The same for a bus as the command line names it; false with `code`: the name is wrong, which has been
/// said, or a control that does not answer may hold it. `at_once`: what takes energy away waits for no
/// control that does not answer, and is not refused for it.
bool find_holder(const std::string& bus, std::optional<Holder>& holder, int& code, bool at_once = false);
/// Says that the bus is held, and that `what` is not done therefore; the exit code.
int refuse_held(const Holder& holder, const std::string& url, const std::string& what);

/// Objects of the nodes of a held bus, read by the control that holds it; it writes none.
class HeldBus final : public SdoAccess {
 public:
  /// nullptr: it cannot be reached, which has been said.
  static std::unique_ptr<HeldBus> open(Holder holder, double timeout_ms);
  const Holder& holder() const noexcept { return holder_; }
  SdoOutcome read(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex) override;
  SdoOutcome write(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex,
                   std::span<const std::uint8_t> data) override;
  /// What the control said last instead of an answer of the node; empty: nothing.
  const std::string& refusal() const noexcept { return refusal_; }

 private:
  HeldBus(Holder holder, double timeout_ms) : holder_(std::move(holder)), timeout_ms_(timeout_ms) {}
  Holder holder_;
  double timeout_ms_;
  SocketClient connection_;
  std::string refusal_;
};

}  // namespace servogate::gateway::command
