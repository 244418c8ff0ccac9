// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::cycle {

using image::AlarmRecord;
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

constexpr std::string_view kReactionWords[][2] = {
    {"none", "нет"},
    {"warning", "предупреждение"},
    {"stop at block end", "останов в конце кадра"},
    {"stop on the path", "останов на траектории"},
    {"stop of each axis", "останов каждой оси"},
    {"stop of each axis, then power off", "останов каждой оси, затем отключение питания"},
    {"quick stop", "быстрый останов"},
    {"power off", "отключение питания"}};
constexpr std::string_view kResetWords[][2] = {
    {"reset", "сброс"},
    {"reset after the cause has gone", "сброс после устранения причины"},
    {"goes by itself", "снимается автоматически"}};

/// detail1 of an overrun: 0 the thread woke up late, n the phase n - 1 of the cycle before (cycle::Phase).
constexpr std::string_view kLatePhases[][2] = {
    {"waking up (the computer was busy elsewhere)", "пробуждение (компьютер был занят другим)"},
    {"receiving", "приём"},
    {"PLC", "ПЛК"},
    {"interpolation", "интерполяция"},
    {"axes", "оси"},
    {"sending", "передача"},
    {"publishing", "публикация снимков"}};

std::string_view phase_words(int phase, Language language) {
  return phase >= 0 && phase < static_cast<int>(std::size(kLatePhases))
             ? kLatePhases[phase][language == Language::russian]
             : "?";
}

std::string_view state_words(int state, Language language) {
  return state >= 0 && state < kStateCount ? kDriveStates[state][language == Language::russian] : "?";
}

std::string hex(unsigned value, int digits) {
  char buffer[16];
  std::snprintf(buffer, sizeof buffer, "0x%0*X", digits, value);
  return buffer;
}

std::string name_at(const std::vector<std::string>& names, int index) {
  return index >= 0 && index < std::ssize(names) ? names[static_cast<std::size_t>(index)]
                                                 : std::to_string(index);
}

/// The figures of these alarms are lengths or angles of the axis.
bool figures_are_lengths(image::AlarmNumber n) {
  using namespace axis::alarm;
  return (n >= kFollowingError && n <= kSetpointStep) ||
         (n >= kHomingSwitchNotFound && n <= kHomingIndexNotFound) || n == kHomingLimitAgain ||
         n == kHomingInterrupted || n == kHomingIndexNearEdge || n == kHomingDriveFailed || n == kOffPath ||
         n == kPlaceUnknown || n == kFollowingErrorHigh || n == kTorqueTooFast || n == kDriveOffline;
}

/// Which figures of an alarm are places of the axis, not lengths: a diameter axis shows them as diameters.
struct Places {
  image::AlarmNumber number;
  bool value, limit;
};
constexpr Places kPlaces[] = {
    {axis::alarm::kOffPath, false, true},           {axis::alarm::kPlaceUnknown, true, true},
    {axis::alarm::kHomingLimitAgain, true, false},  {axis::alarm::kHomingInterrupted, true, false},
    {axis::alarm::kHomingDriveFailed, true, false}, {axis::alarm::kDriveOffline, true, false}};

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

/// Why a drive that would be ready is not enabled.
std::string mode_awaited_words(Language language) {
  return language == Language::russian ? "; его 6061h не показывает заданный режим, без этого он не "
                                         "включается: сравните 6060h, 6061h и "
                                         "6502h (`servogate od`)"
                                       : "; its 6061h does not show the mode that it was given, and before "
                                         "that it is not enabled: compare "
                                         "6060h, 6061h and 6502h (`servogate od`)";
}

/// NMT state of a heartbeat.
std::string nmt_words(int state, Language language) {
  const bool russian = language == Language::russian;
  if (state == 4) return russian ? "Stopped (остановлен)" : "Stopped";
  if (state == 127) return russian ? "Pre-operational (не в работе)" : "Pre-operational";
  return std::to_string(state);
}

/// "2 (can.y, axis Y)".
std::string node_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  std::string words = names.node_name ? names.node_name(r.segment, r.node) : std::string();
  if (r.axis >= 0) {
    if (!words.empty()) words += ", ";
    words += (language == Language::russian ? "ось " : "axis ") + name_at(names.axes, r.axis);
  }
  return std::to_string(r.node) + (words.empty() ? "" : " (" + words + ")");
}

