// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bus/lost_frames.hpp"

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kLost{"can.lost",
                        "bus {0}: {1} frames were lost on this computer; what was seen here says nothing",
                        "шина {0}: на этом компьютере потеряно кадров: {1}; по увиденному судить нельзя"};

int judge(int code, const std::string& bus, std::uint64_t lost) {
  if (lost == 0) return code;
  complain(kLost, {bus, std::to_string(lost)});
  return kInfrastructure;
}

}  // namespace

int unless_frames_lost(int code, const std::string& bus, const image::CanBus& transport) {
  return judge(code, bus, transport.lost());
}

int unless_frames_lost(int code, const Control& control) {
  for (std::size_t b = 0; b < control.machine().buses.size(); ++b)
    code = judge(code, "'" + control.machine().buses[b].name + "'", control.frames_lost(b));
  return code;
}

}  // namespace servogate::gateway::command
