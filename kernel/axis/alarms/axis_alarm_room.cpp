// SPDX-License-Identifier: Apache-2.0
#include "kernel/axis/alarms/axis_alarm_room.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "firmware_if/image/alarms/alarm_text.hpp"
#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/image/process_image.hpp"
#include "kernel/axis/alarms/axis_rows.hpp"

namespace servogate::axis {

namespace {

using image::AlarmNames;
using image::AlarmRecord;
using text::Language;

/// The figures of these alarms are lengths or angles of the axis.
bool figures_are_lengths(image::AlarmNumber n) {
  using namespace alarm;
  return (n >= kFollowingError && n <= kSetpointStep) ||
         (n >= kHomingSwitchNotFound && n <= kHomingIndexNotFound) || n == kHomingLimitAgain ||
         n == kHomingInterrupted || n == kHomingIndexNearEdge || n == kHomingDriveFailed || n == kOffPath ||
         n == kPlaceUnknown || n == kFollowingErrorHigh || n == kTorqueTooFast ||
         (n >= kGearWindow && n <= kGearNotInStep) || n == kDriveOffline;
}

/// Which figures of an alarm are places of the axis, not lengths: a diameter axis shows them as diameters.
struct Places {
  image::AlarmNumber number;
  bool value, limit;
};
constexpr Places kPlaces[] = {
    {alarm::kOffPath, false, true},           {alarm::kPlaceUnknown, true, true},
    {alarm::kHomingLimitAgain, true, false},  {alarm::kHomingInterrupted, true, false},
    {alarm::kHomingDriveFailed, true, false}, {alarm::kDriveOffline, true, false},
    {alarm::kGearDisengaged, true, false}};

bool of_spindle(const AlarmRecord& r) { return r.number >= 1200 && r.number < 1300; }

/// Why a drive that would be ready is not enabled.
std::string mode_awaited_words(Language language) {
  return language == Language::russian
             ? "; его 6061h не показывает заданный режим, без этого он не включается: сравните 6060h, 6061h "
               "и 6502h (`servogate od`)"
             : "; its 6061h does not show the mode that it was given, and before that it is not enabled: "
               "compare 6060h, 6061h and 6502h (`servogate od`)";
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

std::string master_words(double master, const AlarmNames& names, Language language) {
  const int axis = static_cast<int>(master);
  if (axis >= 0) return image::name_at(names.axes, axis);
  const std::string name = axis == -1 ? "S" : "S" + std::to_string(-axis);
  return (language == Language::russian ? "шпиндель " : "spindle ") + name;
}

/// What disengaged a gear, by GearEnd.
std::string disengaged_words(double why, const std::string& axis, Language language) {
  const bool russian = language == Language::russian;
  switch (static_cast<GearEnd>(static_cast<int>(why))) {
    case GearEnd::feed:
      return russian ? "ПЛК снял " + axis + ".feed_enable" : "the PLC withdrew " + axis + ".feed_enable";
    case GearEnd::power:
      return russian ? "ось потеряла питание или разрешение" : "the axis lost its power or its enable";
    case GearEnd::alarm:
      break;
  }
  return russian ? "ось остановила авария" : "an alarm stopped the axis";
}

std::string state_words(double state, Language language) {
  return std::string(image::drive_state_text(static_cast<int>(state), language));
}

class AxisWords final : public image::AlarmWords {
 public:
  void arguments(const AlarmRecord& r, const AlarmNames& names, Language language,
                 image::AlarmArguments& out) const override {
    if (of_spindle(r)) out[0] = r.detail2 > 0.0 ? "S" + text::number(r.detail2 + 1.0) : "S";
    if (figures_are_lengths(r.number)) lengths(r, names, language, out);
    const auto report = r.detail.get<image::DriveReport>();
    if (r.number == alarm::kSpindleNotReady && r.value == 0.0)
      out[5] =
          language == Language::russian ? "он не сообщает о готовности" : "it does not tell that it is ready";
    else if (r.number == alarm::kSpindleNotReady)
      out[5] = image::error_words(r, static_cast<std::uint16_t>(r.value), names, language);
    if (r.number == alarm::kSpindleDriveFault && (!report || report->error_code == 0))
      out[5] = image::error_words(r, static_cast<std::uint16_t>(r.value), names, language);
    if (r.number == alarm::kDriveRefuses) {
      out[1] = state_words(r.value, language);
      out[2] = state_words(r.limit, language);
      out[7] = r.detail2 > 0.0 ? mode_awaited_words(language) : "";
    }
    if (r.number == alarm::kFollowingError) out[7] = torque_words(r.detail2, language);
    if (r.number >= alarm::kGearWindow && r.number <= alarm::kGearNotInStep) {
      out[6] = disengaged_words(r.detail1, out[0], language);
      out[7] = master_words(r.detail2, names, language);
    }
    if (r.number == alarm::kHomingInterrupted) out[6] = break_words(r.detail1, out[0], language);
  }

 private:
  static void lengths(const AlarmRecord& r, const AlarmNames& names, Language language,
                      image::AlarmArguments& out) {
    const bool russian = language == Language::russian;
    const std::string unit = r.axis >= 0 && r.axis < std::ssize(names.units)
                                 ? " " + names.units[static_cast<std::size_t>(r.axis)]
                                 : (russian ? " мм" : " mm");
    const auto* places = std::find_if(std::begin(kPlaces), std::end(kPlaces),
                                      [&](const Places& p) { return p.number == r.number; });
    const bool diameter = r.axis >= 0 && r.axis < std::ssize(names.diameters) &&
                          names.diameters[static_cast<std::size_t>(r.axis)] && places != std::end(kPlaces);
    const auto figure = [&](double v, bool place) {
      if (!diameter || !place) return text::number(v, 4) + unit;
      return text::number(2.0 * v, 4) + unit + (russian ? " по диаметру" : " in diameter");
    };
    out[1] = figure(r.value, places != std::end(kPlaces) && places->value);
    out[2] = figure(r.limit, places != std::end(kPlaces) && places->limit);
    out[6] = figure(r.detail1, false);
  }
};

}  // namespace

const image::AlarmRoom& alarm_room() {
  static const AxisWords words;
  static const image::AlarmRoom room{kAxisRows, &words};
  return room;
}

}  // namespace servogate::axis
