// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/device_words.hpp"

#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {

namespace {

struct Words {
  std::uint32_t number;
  const char* english;
  const char* russian;
};

/// Device profiles by the low word of 1000h. Source: CiA 301, 7.5.2.1, and the profiles' own titles.
constexpr Words kProfiles[] = {
    {0, "device without a standard profile", "устройство без стандартного профиля"},
    {401, "I/O module", "модуль ввода-вывода"},
    {402, "drive", "привод"},
    {404, "measuring device or controller", "измеритель или регулятор"},
    {405, "PLC", "ПЛК"},
    {406, "encoder", "датчик положения"},
    {408, "hydraulic drive", "гидропривод"},
    {410, "inclinometer", "инклинометр"},
    {412, "medical device", "медицинское устройство"},
    {413, "gateway of a truck", "шлюз грузовика"},
    {414, "weaving machine", "ткацкая машина"},
    {415, "road construction machine", "дорожная машина"},
    {416, "door control", "управление дверью"},
    {417, "lift control", "управление лифтом"},
    {418, "battery", "аккумулятор"},
    {419, "battery charger", "зарядное устройство"},
    {420, "extruder part", "часть экструдера"},
    {422, "municipal vehicle", "коммунальная машина"},
    {425, "medical add-on", "медицинская приставка"},
    {437, "photovoltaic device", "фотоэлектрическое устройство"},
    {443, "subsea instrument", "подводный прибор"},
    {445, "RFID reader", "считыватель RFID"},
    {447, "special vehicle device", "прибор спецмашины"},
    {450, "pump", "насос"},
    {452, "positioning drive", "позиционный привод"},
    {453, "power supply", "блок питания"},
    {454, "energy management device", "устройство учёта энергии"},
    {455, "drilling machine", "буровая машина"},
    {458, "energy meter", "счётчик энергии"},
    {459, "weighing device", "весы"},
};
/// Bits 16 to 23 of 1000h. Source: CiA 402-1, "Object 1000h".
constexpr Words kDrives[] = {{1u << 16, "frequency converter", "преобразователь частоты"},
                             {1u << 17, "servo drive", "сервопривод"},
                             {1u << 18, "stepper drive", "шаговый привод"}};
/// Source: CiA 401, "Object 1000h".
constexpr Words kInputsOutputs[] = {{1u << 16, "digital inputs", "дискретные входы"},
                                    {1u << 17, "digital outputs", "дискретные выходы"},
                                    {1u << 18, "analog inputs", "аналоговые входы"},
                                    {1u << 19, "analog outputs", "аналоговые выходы"}};
/// Source: CiA 406, "Object 1000h".
constexpr Words kEncoders[] = {
    {1, "single-turn absolute rotary encoder", "однооборотный абсолютный датчик угла"},
    {2, "multi-turn absolute rotary encoder", "многооборотный абсолютный датчик угла"},
    {3, "single-turn absolute rotary encoder with electronic turn-count",
     "однооборотный абсолютный датчик угла с электронным счётом оборотов"},
    {4, "incremental rotary encoder", "инкрементный датчик угла"},
    {5, "incremental rotary encoder with electronic counting",
     "инкрементный датчик угла с электронным счётом"},
    {6, "incremental linear encoder", "инкрементная линейка"},
    {7, "incremental linear encoder with electronic counting", "инкрементная линейка с электронным счётом"},
    {8, "absolute linear encoder", "абсолютная линейка"},
    {9, "absolute linear encoder with cyclic coding", "абсолютная линейка с циклическим кодом"},
    {10, "multi-sensor encoder", "многоканальный датчик положения"}};

std::string flags(std::uint32_t type, const Words* begin, const Words* end, text::Language language) {
  std::string words;
  for (const Words* w = begin; w != end; ++w)
    if ((type & w->number) != 0)
      words += (words.empty() ? "" : ", ") +
               std::string(language == text::Language::english ? w->english : w->russian);
  return words;
}

std::string words_in(std::uint32_t type, text::Language language) {
  const std::uint32_t profile = type & 0xFFFF;
  std::string words;
  if (profile == 402) words = flags(type, std::begin(kDrives), std::end(kDrives), language);
  if (profile == 401) {
    words = flags(type, std::begin(kInputsOutputs), std::end(kInputsOutputs), language);
    if (!words.empty())
      words = (language == text::Language::english ? "I/O module with " : "модуль ввода-вывода: ") + words;
  }
  if (profile == 406)
    for (const Words& w : kEncoders)
      if (w.number == type >> 16) words = language == text::Language::english ? w.english : w.russian;
  for (const Words& w : kProfiles)
    if (words.empty() && w.number == profile)
      words = language == text::Language::english ? w.english : w.russian;
  if (words.empty()) words = language == text::Language::english ? "device" : "устройство";
  return profile == 0 ? words : words + " (CiA " + std::to_string(profile) + ")";
}

}  // namespace

std::string device_type_words(std::uint32_t device_type) {
  return text::both(words_in(device_type, text::Language::english),
                    words_in(device_type, text::Language::russian));
}

std::string nmt_state_words(NmtState state) {
  switch (state) {
    case NmtState::boot_up:
      return text::both("boot-up", "запуск");
    case NmtState::stopped:
      return text::both("stopped", "остановлен");
    case NmtState::operational:
      return text::both("operational", "в работе");
    case NmtState::pre_operational:
      break;
  }
  return text::both("pre-operational", "предрабочее состояние");
}

const char* nmt_state_name(NmtState state) {
  switch (state) {
    case NmtState::boot_up:
      return "boot_up";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::pre_operational:
      break;
  }
  return "pre_operational";
}

std::string drive_modes(std::uint32_t supported, const char* between) {
  std::string words;
  for (int mode = 1; mode <= 11; ++mode) {
    const auto m = static_cast<OperationMode>(mode);
    if ((supported & supported_bit(m)) == 0) continue;
    // cstca has no place in the master's own list. Source: CiA 402-2, "Object 6502h".
    const std::string name = mode == 11 ? "cstca" : short_name(m);
    words += (words.empty() ? "" : between) + name;
  }
  return words;
}

}  // namespace servogate::canopen
