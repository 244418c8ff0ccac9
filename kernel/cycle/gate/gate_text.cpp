// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <iterator>

#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {

using text::Language;

namespace {

/// Placeholders: {0} axis, {1} value (in words where it names something), {2} limit, {3} unit of the axis.
constexpr text::Entry kTexts[] = {
    {"gate.accepted", "accepted", "принято"},
    {"gate.unknown_request", "this request is not known", "неизвестный запрос"},
    {"gate.asker_may_not", "whoever asks here may not ask for `{1}`", "отсюда запрос «{1}» не разрешён"},
    {"gate.no_such_axis", "there is no axis number {1}", "нет оси с номером {1}"},
    {"gate.no_such_process", "there is no process {1}", "нет процесса {1}"},
    {"gate.bad_value", "the value {1} is not possible here (largest: {2})",
     "значение {1} здесь недопустимо (наибольшее: {2})"},
    {"gate.alarm_active", "alarm {1} is active: remove its cause and reset first",
     "действует авария {1}: устраните причину и выполните сброс"},
    {"gate.emergency_stop", "emergency stop: unlock it and reset first",
     "аварийный останов: отпустите кнопку и выполните сброс"},
    {"gate.not_powered", "{0} is not ready: switch the drives on first (or wait until the brake is open)",
     "{0} не готова: сначала включите приводы (или дождитесь отпускания тормоза)"},
    {"gate.not_homed", "{0} is not homed: run `servogate home {0}` first",
     "{0} не выведена в ноль: сначала выполните `servogate home {0}`"},
    {"gate.feed_not_enabled",
     "{0}: the PLC does not permit motion: {0}.feed_enable is FALSE (an open door, for example; the PLC "
     "program shows the reason)",
     "{0}: ПЛК не разрешает движение: {0}.feed_enable = FALSE (например, открыта дверь; причину ищите в "
     "программе ПЛК)"},
    {"gate.program_runs", "a program runs: end it first (`servogate reset`)",
     "выполняется программа: сначала завершите её (`servogate reset`)"},
    {"gate.program_does_not_run", "no program runs: `servogate start` starts the loaded one",
     "программа не выполняется: загруженную запустит `servogate start`"},
    {"gate.program_not_held", "the program runs and is not held: `servogate hold` holds it",
     "программа выполняется и не приостановлена: приостановит её `servogate hold`"},
    {"gate.not_stepping",
     "the program was started in AUTO and cannot be stepped: `servogate resume` continues it to its end, "
     "`servogate reset` ends it",
     "программа пущена в АВТО, её нельзя выполнять по кадрам: `servogate resume` продолжит её до конца, "
     "`servogate reset` завершит"},
    {"gate.no_program", "no program is loaded: run `servogate load PROGRAM` first",
     "программа не загружена: сначала выполните `servogate load PROGRAM`"},
    {"gate.wrong_mode", "not possible in mode {1}", "невозможно в режиме {1}"},
    {"gate.homing_runs", "homing is under way: wait or stop it first",
     "идёт выход в ноль: дождитесь конца или остановите его"},
    {"gate.axis_owned", "{0} belongs to {1}", "осью {0} владеет {1}"},
    {"gate.axis_moves", "{0} moves: wait until it stands", "{0} движется: дождитесь останова"},
    {"gate.manual_held", "{1} holds manual control", "ручным управлением владеет {1}"},
    {"gate.on_hard_limit",
     "{0} is on its limit switch: it can only be jogged away from it (`servogate jog`), so {1} is not "
     "possible",
     "{0} на концевом выключателе: её можно только отвести от него вручную (`servogate jog`), {1} "
     "невозможно"},
    {"gate.at_soft_limit", "{0} is at its travel limit {2} {3} already",
     "{0} уже на границе зоны перемещения {2} {3}"},
    {"gate.no_home_needed", "{0} needs no homing", "{0} не требует выхода в ноль"},
    {"gate.place_not_writable", "byte {1} belongs to inputs, PLC or control: only `force` may overwrite it",
     "байт {1} принадлежит входам, ПЛК или ЧПУ: его может заменить только `force`"},
    {"gate.place_outside", "byte {1} is outside the packet of {2} bytes",
     "байт {1} вне пакета размером {2} байт"},
    {"gate.start_not_permitted", "the machine does not permit the start", "станок не разрешает пуск"},
    {"gate.jog_range", "{0} cannot jog by {1} {3}: from -{2} to {2} {3} is possible",
     "{0} не может переместиться на {1} {3}: возможно от -{2} до {2} {3}"},
    {"gate.zero_range", "{0} cannot be given the value {1} {3}: from -{2} to {2} {3} is possible",
     "{0} не может получить значение {1} {3}: возможно от -{2} до {2} {3}"},
    {"gate.override_range", "a feed override of {1} % is not possible: 0 to {2} %",
     "коррекция подачи {1} % невозможна: от 0 до {2} %"},
    {"gate.emergency_stop_place", "the emergency stop cannot be forced",
     "аварийный останов нельзя удерживать"},
    {"gate.logic_not_changed",
     "the PLC did not take the change: it came too late, or 256 variables are forced",
     "ПЛК не принял изменение: оно опоздало, или удерживается уже 256 переменных"},
    {"gate.axis_not_auxiliary", "{0} is an axis of the programs: the PLC moves those that are `auxiliary`",
     "{0} — ось программ: ПЛК перемещает оси с ключом `auxiliary`"},
    {"gate.outside_travel", "{0} cannot go to {1} {3}: its travel ends at {2} {3}",
     "{0} не может перейти в {1} {3}: ход кончается в {2} {3}"},
    {"gate.velocity_range", "{0} cannot move at {1} {3}/s: above 0 and up to {2} {3}/s is possible",
     "{0} не может двигаться со скоростью {1} {3}/с: возможно больше 0 и до {2} {3}/с"},
    {"gate.acceleration_range",
     "{0} cannot accelerate with {1} {3}/s2: 0 (its limit) and up to {2} {3}/s2 is possible",
     "{0} не может разгоняться с {1} {3}/с2: возможно 0 (её предел) и до {2} {3}/с2"},
    {"gate.axis_stopping", "{0} is held by MC_Stop until its Execute becomes FALSE",
     "{0} удерживается MC_Stop, пока не снят его Execute"},
    {"gate.drives_not_wanted", "{0}: the operator has not switched the drives on",
     "{0}: оператор не включил приводы"},
    {"gate.axis_error_stop", "{0} was stopped by an error: MC_Reset first",
     "{0} остановлена ошибкой: сначала MC_Reset"},
    {"gate.switching_off",
     "{0} is still being switched off: wait until the drives are off, then `servogate power on`",
     "{0} ещё выключается: дождитесь выключения приводов, затем `servogate power on`"},
    {"gate.program_stopping", "the program is still stopping: ask again once the axes stand",
     "программа ещё останавливается: повторите, когда оси остановятся"},
    {"gate.handwheel_stopped", "{0} was stopped: select the handwheel anew",
     "{0} остановлена: выберите маховик заново"},
    {"gate.drives_on",
     "a drive is on or a spindle turns: the PLC can be held only when they are off (`servogate power off`)",
     "включён привод или вращается шпиндель: ПЛК можно удерживать, только когда они выключены (`servogate "
     "power off`)"},
    {"gate.logic_held", "the PLC is held for single scans already",
     "ПЛК уже удерживается для отдельных сканов"},
    {"gate.logic_not_held", "the PLC is not held", "ПЛК не удерживается"},
    {"gate.forces_full", "too many places are forced: release some of them first",
     "удерживается слишком много мест: сначала освободите некоторые"},
    {"gate.no_torque", "{0} cannot be torque-controlled: it has no `torque_max` in the machine file",
     "{0} не управляется моментом: в файле станка у неё нет `torque_max`"},
    {"gate.torque_range", "{0} cannot be given {1} % of the rated torque: from -{2} to {2} % is possible",
     "{0} не может получить {1} % номинального момента: возможно от -{2} до {2} %"},
    {"gate.torque_ramp_range",
     "{0} cannot change its torque by {1} % a second: 0 (its limit) and up to {2} % is possible",
     "{0} не может менять момент на {1} % в секунду: возможно 0 (её предел) и до {2} %"},
    {"gate.jogged_by_another",
     "another client is jogging {0}: wait until it stops, or stop the axis (`servogate hold`)",
     "{0} двигает другой клиент: дождитесь, пока он закончит, или остановите ось (`servogate hold`)"},
    {"gate.guard_program",
     "this place guards motion or energy and is forced or released only at standstill: a program is in "
     "progress (`servogate reset` ends it)",
     "это место защищает от движения или включения, его удерживают и освобождают только при останове: "
     "выполняется программа (`servogate reset` завершит её)"},
    {"gate.guard_homing",
     "this place guards motion or energy and is forced or released only at standstill: homing is under way "
     "(`servogate stop` stops it)",
     "это место защищает от движения или включения, его удерживают и освобождают только при останове: идёт "
     "выход в ноль (`servogate stop` остановит его)"},
    {"gate.guard_axis",
     "this place guards motion or energy and is forced or released only at standstill: {0} moves "
     "(`servogate stop` stops it)",
     "это место защищает от движения или включения, его удерживают и освобождают только при останове: {0} "
     "движется (`servogate stop` остановит её)"},
    {"gate.guard_spindle",
     "this place guards motion or energy and is forced or released only at standstill: spindle {1} is "
     "ordered to turn or still turns (`servogate reset` stops it)",
     "это место защищает от движения или включения, его удерживают и освобождают только при останове: "
     "шпинделю {1} задано вращение, или он ещё вращается (`servogate reset` остановит его)"},
    {"gate.too_old",
     "the request waited for {1} ms before the control could carry it out, and {2} ms is the longest: "
     "nothing "
     "was done; send it again if it is still wanted",
     "запрос ждал {1} мс, прежде чем управление смогло его выполнить, а можно не больше {2} мс: ничего не "
     "сделано; если он ещё нужен, повторите его"},
    {"gate.client_gone", "the client that sent the request has gone: nothing was done",
     "клиента, который послал запрос, уже нет: ничего не сделано"},
    {"gate.function_runs", "a function is under way: wait until the PLC has acknowledged it",
     "выполняется функция: дождитесь её подтверждения от ПЛК"},
    {"gate.way_back_full",
     "the way away from the program has too many turns to be remembered: `servogate return` leads back, or "
     "go "
     "on with {0}",
     "путь от контура имеет слишком много поворотов: `servogate return` вернёт оси, или продолжайте осью "
     "{0}"},
    {"gate.on_path", "no axis is away from the path of the program: `servogate resume` goes on",
     "оси не отводились от контура: `servogate resume` продолжит"},
    {"gate.off_path", "{0} was jogged away from the program by {1} {3}: `servogate return` first",
     "{0} отведена от контура на {1} {3}: сначала `servogate return`"},
    {"gate.retraced",
     "the program went back on its path by {1} mm: `servogate return` leads forward to where it was held",
     "программа отведена назад по контуру на {1} мм: `servogate return` вернёт её туда, где она была "
     "приостановлена"},
    {"gate.spindle_differs",
     "the spindle is not as it was when the program was held: `servogate mdi \"{1}\"` first",
     "шпиндель не в том состоянии, в котором программа была приостановлена: сначала `servogate mdi "
     "\"{1}\"`"},
    {"gate.tool_differs",
     "the program was held with tool {1} in the spindle: change it back, or end the program with `servogate "
     "reset` and go on with `servogate start --interrupted`",
     "программа приостановлена с инструментом {1} в шпинделе: верните его, или завершите программу командой "
     "`servogate reset` и продолжите командой `servogate start --interrupted`"},
    {"gate.axis_is_spindle",
     "{0} is a spindle now: its M function (`axis_m` of the machine file) makes it an axis first",
     "{0} сейчас работает как шпиндель: сначала переведите его в режим оси функцией M (`axis_m` в файле "
     "станка)"},
    {"gate.no_path_wheel",
     "no handwheel drives programs of this process: `[[path_wheel]]` of the machine file declares it",
     "у этого процесса нет маховичка движения по контуру: его объявляет `[[path_wheel]]` файла станка"},
    {"gate.no_gear", "{0} has no gear number {1}: `[[gear]]` of the machine file gives it {2}",
     "у {0} нет редуктора номер {1}: в `[[gear]]` файла станка их {2}"},
    {"gate.axis_geared",
     "{0} follows its master by an electronic gear: disengage it first (the PLC sets {0}.gear to 0; "
     "`servogate stop` stops all)",
     "{0} следует за ведущей через электронный редуктор: сначала выключите его (ПЛК записывает 0 в {0}.gear; "
     "`servogate stop` останавливает всё)"},
    {"gate.gear_master",
     "the master of {0} gives no position: it is not homed, its zero mark has not been passed, or its drive "
     "does not answer",
     "положение ведущей для {0} неизвестно: она не выведена в ноль, не пройдена нулевая метка или не "
     "отвечает "
     "привод"},
    {"gate.gear_too_fast", "the master asks {0} for {1} {3}/s, at most {2} {3}/s: run the master more slowly",
     "ведущая требует от {0} {1} {3}/с, возможно {2} {3}/с: замедлите ведущую"},
    {"gate.gear_off_place",
     "{0} is {1} {3} off its place behind its master, {2} {3} allowed (`window`): jog it there first",
     "{0} отстоит от положения по ведущей на {1} {3}, допустимо {2} {3} (`window`): сначала переместите её"},
};
static_assert(std::size(kTexts) == static_cast<std::size_t>(Refusal::gear_off_place) + 1);
static_assert(static_cast<int>(Refusal::axis_error_stop) == 38,
              "programs of PLCs know these numbers as ErrorID (docs/plc.md): new ones come last");

constexpr std::string_view kAskers[][2] = {{"the command line", "командная строка"},
                                           {"the page", "страница"},
                                           {"the pendant", "выносной пульт"},
                                           {"the PLC", "ПЛК"},
                                           {"the scenario", "сценарий"},
                                           {"Modbus", "Modbus"},
                                           {"the program", "программа"},
                                           {"the bench", "стенд"}};
constexpr std::string_view kOwners[][2] = {{"nobody", "никто"},
                                           {"a program", "программа"},
                                           {"manual control", "ручное управление"},
                                           {"homing", "выход в ноль"},
                                           {"the PLC", "ПЛК"},
                                           {"the bench", "стенд"},
                                           {"an electronic gear", "электронный редуктор"}};
constexpr std::string_view kModes[][2] = {{"off", "выкл."}, {"MDI", "MDI"},   {"AUTO", "AUTO"},
                                          {"STEP", "STEP"}, {"MANU", "MANU"}, {"MANJ", "MANJ"},
                                          {"PROF", "PROF"}, {"HOME", "HOME"}};
constexpr std::string_view kKinds[][2] = {{"none", "нет"},
                                          {"power", "питание"},
                                          {"home", "выход в ноль"},
                                          {"jog", "перемещение"},
                                          {"jog", "перемещение"},
                                          {"keep-alive", "подтверждение"},
                                          {"stop jogging", "останов перемещения"},
                                          {"zero", "обнуление"},
                                          {"mode", "режим"},
                                          {"start", "пуск"},
                                          {"step", "шаг"},
                                          {"hold", "пауза"},
                                          {"resume", "продолжение"},
                                          {"stop", "останов"},
                                          {"reset", "сброс"},
                                          {"override", "коррекция подачи"},
                                          {"quick stop", "быстрый останов"},
                                          {"acknowledge", "квитирование"},
                                          {"set a place", "запись в ячейку"},
                                          {"force", "принудительное значение"},
                                          {"release a force", "снятие принудительного значения"},
                                          {"change the PLC", "изменение ПЛК"},
                                          {"power of an auxiliary axis", "питание вспомогательной оси"},
                                          {"home an auxiliary axis", "выход в ноль вспомогательной оси"},
                                          {"move an auxiliary axis", "перемещение вспомогательной оси"},
                                          {"move an auxiliary axis", "перемещение вспомогательной оси"},
                                          {"move an auxiliary axis", "перемещение вспомогательной оси"},
                                          {"stop an auxiliary axis", "останов вспомогательной оси"},
                                          {"reset an auxiliary axis", "сброс вспомогательной оси"},
                                          {"hold the PLC for single scans", "отдельные сканы ПЛК"},
                                          {"torque of an auxiliary axis", "момент вспомогательной оси"},
                                          {"give an axis to a process", "передача оси процессу"},
                                          {"change origins or tools", "изменение начал и инструмента"},
                                          {"return to the path", "возврат на контур"},
                                          {"a typed function", "функция, введённая вручную"},
                                          {"the handwheel of a path", "маховичок движения по контуру"},
                                          {"an electronic gear", "электронный редуктор"}};

template <std::size_t N>
std::string word(const std::string_view (&table)[N][2], double index, Language language) {
  const bool inside = index >= 0.0 && index < static_cast<double>(N);
  return inside ? std::string(table[static_cast<std::size_t>(index)][language == Language::russian])
                : text::number(index);
}

std::string value_words(const image::Answer& answer, Language language) {
  switch (static_cast<Refusal>(answer.refusal)) {
    case Refusal::asker_may_not:
      return word(kKinds, answer.value, language);
    case Refusal::wrong_mode:
      return word(kModes, answer.value, language);
    case Refusal::axis_owned:
      return word(kOwners, answer.value, language);
    case Refusal::manual_held:
      return word(kAskers, answer.value, language);
    case Refusal::on_hard_limit:
      return answer.value > 0.0 ? "+" : "-";
    case Refusal::no_such_process:
    case Refusal::guard_spindle:
      return text::number(answer.value + 1);
    case Refusal::override_range:
      return text::number(answer.value * 100.0, 4);
    case Refusal::spindle_differs:
      return answer.value == 0.0
                 ? "M5"
                 : (answer.value > 0.0 ? "M3 S" : "M4 S") + text::number(std::abs(answer.value), 4);
    default:
      return text::number(answer.value, 4);
  }
}

}  // namespace

std::string asker_words(image::Asker asker, Language language) {
  return word(kAskers, static_cast<double>(asker), language);
}

std::span<const text::Entry> refusal_texts() noexcept { return kTexts; }

std::string render(const image::Answer& answer, const std::vector<std::string>& axis_letters,
                   Language language, const std::vector<std::string>& axis_units) {
  if (answer.refusal == 0) return {};
  if (answer.refusal >= std::size(kTexts)) return "refusal " + std::to_string(answer.refusal);
  const int a = answer.axis;
  const std::string letter =
      a >= 0 && a < std::ssize(axis_letters) ? axis_letters[static_cast<std::size_t>(a)] : std::to_string(a);
  const std::string unit =
      a >= 0 && a < std::ssize(axis_units) ? axis_units[static_cast<std::size_t>(a)] : "mm";
  const double scale = static_cast<Refusal>(answer.refusal) == Refusal::override_range ? 100.0 : 1.0;
  const std::vector<std::string> arguments = {letter, value_words(answer, language),
                                              text::number(answer.limit * scale, 4), unit};
  return text::render(kTexts[answer.refusal], arguments, language);
}

}  // namespace servogate::cycle
