// SPDX-License-Identifier: Apache-2.0
// `servogate sim`: all simulated devices of a machine, for somebody else's controller.
#include <poll.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "drivers/clock.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/drive_desk.hpp"
#include "gateway/command/simulated/node_presence.hpp"
#include "gateway/command/simulated/sim_points.hpp"
#include "gateway/control/compose/can_transport.hpp"
#include "gateway/control/compose/simulated/machine_faults.hpp"
#include "machine/bus_place.hpp"

namespace servogate::gateway::command {

namespace {

using text::Entry;

const Entry kBadBus{"sim.bad-bus", "--bus {0}: expected NAME=URL with a bus of the machine file: {1}",
                    "--bus {0}: нужно ИМЯ=URL с шиной из файла станка: {1}"};
const Entry kInside{
    "sim.inside",
    "the bus '{0}' of the machine file is {1}, which nobody else can reach: --bus {0}=URL serves it "
    "elsewhere (`servogate can bus {0}` makes a bus)",
    "шина «{0}» в файле станка — {1}, снаружи она недоступна: --bus {0}=URL обслужит её в другом месте "
    "(шину создаёт `servogate can bus {0}`)"};
const Entry kLockstep{"sim.lockstep",
                      "sim keeps pace with the wall clock; {0} has granted time: use `servogate drive`",
                      "sim идёт по настенным часам; у {0} выдаваемое время: для неё `servogate drive`"};
const Entry kNoBuses{"sim.no-buses", "the machine file has no CAN bus", "в файле станка нет шины CAN"};
const Entry kOneWire{"sim.one-wire", "the buses '{0}' and '{1}' would be one wire, {2}: each needs its own",
                     "шины «{0}» и «{1}» оказались бы одним проводом, {2}: каждой нужен свой"};
const Entry kServes{"sim.serves", "{0}: {1} simulated drives on {2}",
                    "{0}: имитируемых приводов на {2}: {1}"};
const Entry kNotServed{"sim.not-served",
                       "station {0} can be reached by nobody outside; its switches are told here",
                       "станция {0} снаружи недоступна; её датчики сообщаются здесь"};
const Entry kGone{"sim.gone", "the bus {0} is gone", "шина {0} исчезла"};

/// A bus of the machine and where it is served.
struct Served {
  std::size_t index;
  std::string name, url;
  std::uint32_t bit_rate;
  std::vector<int> nodes;
  CanTransport transport;
  std::optional<TwinWatch> twins;
  std::vector<image::CanFrame> waiting;     ///< for the bus outside
  std::optional<image::CanFrame> entering;  ///< the wire inside is full
};

/// The url of each bus after --bus; false: wrong, which has been said.
bool find_urls(const SimOptions& options, machine::MachineConfig& m, std::vector<Served>& buses) {
  std::string names;
  for (const machine::BusConfig& b : m.buses) names += (names.empty() ? "" : ", ") + b.name;
  for (const std::string& word : options.buses) {
    const std::size_t equals = word.find('=');
    const auto bus = std::find_if(m.buses.begin(), m.buses.end(), [&](const auto& b) {
      return equals != std::string::npos && b.name == word.substr(0, equals);
    });
    if (bus == m.buses.end()) {
      complain(kBadBus, {word, names});
      return false;
    }
    bus->url = word.substr(equals + 1);
  }
  for (std::size_t i = 0; i < m.buses.size(); ++i) {
    machine::BusConfig& b = m.buses[i];
    if (b.mock()) complain(kInside, {b.name, b.url});
    if (b.lockstep()) complain(kLockstep, {b.url});
    if (b.mock() || b.lockstep()) return false;
    for (const Served& other : buses) {
      if (!machine::same_bus(other.url, b.url)) continue;
      complain(kOneWire, {other.name, b.name, b.url});
      return false;
    }
    buses.push_back({i, b.name, b.url, static_cast<std::uint32_t>(b.bit_rate), {}, {}, {}, {}, {}});
    for (const machine::NodeConfig& node : b.nodes) buses.back().nodes.push_back(node.id);
    // Inside, the drives live on a simulated wire as in a control of their own.
    b.url = "mock:" + b.name;
  }
  if (buses.empty()) complain(kNoBuses, {});
  return !buses.empty();
}

/// kDone, or the exit code after saying what is wrong.
int open_buses(std::vector<Served>& buses, bool as_json, const EndBySignal& signals) {
  for (Served& b : buses) {
    CanTransportOptions options;
    options.bit_rate = b.bit_rate;
    drivers::Notice why;
    auto opened = open_can(b.url, options, why);
    if (!opened) {
      complain(*why.entry, why.arguments);
      return kInfrastructure;
    }
    b.transport = std::move(*opened);
    if (const int code = may_join(b.transport, b.url, b.nodes, true, signals); code != kDone) return code;
    b.twins.emplace(b.url, [nodes = b.nodes](int node) {
      return std::find(nodes.begin(), nodes.end(), node) != nodes.end();
    });
    tell(text::render(kServes, std::vector<std::string>{b.name, std::to_string(b.nodes.size()), b.url},
                      text::user_language()));
    if (as_json) print_json_line({{"event", "serving"}, {"bus", b.name}, {"url", b.url}, {"nodes", b.nodes}});
  }
  return kDone;
}

/// Carries frames between a bus outside and the simulated wire of the same name. None is dropped: what the
/// other side has no room for waits, and meanwhile the transport keeps (and counts) what comes.
void carry(Served& b, image::CanBus& inside) {
  image::CanFrame frame;
  while (b.entering || b.transport.bus->receive(frame)) {
    if (b.entering)
      frame = *b.entering;
    else
      b.twins->hear(frame);
    b.entering.reset();
    if (frame.error || frame.fd) continue;  // classic devices hear no FD frame
    if (inside.send(frame)) continue;
    b.entering = frame;
    break;
  }
  while (inside.receive(frame)) b.waiting.push_back(frame);
  std::size_t sent = 0;
  while (sent < b.waiting.size() && b.transport.bus->send(b.waiting[sent])) ++sent;
  b.waiting.erase(b.waiting.begin(), b.waiting.begin() + static_cast<std::ptrdiff_t>(sent));
}

int serve(const SimOptions& options, const machine::LoadResult& loaded, std::vector<Served>& buses,
          DriveDesk& desk, const EndBySignal& signals) {
  constexpr image::Nanoseconds kShortest = 50 * image::kMicrosecond;
  const auto made = simulated_world(loaded);
  mock::World& world = *made;
  MachineFaults faults(loaded.machine, world, false);
  desk.set_devices([&](const DriveDeed& deed, std::string& why) {
    using Kind = DriveDeed::Kind;
    if (deed.kind == Kind::fault) return faults.inject(deed.device, deed.fault, why);
    return faults.clear(deed.device, deed.kind == Kind::clear ? std::optional(deed.fault.kind) : std::nullopt,
                        why);
  });
  SimPoints points(loaded.machine, world, options.json);
  std::vector<mock::SimulatedDrive*> drives;
  for (const machine::BusConfig& bus : loaded.machine.buses)
    for (const machine::NodeConfig& node : bus.nodes)
      if (mock::SimulatedDrive* d = world.drive(bus.name + "." + node.name)) drives.push_back(d);
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  std::vector<pollfd> polled(buses.size() + 1);
  std::vector<bool> heard(buses.size());
  while (!signals.ended()) {
    // The simulated world begins at zero.
    const image::Nanoseconds now = drivers::clock_ns(CLOCK_MONOTONIC) - start;
    for (Served& b : buses) carry(b, *world.bus(b.index));
    faults.advance_to(now);
    world.advance_to(now);
    for (Served& b : buses) carry(b, *world.bus(b.index));
    desk.advance(now, drives, [&](const std::string& line) { return points.play(line, now); });
    points.look(now);
    for (std::size_t i = 0; i < buses.size(); ++i) {
      const bool down = buses[i].transport.bus->state() == image::CanState::down;
      if (down && heard[i] && buses[i].url.starts_with("socketcand:")) {
        complain(kGone, {buses[i].url});
        return kInfrastructure;
      }
      heard[i] = heard[i] || !down;
      polled[i] = {buses[i].transport.descriptor, POLLIN, 0};
    }
    polled.back() = {desk.descriptor(), POLLIN, 0};
    const timespec limit{0, kShortest};
    ppoll(polled.data(), polled.size(), &limit, nullptr);
  }
  return kDone;
}

}  // namespace

int sim(const SimOptions& options) {
  machine::LoadResult loaded = machine::load(options.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  std::vector<Served> buses;
  if (!find_urls(options, loaded.machine, buses)) return kWrongUse;
  std::vector<int> nodes;
  for (const Served& b : buses) nodes.insert(nodes.end(), b.nodes.begin(), b.nodes.end());
  auto deeds = read_deeds(options.faults, nodes);
  if (!deeds) return kWrongUse;
  const EndBySignal signals;
  int code = open_buses(buses, options.json, signals);
  if (code != kDone) return code;
  for (const machine::StationConfig& s : loaded.machine.stations)
    if (!s.over_bus() && s.mock())
      tell(text::render(kNotServed, std::vector<std::string>{s.name}, text::user_language()));
  DriveDesk desk(std::move(*deeds), true, options.json);
  code = serve(options, loaded, buses, desk, signals);
  for (const Served& b : buses) code = unless_frames_lost(code, b.url, *b.transport.bus);
  return code;
}

}  // namespace servogate::gateway::command
