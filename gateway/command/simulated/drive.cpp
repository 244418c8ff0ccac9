// SPDX-License-Identifier: Apache-2.0
// `servogate drive`: simulated drives on a bus, as a process of their own.
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "drivers/clock.hpp"
#include "drivers/mock/drive/device_objects.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/canopen/data_sheet.hpp"
#include "gateway/command/canopen/sheet_file.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/drive_desk.hpp"
#include "gateway/command/simulated/fault_line.hpp"
#include "gateway/command/simulated/node_presence.hpp"
#include "gateway/command/simulated/switch_option.hpp"
#include "gateway/control/compose/can_transport.hpp"
#include "gateway/control/compose/simulated/drive_kind.hpp"
#include "gateway/control/compose/simulated/simulated_node.hpp"
#include "machine/files/output_files.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kLives{"drive.lives", "node {0} on {1}: {2}", "узел {0} на {1}: {2}"};
const text::Entry kNoDevice{"drive.no-device", "there is no device file {0}.toml in {1}",
                            "нет файла устройства {0}.toml в {1}"};
const text::Entry kNoNode{"drive.no-node", "{0} has no node {1}", "на шине {0} нет узла {1}"};
const text::Entry kGone{"drive.gone", "the bus {0} is gone", "шина {0} исчезла"};
const text::Entry kDeviceTwice{"drive.device-twice", "the nodes of a machine file have their devices from it",
                               "узлы файла станка берут устройства из него"};
const text::Entry kNoProfile{"drive.no-profile",
                             "--profile '{0}' is none of {1}, and no data sheet (FILE.eds)",
                             "--profile «{0}»: нет среди {1}, и это не файл описания (FILE.eds)"};
const text::Entry kNoPlantKey{"drive.no-plant-key", "--plant {0}: expected KEY=VALUE; keys: {1}",
                              "--plant {0}: нужно КЛЮЧ=ЗНАЧЕНИЕ; ключи: {1}"};
const text::Entry kPlantRange{"drive.plant-range", "--plant {0}: {1} is {2} to {3} {4}",
                              "--plant {0}: {1} — от {2} до {3} {4}"};
const text::Entry kNoSwitch{
    "drive.no-switch",
    "--switch {0}: expected INPUT=FROM..TO in revolutions, as home=1.5..2 or positive_limit=3..; inputs: {1}",
    "--switch {0}: нужно ВХОД=ОТ..ДО в оборотах, например home=1.5..2 или positive_limit=3..; входы: {1}"};
const text::Entry kOtherNode{
    "drive.other-node",
    "{0} is the configuration of node {1}: node {2} takes its values; COB-IDs that follow from the node-ID: "
    "{3}",
    "{0} — настройка узла {1}: узел {2} берёт её значения; COB-ID, следующих за номером узла: {3}"};
const text::Entry kLeftOut{"drive.left-out", "{0}: left out, as it cannot be simulated: {1}",
                           "{0}: пропущено, имитировать нельзя: {1}"};
const text::Entry kOneEds{"drive.one-eds", "--write-eds is for one node; --node has {0}",
                          "--write-eds — для одного узла, а в --node их {0}"};
const text::Entry kMoreLeftOut{"drive.more-left-out", " and {0} more", " и ещё {0}"};

/// What is to be simulated, and where.
struct Plan {
  std::string url;
  std::uint32_t bit_rate = 0;
  std::vector<mock::SimulatedDriveConfig> drives;
};