/// The sentences of these begin with the bus, whichever node has to do with it.
bool of_a_bus(image::AlarmNumber n) {
  using namespace alarm;
  return n == kBusOff || n == kBusErrorPassive || n == kBusDown || n == kBusSendOverflow ||
         n == kForeignFrame || n == kForeignRequest || n == kLeadLost;
}

std::string where(const AlarmRecord& r, const AlarmNames& names, Language language) {
  if (r.source >= 0) return name_at(names.sources, r.source);
  if (r.node >= 0 && !of_a_bus(r.number)) return node_words(r, names, language);
  return r.segment < 0 ? "-" : name_at(names.segments, r.segment);
}

std::string detail_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  return names.detail ? names.detail(r, language) : std::string();
}

std::string boot_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const std::string words = detail_words(r, names, language);
  if (!words.empty()) return words;
  return language == Language::russian ? "запуск не удался" : "start-up failed";
}

std::string plc_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  std::string words = names.plc_fault ? names.plc_fault(r, language) : std::string();
  if (!words.empty()) return words;
  const bool russian = language == Language::russian;
  return (russian ? "ошибка " : "error ") + text::number(r.value, 0) +
         (russian ? " в строке " : " in line ") + std::to_string(r.line);
}

std::string frame_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const std::string words = detail_words(r, names, language);
  return words.empty() ? hex(static_cast<unsigned>(r.value), 3) : words;
}

std::string axis_name(const AlarmRecord& r, const AlarmNames& names) {
  if (of_spindle(r)) return r.axis > 0 ? "S" + std::to_string(r.axis + 1) : "S";
  return r.axis < 0 ? "-" : name_at(names.axes, r.axis);
}

std::string error_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const bool in_value = r.number == axis::alarm::kSpindleDriveFault && r.error_code == 0;
  const auto code = in_value ? static_cast<std::uint16_t>(r.value) : r.error_code;
  if (code == 0) return language == Language::russian ? "без кода" : "without a code";
  std::string out = hex(code, 4);
  const std::string words = names.error_text ? names.error_text(r, code, language) : std::string();
  return words.empty() ? out : out + " (" + words + ")";
}

std::string torque_words(double permille, Language language) {
  const bool russian = language == Language::russian;
  if (std::isnan(permille))
    return russian ? "моменте, о котором привод не сообщает" : "a torque that the drive does not report";
  const std::string number = text::number(permille, 1);
  return russian ? "моменте " + number + " ‰ от номинального" : number + " ‰ of the rated torque";
}

/// What broke a homing off, by image::JogEnd.
std::string break_words(double why, const std::string& axis, Language language) {
  const bool russian = language == Language::russian;
  switch (static_cast<image::JogEnd>(static_cast<int>(why))) {
    case image::JogEnd::feed:
      return russian ? "ПЛК снял " + axis + ".feed_enable (в примерах: открыта дверь)"
                     : "the PLC withdrew " + axis + ".feed_enable (in the examples: the door is open)";
    case image::JogEnd::alarm:
      return russian ? "движение прервала авария" : "an alarm took the motion away";
    case image::JogEnd::power:
      return russian ? "привод отключён" : "its drive was switched off";
    default:
      return russian ? "его прервал привод" : "its drive ended it";
  }
}

/// "bracket.nc:12" of a block, the bare number elsewhere.
std::string line_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const std::string line = std::to_string(r.line);
  if (r.process < 0) return line;
  // What the interpreter found follows, with its file.
  const bool found = r.number == alarm::kProgramError || r.number == alarm::kProgramWarning;
  const std::string file =
      !found && names.program_file ? names.program_file(r.process, r.run, r.file) : std::string();
  if (!file.empty()) return file + ":" + line;
  return (language == Language::russian ? "строка " : "line ") + line;
}

