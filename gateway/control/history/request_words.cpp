// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/history/request_words.hpp"

#include <algorithm>
#include <array>

#include "firmware_if/text/units.hpp"
#include "gateway/control/history/texts.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::gateway::history {

namespace {

using image::RequestKind;
using text::Entry;

/// {0} the axis, {1} the value as `shown` has it.
struct Row {
  RequestKind kind;
  enum class Value { none, plain, sign, on_off, percent, process, function } shown;
  Entry words;
};
constexpr Row kRows[] = {
    {RequestKind::power, Row::Value::on_off, {"history.ask-power", "drives {1}", "приводы {1}"}},
    {RequestKind::home, Row::Value::none, {"history.ask-home", "home {0}", "поиск нулевой точки {0}"}},
    {RequestKind::jog_increment, Row::Value::plain, {"history.ask-jog", "jog {0} by {1}", "шаг {0} на {1}"}},
    {RequestKind::jog_continuous, Row::Value::sign, {"history.ask-jog-on", "jog {0} {1}", "толчок {0} {1}"}},
    {RequestKind::jog_stop, Row::Value::none, {"history.ask-jog-stop", "end of the jog", "конец толчка"}},
    {RequestKind::zero,
     Row::Value::plain,
     {"history.ask-zero", "set {0} to {1}", "присвоить {0} значение {1}"}},
    {RequestKind::assign,
     Row::Value::process,
     {"history.ask-assign", "give {0} to process {1}", "передать {0} процессу {1}"}},
    {RequestKind::tables,
     Row::Value::none,
     {"history.ask-tables", "change origins or tools", "изменить начала или инструмент"}},
    {RequestKind::reposition,
     Row::Value::none,
     {"history.ask-return", "return to the path", "возврат на контур"}},
    {RequestKind::retrace,
     Row::Value::none,
     {"history.ask-retrace", "back along the path", "назад по контуру"}},
    {RequestKind::function,
     Row::Value::function,
     {"history.ask-function", "{1} beside the held program", "{1} при приостановленной программе"}},
    {RequestKind::start, Row::Value::none, {"history.ask-start", "start", "пуск"}},
    {RequestKind::step, Row::Value::none, {"history.ask-step", "one block", "один кадр"}},
    {RequestKind::hold, Row::Value::none, {"history.ask-hold", "feed hold", "останов подачи"}},
    {RequestKind::resume, Row::Value::none, {"history.ask-resume", "resume", "продолжение"}},
    {RequestKind::stop, Row::Value::none, {"history.ask-stop", "stop", "стоп"}},
    {RequestKind::reset, Row::Value::none, {"history.ask-reset", "reset", "сброс"}},
    {RequestKind::override_feed,
     Row::Value::percent,
     {"history.ask-override", "feed override {1}", "коррекция подачи {1}"}},
    {RequestKind::quick_stop, Row::Value::none, {"history.ask-quick-stop", "quick stop", "быстрый останов"}},
    {RequestKind::acknowledge,
     Row::Value::none,
     {"history.ask-acknowledge", "acknowledge alarms", "подтверждение аварий"}},
    {RequestKind::force,
     Row::Value::plain,
     {"history.ask-force", "force a place to {1}", "фиксация места: {1}"}},
    {RequestKind::set_place,
     Row::Value::plain,
     {"history.ask-set", "write {1} into a place", "запись {1} по адресу"}},
    {RequestKind::release_force, Row::Value::none, {"history.ask-release", "end a force", "снятие фиксации"}},
    {RequestKind::logic,
     Row::Value::none,
     {"history.ask-logic", "another PLC program", "другая программа ПЛК"}},
    {RequestKind::logic_scan,
     Row::Value::none,
     {"history.ask-scan", "hold the PLC or run single scans", "останов ПЛК или отдельные циклы"}},
};

const Row* row_of(RequestKind kind) noexcept {
  const auto found =
      std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.kind == kind; });
  return found == std::end(kRows) ? nullptr : &*found;
}

std::string shown(const Row& row, const image::Request& request) {
  const double value = request.value;
  switch (row.shown) {
    case Row::Value::process:
      return std::to_string(request.process + 1);
    case Row::Value::function: {
      constexpr std::string_view kWords[image::kFunctions] = {"M", "T", "M3 S", "M4 S", "M5"};
      const std::string word(kWords[std::min<std::size_t>(request.index, image::kFunctions - 1)]);
      return word == "M5" ? word : word + text::number(value, 4);
    }
    case Row::Value::plain:
      return text::number(value, 4);
    case Row::Value::sign:
      return value < 0.0 ? "-" : "+";
    case Row::Value::on_off:
      return value != 0.0 ? text::both("on", "включить") : text::both("off", "выключить");
    case Row::Value::percent:
      return text::number(value * 100.0, 1) + " %";
    case Row::Value::none:
      break;
  }
  return {};
}

/// Homing names its axes as bits.
std::string axes_of(const image::Request& request, const machine::MachineConfig& machine) {
  if (request.axis >= 0) return machine.axes[static_cast<std::size_t>(request.axis)].letter;
  const auto bits = request.kind == RequestKind::home ? static_cast<std::uint32_t>(request.value) : 0u;
  std::string list;
  for (std::size_t a = 0; a < machine.axes.size(); ++a)
    if ((bits >> a & 1u) != 0) list += (list.empty() ? "" : ", ") + machine.axes[a].letter;
  return list.empty() ? text::both("all axes", "всех осей") : list;
}

}  // namespace

bool kept(RequestKind kind) noexcept { return row_of(kind) != nullptr; }

Event request_event(const image::Request& request, const image::Answer& answer,
                    const machine::MachineConfig& machine, double machine_s) {
  const Row& row = *row_of(request.kind);
  const auto in = [&](text::Language language) {
    const std::string axis = axes_of(request, machine);
    return text::render(row.words, std::array{axis, shown(row, request)}, language);
  };
  const auto asker = [&](text::Language language) { return cycle::asker_words(request.asker, language); };
  const auto refusal = [&](text::Language language) {
    return cycle::render(answer, machine.letters(), language, machine.unit_words());
  };
  const std::string who = text::both(asker(text::Language::english), asker(text::Language::russian));
  const std::string what = text::both(in(text::Language::english), in(text::Language::russian));
  Event e =
      answer.refusal == 0
          ? event("request", says::kAsked, {who, what}, machine_s)
          : event("refused", says::kRefused,
                  {who, what, text::both(refusal(text::Language::english), refusal(text::Language::russian))},
                  machine_s);
  e.id = std::string(answer.refusal == 0 ? row.words.id : cycle::refusal_texts()[answer.refusal].id);
  e.who = asker(text::Language::english);
  return e;
}

}  // namespace servogate::gateway::history