int plan_from_machine(const DriveOptions& options, const NamedBus& named, Plan& plan) {
  if (!options.device.empty() || !options.profile.empty()) {
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

/// FILE.eds or FILE.dcf, as opposed to the name of a kind.
bool is_sheet(const std::string& profile) { return profile.find('.') != std::string::npos; }

/// A DCF is of one node; others get its values with COB-IDs of their own.
void say_other_node(const DriveOptions& options, canopen::Eds& sheet) {
  const int following = canopen::follow_node(sheet);
  const int of = sheet.commissioning ? sheet.commissioning->node : 0;
  for (const int id : options.nodes)
    if (of != 0 && id != of)
      complain(kOtherNode,
               {options.profile, std::to_string(of), std::to_string(id), std::to_string(following)});
}

int plan_from_profile(const DriveOptions& options, Plan& plan) {
  std::shared_ptr<const canopen::Eds> sheet;
  if (is_sheet(options.profile)) {
    auto read = read_data_sheet(options.profile);
    if (!read) return kWrongUse;
    say_other_node(options, *read);
    sheet = std::make_shared<const canopen::Eds>(std::move(*read));
  }
  for (const int id : options.nodes) {
    auto drive = sheet != nullptr ? drive_of_sheet(sheet, id) : drive_kind(options.profile, id);
    if (!drive) {
      complain(kNoProfile, {options.profile, drive_kinds()});
      return kWrongUse;
    }
    plan.drives.push_back(std::move(*drive));
  }
  return kDone;
}

/// KEY=VALUE,... of every --plant, for all drives.
int apply_plant(const DriveOptions& options, Plan& plan) {
  for (const std::string& word : options.plant) {
    const std::size_t equals = word.find('=');
    const PlantKey* key = equals == std::string::npos ? nullptr : plant_key(word.substr(0, equals));
    if (key == nullptr) {
      complain(kNoPlantKey, {word, plant_keys()});
      return kWrongUse;
    }
    double value = 0.0;
    const char* end = word.data() + word.size();
    const auto [at, error] = std::from_chars(word.data() + equals + 1, end, value);
    if (error != std::errc{} || at != end || !(value >= key->min && value <= key->max)) {
      complain(kPlantRange, {word, std::string(key->key), text::number(key->min, 9),
                             text::number(key->max, 9), std::string(key->unit)});
      return kWrongUse;
    }
    for (mock::SimulatedDriveConfig& drive : plan.drives) key->set(drive.plant, value);
  }
  return kDone;
}

/// INPUT=FROM..TO of every --switch, for all drives, once their encoders are known.
int apply_switches(const DriveOptions& options, Plan& plan) {
  for (const std::string& word : options.switches) {
    const auto place = parse_switch(word);
    if (!place) {
      complain(kNoSwitch, {word, drive_input_names()});
      return kWrongUse;
    }
    for (mock::SimulatedDriveConfig& drive : plan.drives)
      drive.switches.push_back(place->at(drive.plant.counts_per_rev));
  }
  return kDone;
}

/// --pdo-map, for all drives.
void apply_map_access(const DriveOptions& options, Plan& plan) {
  using enum canopen::MapAccess;
  constexpr std::pair<std::string_view, canopen::MapAccess> kNames[] = {
      {"variable", variable}, {"whole", whole}, {"fixed", fixed}};
  for (const auto& [name, access] : kNames)
    if (name == options.pdo_map)
      for (mock::SimulatedDriveConfig& drive : plan.drives) drive.map_access = access;
}

int plan_from_url(const DriveOptions& options, Plan& plan) {
  if (!options.profile.empty()) return plan_from_profile(options, plan);
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
  Drives(const Plan& plan, image::CanBus& bus, image::Nanoseconds now, DriveDesk& desk)
      : bus_(bus), desk_(desk), start_(now), twins_(plan.url, [this](int node) { return has(node); }) {
    for (const mock::SimulatedDriveConfig& config : plan.drives) {
      drives_.push_back(std::make_unique<mock::SimulatedDrive>(config));
      drives_.back()->connect(bus, now);
      all_.push_back(drives_.back().get());
    }
  }
  /// Objects of the data sheet that no drive can have.
  const std::vector<mock::ObjectPlace>& left_out() const { return drives_.front()->left_out(); }
  void advance_to(image::Nanoseconds now) {
    image::CanFrame frame;
    while (bus_.receive(frame)) {
      frame.timestamp_ns = std::min(frame.timestamp_ns, now);
      twins_.hear(frame);
      for (const auto& drive : drives_) drive->on_frame(frame);
    }
    for (const auto& drive : drives_) drive->advance_to(now);
    desk_.advance(now - start_, all_);
  }
  image::Nanoseconds next_action_ns() const {
    image::Nanoseconds next = drives_.front()->next_action_ns();
    for (const auto& drive : drives_) next = std::min(next, drive->next_action_ns());
    return next;
  }

 private:
  bool has(int node) const {
    return std::any_of(drives_.begin(), drives_.end(),
                       [node](const auto& d) { return d->node_id() == node; });
  }

  image::CanBus& bus_;
  DriveDesk& desk_;
  image::Nanoseconds start_;
  TwinWatch twins_;
  std::vector<std::unique_ptr<mock::SimulatedDrive>> drives_;
  std::vector<mock::SimulatedDrive*> all_;
};

void say_left_out(const DriveOptions& options, const Drives& drives) {
  constexpr std::size_t kNamed = 20;
  const auto& places = drives.left_out();
  if (places.empty()) return;
  std::string names;
  for (std::size_t i = 0; i < places.size() && i < kNamed; ++i)
    names += (i > 0 ? ", " : "") + canopen::address_text(places[i].index, places[i].subindex);
  if (places.size() > kNamed)
    names += text::render(kMoreLeftOut, std::vector<std::string>{std::to_string(places.size() - kNamed)},
                          text::user_language());
  complain(kLeftOut, {options.profile, names});
  if (!options.json) return;
  nlohmann::json objects = nlohmann::json::array();
  for (const mock::ObjectPlace& p : places) objects.push_back(canopen::address_text(p.index, p.subindex));
  print_json_line({{"event", "left_out"}, {"profile", options.profile}, {"objects", objects}});
}

int live_in_lockstep(const DriveOptions& options, const Plan& plan, usercan::SocketcandBus& bus,
                     DriveDesk& desk, const EndBySignal& signals) {
  auto now = bus.wait_grant();
  if (!now) return kDone;
  Drives drives(plan, bus, *now, desk);
  say_left_out(options, drives);
  for (; now && !signals.ended(); now = bus.wait_grant()) {
    drives.advance_to(*now);
    bus.done(std::max(drives.next_action_ns(), *now + 1), usercan::LockstepWake::frames);
  }
  return kDone;
}

int live(const DriveOptions& options, const Plan& plan, const CanTransport& transport, DriveDesk& desk,
         const EndBySignal& signals) {
  // Loops and mechanics catch up when a frame comes or the drive itself wants to speak.
  constexpr image::Nanoseconds kShortest = 50 * image::kMicrosecond, kLongest = image::kMillisecond;
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  Drives drives(plan, *transport.bus, start, desk);
  say_left_out(options, drives);
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
    pollfd p[] = {{transport.descriptor, POLLIN, 0}, {desk.descriptor(), POLLIN, 0}};
    const image::Nanoseconds quiet = drives.next_action_ns() - drivers::clock_ns(CLOCK_MONOTONIC);
    const timespec limit{0, std::clamp(quiet, kShortest, kLongest)};
    ppoll(p, 2, &limit, nullptr);
  }
  return kDone;
}

/// Whether the file of --write-eds can be asked for.
int check_eds_file(const DriveOptions& options) {
  if (options.write_eds.empty()) return kDone;
  if (options.nodes.size() != 1) {
    complain(kOneEds, {std::to_string(options.nodes.size())});
    return kWrongUse;
  }
  const auto problem = files::problem_of_outputs(
      {{"--write-eds", options.write_eds}},
      {{"--profile", is_sheet(options.profile) ? options.profile : ""}, {"--script", options.faults.script}});
  if (!problem) return kDone;
  complain(*problem->entry, problem->arguments);
  return problem->wrong_use ? kWrongUse : kInfrastructure;
}

int write_eds(const DriveOptions& options, const mock::SimulatedDriveConfig& config) {
  canopen::SheetOrigin origin = sheet_origin(options.write_eds, "servogate drive");
  origin.node = config.node_id;
  const mock::DeviceObjects objects = mock::device_objects(config);
  return write_sheet(options.write_eds,
                     canopen::sheet_of_rows(objects.rows, objects.hidden, config.data_sheet.get(), origin),
                     config.node_id);
}

}  // namespace

