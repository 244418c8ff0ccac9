// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/simulated/machine_faults.hpp"
#include "firmware_if/text/in_both.hpp"

#include <algorithm>

namespace servogate::gateway {

namespace {

using fault::Device;
using fault::Kind;

constexpr unsigned bit(Device device) { return static_cast<unsigned>(device); }

const text::Entry kNothingThere{"fault.no-device", "nothing simulated is called '{0}'; there are {1}",
                                "среди имитируемого нет «{0}»; есть {1}"};
const text::Entry kNotItsKind{"fault.not-its-kind", "'{0}' cannot be put on '{1}'; possible are {2}",
                              "«{0}» не бывает у «{1}»; возможны {2}"};
const text::Entry kNoSender{"fault.no-sender", "no node of '{0}' has the node-ID {1}",
                            "у «{0}» нет узла с номером {1}"};

/// False: the fault is neither.
template <class Node>
bool supply_or_swap(Node& node, const fault::Fault& f, bool begins) {
  if (f.kind == Kind::kill) node.supply(!begins);
  if (f.kind == Kind::swapped)
    node.swap(begins ? std::optional(static_cast<std::uint32_t>(f.value)) : std::nullopt);
  return f.kind == Kind::kill || f.kind == Kind::swapped;
}

}  // namespace

MachineFaults::MachineFaults(const machine::MachineConfig& machine, mock::World& world, bool controlled)
    : machine_(machine), world_(world), controlled_(controlled) {}

std::optional<MachineFaults::Target> MachineFaults::find_on_bus(std::string_view device) const {
  for (std::size_t b = 0; b < machine_.buses.size(); ++b) {
    const machine::BusConfig& bus = machine_.buses[b];
    if (!bus.mock()) continue;
    Target target;
    target.name = device;
    target.devices = bit(Device::bus);
    target.endpoint = 0;  // the control's
    target.wire = world_.wire(b);
    if (bus.name == device) return target;
    for (std::size_t n = 0; n < bus.nodes.size(); ++n) {
      if (bus.name + "." + bus.nodes[n].name != device) continue;
      target.endpoint = static_cast<int>(n) + 1;  // behind the control
      target.drive = world_.drive(device);
      target.encoder = world_.encoder(device);
      target.module = world_.module(device);
      target.devices = bit(Device::node) | (target.drive != nullptr ? bit(Device::drive) : 0u) |
                       (target.encoder != nullptr ? bit(Device::encoder) : 0u) |
                       (target.module != nullptr ? bit(Device::module) : 0u);
      return target;
    }
  }
  return std::nullopt;
}

std::optional<MachineFaults::Target> MachineFaults::find(std::string_view device) const {
  if (auto target = find_on_bus(device)) return target;
  if (auto target = find_pendant(device)) return target;
  Target target;
  target.name = device;
  target.station = world_.modbus(device);
  target.chip = world_.chip(device);
  target.board = world_.board(device);
  target.devices = target.station != nullptr ? bit(Device::station) : bit(Device::chip);
  if (target.station != nullptr || target.chip != nullptr || target.board != nullptr) return target;
  target.contact = world_.contact(device);
  target.devices = target.contact.chip != nullptr ? bit(Device::input) : bit(Device::control);
  return target.contact.chip != nullptr || has_control(device) ? std::optional(target) : std::nullopt;
}

/// A simulated pendant, "pendant", or one of its buttons, "pendant.start".
std::optional<MachineFaults::Target> MachineFaults::find_pendant(std::string_view device) const {
  const std::size_t dot = device.find('.');
  Target target;
  target.name = device;
  target.pendant = world_.pendant(device.substr(0, dot));
  if (target.pendant == nullptr) return std::nullopt;
  target.devices = bit(Device::pendant);
  if (dot == std::string_view::npos) return target;
  target.button = device.substr(dot + 1);
  target.devices = bit(Device::button);
  return target.pendant->has_button(target.button) ? std::optional(target) : std::nullopt;
}

std::string MachineFaults::names() const {
  std::string list;
  const auto add = [&](const std::string& name) { list += (list.empty() ? "" : ", ") + name; };
  for (const machine::BusConfig& bus : machine_.buses) {
    if (!bus.mock()) continue;
    add(bus.name);
    for (const machine::NodeConfig& node : bus.nodes) add(bus.name + "." + node.name);
  }
  for (const machine::StationConfig& station : machine_.stations) {
    if (world_.modbus(station.name) != nullptr || world_.chip(station.name) != nullptr ||
        world_.board(station.name) != nullptr)
      add(station.name);
    for (const machine::PointConfig& point : station.points)
      if (world_.contact(point.name).chip != nullptr) add(point.name);
  }
  for (const machine::PendantConfig& pendant : machine_.pendants)
    if (world_.pendant(pendant.name) != nullptr) add(pendant.name);
  if (controlled_) add(std::string(kControl));
  return list;
}

int MachineFaults::endpoint_of(const Target& bus, int node) const {
  for (const machine::BusConfig& b : machine_.buses)
    for (std::size_t n = 0; b.name == bus.name && n < b.nodes.size(); ++n)
      if (b.nodes[n].id == node) return static_cast<int>(n) + 1;
  return -1;
}

std::optional<MachineFaults::Wish> MachineFaults::meant(std::string_view device, const fault::Fault& fault,
                                                        std::string& why) const {
  const auto target = find(device);
  if (!target) {
    why = text::in_both(kNothingThere, {std::string(device), names()});
    return std::nullopt;
  }
  if ((fault::row(fault.kind).devices & target->devices) == 0) {
    why = text::in_both(kNotItsKind, {std::string(fault::name_of(fault.kind)), std::string(device),
                                      fault::names_for(target->devices)});
    return std::nullopt;
  }
  fault::Fault meant = fault;
  if (target->devices == bit(Device::bus) && fault.sender > 0) {
    meant.sender = endpoint_of(*target, fault.sender);
    if (meant.sender < 0) {
      why = text::in_both(kNoSender, {std::string(device), std::to_string(fault.sender)});
      return std::nullopt;
    }
  }
  return Wish{*target, meant, {}};
}

bool MachineFaults::possible(std::string_view device, const fault::Fault* fault, std::string& why) const {
  if (fault != nullptr) return meant(device, *fault, why).has_value();
  if (find(device)) return true;
  why = text::in_both(kNothingThere, {std::string(device), names()});
  return false;
}

bool MachineFaults::inject(std::string_view device, const fault::Fault& fault, std::string& why) {
  auto wished = meant(device, fault, why);
  if (!wished) return false;
  wish(std::move(*wished));
  return true;
}

bool MachineFaults::clear(std::string_view device, std::optional<Kind> kind, std::string& why) {
  const auto target = find(device);
  if (!target) {
    why = text::in_both(kNothingThere, {std::string(device), names()});
    return false;
  }
  wish({*target, {}, kind});
  return true;
}

void MachineFaults::wish(Wish wish) {
  const std::scoped_lock lock(wishes_lock_);
  wishes_.push_back(std::move(wish));
  wished_.store(true, std::memory_order_release);
}

void MachineFaults::advance_to(image::Nanoseconds t) {
  if (active_.empty() && !wished_.load(std::memory_order_acquire)) return;
  for (std::size_t i = active_.size(); i-- > 0;) {
    if (active_[i].until == 0 || t < active_[i].until) continue;
    const Active over = std::move(active_[i]);
    active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(i));
    end(over);
  }
  const std::scoped_lock lock(wishes_lock_);
  wished_.store(false, std::memory_order_relaxed);
  for (const Wish& w : wishes_) w.fault ? begin(w.target, *w.fault, t) : end_all(w.target, w.ends);
  wishes_.clear();
}

