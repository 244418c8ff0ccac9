// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/show.hpp"

#include <cstdio>
#include <string_view>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/units.hpp"
#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;
using text::Entry;

const Entry kHead{"client.head", "{0}: {1}, {2}{3}, {4} s", "{0}: {1}, {2}{3}, {4} с"};
const Entry kMachine{"client.machine", "{0}{1}, {2} s", "{0}{1}, {2} с"};
const Entry kProcessHead{"client.process-head", "process {0}: {1}, {2}", "процесс {0}: {1}, {2}"};
const Entry kHoming{"client.homing", ", homing", ", идёт выход в ноль"};
const Entry kFeed{"client.feed", "feed {0} mm/min, override {1} %, tool {2}",
                  "подача {0} мм/мин, коррекция {1} %, инструмент {2}"};
const Entry kRetraced{"client.stands-back", "back on its path by {0} mm",
                      "отведена назад по контуру на {0} мм"};
const Entry kHoldsLater{"client.holds-later",
                        "is held at the end of the thread, or when the tap has left its hole",
                        "будет остановлена в конце резьбы или после выхода метчика из отверстия"};
const Entry kByWheel{"client.by-wheel", "follows its handwheel along the path: {0} %",
                     "следует маховичку по контуру: {0} %"};
const Entry kByWheelLost{"client.by-wheel-lost",
                         "stands: the handwheel that drives it along its path is lost",
                         "стоит: маховичок движения по контуру потерян"};
const Entry kBySpindle{"client.by-spindle", "goes with the spindle, {0} um off its angle",
                       "идёт за шпинделем, отклонение от его угла {0} мкм"};
const Entry kRestartAt{"client.restart-at", "begins at line {0} of {1}: {2}",
                       "начало со строки {0} файла {1}: {2}"};
const Entry kRestartAxis{"client.restart-axis",
                         "  {0} stands at {1} {3}, the block begins at {2} {3} (machine coordinates)",
                         "  {0} стоит на {1} {3}, кадр начинается на {2} {3} (в координатах станка)"};
const Entry kRestartStep{"client.restart-step", "  {0}. {1}", "  {0}. {1}"};
const Entry kRestartOverlap{"client.restart-overlap",
                            "the block was interrupted {0} mm behind its beginning: that much is cut again",
                            "кадр прерван в {0} мм от своего начала: этот участок обрабатывается снова"};
const Entry kRestartPassed{"client.restart-passed", "not repeated: {0}", "не повторяются: {0}"};
const Entry kRestartWrites{"client.restart-writes", "not repeated: {0} writes into packets",
                           "не повторяются записи в пакеты: {0}"};
const Entry kRestartSignals{
    "client.restart-signals",
    "the program reads signals of the machine before this block: all of this holds for their present values",
    "до этого кадра программа читает сигналы станка: всё это верно для их нынешних значений"};
const Entry kRestartOld{"client.restart-old",
                        "the block is that of the disk: up to 100 ms before the power was lost",
                        "кадр взят с диска: до 100 мс перед отключением питания"};
const Entry kAxes{"client.axes", "axes: in the program's coordinates, in machine coordinates, to go:",
                  "оси: в координатах программы, в координатах станка, остаток пути:"};
const Entry kSpindle{"client.spindle", "  spindle {0} rpm (commanded {1})  {2}",
                     "  шпиндель {0} об/мин (задано {1})  {2}"};
const Entry kLine{
    "client.line",
    "line {0} ({1}): {2} requests, {3} repeated, {4} without an answer in time, {5} wrong "
    "answers, {6} exceptions, opened {7} times, {8} attempts to open it failed",
    "линия {0} ({1}): запросов {2}, повторов {3}, без ответа вовремя {4}, неверных ответов {5}, "
    "исключений {6}, открыта раз: {7}, неудачных попыток открыть: {8}"};
const Entry kLineUnit{"client.line-unit", "  unit {0} ({1})  {2}, {3} errors",
                      "  станция {0} ({1})  {2}, ошибок: {3}"};
const Entry kChip{"client.chip", "chip {0} ({1})  {2}, {3} errors", "микросхема {0} ({1})  {2}, ошибок: {3}"};
const Entry kProgram{"client.program", "program {0}: {1} blocks", "программа {0}: кадров {1}"};
const Entry kProgramLine{"client.program-line", "program {0}, line {1} of {2}, {3} blocks done",
                         "программа {0}, строка {1} из {2}, выполнено кадров: {3}"};
