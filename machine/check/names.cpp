// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>

#include "firmware_if/canopen/302/segment_config.hpp"
#include "kernel/program/languages/languages.hpp"
#include "machine/bus_place.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"

namespace servogate::machine {

namespace {

bool letter_or_underscore(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool digit(char c) { return c >= '0' && c <= '9'; }

bool is_name(std::string_view text) {
  return !text.empty() && letter_or_underscore(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return letter_or_underscore(c) || digit(c); });
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c + 32);
  return text;
}

/// Names of one kind: each of the right form and, without case, once.
class NameSet {
 public:
  NameSet(const MachineConfig& machine, Reading& reading, std::string what)
      : machine_(machine), reading_(reading), what_(std::move(what)) {}

  void add(const std::string& name, const std::string& path, bool check_form = true) {
    if (name.empty()) return;  // missing: said by the reader
    const Where at = machine_.where(path);
    if (check_form && !is_name(name)) reading_.error(at, finding::kBadName, {name});
    const auto [it, fresh] = seen_.try_emplace(lower(name), at.line);
    if (!fresh) reading_.error(at, finding::kTwice, {what_, name, std::to_string(it->second)});
  }

 private:
  const MachineConfig& machine_;
  Reading& reading_;
  std::string what_;
  std::map<std::string, int> seen_;
};

/// A letter that is another word of the language, such as F, would never reach the axis.
void check_program_letter(const MachineConfig& machine, const AxisConfig& axis, const std::string& path,
                          Reading& reading) {
  const std::string known = program::axis_letters(machine.control.dialect);
  if (axis.auxiliary || known.empty() || known.find(axis.letter[0]) != std::string::npos) return;
  std::string list;
  for (const char letter : known) list += (list.empty() ? "" : " ") + std::string(1, letter);
  reading.error(machine.where(path), finding::kLetterTaken, {axis.letter, machine.control.dialect, list});
}

void check_letters(const MachineConfig& machine, Reading& reading) {
  NameSet letters(machine, reading, text::both("axis", "ось"));
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    const std::string& letter = machine.axes[i].letter;
    const std::string path = "axis." + std::to_string(i) + ".letter";
    if (letter.empty()) continue;
    if (letter.size() != 1 || letter[0] < 'A' || letter[0] > 'Z') {
      reading.error(machine.where(path), finding::kBadLetter, {letter});
      continue;
    }
    check_program_letter(machine, machine.axes[i], path, reading);
    letters.add(letter, path, false);
  }
}

/// Two segments on one wire would take each other for a second master.
void check_wire(const MachineConfig& machine, std::size_t b, Reading& reading) {
  const BusConfig& bus = machine.buses[b];
  for (std::size_t i = 0; i < b && !bus.url.empty(); ++i) {
    const BusConfig& other = machine.buses[i];
    if (!same_bus(other.url, bus.url)) continue;
    const Where there = machine.where("bus." + std::to_string(i) + ".url");
    return reading.error(machine.where("bus." + std::to_string(b) + ".url"), finding::kOneWire,
                         {bus.name, other.name, std::to_string(there.line)});
  }
}

void check_nodes(const MachineConfig& machine, Reading& reading) {
  NameSet buses(machine, reading, text::both("bus", "шина"));
  for (std::size_t b = 0; b < machine.buses.size(); ++b) {
    const std::string bus = "bus." + std::to_string(b);
    buses.add(machine.buses[b].name, bus + ".name");
    check_wire(machine, b, reading);
    NameSet names(machine, reading, text::both("node", "узел"));
    NameSet ids(machine, reading, text::both("node id", "номер узла"));
    for (std::size_t n = 0; n < machine.buses[b].nodes.size(); ++n) {
      const NodeConfig& node = machine.buses[b].nodes[n];
      const std::string path = bus + ".node." + std::to_string(n);
      names.add(node.name, path + ".name");
      if (node.id != 0) ids.add(std::to_string(node.id), path + ".id", false);
    }
  }
}

/// "di3" into kind and number, and the writer that follows from it.
void take_channel(MachineConfig& machine, std::size_t s, std::size_t p, Reading& reading) {
  PointConfig& point = machine.stations[s].points[p];
  if (point.channel_text.empty()) return;
  const std::string path = "station." + std::to_string(s) + ".points." + std::to_string(p);
  static constexpr std::pair<std::string_view, ChannelKind> kKinds[] = {
      {"di", ChannelKind::di}, {"dq", ChannelKind::dq}, {"ai", ChannelKind::ai}, {"aq", ChannelKind::aq}};
  const std::string_view text = point.channel_text;
  int number = -1;
  if (text.size() > 2 && digit(text[2])) {
    const auto [end, error] = std::from_chars(text.data() + 2, text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || number > 65535) number = -1;
  }
  const auto kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                 [&](const auto& k) { return text.substr(0, 2) == k.first; });
  if (kind == std::end(kKinds) || number < 0) {
    reading.error(machine.where(path + ".channel"), finding::kBadChannel, {point.channel_text});
    return;
  }
  point.channel = kind->second;
  point.number = number;
  if (!machine.places.contains(path + ".writer"))
    point.writer = point.is_input() ? image::Writer::input : image::Writer::plc;
}

/// Two masters on one wire would take each other's answers.
void check_line_device(const MachineConfig& machine, std::size_t l, Reading& reading) {
  const LineConfig& line = machine.lines[l];
  for (std::size_t i = 0; i < l && !line.url.empty(); ++i) {
    const LineConfig& other = machine.lines[i];
    if (!same_bus(other.url, line.url)) continue;
    const Where there = machine.where("line." + std::to_string(i) + ".url");
    return reading.error(machine.where("line." + std::to_string(l) + ".url"), finding::kOneDevice,
                         {line.name, other.name, std::to_string(there.line)});
  }
}

void check_points(MachineConfig& machine, Reading& reading) {
  NameSet lines(machine, reading, text::both("line", "линия"));
  for (std::size_t l = 0; l < machine.lines.size(); ++l) {
    lines.add(machine.lines[l].name, "line." + std::to_string(l) + ".name");
    check_line_device(machine, l, reading);
  }
  NameSet stations(machine, reading, text::both("station", "станция"));
  // Points and free symbols share one name space: the PLC and the part program see both.
  NameSet names(machine, reading, text::both("name", "имя"));
  for (std::size_t s = 0; s < machine.stations.size(); ++s) {
    const std::string station = "station." + std::to_string(s);
    stations.add(machine.stations[s].name, station + ".name");
    StationConfig& config = machine.stations[s];
    if (const LineConfig* line = machine.line(config.line); line != nullptr && config.url.empty())
      config.url = line->url;
    NameSet channels(machine, reading, text::both("channel", "канал"));
    for (std::size_t p = 0; p < machine.stations[s].points.size(); ++p) {
      take_channel(machine, s, p, reading);
      const PointConfig& point = machine.stations[s].points[p];
      const std::string path = station + ".points." + std::to_string(p);
      names.add(point.name, path + ".name");
      channels.add(point.channel_text, path + ".channel", false);
    }
  }
  for (std::size_t i = 0; i < machine.symbols.size(); ++i)
    names.add(machine.symbols[i].name, "symbol." + std::to_string(i) + ".name");
}

}  // namespace

void check_names(MachineConfig& machine, Reading& reading) {
  check_letters(machine, reading);
  check_nodes(machine, reading);
  check_points(machine, reading);
}

}  // namespace servogate::machine
