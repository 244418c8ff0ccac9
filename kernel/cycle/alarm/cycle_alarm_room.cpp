// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/alarm/cycle_alarm_room.hpp"

#include <iterator>

#include "firmware_if/image/alarms/alarm_text.hpp"
#include "kernel/cycle/alarm/cycle_rows.hpp"

namespace servogate::cycle {

namespace {

/// detail1 of an overrun: 0 the thread woke up late, n the phase n - 1 of the cycle before (cycle::Phase).
constexpr std::string_view kLatePhases[][2] = {
    {"waking up (the computer was busy elsewhere)", "пробуждение (компьютер был занят другим)"},
    {"receiving", "приём"},
    {"PLC", "ПЛК"},
    {"interpolation", "интерполяция"},
    {"axes", "оси"},
    {"sending", "передача"},
    {"publishing", "публикация снимков"}};

class CycleWords final : public image::AlarmWords {
 public:
  void arguments(const image::AlarmRecord& r, const image::AlarmNames&, text::Language language,
                 image::AlarmArguments& out) const override {
    if (r.number != image::alarm::kOverrunLimit) return;
    const int phase = static_cast<int>(r.detail1);
    out[6] = phase >= 0 && phase < std::ssize(kLatePhases)
                 ? kLatePhases[phase][language == text::Language::russian]
                 : "?";
  }
};

}  // namespace

const image::AlarmRoom& alarm_room() {
  static const CycleWords words;
  static const image::AlarmRoom room{kCycleRows, &words};
  return room;
}

}  // namespace servogate::cycle
