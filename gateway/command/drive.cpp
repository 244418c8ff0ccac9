// SPDX-License-Identifier: Apache-2.0
#include <poll.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "drivers/clock.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/named_bus.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/compose/can_transport.hpp"
#include "gateway/compose/simulated_node.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kLives{"drive.lives", "node {0} on {1}: {2}", "узел {0} на {1}: {2}"};
const text::Entry kNoDevice{"drive.no-device", "there is no device file {0}.toml in {1}",
                            "нет файла устройства {0}.toml в {1}"};
const text::Entry kNoNode{"drive.no-node", "{0} has no node {1}", "на шине {0} нет узла {1}"};
const text::Entry kGone{"drive.gone", "the bus {0} is gone", "шина {0} исчезла"};
const text::Entry kDeviceTwice{"drive.device-twice", "the nodes of a machine file have their devices from it",
                               "узлы файла станка берут устройства из него"};

/// What is to be simulated, and where.
struct Plan {
  std::string url;
  std::uint32_t bit_rate = 0;
  std::vector<mock::SimulatedDriveConfig> drives;
};

int plan_from_machine(const DriveOptions& options, const NamedBus& named, Plan& plan) {
  if (!options.device.empty()) {
    complain(kDeviceTwice, {});
    return kWrongUse;
  }
  const machine::BusConfig& bus = named.machine->machine.buses[named.index];
  for (const int id : options.nodes) {
    const auto node =
        std::find_if(bus.nodes.begin(), bus.nodes.end(), [id](const auto& n) { return n.id == id; });
    if (node == bus.nodes.end()) {
      complain(kNoNode, {options.bus, std::to_string(id)});
      return kWrongUse;
    }
    plan.drives.push_back(simulated_node(*named.machine, bus, *node));
  }
  return kDone;
}

int plan_from_url(const DriveOptions& options, Plan& plan) {
  machine::DeviceResult device;
  if (!options.device.empty()) {
    std::string found, looked;
    for (const std::string& folder : machine::device_folders()) {
      const std::string path = folder + "/" + options.device + ".toml";
      if (found.empty() && std::filesystem::exists(path)) found = path;
      looked += (looked.empty() ? "" : ", ") + folder;
    }
    if (found.empty()) {
      complain(kNoDevice, {options.device, looked});
      return kWrongUse;
    }
    device = machine::load_device(found);
    if (print_findings(device.findings) > 0) return kWrongUse;
  }
  for (const int id : options.nodes)
    plan.drives.push_back(simulated_device(options.device.empty() ? nullptr : &device.device, id));
  return kDone;
}

/// Several drives behind one connection to a bus: each hears everything, none hears the others.
class Drives {
 public:
  Drives(const Plan& plan, image::CanBus& bus, image::Nanoseconds now) : bus_(bus) {
    for (const mock::SimulatedDriveConfig& config : plan.drives) {
      drives_.push_back(std::make_unique<mock::SimulatedDrive>(config));
      drives_.back()->connect(bus, now);
    }
  }
  void advance_to(image::Nanoseconds now) {
    image::CanFrame frame;
    while (bus_.receive(frame)) {
      frame.timestamp_ns = std::min(frame.timestamp_ns, now);
      for (const auto& drive : drives_) drive->on_frame(frame);
    }
    for (const auto& drive : drives_) drive->advance_to(now);
  }
  image::Nanoseconds next_action_ns() const {
    image::Nanoseconds next = drives_.front()->next_action_ns();
    for (const auto& drive : drives_) next = std::min(next, drive->next_action_ns());
    return next;
  }

 private:
  image::CanBus& bus_;
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives_;
};

int live_in_lockstep(const Plan& plan, usercan::SocketcandBus& bus, const EndBySignal& signals) {
  auto now = bus.wait_grant();
  if (!now) return kDone;
  Drives drives(plan, bus, *now);
  for (; now && !signals.ended(); now = bus.wait_grant()) {
    drives.advance_to(*now);
    bus.done(std::max(drives.next_action_ns(), *now + 1));
  }
  return kDone;
}

int live(const Plan& plan, const CanTransport& transport, const EndBySignal& signals) {
  // Loops and mechanics catch up when a frame comes or the drive itself wants to speak.
  constexpr image::Nanoseconds kShortest = 50 * image::kMicrosecond, kLongest = image::kMillisecond;
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  Drives drives(plan, *transport.bus, start);
  bool heard = transport.bus->state() != image::CanState::down;
  while (!signals.ended()) {
    drives.advance_to(drivers::clock_ns(CLOCK_MONOTONIC));
    const bool down = transport.bus->state() == image::CanState::down;
    // An interface comes back; a server does not.
    if (down && heard && plan.url.starts_with("socketcand:")) {
      complain(kGone, {plan.url});
      return kInfrastructure;
    }
    heard = heard || !down;
    pollfd p{transport.descriptor, POLLIN, 0};
    const image::Nanoseconds quiet = drives.next_action_ns() - drivers::clock_ns(CLOCK_MONOTONIC);
    const timespec limit{0, std::clamp(quiet, kShortest, kLongest)};
    ppoll(&p, 1, &limit, nullptr);
  }
  return kDone;
}

}  // namespace

int drive(const DriveOptions& options) {
  const auto named = named_bus(options.bus, options.bit_rate);
  if (!named) return kWrongUse;
  Plan plan{named->url, named->bit_rate, {}};
  if (const int code =
          named->machine ? plan_from_machine(options, *named, plan) : plan_from_url(options, plan);
      code != kDone)
    return code;
  const EndBySignal signals;
  CanTransportOptions transport_options;
  transport_options.bit_rate = plan.bit_rate;
  for (const int node : options.nodes) transport_options.participant += "node" + std::to_string(node);
  drivers::Notice why;
  const auto transport = open_can(plan.url, transport_options, why);
  if (!transport) {
    complain(*why.entry, why.arguments);
    return kInfrastructure;
  }
  for (const mock::SimulatedDriveConfig& d : plan.drives)
    std::fprintf(stderr, "%s\n",
                 text::render(kLives, std::vector<std::string>{std::to_string(d.node_id), plan.url, d.name},
                              text::user_language())
                     .c_str());
  if (transport->lockstep != nullptr) return live_in_lockstep(plan, *transport->lockstep, signals);
  return live(plan, *transport, signals);
}

}  // namespace servogate::gateway::command
