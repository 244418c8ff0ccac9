// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>

#include "machine/check/check.hpp"
#include "machine/check/device_kind.hpp"
#include "machine/check/findings.hpp"
#include "machine/check/findings_pendant.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::machine {

namespace {

template <class List, class Name>
std::string listed(const List& list, Name name) {
  std::string out;
  for (const auto& item : list) out += (out.empty() ? "" : ", ") + std::string(name(item));
  return out;
}

void axes_of(const LoadResult& loaded, const PendantConfig& p, const std::string& path,
             const pendant::Layout& layout, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  const std::string moved = pendant_rules(m, {}, layout).axes;
  const std::string there = listed(moved, [](char letter) { return std::string(1, letter); });
  for (std::size_t n = 0; n < p.axes.size(); ++n)
    if (p.axes[n].size() != 1 || moved.find(p.axes[n]) == std::string::npos)
      reading.error(m.where(path + ".axes." + std::to_string(n)), finding::kPendantAxis,
                    {p.name, p.axes[n], there});
  const std::string mine = pendant_rules(m, p, layout).axes;
  const bool any = std::any_of(layout.axes.begin(), layout.axes.end(), [&](const pendant::AxisCode& a) {
    return mine.find(a.letter) != std::string::npos;
  });
  if (!any && !mine.empty())
    reading.error(m.where(path + ".axes"), finding::kPendantNobody,
                  {p.name, listed(layout.axes, [](const auto& a) { return std::string(1, a.letter); }),
                   listed(mine, [](char letter) { return std::string(1, letter); })});
}

void dead_man_of(const MachineConfig& m, const PendantConfig& p, const std::string& path,
                 const pendant::Layout& layout, Reading& reading) {
  const int button = p.dead_man.empty() ? -1 : layout.button(p.dead_man);
  for (const pendant::Binding& b : layout.bindings) {
    using pendant::Action;
    if (button < 0 || b.button != button || b.with >= 0) continue;
    if (b.action == Action::nothing || b.action == Action::shift || b.action == Action::hold_axis) continue;
    reading.error(m.where(path + ".dead_man"), finding::kPendantDeadManActs,
                  {p.dead_man, std::string(pendant::action_word(b.action))});
  }
  const PointConfig* point = p.dead_man_point.empty() ? nullptr : m.point(p.dead_man_point);
  if (point != nullptr && (point->hold || point->loss != 0.0))
    reading.error(m.where(path + ".dead_man_point"), finding::kPendantDeadManLoss, {point->name});
}

void processes_of(const MachineConfig& m, const PendantConfig& p, const std::string& path,
                  const pendant::Layout& layout, Reading& reading) {
  const std::string mine = pendant_rules(m, p, layout).axes;
  int process = 0;
  for (const pendant::AxisCode& a : layout.axes) {
    const int index = m.axis_index(std::string(1, a.letter));
    if (index < 0 || mine.find(a.letter) == std::string::npos) continue;
    const int its = m.axes[static_cast<std::size_t>(index)].process;
    if (process == 0) process = its;
    if (its == process) continue;
    return reading.error(m.where(path + (p.axes.empty() ? ".name" : ".axes")), finding::kPendantProcesses,
                         {p.name, std::to_string(process)});
  }
}

/// Two files of the machine may open one hidraw device: nothing in the system keeps them apart.
void same_device(const LoadResult& loaded, std::size_t n, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  const PendantConfig& p = m.pendants[n];
  const auto mine = hid_place(p.url);
  const DeviceConfig* device = loaded.device(p.device);
  for (std::size_t o = 0; o < n; ++o) {
    const PendantConfig& q = m.pendants[o];
    const auto its = hid_place(q.url);
    const DeviceConfig* other = loaded.device(q.device);
    if (!mine || !its || device == nullptr || other == nullptr) continue;
    if (device->pendant.usb_vendor != other->pendant.usb_vendor ||
        device->pendant.usb_product != other->pendant.usb_product)
      continue;
    const auto any = [](const HidPlace& h) { return h.serial.empty() && h.path.empty(); };
    const bool other_kinds = mine->serial.empty() != its->serial.empty();
    if (any(*mine) || any(*its) || other_kinds || (mine->serial == its->serial && mine->path == its->path))
      reading.error(m.where("pendant." + std::to_string(n) + ".url"), finding::kPendantSame,
                    {q.name, p.name});
  }
}

}  // namespace

void check_pendants(const LoadResult& loaded, Reading& reading) {
  const MachineConfig& m = loaded.machine;
  std::set<std::string> names;
  for (std::size_t n = 0; n < m.pendants.size(); ++n) {
    const PendantConfig& p = m.pendants[n];
    const std::string path = "pendant." + std::to_string(n);
    if (!names.insert(p.name).second)
      reading.error(m.where(path + ".name"), finding::kPendantTwice, {p.name});
    const bool mock = p.mock() && p.url.size() > 5;
    if (!p.url.empty() && !mock && !hid_place(p.url))
      reading.error(m.where(path + ".url"), finding::kPendantUrl, {p.url});
    const DeviceConfig* device = loaded.device(p.device);
    if (device == nullptr || !kind_known(*device)) continue;
    if (device->kind != DeviceKind::pendant) {
      reading.error(m.where(path + ".device"), finding::kWrongDevice,
                    {p.device, kind_name(device->kind), kind_name(DeviceKind::pendant)});
      continue;
    }
    const pendant::Layout layout = pendant_layout(
        *device, p, [&](const std::string& key, const std::string& text, const std::string& form) {
          reading.error(m.where(path + "." + key), finding::kPendantText, {key, text, form});
        });
    if (!p.dead_man.empty() && layout.button(p.dead_man) < 0)
      reading.error(m.where(path + ".dead_man"), finding::kPendantButton,
                    {p.device, p.dead_man, listed(layout.buttons, [](const auto& b) { return b.name; })});
    axes_of(loaded, p, path, layout, reading);
    dead_man_of(m, p, path, layout, reading);
    processes_of(m, p, path, layout, reading);
    same_device(loaded, n, reading);
  }
}

}  // namespace servogate::machine