void MachineFaults::begin(const Target& target, const fault::Fault& fault, image::Nanoseconds t) {
  if (target.drive != nullptr && fault::row(fault.kind).happens_to(Device::drive))
    return target.drive->inject(fault);  // which ends it by itself
  if (fault.kind == Kind::late_cycle) {
    lateness_ns_ += fault.delay_ns;
    return;
  }
  if (fault.kind == Kind::trip || fault.kind == Kind::parameter) {
    target.station->inject(fault);
    return;
  }
  const bool side_by_side = target.devices == bit(Device::bus);
  if (!side_by_side) end_all(target, fault.kind);
  active_.push_back({target, fault, fault.duration_ns > 0 ? t + fault.duration_ns : 0});
  target.station != nullptr ? settle(*target.station) : apply(target, fault, true);
}

void MachineFaults::end(const Active& active) {
  active.target.station != nullptr ? settle(*active.target.station)
                                   : apply(active.target, active.fault, false);
}

/// A Modbus station has one fault at a time: the newest that lasts still, but a dead one has no other.
void MachineFaults::settle(mock::ModbusStation& station) const {
  std::optional<fault::Fault> now;
  for (const Active& a : active_)
    if (a.target.station == &station && !(now && now->kind == Kind::kill)) now = a.fault;
  if (!now)
    station.clear_fault();
  else
    station.inject(*now);
}

