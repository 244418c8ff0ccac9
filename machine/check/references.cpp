// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include "firmware_if/text/nearest.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

struct Names {
  std::vector<std::string> points, nodes, axes;
};

Names all_names(const MachineConfig& machine) {
  Names out;
  for (const StationConfig& s : machine.stations)
    for (const PointConfig& p : s.points) out.points.push_back(p.name);
  for (const BusConfig& b : machine.buses)
    for (const NodeConfig& n : b.nodes) out.nodes.push_back(b.name + "." + n.name);
  out.axes = machine.letters();
  return out;
}

std::string hint(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string near = text::nearest(word, candidates);
  if (!near.empty())
    return text::both("; did you mean \"" + near + "\"?", "; имелось в виду «" + near + "»?");
  return "";
}

std::string point_kind(const PointConfig& p) {
  switch (p.channel) {
    case ChannelKind::di:
      return text::both("a digital input", "дискретный вход");
    case ChannelKind::dq:
      return text::both("a digital output", "дискретный выход");
    case ChannelKind::ai:
      return text::both("an analog input", "аналоговый вход");
    case ChannelKind::aq:
      return text::both("an analog output", "аналоговый выход");
  }
  return {};
}

struct Wanted {
  std::string words;
  bool (*fits)(const PointConfig& p);
};
Wanted wanted_point(Refers refers) {
  switch (refers) {
    case Refers::digital_input:
      return {text::both("a digital input", "дискретный вход"),
              [](const PointConfig& p) { return p.channel == ChannelKind::di; }};
    case Refers::digital_output:
      return {text::both("a digital output", "дискретный выход"),
              [](const PointConfig& p) { return p.channel == ChannelKind::dq; }};
    case Refers::analog_output:
      return {text::both("an analog output", "аналоговый выход"),
              [](const PointConfig& p) { return p.channel == ChannelKind::aq; }};
    default:
      return {"", [](const PointConfig&) { return true; }};
  }
}

/// Path as a person sees it, list positions left out.
std::string shown(std::string_view path) {
  std::string out;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const std::string_view part = path.substr(0, dot);
    if (part.find_first_not_of("0123456789") != std::string_view::npos)
      out += (out.empty() ? "" : ".") + std::string(part);
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return out;
}

class ReferenceCheck {
 public:
  ReferenceCheck(const MachineConfig& machine, Reading& reading)
      : machine_(machine), reading_(reading), names_(all_names(machine)) {}

  void text(const Key& key, const std::string& value, const std::string& path) {
    if (value.empty()) return;
    const Where at = machine_.where(path);
    const std::string name = shown(path);
    switch (key.rule.refers) {
      case Refers::nothing:
      case Refers::device:
        return;  // device files: check_devices
      case Refers::axis:
        if (machine_.axis_index(value) < 0 && all_named())
          reading_.error(at, finding::kNoSuch,
                         {name, text::both("axis", "оси"), value, hint(value, names_.axes)});
        return;
      case Refers::node:
        if (machine_.node(value) == nullptr)
          reading_.error(at, finding::kNoSuch,
                         {name, text::both("node", "узла"), value, hint(value, names_.nodes)});
        return;
      case Refers::file: {
        const std::string source = machine_.resolve(value);
        std::error_code error;
        if (!std::filesystem::exists(source, error))
          reading_.error(at, finding::kNoFile, {name, value});
        else if (const std::string why = files::why_unreadable(source); !why.empty())
          reading_.error(at, finding::kUnreadableFile, {name, value, why});
        return;
      }
      default:
        point(key, value, at, name);
    }
  }

 private:
  /// An axis without a letter is told by itself: it may be the one that is meant.
  bool all_named() const {
    return std::none_of(machine_.axes.begin(), machine_.axes.end(),
                        [](const AxisConfig& a) { return a.letter.empty(); });
  }
  void point(const Key& key, const std::string& value, Where at, const std::string& name) {
    const PointConfig* p = machine_.point(value);
    const Wanted wanted = wanted_point(key.rule.refers);
    if (p == nullptr)
      reading_.error(at, finding::kNoSuch,
                     {name, text::both("point", "сигнала"), value, hint(value, names_.points)});
    else if (!wanted.fits(*p))
      reading_.error(at, finding::kWrongPoint, {name, value, point_kind(*p), wanted.words});
  }

