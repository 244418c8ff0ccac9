// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/master/board_alarms.hpp"

#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/alarms/alarm_text.hpp"

namespace servogate::board {

namespace {

constexpr image::AlarmRow kRows[] = {
    {image::alarm::kBoardRefused,
     image::Reaction::stop_on_path,
     image::ResetCondition::reset,
     {"board.refused", "{3}: the board refuses what the machine file asks of it: {6}",
      "{3}: плата отказывается от того, что задано в файле станка: {6}"},
     "Compare [axis.board] and the station in the machine file with what the firmware of the board has "
     "(docs/usb-board.md), or install the firmware that belongs to this version. The board is asked again "
     "every 2 s.",
     "Сравните [axis.board] и станцию в файле станка с тем, что есть у прошивки платы (docs/usb-board.md), "
     "или установите прошивку этой версии. Плату спрашивают снова каждые 2 с."},
};

struct Words {
  std::string_view english, russian;
};
/// {0}: what is wanted, {1}: what it has. In the order of RefusedFor.
constexpr Words kReasons[] = {
    {"no reason", "причина неизвестна"},
    {"it speaks version {1} of the protocol, this program version {0}",
     "у неё версия протокола {1}, у этой программы {0}"},
    {"its firmware does not take this `watchdog`", "её прошивка не принимает такой `watchdog`"},
    {"its firmware does not take this cycle time", "её прошивка не принимает такое время цикла"},
    {"it has no channel {0}", "у неё нет канала {0}"},
    {"its channel {0} has no such output", "у её канала {0} нет такого выхода"},
    {"its channel {0} has no encoder", "у её канала {0} нет энкодера"},
    {"the fastest axis needs {0} steps/s, it makes {1}", "самой быстрой оси нужно {0} шагов/с, она даёт {1}"},
    {"{0} digital inputs are used, it has {1}", "используется цифровых входов: {0}, у неё {1}"},
    {"{0} digital outputs are used, it has {1}", "используется цифровых выходов: {0}, у неё {1}"},
    {"{0} analog inputs are used, it has {1}", "используется аналоговых входов: {0}, у неё {1}"},
    {"{0} analog outputs are used, it has {1}", "используется аналоговых выходов: {0}, у неё {1}"},
};

class BoardWords final : public image::AlarmWords {
 public:
  void arguments(const image::AlarmRecord& r, const image::AlarmNames&, text::Language language,
                 image::AlarmArguments& out) const override {
    const std::size_t why = r.key < std::size(kReasons) ? r.key : 0;
    const Words& words = kReasons[why];
    const std::vector<std::string> figures{text::number(r.value), text::number(r.limit)};
    out[6] = text::render({"", words.english, words.russian}, figures, language);
  }
};

}  // namespace

image::AlarmRecord refused_alarm(const Session& session, int source) noexcept {
  image::AlarmRecord r;
  r.number = image::alarm::kBoardRefused;
  r.source = static_cast<std::int16_t>(source);
  const Refused& refused = session.refused();
  r.key = static_cast<std::uint64_t>(refused.why);
  r.value = refused.wanted;
  r.limit = refused.has;
  return r;
}

const image::AlarmRoom& alarm_room() {
  static const BoardWords words;
  static const image::AlarmRoom room{kRows, &words};
  return room;
}

}  // namespace servogate::board
