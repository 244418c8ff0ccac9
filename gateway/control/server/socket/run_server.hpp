// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "gateway/control/compose/control.hpp"
#include "gateway/control/server/socket/line_server.hpp"

namespace servogate::gateway {

/// The socket of a `servogate run`: it says who holds the buses and reads objects of their nodes (`buses`,
/// `sdo_read`); everything else is refused. So a tool reads a bus through the run instead of speaking between
/// its frames.
class RunServer final : public LineServer {
 public:
  /// Others can reach a bus of this machine: the run has to say that it holds it.
  static bool needed(const machine::MachineConfig& machine);

  RunServer(Control& control, std::string path) : LineServer(std::move(path)), control_(control) {}
  ~RunServer() override { stop(); }

 private:
  std::optional<std::string> answer(std::string_view line, Connection& connection,
                                    const LinePlace& place) override;

  Control& control_;
  image::ProcessImage image_;
};

}  // namespace servogate::gateway
