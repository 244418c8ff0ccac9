// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/text/hex.hpp"

namespace servogate::canopen {
namespace {

constexpr text::Entry kStates[] = {
    {"drive-offline", "Offline", "Нет связи"},
    {"drive-not-ready", "Not ready to switch on", "Не готов к включению"},
    {"drive-switch-on-disabled", "Switch on disabled", "Включение запрещено"},
    {"drive-ready", "Ready to switch on", "Готов к включению"},
    {"drive-switched-on", "Switched on", "Включён"},
    {"drive-enabled", "Operation enabled", "Работа разрешена"},
    {"drive-quick-stop", "Quick stop active", "Быстрый останов"},
    {"drive-fault-reaction", "Fault reaction active", "Реакция на неисправность"},
    {"drive-fault", "Fault", "Неисправность"},
};
constexpr text::Entry kUndefined{"drive-state-undefined", "undefined state {0}",
                                 "неопределённое состояние {0}"};

struct BitText {
  std::uint16_t mask;
  std::uint16_t value;
  text::Entry entry;
};
// Bits 12 and 13 mean different things per mode and are left to whoever knows the mode.
constexpr BitText kBits[] = {
    {statusword::kVoltageEnabled, 0, {"drive-bit-no-voltage", "no main voltage", "нет силового питания"}},
    {statusword::kWarning, statusword::kWarning, {"drive-bit-warning", "warning", "предупреждение"}},
    {statusword::kRemote, 0, {"drive-bit-local", "not under remote control", "не под управлением по шине"}},
    {statusword::kTargetReached,
     statusword::kTargetReached,
     {"drive-bit-target", "target reached", "задание достигнуто"}},
    {statusword::kInternalLimit,
     statusword::kInternalLimit,
     {"drive-bit-limit", "internal limit active", "действует внутреннее ограничение"}},
};

std::string hex(std::uint16_t word) { return text::hex_number(word, 4) + "h"; }

}  // namespace

const text::Entry& state_text(image::DriveState state) noexcept { return kStates[static_cast<int>(state)]; }

std::string describe_statusword(std::uint16_t word, text::Language language) {
  std::string sentence;
  if (const auto state = decode_state(word)) {
    sentence = text::render(state_text(*state), {}, language);
  } else {
    const std::string arguments[] = {hex(word)};
    sentence = text::render(kUndefined, arguments, language);
  }
  const char* separator = "; ";
  for (const BitText& bit : kBits) {
    if ((word & bit.mask) != bit.value) continue;
    sentence += separator + text::render(bit.entry, {}, language);
    separator = ", ";
  }
  return sentence;
}

}  // namespace servogate::canopen