void MachineFaults::end_all(const Target& target, std::optional<Kind> kind) {
  if (target.drive != nullptr) kind ? target.drive->clear(*kind) : target.drive->clear_faults();
  std::vector<Active> over;
  std::erase_if(active_, [&](const Active& a) {
    const bool ends = a.target.name == target.name && (!kind || a.fault.kind == *kind);
    if (ends) over.push_back(a);
    return ends;
  });
  for (const Active& a : over) end(a);
}

void MachineFaults::apply(const Target& target, const fault::Fault& fault, bool begins) {
  if (target.pendant != nullptr && fault.kind == Kind::stuck)
    return begins ? target.pendant->stick(target.button, fault.level)
                  : target.pendant->release(target.button);
  if (target.pendant != nullptr)
    return fault.kind == Kind::unplug ? target.pendant->plug(!begins) : target.pendant->garble(begins);
  if (target.chip != nullptr && fault.kind == Kind::edges_lost) return target.chip->lose_edges(begins);
  if (target.chip != nullptr) return target.chip->plug(!begins);
  if (target.board != nullptr && fault.kind == Kind::edges_lost) return target.board->lose_edges(begins);
  if (target.board != nullptr) return target.board->plug(!begins);
  if (target.encoder != nullptr && fault.kind == Kind::unreadable)
    return target.encoder->set_unreadable(begins);
  if (target.encoder != nullptr && supply_or_swap(*target.encoder, fault, begins)) return;
  if (target.module != nullptr && supply_or_swap(*target.module, fault, begins)) return;
  if (target.wire != nullptr) return apply_to_wire(target, fault, begins);
  const mock::World::Contact& contact = target.contact;
  if (fault.kind == Kind::bounce)
    contact.chip->set_bounce(contact.number,
                             begins ? mock::Bounce{fault.delay_ns, fault.seed} : mock::Bounce{});
  else if (begins)
    contact.chip->force_input(contact.number, image::raw_of(contact.rule, fault.level ? 1.0 : 0.0) != 0.0);
  else
    contact.chip->release_input(contact.number);
}

void MachineFaults::apply_to_wire(const Target& target, const fault::Fault& f, bool begins) {
  mock::CanSegment& wire = *target.wire;
  if (f.kind == Kind::unplug) return wire.set_connected(target.endpoint, !begins);
  if (f.kind == Kind::bus_off)
    return begins ? wire.force_bus_off(target.endpoint) : wire.restart(target.endpoint);
  if (begins)
    wire.inject(f);
  else
    wire.clear(f);
}

}  // namespace servogate::gateway
