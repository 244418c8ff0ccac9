// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/open_bus.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNoBus{"compose.no-bus", "bus '{0}': {1}", "шина «{0}»: {1}"};
const text::Entry kPerhapsReal{
    "compose.perhaps-real",
    "bus '{0}' is said to be simulated, but a real one may be behind '{1}': leave `simulated` out, and the "
    "machine waits for its operator",
    "шина «{0}» объявлена имитацией, но за «{1}» может быть настоящая: уберите `simulated`, и станок будет "
    "ждать оператора"};

}  // namespace

std::optional<CanTransport> open_bus(const machine::MachineConfig& machine, std::size_t bus,
                                     std::vector<text::Finding>& findings) {
  const machine::BusConfig& b = machine.buses[bus];
  std::vector<int> nodes;
  for (const machine::NodeConfig& node : b.nodes) nodes.push_back(node.id);
  drivers::Notice why;
  auto opened =
      open_can(b.url, {static_cast<std::uint32_t>(b.bit_rate), false, master_filters(nodes), "control"}, why);
  const machine::Where where = machine.where("bus." + std::to_string(bus) + ".url");
  const auto refuse = [&](const text::Entry& entry, const std::string& text) {
    findings.push_back(
        {text::Severity::error, machine.file, where.line, where.column, &entry, {b.name, text}, {}});
    return std::nullopt;
  };
  if (!opened)
    return refuse(kNoBus, text::both(why.str(text::Language::english), why.str(text::Language::russian)));
  if (b.nothing_real() && !opened->nothing_real) return refuse(kPerhapsReal, b.url);
  return opened;
}

bool bus_not_opened(const text::Finding& finding) { return finding.entry == &kNoBus; }

void probe_buses(const machine::MachineConfig& machine, std::vector<text::Finding>& findings) {
  for (std::size_t b = 0; b < machine.buses.size(); ++b)
    if (machine.buses[b].url.starts_with("socketcan:")) open_bus(machine, b, findings);
}

}  // namespace servogate::gateway
