// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bus/named_bus.hpp"

#include <algorithm>

#include "gateway/cli/messages.hpp"

namespace servogate::gateway::command {

namespace {
const text::Entry kNoBus{"can.no-bus", "{0} has no bus '{1}'", "в {0} нет шины «{1}»"};
}  // namespace

std::optional<NamedBus> named_bus(const std::string& name, double bit_rate) {
  NamedBus named{name, static_cast<std::uint32_t>(bit_rate), std::nullopt, 0};
  const std::size_t hash = name.rfind('#');
  if (hash == std::string::npos) return named;
  const std::string file = name.substr(0, hash), bus = name.substr(hash + 1);
  named.machine = machine::load(file);
  if (print_findings(named.machine->findings) > 0) return std::nullopt;
  const auto& buses = named.machine->machine.buses;
  const auto found = std::find_if(buses.begin(), buses.end(), [&](const auto& b) { return b.name == bus; });
  if (found == buses.end()) {
    complain(kNoBus, {file, bus});
    return std::nullopt;
  }
  named.index = static_cast<std::size_t>(found - buses.begin());
  named.url = found->url;
  named.bit_rate = static_cast<std::uint32_t>(found->bit_rate);
  return named;
}

}  // namespace servogate::gateway::command
