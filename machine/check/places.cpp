// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "firmware_if/image/interface_map.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

struct Used {
  std::string name;
  image::Place place;
  image::Writer writer;
  Where at;
};

std::string writer_name(image::Writer w) {
  return std::string(choices_of<image::Writer>()[static_cast<std::size_t>(w)]);
}

std::uint32_t packet_size(const MachineConfig& machine, image::Packet packet) {
  if (packet == image::Packet::a) return image::kPacketASize;
  return static_cast<std::uint32_t>(packet == image::Packet::k ? machine.control.k_size
                                                               : machine.control.syvar_size);
}

void check_inside(const MachineConfig& machine, const Used& used, Reading& reading) {
  const std::uint32_t size = packet_size(machine, used.place.packet);
  if (used.place.byte() + used.place.bytes() > size)
    reading.error(used.at, finding::kOutside, {to_string(used.place), used.name, std::to_string(size)});
}

/// A point's format has to carry what its channel gives.
void check_point(const PointConfig& p, const std::string& path, const MachineConfig& machine,
                 Reading& reading) {
  if (p.number < 0) return;
  const Where at = machine.where(path + ".place");
  const std::string place = to_string(p.place);
  if (p.place.packet != image::Packet::a) reading.error(at, finding::kPointPacket, {place, p.name});
  if (!p.is_analog() && p.place.format != image::Format::bl)
    reading.error(at, finding::kPointFormat,
                  {place, p.name, text::both("a digital channel", "дискретный канал"),
                   text::both("a bit (SA16)", "бит (SA16)")});
  const bool word = p.place.format >= image::Format::in && p.place.format <= image::Format::lr;
  if (p.is_analog() && !word)
    reading.error(at, finding::kPointFormat,
                  {place, p.name, text::both("an analog channel", "аналоговый канал"),
                   text::both("a word (SA16.IN, .LI, .RE)", "слово (SA16.IN, .LI, .RE)")});
  const Where writer = machine.where(path + ".writer");
  if (p.is_input() && p.writer != image::Writer::input)
    reading.error(writer, finding::kInputWriter, {p.name, writer_name(p.writer)});
  if (!p.is_input() && p.writer == image::Writer::input)
    reading.error(writer, finding::kOutputWriter, {p.name});
}

/// Missing and wrong places were said by the reader.
bool usable(const MachineConfig& machine, const std::string& path) {
  return machine.places.contains(path + ".place") && !machine.unread.contains(path + ".place");
}

std::vector<Used> collect(const MachineConfig& machine, Reading& reading) {
  std::vector<Used> out;
  for (std::size_t s = 0; s < machine.stations.size(); ++s)
    for (std::size_t i = 0; i < machine.stations[s].points.size(); ++i) {
      const PointConfig& p = machine.stations[s].points[i];
      const std::string path = "station." + std::to_string(s) + ".points." + std::to_string(i);
      if (!usable(machine, path)) continue;
      check_point(p, path, machine, reading);
      out.push_back({p.name, p.place, p.writer, machine.where(path + ".place")});
    }
  for (std::size_t i = 0; i < machine.symbols.size(); ++i) {
    const SymbolConfig& s = machine.symbols[i];
    const std::string path = "symbol." + std::to_string(i);
    if (!usable(machine, path)) continue;
    if (s.writer == image::Writer::input)
      reading.error(machine.where(path + ".writer"), finding::kFreeWriter, {s.name});
    out.push_back({s.name, s.place, s.writer, machine.where(path + ".place")});
  }
  return out;
}

void check_overlaps(const std::vector<Used>& used, Reading& reading) {
  for (std::size_t i = 0; i < used.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (used[i].place.overlaps(used[j].place)) {
        reading.error(used[i].at, finding::kOverlap,
                      {to_string(used[i].place), used[i].name, to_string(used[j].place), used[j].name,
                       std::to_string(used[j].at.line)});
        break;
      }
}

/// Bytes of packet K that the control keeps: the whole interface, named fields said by name.
void check_interface(const MachineConfig& machine, const std::vector<Used>& used, Reading& reading) {
  std::uint32_t end = image::kMachineBase;
  for (const image::InterfaceField& f : image::kMachineFields)
    end = std::max(end, image::kMachineBase + f.byte + image::format_size(f.format));
  const auto fields =
      image::interface_symbols(machine.control.processes, machine.letters(),
                               static_cast<int>(machine.spindles.size()), machine.auxiliary_axes());
  for (const Used& u : used) {
    const std::uint32_t first = u.place.byte(), last = first + u.place.bytes();
    std::uint32_t kept = image::kInterfaceBase, kept_end = end;
    for (int a = 0; a < image::kMaxAxes; ++a)
      if ((machine.auxiliary_axes() >> a & 1u) != 0 && last > image::motion_base(a) &&
          first < image::motion_base(a) + image::kMotionBlock) {
        kept = image::motion_base(a);
        kept_end = kept + image::kMotionBlock;
      }
    if (u.place.packet != image::Packet::k || first >= kept_end || last <= kept) continue;
    const auto hit = std::find_if(fields.begin(), fields.end(),
                                  [&](const image::Symbol& f) { return f.place.overlaps(u.place); });
    if (hit != fields.end())
      reading.error(u.at, finding::kInterface,
                    {to_string(u.place), u.name, to_string(hit->place), hit->name});
    else
      reading.error(u.at, finding::kInterfaceReserved,
                    {to_string(u.place), u.name, std::to_string(kept), std::to_string(kept_end - 1)});
  }
}

}  // namespace

void check_places(const MachineConfig& machine, Reading& reading) {
  const std::vector<Used> used = collect(machine, reading);
  for (const Used& u : used) check_inside(machine, u, reading);
  check_overlaps(used, reading);
  check_interface(machine, used, reading);
}

}  // namespace servogate::machine
