// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/text/hex.hpp"

#include <iterator>

namespace servogate::image {

using text::Language;

namespace {

constexpr std::string_view kDriveStates[][2] = {{"offline", "нет связи"},
                                                {"not ready to switch on", "не готов к включению"},
                                                {"switch on disabled", "включение запрещено"},
                                                {"ready to switch on", "готов к включению"},
                                                {"switched on", "включён"},
                                                {"operation enabled", "работа разрешена"},
                                                {"quick stop active", "быстрый останов"},
                                                {"fault reaction active", "реакция на аварию"},
                                                {"fault", "авария"}};
constexpr int kStateCount = static_cast<int>(std::size(kDriveStates));

/// State of CiA 402-2, table "state coding" of the status word; -1: no valid one.
int state_of(std::uint16_t statusword) {
  switch (statusword & 0x4F) {
    case 0x00:
      return 1;
    case 0x40:
      return 2;
    case 0x0F:
      return 7;
    case 0x08:
      return 8;
    default:
      break;
  }
  switch (statusword & 0x6F) {
    case 0x21:
      return 3;
    case 0x23:
      return 4;
    case 0x27:
      return 5;
    case 0x07:
      return 6;
    default:
      return -1;
  }
}

}  // namespace

std::string_view drive_state_text(int state, Language language) {
  return state >= 0 && state < kStateCount ? kDriveStates[state][language == Language::russian] : "?";
}

std::string hex_text(unsigned value, int digits) {
  return std::string("0x") + text::hex_number(value, digits);
}

std::string object_text(std::uint16_t index, std::uint16_t subindex) {
  return hex_text(index, 4) + ":" + hex_text(subindex, 2).substr(2);
}

std::string statusword_text(std::uint16_t statusword, Language language) {
  const bool russian = language == Language::russian;
  std::string out = hex_text(statusword, 4) + " ";
  const int state = state_of(statusword);
  out += state < 0 ? (russian ? "недопустимое состояние" : "no valid state")
                   : std::string(drive_state_text(state, language));
  if (statusword & 0x0080) out += russian ? ", предупреждение" : ", warning";
  if (statusword & 0x0800) out += russian ? ", внутреннее ограничение" : ", internal limit";
  if (state >= 3 && state <= 5 && !(statusword & 0x0010))
    out += russian ? ", нет силового напряжения" : ", no main voltage";
  return out;
}

}  // namespace servogate::image