  const MachineConfig& machine_;
  Reading& reading_;
  Names names_;
};

/// Every drive moves one thing only.
void check_drive_owners(const MachineConfig& machine, Reading& reading) {
  std::map<std::string, std::string> owners;
  const auto own = [&](const std::string& drive, const std::string& who, const std::string& path) {
    if (drive.empty()) return;
    const auto [it, fresh] = owners.try_emplace(drive, who);
    if (!fresh) reading.error(machine.where(path), finding::kNodeTwice, {drive, it->second});
  };
  // A spindle that becomes an axis shares its drive with it, and nobody else does.
  const auto becomes = [&machine](const AxisConfig& a) {
    return std::any_of(machine.spindles.begin(), machine.spindles.end(), [&a](const SpindleConfig& s) {
      return !a.letter.empty() && s.axis == a.letter && s.drive == a.drive;
    });
  };
  for (std::size_t i = 0; i < machine.axes.size(); ++i)
    if (!becomes(machine.axes[i]))
      own(machine.axes[i].drive,
          text::both("axis " + machine.axes[i].letter, "ось " + machine.axes[i].letter),
          "axis." + std::to_string(i) + ".drive");
  for (std::size_t i = 0; i < machine.spindles.size(); ++i)
    own(machine.spindles[i].drive,
        text::both("spindle " + std::to_string(i + 1), "шпиндель " + std::to_string(i + 1)),
        "spindle." + std::to_string(i) + ".drive");
}

/// An adapter, or a bus server of another computer: servers of simulated buses listen on loopback only.
bool perhaps_real(std::string_view url) {
  if (url.starts_with("gsusb:") || url.starts_with("slcan:")) return true;
  constexpr std::string_view kServed = "socketcand:";
  if (!url.starts_with(kServed)) return false;
  const std::string_view host = url.substr(kServed.size());
  constexpr std::string_view kHere[] = {"unix:", "localhost:", "127.", "[::1]:", "::1:"};
  return std::none_of(std::begin(kHere), std::end(kHere),
                      [host](std::string_view here) { return host.starts_with(here); });
}

/// Initial values are of points that there are. What is said of something real is of the same machine on a
/// desk, and has no effect here.
void check_simulated(const MachineConfig& machine, Reading& reading) {
  for (const auto& [name, value] : machine.simulation.initial)
    if (machine.point(name) == nullptr)
      reading.error(machine.where("simulation.initial." + name), finding::kNoSuch,
                    {"simulation.initial", text::both("point", "сигнала"), name,
                     hint(name, all_names(machine).points)});
  // Of an interface of Linux only its kind can tell, when it is opened.
  for (std::size_t b = 0; b < machine.buses.size(); ++b)
    if (machine.buses[b].simulated && perhaps_real(machine.buses[b].url))
      reading.error(machine.where("bus." + std::to_string(b) + ".simulated"), finding::kPerhapsReal,
                    {machine.buses[b].name, machine.buses[b].url});
}

}  // namespace

void check_references(const MachineConfig& machine, Reading& reading) {
  ReferenceCheck check(machine, reading);
  // The walk hands out writable members; this visitor only reads them.
  visit_keys(section_of<MachineConfig>(), const_cast<MachineConfig*>(&machine),
             [&](const Key& key, void* member, const std::string& path) {
               if (key.kind == KeyKind::text) check.text(key, *static_cast<std::string*>(member), path);
               if (key.kind != KeyKind::texts) return;
               const auto& list = *static_cast<std::vector<std::string>*>(member);
               for (std::size_t i = 0; i < list.size(); ++i)
                 check.text(key, list[i], path + "." + std::to_string(i));
             });
  check_drive_owners(machine, reading);
  check_simulated(machine, reading);
}

}  // namespace servogate::machine
