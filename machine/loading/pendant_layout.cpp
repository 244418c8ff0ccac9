// SPDX-License-Identifier: Apache-2.0
#include "machine/loading/pendant_layout.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "machine/check/findings_pendant.hpp"

namespace servogate::machine {

namespace {

/// Calls `take` with each text that `parse` understands.
template <class Parse, class Take>
void each(const std::vector<std::string>& texts, const std::string& path, const std::string& form,
          const BadText& bad, Parse parse, Take take) {
  for (std::size_t n = 0; n < texts.size(); ++n)
    if (auto value = parse(texts[n]))
      take(std::move(*value));
    else if (bad)
      bad(path + "." + std::to_string(n), texts[n], form);
}

void meanings(pendant::Layout& layout, const std::vector<std::string>& texts, const std::string& path,
              const BadText& bad) {
  each(
      texts, path,
      text::both("BUTTON: ACTION, or BUTTON + BUTTON: ACTION; actions: ",
                 "КНОПКА: ДЕЙСТВИЕ или КНОПКА + КНОПКА: ДЕЙСТВИЕ; действия: ") +
          std::string(pendant::action_words()),
      bad,
      [&layout](const std::string& text) {
        auto binding = pendant::parse_binding(text, layout);
        // It selects an axis that the pendant has not.
        if (binding && binding->axis != 0 && layout.axis_index(binding->axis) < 0) binding.reset();
        return binding;
      },
      [&layout](const pendant::Binding& binding) { pendant::bind(layout, binding); });
}

}  // namespace

pendant::Layout pendant_layout(const DeviceConfig& device, const BadText& bad) {
  const PendantMap& m = device.pendant;
  pendant::Layout out;
  out.name = device.name;
  out.usb_vendor = static_cast<std::uint16_t>(m.usb_vendor);
  out.usb_product = static_cast<std::uint16_t>(m.usb_product);
  out.report_number = m.report_number;
  out.report_bytes = m.report_bytes;
  for (const int key : {m.first_key, m.second_key})
    if (key >= 0) out.keys.push_back(key);
  out.bits = m.bits;
  out.axis = m.axis;
  out.step = m.step;
  out.wheel = m.wheel;
  out.ring = m.ring;
  out.wheel_kind = static_cast<pendant::WheelKind>(m.wheel_kind);
  out.ring_range = m.ring_range;
  out.ring_from = m.ring_from;
  each(m.buttons, "pendant.buttons", "\"0x0C fn\"", bad, pendant::parse_button,
       [&](pendant::Button b) { out.buttons.push_back(std::move(b)); });
  each(m.axes, "pendant.axes", "\"0x11 X\", \"0x06 off\"", bad, pendant::parse_axis,
       [&](const pendant::AxisCode& a) {
         if (a.letter != 0)
           out.axes.push_back(a);
         else
           out.axis_off = a.code;
       });
  each(m.steps, "pendant.steps", "\"0x0D 0.001\", \"0.001 = 1\"", bad, pendant::parse_step,
       [&](const pendant::Step& s) { out.steps.push_back(s); });
  meanings(out, m.meanings, "pendant.meanings", bad);
  out.display_number = m.display_number;
  out.display_bytes = m.display_bytes;
  each(m.display, "pendant.display",
       "0x.., work N, machine N, shown N, feed, spindle, feed_override, spindle_override, step_mark, flags",
       bad, pendant::parse_field, [&](const pendant::Field& f) { out.display.push_back(f); });
  return out;
}

pendant::Layout pendant_layout(const DeviceConfig& device, const PendantConfig& pendant, const BadText& bad) {
  pendant::Layout out = pendant_layout(device);
  meanings(out, pendant.buttons, "buttons", bad);
  return out;
}

pendant::Rules pendant_rules(const MachineConfig& machine, const PendantConfig& pendant,
                             const pendant::Layout& layout) {
  pendant::Rules rules;
  rules.max_step = pendant.max_step;
  rules.dead_man = pendant.dead_man.empty() ? -1 : layout.button(pendant.dead_man);
  for (const AxisConfig& axis : machine.axes) {
    const bool named = pendant.axes.empty() ||
                       std::find(pendant.axes.begin(), pendant.axes.end(), axis.letter) != pendant.axes.end();
    if (!axis.auxiliary && named) rules.axes += axis.letter;
  }
  return rules;
}

std::optional<HidPlace> hid_place(std::string_view url) {
  if (!url.starts_with("hid:") || url.size() == 4) return std::nullopt;
  const std::string rest(url.substr(4));
  if (rest == "any") return HidPlace{};
  if (rest.starts_with('/')) return HidPlace{{}, rest};
  return HidPlace{rest, {}};
}

/// Tells what stands twice where each stands once. A pendant without an axis selector has no codes of axes.
template <class Tell>
void twice(const pendant::Layout& layout, Tell tell) {
  std::set<std::string> names, letters;
  // What a simulated pendant is turned by has names, too.
  for (const auto& [place, name] : {std::pair(layout.wheel, "wheel"), std::pair(layout.ring, "ring"),
                                    std::pair(layout.axis, "axis"), std::pair(layout.step, "step")})
    if (place >= 0) names.insert(name);
  std::set<int> codes, places;
  for (const pendant::Button& b : layout.buttons) {
    if (!names.insert(b.name).second) tell("buttons", b.name);
    if (!codes.insert(b.code).second) tell("buttons", std::to_string(b.code));
  }
  for (const pendant::AxisCode& a : layout.axes) {
    if (!letters.insert(std::string(1, a.letter)).second) tell("axes", std::string(1, a.letter));
    if (layout.axis >= 0 && (a.code == layout.axis_off || !places.insert(a.code).second))
      tell("axes", std::to_string(a.code));
  }
  places.clear();
  for (const pendant::Step& s : layout.steps)
    if (s.code >= 0 && !places.insert(s.code).second) tell("steps", std::to_string(s.code));
}

void check_pendant_device(const DeviceConfig& device, Reading& reading) {
  if (!device.places.contains("pendant"))
    return reading.error(device.where("kind"), finding::kNoPendantTable, {});
  bool good = true;
  const auto wrong = [&](const std::string& key, const text::Entry& entry,
                         std::vector<std::string> arguments) {
    reading.error(device.where("pendant." + key), entry, std::move(arguments));
    good = false;
  };
  const pendant::Layout layout =
      pendant_layout(device, [&](const std::string& path, const std::string& text, const std::string& form) {
        reading.error(device.where(path), finding::kPendantText, {path, text, form});
        good = false;
      });
  const PendantMap& m = device.pendant;
  const std::pair<const char*, int> places[] = {
      {"first_key", m.first_key}, {"second_key", m.second_key},           {"axis", m.axis}, {"step", m.step},
      {"wheel", m.wheel},         {"bits", m.bits < 0 ? -1 : m.bits + 1}, {"ring", m.ring}};
  for (const auto& [key, place] : places)
    if (place >= m.report_bytes)
      wrong(key, finding::kPendantPlace, {key, std::to_string(place), std::to_string(m.report_bytes)});
  for (std::size_t n = 0; n < std::size(places); ++n)
    for (std::size_t o = n + 1; o < std::size(places); ++o)
      if (places[n].second >= 0 && places[n].second == places[o].second)
        wrong(places[o].first, finding::kPendantShared,
              {places[n].first, places[o].first, std::to_string(places[n].second)});
  for (const auto& [key, place] : places)
    if (place == 0 && m.report_number != 0) wrong(key, finding::kPendantShared, {"report_number", key, "0"});
  const auto lacks = [&](bool wanted, const char* key, const char* missing) {
    if (wanted) wrong(key, finding::kPendantLacks, {key, missing});
  };
  lacks(m.wheel >= 0 && m.wheel_kind == PendantWheel::none, "wheel", "wheel_kind");
  lacks(m.step >= 0 && std::any_of(layout.steps.begin(), layout.steps.end(),
                                   [](const pendant::Step& s) { return s.code < 0; }),
        "step", "steps = [\"CODE LENGTH\"]");
  lacks(!m.display.empty() && m.display_bytes == 0, "display", "display_bytes");
  if (m.ring >= 0 && m.ring_from > m.ring_range)
    wrong("ring_from", finding::kPendantRing, {std::to_string(m.ring_from), std::to_string(m.ring_range)});
  twice(layout, [&](const char* key, std::string text) {
    wrong(key, finding::kPendantTwiceHere, {key, std::move(text)});
  });
  if (layout.buttons.size() > pendant::kMostButtons || layout.axes.size() > pendant::kMostAxes)
    wrong("buttons", finding::kPendantMany,
          {std::to_string(pendant::kMostButtons), std::to_string(pendant::kMostAxes)});
  for (const pendant::Button& b : layout.buttons) {
    if (m.bits >= 0 && b.code > 15) wrong("buttons", finding::kPendantBit, {b.name, std::to_string(b.code)});
    if (m.bits < 0 && b.code == 0) wrong("buttons", finding::kPendantBit, {b.name, "0"});
  }
  const auto rows = [&layout](const pendant::Field& f) {
    return (f.kind == pendant::FieldKind::work || f.kind == pendant::FieldKind::machine ||
            f.kind == pendant::FieldKind::shown) &&
           f.value >= layout.axes.size();
  };
  if (good && std::any_of(layout.display.begin(), layout.display.end(), rows))
    wrong("display", finding::kPendantRow, {std::to_string(layout.axes.size())});
}

}  // namespace servogate::machine