int drive(const DriveOptions& options) {
  if (!each_once(options.nodes)) return kWrongUse;
  if (const int code = check_eds_file(options); code != kDone) return code;
  const auto named = named_bus(options.bus, options.bit_rate);
  if (!named) return kWrongUse;
  Plan plan{named->url, named->bit_rate, {}};
  if (const int code =
          named->machine ? plan_from_machine(options, *named, plan) : plan_from_url(options, plan);
      code != kDone)
    return code;
  if (const int code = apply_plant(options, plan); code != kDone) return code;
  if (const int code = apply_switches(options, plan); code != kDone) return code;
  apply_map_access(options, plan);
  if (!options.write_eds.empty())
    if (const int code = write_eds(options, plan.drives.front()); code != kDone) return code;
  auto deeds = read_deeds(options.faults, options.nodes);
  if (!deeds) return kWrongUse;
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
  // The control of the machine may be starting at the same time.
  const bool ask = !named->machine.has_value();
  if (transport->lockstep == nullptr)
    if (const int code = may_join(*transport, plan.url, options.nodes, ask, signals); code != kDone)
      return code;
  for (const mock::SimulatedDriveConfig& d : plan.drives) {
    tell(text::render(kLives, std::vector<std::string>{std::to_string(d.node_id), plan.url, d.name},
                      text::user_language()));
    if (options.json)
      print_json_line({{"event", "node"}, {"node", d.node_id}, {"bus", plan.url}, {"device", d.name}});
  }
  // Standard input has no place in granted time.
  DriveDesk desk(std::move(*deeds), true, options.json);
  const int code = transport->lockstep != nullptr
                       ? live_in_lockstep(options, plan, *transport->lockstep, desk, signals)
                       : live(options, plan, *transport, desk, signals);
  return unless_frames_lost(code, plan.url, *transport->bus);
}

}  // namespace servogate::gateway::command
