// SPDX-License-Identifier: Apache-2.0
// Spindles that follow the angle of another one, and by what angle threads go.
#include <string>
#include <vector>

#include "machine/check/check.hpp"
#include "machine/check/findings_io.hpp"

namespace servogate::machine {

void check_couplings(const MachineConfig& machine, Reading& reading) {
  for (std::size_t i = 0; i < machine.spindles.size(); ++i) {
    const SpindleConfig& s = machine.spindles[i];
    const std::string path = "spindle." + std::to_string(i) + ".", number = std::to_string(i + 1);
    const auto error = [&](const char* key, const text::Entry& entry, std::vector<std::string> arguments) {
      reading.error(machine.where(path + key), entry, std::move(arguments));
    };
    const SpindleConfig* leader = machine.spindle_of_process(s.process - 1);
    if (s.thread_master == ThreadMaster::setpoint) {
      if (leader != &s)
        error("thread_master", finding::kThreadMasterFirst, {number});
      else if (!s.has_encoder() || s.drive.empty())
        error("thread_master", finding::kThreadMasterEncoder, {number});
    }
    if (s.coupling == Coupling::none) {
      if (machine.places.contains(path + "coupling_window"))
        error("coupling_window", finding::kCouplingWindowAlone, {number});
      continue;
    }
    if (leader == nullptr || leader == &s) {
      error("coupling", finding::kCouplingFirst, {number});
      continue;
    }
    for (const SpindleConfig* one : {leader, &s})
      if (!one->has_encoder() || one->drive.empty())
        error("coupling", finding::kCouplingEncoder,
              {number, std::to_string(one - machine.spindles.data() + 1)});
  }
}

}  // namespace servogate::machine
