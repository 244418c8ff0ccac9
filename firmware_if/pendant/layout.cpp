// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/layout.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace servogate::pendant {

namespace {

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Splits at the first `at`; the rest is empty where there is none.
std::pair<std::string_view, std::string_view> split(std::string_view text, char at) {
  const std::size_t found = text.find(at);
  if (found == std::string_view::npos) return {trim(text), {}};
  return {trim(text.substr(0, found)), trim(text.substr(found + 1))};
}

std::optional<std::uint8_t> byte(std::string_view text) {
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  }
  unsigned value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size() || value > 0xFF) return std::nullopt;
  return static_cast<std::uint8_t>(value);
}

std::optional<double> number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool is_name(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

std::optional<char> letter(std::string_view text) {
  if (text.size() != 1 || text[0] < 'A' || text[0] > 'Z') return std::nullopt;
  return text[0];
}

constexpr std::string_view kActions[] = {
    "nothing", "shift",       "stop",      "hold",        "start_hold", "reset",     "power", "home",
    "zero",    "override_by", "next_step", "coordinates", "select",     "hold_axis", "mdi",   "path_wheel"};
constexpr std::string_view kFields[] = {"",        "work",          "machine",          "shown",     "feed",
                                        "spindle", "feed_override", "spindle_override", "step_mark", "flags"};

}  // namespace

int Layout::button(std::string_view named) const {
  for (std::size_t b = 0; b < buttons.size(); ++b)
    if (buttons[b].name == named) return static_cast<int>(b);
  return -1;
}

int Layout::axis_index(char letter) const {
  for (std::size_t a = 0; a < axes.size(); ++a)
    if (axes[a].letter == letter) return static_cast<int>(a);
  return -1;
}

std::optional<Button> parse_button(std::string_view text) {
  const auto [code, name] = split(trim(text), ' ');
  const auto value = byte(code);
  if (!value || !is_name(name)) return std::nullopt;
  return Button{std::string(name), *value};
}

std::optional<AxisCode> parse_axis(std::string_view text) {
  const auto [code, name] = split(trim(text), ' ');
  const auto value = byte(code);
  if (!value) return std::nullopt;
  if (name == "off") return AxisCode{0, *value};
  const auto axis = letter(name);
  return axis ? std::optional(AxisCode{*axis, *value}) : std::nullopt;
}

std::optional<Step> parse_step(std::string_view text) {
  Step step;
  auto [front, mark] = split(trim(text), '=');
  if (!mark.empty()) {
    const auto value = byte(mark);
    if (!value) return std::nullopt;
    step.mark = *value;
  }
  const auto [code, length] = split(front, ' ');
  if (!length.empty()) {
    const auto value = byte(code);
    if (!value) return std::nullopt;
    step.code = *value;
    front = length;
  }
  const auto value = number(front);
  if (!value || *value <= 0.0) return std::nullopt;
  step.length = *value;
  return step;
}

std::optional<Field> parse_field(std::string_view text) {
  if (const auto value = byte(trim(text)); value && trim(text).starts_with("0x"))
    return Field{FieldKind::constant, *value};
  const auto [word, row] = split(trim(text), ' ');
  for (std::size_t k = 1; k < std::size(kFields); ++k) {
    if (kFields[k] != word) continue;
    const auto kind = static_cast<FieldKind>(k);
    const bool rows = kind == FieldKind::work || kind == FieldKind::machine || kind == FieldKind::shown;
    if (!rows) return row.empty() ? std::optional(Field{kind, 0}) : std::nullopt;
    const auto value = byte(row);
    if (!value || *value < 1 || *value > kMostAxes) return std::nullopt;
    return Field{kind, static_cast<std::uint8_t>(*value - 1)};
  }
  return std::nullopt;
}

std::string_view action_word(Action action) { return kActions[static_cast<std::size_t>(action)]; }

std::string_view action_words() {
  return "nothing, shift, stop, hold, start_hold, reset, power, home, zero, override_by N, next_step, "
         "coordinates, "
         "select AXIS, hold_axis AXIS, mdi BLOCK, path_wheel";
}

std::optional<Binding> parse_binding(std::string_view text, const Layout& layout) {
  const auto [chord, deed] = split(text, ':');
  const auto [first, second] = split(chord, '+');
  Binding out;
  out.button = layout.button(second.empty() ? first : second);
  out.with = second.empty() ? -1 : layout.button(first);
  if (out.button < 0 || (!second.empty() && (out.with < 0 || out.with == out.button))) return std::nullopt;
  const auto [word, rest] = split(deed, ' ');
  const auto found = std::find(std::begin(kActions), std::end(kActions), word);
  if (found == std::end(kActions)) return std::nullopt;
  out.action = static_cast<Action>(found - std::begin(kActions));
  switch (out.action) {
    case Action::override_by: {
      const auto value = number(rest);
      if (!value || *value == 0.0 || std::abs(*value) > 150.0) return std::nullopt;
      out.value = *value;
      return out;
    }
    case Action::select:
    case Action::hold_axis: {
      const auto axis = letter(rest);
      if (!axis) return std::nullopt;
      out.axis = *axis;
      return out;
    }
    case Action::mdi:
      if (rest.empty()) return std::nullopt;
      out.text = rest;
      return out;
    default:
      return rest.empty() ? std::optional(out) : std::nullopt;
  }
}

void bind(Layout& layout, const Binding& binding) {
  std::erase_if(layout.bindings,
                [&](const Binding& b) { return b.button == binding.button && b.with == binding.with; });
  layout.bindings.push_back(binding);
}

}  // namespace servogate::pendant