const Entry kSubprogramLine{"client.subprogram-line",
                            "program {0}, line {1} of {2} (subprogram), {3} blocks done",
                            "программа {0}, строка {1} в {2} (подпрограмма), выполнено кадров: {3}"};
const Entry kTyped{"client.typed", "typed block: {0}", "введённый кадр: {0}"};
const Entry kTypedSubprogram{"client.typed-subprogram", "typed block: {0}, line {1} of {2} (subprogram)",
                             "введённый кадр: {0}, строка {1} в {2} (подпрограмма)"};
const Entry kPlcHeld{"client.plc-held", "the PLC is held for single scans (by {0})",
                     "ПЛК удерживается для отдельных сканов ({0})"};
const Entry kForced{"client.forced", "forced: {0} = {1} (by {2})", "удерживается: {0} = {1} ({2})"};
const Entry kForcedStays{"client.forced-stays", "forced: {0} = {1} (by {2}, stays)",
                         "удерживается: {0} = {1} ({2}, постоянно)"};
const Entry kMessage{"client.message", "message: {0}", "сообщение: {0}"};
const Entry kWaits{"client.waits", "{0} ({1} s so far)", "{0} (уже {1} с)"};
const Entry kProcess{"client.process", "process {0}: ", "процесс {0}: "};

/// Words of the status and what people read for them; in English the words themselves.
struct Word {
  std::string_view word, russian;
};
constexpr Word kModes[] = {{"off", "выключено"},   {"mdi", "ручной ввод"},  {"auto", "авто"},
                           {"step", "покадровый"}, {"manual", "ручной"},    {"increment", "на шаг"},
                           {"profile", "профиль"}, {"home", "выход в ноль"}};
constexpr Word kStates[] = {{"idle", "ничего не выполняется"},
                            {"running", "выполняется"},
                            {"held", "приостановлено"},
                            {"waiting", "ожидание"},
                            {"stopped_by_alarm", "остановлено аварией"},
                            {"ended", "завершено"},
                            {"stopped", "остановлено"}};
constexpr Word kDrives[] = {{"offline", "нет связи с приводом"},
                            {"not_ready_to_switch_on", "привод не готов к включению"},
                            {"switch_on_disabled", "привод выключен"},
                            {"ready_to_switch_on", "привод готов к включению"},
                            {"switched_on", "привод включён, не разрешён"},
                            {"operation_enabled", "привод работает"},
                            {"quick_stop_active", "быстрый останов привода"},
                            {"fault_reaction_active", "привод реагирует на отказ"},
                            {"fault", "отказ привода"}};

constexpr Word kQualities[] = {{"never", "ответов ещё не было"},
                               {"good", "данные свежие"},
                               {"stale", "данные устарели"},
                               {"bad", "связи нет"}};

/// The same of an inverter on a line.
struct InverterWord {
  std::string_view state;
  Entry words;
};
const InverterWord kInverters[] = {
    {"offline",
     {"client.inverter-offline", "inverter {0} does not answer", "преобразователь {0} не отвечает"}},
    {"switch_on_disabled",
     {"client.inverter-disabled", "inverter {0} may not run", "преобразователю {0} нельзя работать"}},
    {"ready_to_switch_on", {"client.inverter-ready", "inverter {0} is ready", "преобразователь {0} готов"}},
    {"fault", {"client.inverter-fault", "inverter {0} has tripped", "авария преобразователя {0}"}}};
const Entry kInverterOn{"client.inverter-on", "inverter {0} is on", "преобразователь {0} включён"};
const Entry kOutputs{"client.spindle-outputs", "by output {0}, without feedback",
                     "по выходу {0}, без обратной связи"};
const Entry kInGear{"client.in-gear", "{0}, gear {1}", "{0}, ступень {1}"};
const Entry kNoGear{"client.no-gear", "{0}, in no gear", "{0}, ступень не включена"};
const Entry kAtSpeed{"client.at-speed", "{0}, at speed", "{0}, частота достигнута"};

const Entry kGearInStep{"client.gear-in-step", ", in step with {0}, {1} {2} behind",
                        ", в синхронизме с {0}, отстаёт на {1} {2}"};
