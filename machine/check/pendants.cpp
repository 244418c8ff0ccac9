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
  }
}

}  // namespace servogate::machine