std::vector<std::string> arguments(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const std::string unit = !figures_are_lengths(r.number) ? ""
                           : r.axis >= 0 && r.axis < std::ssize(names.units)
                               ? " " + names.units[static_cast<std::size_t>(r.axis)]
                               : (language == Language::russian ? " мм" : " mm");
  auto figure = [&](double v) { return text::number(v, 4) + unit; };
  const auto* places = std::find_if(std::begin(kPlaces), std::end(kPlaces),
                                    [&](const Places& p) { return p.number == r.number; });
  const bool diameter = r.axis >= 0 && r.axis < std::ssize(names.diameters) &&
                        names.diameters[static_cast<std::size_t>(r.axis)] && places != std::end(kPlaces);
  const auto place = [&](double v, bool is_place) {
    if (!diameter || !is_place) return figure(v);
    return figure(2.0 * v) + (language == Language::russian ? " по диаметру" : " in diameter");
  };
  std::vector<std::string> out = {axis_name(r, names),
                                  place(r.value, places != std::end(kPlaces) && places->value),
                                  place(r.limit, places != std::end(kPlaces) && places->limit),
                                  where(r, names, language),
                                  statusword_text(r.statusword, language),
                                  error_words(r, names, language),
                                  figure(r.detail1),
                                  text::number(r.detail2, 1),
                                  hex(r.object_index, 4) + ":" + hex(r.object_subindex, 2).substr(2),
                                  line_words(r, names, language)};
  if (r.number == axis::alarm::kDriveRefuses) {
    out[1] = state_words(static_cast<int>(r.value), language);
    out[2] = state_words(static_cast<int>(r.limit), language);
    out[7] = r.detail2 > 0.0 ? mode_awaited_words(language) : "";
  }
  if (r.number == axis::alarm::kFollowingError) out[7] = torque_words(r.detail2, language);
  if (r.number == axis::alarm::kHomingInterrupted) out[6] = break_words(r.detail1, out[0], language);
  if (r.number == alarm::kOverrunLimit) out[6] = phase_words(static_cast<int>(r.detail1), language);
  if (r.number == alarm::kBootFailed) out[6] = boot_words(r, names, language);
  if (r.number == axis::alarm::kPdoMissing || r.number == alarm::kPdoShort)
    out[6] = r.detail1 <= 0.0     ? ""
             : r.detail1 >= 255.0 ? " (SDO)"
                                  : " (TPDO" + text::number(r.detail1, 0) + ")";
  if (r.number == alarm::kPlcBudget || r.number == alarm::kPlcFault) out[6] = plc_words(r, names, language);
  if (r.number == alarm::kNodeLeft) out[1] = nmt_words(static_cast<int>(r.value), language);
  if (r.number == alarm::kForeignFrame || r.number == alarm::kForeignRequest || r.number == alarm::kLeadLost)
    out[8] = frame_words(r, names, language);
  return out;
}

}  // namespace

std::string_view words(image::Reaction reaction, text::Language language) {
  return kReactionWords[static_cast<int>(reaction)][language == text::Language::russian];
}

std::string_view words(ResetCondition condition, text::Language language) {
  return kResetWords[static_cast<int>(condition)][language == text::Language::russian];
}

std::string statusword_text(std::uint16_t statusword, Language language) {
  const bool russian = language == Language::russian;
  std::string out = hex(statusword, 4) + " ";
  const int state = state_of(statusword);
  out += state < 0 ? (russian ? "недопустимое состояние" : "no valid state")
                   : std::string(state_words(state, language));
  if (statusword & 0x0080) out += russian ? ", предупреждение" : ", warning";
  if (statusword & 0x0800) out += russian ? ", внутреннее ограничение" : ", internal limit";
  if (state >= 3 && state <= 5 && !(statusword & 0x0010))
    out += russian ? ", нет силового напряжения" : ", no main voltage";
  return out;
}

std::string render(const AlarmRecord& record, const AlarmNames& names, Language language) {
  if (record.number == alarm::kExternalAlarm && names.external_text) {
    std::string own = names.external_text(static_cast<int>(record.value), language);
    if (!own.empty()) return own;
  }
  const AlarmRow* row = find_alarm(record.number);
  if (row == nullptr) return "alarm " + std::to_string(record.number);
  std::string sentence = text::render(row->text, arguments(record, names, language), language);
  const bool of_program = record.number == alarm::kProgramError || record.number == alarm::kProgramWarning;
  if (of_program && names.program_finding)
    if (const std::string found =
            names.program_finding(record.process, static_cast<int>(record.value), language);
        !found.empty())
      sentence += ": " + found;
  return sentence;
}

std::string render_remedy(const AlarmRecord& record, const AlarmNames& names, Language language) {
  const AlarmRow* row = find_alarm(record.number);
  if (row == nullptr) return {};
  const text::Entry remedy{row->text.id, row->remedy_en, row->remedy_ru};
  return text::render(remedy, arguments(record, names, language), language);
}

}  // namespace servogate::cycle
