// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/words/jog_words.hpp"

#include <array>
#include <iterator>

namespace servogate::gateway {

namespace {

/// {0} axis.
struct Row {
  std::string_view name;
  text::Entry text;
};

/// Index = image::JogEnd.
constexpr Row kRows[] = {
    {"", {"jog.none", "", ""}},
    {"arrived", {"jog.arrived", "{0} has come to its place", "{0} пришла на место"}},
    {"asked",
     {"jog.asked", "{0} was stopped by a request (hold, stop, reset or jog_stop)",
      "{0} остановлена запросом (hold, stop, reset или jog_stop)"}},
    {"keep_alive",
     {"jog.keep-alive",
      "{0} has stopped: no keep-alive from the jogging client for 100 ms (is the computer too busy?)",
      "{0} остановилась: 100 мс не было подтверждения от клиента, который её перемещает (компьютер "
      "перегружен?)"}},
    {"feed_enable",
     {"jog.feed-enable", "{0} has stopped: the PLC no longer permits its motion (feed_enable is FALSE)",
      "{0} остановилась: ПЛК больше не разрешает её подачу (feed_enable = FALSE)"}},
    {"travel",
     {"jog.travel", "{0} has stopped: it is at the end of its travel",
      "{0} остановилась: достигнут конец её хода"}},
    {"alarm",
     {"jog.alarm", "{0} was stopped by an alarm: `servogate alarms` names it",
      "{0} остановлена аварией: её называет `servogate alarms`"}},
    {"power",
     {"jog.power", "{0} was stopped: its drive was switched off", "{0} остановлена: её привод выключен"}},
};
static_assert(std::size(kRows) == image::kJogEnds);

const Row& row_of(image::JogEnd end) noexcept { return kRows[static_cast<std::size_t>(end)]; }

}  // namespace

std::string_view jog_end_name(image::JogEnd end) noexcept { return row_of(end).name; }

std::string_view jog_end_code(image::JogEnd end) noexcept { return row_of(end).text.id; }

std::string jog_end_words(image::JogEnd end, const std::string& axis, text::Language language) {
  return text::render(row_of(end).text, std::array{axis}, language);
}

}  // namespace servogate::gateway