const Entry kGearEngages{"client.gear-engages", ", getting into step with {0}, {1} {2} behind",
                         ", входит в синхронизм с {0}, отстаёт на {1} {2}"};
const Entry kGearEnds{"client.gear-ends", ", comes to rest behind {0}", ", останавливается после {0}"};
const Entry kGearRefused{"client.gear-refused", ", gear not engaged: {0}", ", редуктор не включён: {0}"};
const Entry kIsAxis{"client.spindle-is-axis", "{0}, it is axis {1}", "{0}, работает как ось {1}"};
const Entry kPhaseError{"client.phase-error", "{0}, phase error {1}°", "{0}, ошибка по углу {1}°"};

template <std::size_t N>
std::string people_read(const Word (&table)[N], const std::string& word) {
  if (text::user_language() != text::Language::russian) return word;
  for (const Word& w : table)
    if (w.word == word) return std::string(w.russian);
  return word;
}

std::string of(const json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::string say(const Entry& entry, const std::vector<std::string>& arguments) {
  return text::render(entry, arguments, text::user_language());
}

std::string fixed(double value, int decimals) {
  char digits[64];
  std::snprintf(digits, sizeof digits, "%.*f", decimals, value);
  return digits;
}

void print_program(const json& s) {
  if (const json back = s.value("retraced_mm", json()); back.is_number())
    print_line(say(kRetraced, {fixed(back.get<double>(), 3)}));
  if (const json off = s.value("off_spindle_mm", json()); off.is_number())
    print_line(say(kBySpindle, {fixed(1000.0 * off.get<double>(), 1)}));
  if (const json wheel = s.value("path_wheel", json()); wheel.is_object())
    print_line(wheel.value("lost", false) ? say(kByWheelLost, {})
                                          : say(kByWheel, {fixed(wheel.value("pct", 0.0), 0)}));
  if (s.value("holds_later", false)) print_line(say(kHoldsLater, {}));
  const std::string program = of(s, "program"), file = of(s, "file"), block = of(s, "block");
  const int line = s.value("line", 0);
  if (!block.empty()) {
    const bool called = line > 0 && !file.empty() && file != program;
    print_line(called ? say(kTypedSubprogram, {block, std::to_string(line), file}) : say(kTyped, {block}));
  }
  if (program.empty()) return;
  const std::string blocks = std::to_string(s.value("blocks", 0));
  const std::string done = std::to_string(s.value("blocks_done", std::int64_t{0}));
  if (line == 0 || !block.empty())
    print_line(say(kProgram, {program, blocks}));
  else if (!file.empty() && file != program)
    print_line(say(kSubprogramLine, {program, std::to_string(line), file, done}));
  else
    print_line(say(kProgramLine, {program, std::to_string(line), std::to_string(s.value("lines", 0)), done}));
  if (const std::string text = of(s, "text"); line > 0 && block.empty() && !text.empty())
    print_line("    " + text);
}

/// A sentence and below it what to do.
void print_advice(const std::string& before, const json& what) {
  print_line(before + of(what, "text"));
  if (const std::string remedy = of(what, "remedy"); !remedy.empty()) print_line("    " + remedy);
}

/// What the programs have said, what they wait for and what stopped them.
void print_processes(const json& s) {
  const json processes = s.value("processes", json::array());
  for (const json& p : processes) {
    const std::string before =
        processes.size() > 1 ? say(kProcess, {std::to_string(p.value("process", 0))}) : std::string();
    if (const std::string message = of(p, "message"); !message.empty())
      print_line(before + say(kMessage, {message}));
    print_wait(p.value("wait", json()), before);
    if (const json stop = p.value("stop", json()); stop.is_object()) print_advice(before, stop);
  }
}

/// That drives are coming is seen at the axes.
void print_missing(const json& missing) {
  for (const json& m : missing)
    if (const std::string reason = of(m, "reason"); reason != "starting" && reason != "alarm")
      print_advice("", m);
}

void print_feed(const json& process) {
  print_line(
      say(kFeed, {fixed(process.value("feed_mm_min", 0.0), 0), fixed(process.value("override_pct", 0.0), 0),
                  std::to_string(process.value("tool", 0))}));
}

/// One program in the head line, several below it.
void print_programs(const json& s) {
  const std::string homing = s.value("homing", false) ? say(kHoming, {}) : std::string();
  const std::string time = fixed(s.value("time_s", 0.0), 3);
  const auto mode = [](const json& p) { return people_read(kModes, of(p, "mode")); };
  const auto state = [](const json& p) { return people_read(kStates, of(p, "state")); };
  const json processes = s.value("processes", json::array());
  if (processes.size() < 2) {
    print_line(say(kHead, {of(s, "machine"), mode(s), state(s), homing, time}));
    print_program(s);
    return;
  }
  print_line(say(kMachine, {of(s, "machine"), homing, time}));
  for (const json& p : processes) {
    print_line(say(kProcessHead, {std::to_string(p.value("process", 0)), mode(p), state(p)}));
    print_program(p);
    print_feed(p);
  }
}

std::string gear_words(const json& axis, const json& gear) {
  const std::string state = of(gear, "state"), master = of(gear, "master");
  const std::string off = fixed(gear.value("phase_error", 0.0), 4), unit = of(axis, "unit");
  if (state == "refused") return say(kGearRefused, {of(gear, "refusal")});
  if (state == "disengaging") return say(kGearEnds, {master});
  if (state == "engaging" || state == "in_step")
    return say(state == "in_step" ? kGearInStep : kGearEngages,
               {master, off, text::in_language(text::unit_words(unit))});
  return {};
}

void print_axis(const json& a) {
  const bool russian = text::user_language() == text::Language::russian;
  const auto words = [&](const char* in_english, const char* in_russian) {
    return std::string(russian ? in_russian : in_english);
  };
  std::string facts = people_read(kDrives, of(a, "drive"));
  facts += a.value("homed", false) ? words(", homed", ", выведена в ноль")
                                   : words(", not homed", ", не выведена в ноль");
  if (a.value("moving", false)) facts += words(", moving", ", движется");
  if (const double beside = a.value("beside", 0.0); beside != 0.0)
    facts += words(", away from the path by ", ", отведена от контура на ") + fixed(beside, 4);
  if (const json gear = a.value("gear", json()); gear.is_object()) facts += gear_words(a, gear);
  if (a.value("on_limit", 0) != 0) facts += words(", on the hard limit", ", на концевом выключателе");
  const std::string unit = text::in_language(text::unit_words(of(a, "unit"))) +
                           (a.value("diameter", false) ? words(" (diameter)", " (диаметр)") : "");
  const json work = a.value("work", json());
  const std::string in_program = work.is_number() ? fixed(work.get<double>(), 4) : std::string("-");
  print_formatted("  %-3s %12s %12.4f %12.4f %s  %s\n", of(a, "letter").c_str(), in_program.c_str(),
                  a.value("position", 0.0), a.value("to_go", 0.0), unit.c_str(), facts.c_str());
}

/// Lines that are real, and simulated ones on which something went wrong.
void print_lines(const json& lines) {
  for (const json& line : lines) {
    const json c = line.value("counters", json()), units = line.value("units", json::array());
    if (!c.is_object()) continue;
    const auto count = [&](const char* key) { return c.value(key, std::uint64_t{0}); };
    const bool quiet = of(line, "url").starts_with("mock:") &&
                       count("timeouts") + count("wrong_answers") + count("exceptions") == 0;
    if (quiet) continue;
    std::vector<std::string> words{of(line, "name"), of(line, "url")};
    for (const char* key :
         {"requests", "repeats", "timeouts", "wrong_answers", "exceptions", "openings", "failed_openings"})
      words.push_back(std::to_string(count(key)));
    print_line(say(kLine, words));
    for (const json& u : units)
      print_line(say(kLineUnit, {std::to_string(u.value("unit", 0)), of(u, "station"),
                                 people_read(kQualities, of(u, "quality")),
                                 std::to_string(u.value("errors", std::uint64_t{0}))}));
  }
}

/// Of simulated chips only those that have something to say.
void print_chips(const json& chips) {
  for (const json& c : chips) {
    const auto errors = c.value("errors", std::uint64_t{0});
    if (of(c, "url").starts_with("mock:") && errors == 0) continue;
    print_line(say(kChip, {of(c, "station"), of(c, "url"), people_read(kQualities, of(c, "quality")),
                           std::to_string(errors)}));
  }
}

/// What turns the spindle, and how it is.
std::string spindle_words(const json& sp) {
  const std::string supplier = of(sp, "supplier"), place = of(sp, "place"), drive = of(sp, "drive");
  std::string words = people_read(kDrives, drive);
  if (supplier == "outputs") words = say(kOutputs, {place});
  if (supplier == "inverter") {
    words = say(kInverterOn, {place});
    for (const InverterWord& w : kInverters)
      if (w.state == drive) words = say(w.words, {place});
  }
  if (const json& gear = sp.value("gear", json()); gear.is_string())
    words = gear == "" ? say(kNoGear, {words}) : say(kInGear, {words, gear.get<std::string>()});
  if (const json& axis = sp.value("axis", json()); axis.is_string())
    words = say(kIsAxis, {words, axis.get<std::string>()});
  if (const json& off = sp.value("phase_error_deg", json()); off.is_number())
    words = say(kPhaseError, {words, fixed(off.get<double>(), 2)});
  return supplier != "drive" && sp.value("at_speed", false) ? say(kAtSpeed, {words}) : words;
}

void print_held(const json& status) {
  if (const json& by = status.value("plc_held_by", json()); by.is_string()) print_line(say(kPlcHeld, {by}));
}

void print_forced(const json& forced) {
  for (const json& f : forced)
    print_line(say(f.value("stays", false) ? kForcedStays : kForced,
                   {of(f, "name"), of(f, "value"), of(f, "user")}));
}

}  // namespace

void print_wait(const json& wait, const std::string& before) {
  if (!wait.is_object()) return;
  print_line(before + say(kWaits, {of(wait, "text"), text::number(wait.value("for_s", 0.0), 1)}));
  if (const std::string remedy = of(wait, "remedy"); !remedy.empty()) print_line("    " + remedy);
}

void print_status(const json& s) {
  print_programs(s);
  print_processes(s);
  print_missing(s.value("missing", json::array()));
  if (s.value("processes", json::array()).size() < 2) print_feed(s);
  const json axes = s.value("axes", json::array());
  if (!axes.empty()) print_line(say(kAxes, {}));
  for (const json& a : axes) print_axis(a);
  for (const json& sp : s.value("spindles", json::array()))
    print_line(say(kSpindle, {fixed(sp.value("actual_rpm", 0.0), 0), fixed(sp.value("command_rpm", 0.0), 0),
                              spindle_words(sp)}));
  print_lines(s.value("modbus", json::array()));
  print_chips(s.value("chips", json::array()));
  print_held(s);
  print_forced(s.value("forced", json::array()));
}

void print_restart(const json& plan) {
  print_line(
      say(kRestartAt, {std::to_string(plan.value("line", 0)), of(plan, "file"), of(plan, "block_text")}));
  for (const json& a : plan.value("axes", json::array()))
    print_line(say(kRestartAxis, {of(a, "letter"), fixed(a.value("stands", 0.0), 3),
                                  fixed(a.value("begins", 0.0), 3), text::unit_words(of(a, "unit"))}));
  if (const json overlap = plan.value("overlap_mm", json()); overlap.is_number())
    print_line(say(kRestartOverlap, {text::number(overlap.get<double>(), 3)}));
  int n = 0;
  for (const json& step : plan.value("steps", json::array()))
    print_line(say(kRestartStep, {std::to_string(++n), step.get<std::string>()}));
  std::string codes;
  for (const json& m : plan.value("passed", json::array()))
    codes += (codes.empty() ? "M" : ", M") + std::to_string(m.get<int>());
  if (!codes.empty()) print_line(say(kRestartPassed, {codes}));
  if (const int writes = plan.value("writes", 0); writes > 0)
    print_line(say(kRestartWrites, {std::to_string(writes)}));
  if (plan.value("signals", false)) print_line(say(kRestartSignals, {}));
  if (plan.value("from_disk", false)) print_line(say(kRestartOld, {}));
}

void print_alarms(const json& alarms) {
  for (const json& a : alarms) {
    const bool first = a.value("first", false);
    print_formatted("%s%d %s: %s\n%s%s\n", first ? "* " : "      ", a.value("number", 0), of(a, "id").c_str(),
                    of(a, "text").c_str(), first ? "    " : "        ", of(a, "remedy").c_str());
  }
}

}  // namespace servogate::gateway::command
