// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/words/wait_words.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>

namespace servogate::gateway {

namespace {

using image::WaitReason;
using text::Entry;

/// What happens: {0} place, {1} comparison and value, {2} present value, {3} word, {4} axis, {5} seconds.
/// What to do: {0} place, {1} who or where, {2} PLC sources.
struct Row {
  std::string_view reason;
  Entry text;
  Entry remedy;
  bool needs_somebody;
};

constexpr Entry kNothing{"", "", ""};
constexpr Entry kSeePlc{"wait.see-plc", "The PLC program writes {0}: see in {2} what it waits for.",
                        "{0} записывает программа ПЛК: посмотрите в {2}, чего она ждёт."};
constexpr Entry kStart{"wait.start", "`servogate start` goes on.", "Продолжить: `servogate start`."};

/// Index = image::WaitReason.
constexpr Row kRows[] = {
    {"none", kNothing, kNothing, false},
    {"signal",
     {"wait.signal", "waits until {0} {1}; it is {2}", "ждёт, пока {0} {1}; сейчас {2}"},
     kNothing,
     true},
    {"m_acknowledge",
     {"wait.m-acknowledge", "waits until the PLC acknowledges {3} ({0})",
      "ждёт, пока ПЛК подтвердит {3} ({0})"},
     kSeePlc,
     false},
    {"s_acknowledge",
     {"wait.s-acknowledge", "waits until the PLC acknowledges {3} ({0})",
      "ждёт, пока ПЛК подтвердит {3} ({0})"},
     kSeePlc,
     false},
    {"t_acknowledge",
     {"wait.t-acknowledge", "waits until the PLC acknowledges {3} ({0})",
      "ждёт, пока ПЛК подтвердит {3} ({0})"},
     kSeePlc,
     false},
    {"h_acknowledge",
     {"wait.h-acknowledge", "waits until the PLC acknowledges {3} ({0})",
      "ждёт, пока ПЛК подтвердит {3} ({0})"},
     kSeePlc,
     false},
    {"dwell", {"wait.dwell", "dwells for {5} s", "выдерживает паузу {5} с"}, kNothing, false},
    {"in_position",
     {"wait.in-position", "waits until {4} is in position", "ждёт выхода {4} в позицию"},
     {"wait.see-axis", "See what holds {4}; load, brake and tuning of its drive.",
      "Посмотрите, что удерживает {4}: нагрузка, тормоз, настройка привода."},
     true},
    {"program_stop",
     {"wait.program-stop", "stands at M00 until the operator's start", "стоит на M00 до пуска оператором"},
     kStart,
     true},
    {"optional_stop",
     {"wait.optional-stop", "stands at M01 until the operator's start", "стоит на M01 до пуска оператором"},
     kStart,
     true},
    {"block_end",
     {"wait.block-end", "stands at the end of a block until the operator's next step",
      "стоит в конце кадра до следующего шага оператора"},
     {"wait.step", "`servogate step` runs the next block.", "Следующий кадр: `servogate step`."},
     true},
    {"read_in_enable",
     {"wait.read-in-enable", "waits for the PLC's leave to read the next block: {0} is FALSE",
      "ждёт от ПЛК разрешения читать следующий кадр: {0} = FALSE"},
     kSeePlc,
     true},
    {"operator_hold",
     {"wait.operator-hold", "is held by a feed hold of the operator or the PLC",
      "остановлена паузой подачи (оператор или ПЛК)"},
     {"wait.resume", "`servogate resume` goes on.", "Продолжить: `servogate resume`."},
     true},
    {"plc_hold",
     {"wait.plc-hold", "is held by the PLC: {0} is TRUE", "остановлена от ПЛК: {0} = TRUE"},
     kSeePlc,
     true},
    {"feed_enable",
     {"wait.feed-enable", "waits for the PLC's feed enable: {0} is FALSE",
      "ждёт от ПЛК разрешения подачи: {0} = FALSE"},
     kSeePlc,
     true},
    {"axis_feed_enable",
     {"wait.axis-feed-enable", "waits for the PLC's feed enable of {4}: {0} is FALSE",
      "ждёт от ПЛК разрешения подачи {4}: {0} = FALSE"},
     kSeePlc,
     true},
    {"override_zero",
     {"wait.override-zero", "does not move: the operator's feed override is 0 %",
      "не движется: коррекция подачи оператора 0 %"},
     {"wait.set-override", "`servogate override 100`; in `servogate run` the option --override.",
      "`servogate override 100`; для `servogate run` — параметр --override."},
     true},
    {"spindle_stands",
     {"wait.spindle-stands", "waits for the spindle: the feed is per revolution, and it does not turn",
      "ждёт шпинделя: подача на оборот, а он не вращается"},
     {"wait.see-spindle",
      "Program S and M3 before the motion; see in {2} what the spindle's enable waits for.",
      "Задайте S и M3 до движения; посмотрите в {2}, чего ждёт разрешение шпинделя."},
     true},
    {"path_wheel",
     {"wait.path-wheel", "does not move: the handwheel that drives it along its path stands",
      "не движется: маховичок движения по контуру стоит"},
     {"wait.turn-wheel", "Turn the wheel, or choose another mode: then `servogate start` goes on.",
      "Вращайте маховичок или снимите его выбор: тогда продолжит `servogate start`."},
     true},
};
static_assert(std::size(kRows) == image::kWaitReasons);

constexpr Entry kHere{"wait.line", "line {0} of {1}: the program {2}", "строка {0} в {1}: программа {2}"};
constexpr Entry kSomewhere{"wait.program", "the program {2}", "программа {2}"};
constexpr Entry kMockInput{"wait.mock-input",
                           "{0} is an input of the simulated station '{1}': `servogate input` plays it; in "
                           "`servogate run` only [simulation] of the machine file does.",
                           "{0} — вход имитируемой станции «{1}»: его разыгрывает `servogate input`; в "
                           "`servogate run` — только [simulation] файла станка."};
constexpr Entry kInput{"wait.input", "{0} is an input of station '{1}': see why it is not so.",
                       "{0} — вход станции «{1}»: выясните, почему он не такой."};
constexpr Entry kNc{"wait.nc", "The control itself writes {0}.", "{0} записывает само управление."};
constexpr Entry kProgram{"wait.part-program", "A part program writes {0}; no other one runs.",
                         "{0} записывает управляющая программа; другая не выполняется."};
constexpr Entry kUnnamed{
    "wait.unnamed", "The machine file names no writer of {0}: the PLC program may write it, or nobody does.",
    "Файл станка не называет, кто записывает {0}: возможно, программа ПЛК или никто."};

constexpr std::string_view kCompare[] = {"=", "<>", "<", "<=", ">", ">="};
constexpr std::string_view kWriters[] = {"nc", "plc", "input", "program"};

/// A wait for another process, which stands in Wait::code from 1 on.
struct ProcessRow {
  std::string_view reason;
  Entry text;
};
constexpr ProcessRow kProcessRows[] = {
    {"process_wait",
     {"wait.process-wait", "waits until process {0} sends it on", "ждёт, пока её не продолжит процесс {0}"}},
    {"process_send",
     {"wait.process-send", "waits until process {0} waits for it",
      "ждёт, пока процесс {0} не станет её ждать"}},
    {"process_start",
     {"wait.process-start", "waits until process {0} is at rest for its next program",
      "ждёт, пока процесс {0} не освободится для следующей программы"}},
};
constexpr Entry kSeeProcess{"wait.see-process", "See in `servogate status` what process {0} does.",
                            "Что делает процесс {0}, показывает `servogate status`."};

std::string join(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

std::string word_of(const image::Wait& wait) {
  switch (wait.reason) {
    case WaitReason::m_acknowledge:
      return "M" + std::to_string(wait.code);
    case WaitReason::s_acknowledge:
      return "S" + text::number(wait.value, 3);
    case WaitReason::t_acknowledge:
      return "T" + std::to_string(wait.code);
    case WaitReason::h_acknowledge:
      return "H" + std::to_string(wait.code);
    default:
      return {};
  }
}

bool is_operators(WaitReason reason) {
  return reason == WaitReason::program_stop || reason == WaitReason::optional_stop ||
         reason == WaitReason::block_end || reason == WaitReason::operator_hold ||
         reason == WaitReason::override_zero;
}

bool has_place(WaitReason reason) {
  return reason != WaitReason::none && reason != WaitReason::dwell && reason != WaitReason::in_position &&
         reason != WaitReason::spindle_stands && reason != WaitReason::path_wheel && !is_operators(reason);
}

std::string named(const WaitWords& w) { return w.symbol.empty() ? w.place : w.symbol + " (" + w.place + ")"; }

std::string placed(const WaitWords& w, const std::string& happens, text::Language language) {
  const std::string file = std::filesystem::path(w.file).filename().string();
  return text::render(w.line > 0 && !file.empty() ? kHere : kSomewhere,
                      std::array{std::to_string(w.line), file, happens}, language);
}

/// The place that is waited for, who writes it, and what to do about a signal.
void describe_place(const machine::MachineConfig& m, const image::ProcessImage& image,
                    const image::Wait& wait, text::Language language, WaitWords& w) {
  const std::vector<image::Symbol> symbols = m.symbol_table();
  const auto found = std::find_if(symbols.begin(), symbols.end(),
                                  [&](const image::Symbol& s) { return s.place == wait.place; });
  const image::Symbol* symbol = found != symbols.end() ? &*found : nullptr;
  w.place = image::to_string(wait.place);
  if (symbol != nullptr) {
    w.symbol = symbol->name;
    w.written_by = kWriters[static_cast<std::size_t>(symbol->writer)];
  }
  const bool is_signal = wait.reason == WaitReason::signal;
  w.actual = image.packets.number(wait.place);
  w.wanted = is_signal ? wait.value : wait.reason == WaitReason::plc_hold ? 0.0 : 1.0;
  w.compare = kCompare[static_cast<std::size_t>(wait.compare)];
  if (is_signal) w.remedy = writer_remedy(m, symbol, named(w), language);
}

}  // namespace

std::string plc_sources(const machine::MachineConfig& machine) {
  if (!machine.plc.sources.empty()) return join(machine.plc.sources);
  return text::both("the PLC program that the machine file does not name ([plc] sources)",
                    "программе ПЛК, которая в файле станка не указана ([plc] sources)");
}

std::string writer_remedy(const machine::MachineConfig& m, const image::Symbol* symbol,
                          const std::string& named, text::Language language) {
  const auto say = [&](const Entry& entry, const std::string& who = {}) {
    return text::render(entry, std::array{named, who, plc_sources(m)}, language);
  };
  if (symbol == nullptr) return say(kUnnamed);
  int station = -1;
  switch (symbol->writer) {
    case image::Writer::input:
      if (m.point(symbol->name, &station) == nullptr) return say(kInput, symbol->name);
      return say(m.stations[static_cast<std::size_t>(station)].mock() ? kMockInput : kInput,
                 m.stations[static_cast<std::size_t>(station)].name);
    case image::Writer::nc:
      return say(kNc);
    case image::Writer::program:
      return say(kProgram);
    case image::Writer::plc:
      break;
  }
  return say(kSeePlc);
}

bool needs_somebody(WaitReason reason) noexcept {
  return kRows[static_cast<std::size_t>(reason)].needs_somebody;
}

WaitWords wait_words(Control& control, const image::ProcessImage& image, int process, const image::Wait& wait,
                     text::Language language) {
  const machine::MachineConfig& m = control.machine();
  const image::ProcessStatus& status = image.processes[static_cast<std::size_t>(process)];
  const Row& row = kRows[static_cast<std::size_t>(wait.reason)];
  WaitWords w;
  w.reason = row.reason;
  w.line = wait.line;
  w.file = control.process(process).texts().file(status.run, status.file);
  w.since_s = static_cast<double>(wait.since_ns) / 1e9;
  w.for_s = static_cast<double>(image.now.t_ns - wait.since_ns) / 1e9;
  w.word = word_of(wait);
  if (wait.reason == WaitReason::signal && wait.code > 0) {
    const ProcessRow& of = kProcessRows[wait.compare == image::Compare::eq   ? 0
                                        : wait.compare == image::Compare::ne ? 1
                                                                             : 2];
    const std::array number{std::to_string(wait.code)};
    w.reason = of.reason;
    w.written_by = "program";
    w.remedy = text::render(kSeeProcess, number, language);
    w.text = placed(w, text::render(of.text, number, language), language);
    return w;
  }
  if (wait.axis >= 0) w.axis = m.axes[static_cast<std::size_t>(wait.axis)].letter;
  if (is_operators(wait.reason)) w.written_by = "operator";
  if (has_place(wait.reason)) describe_place(m, image, wait, language, w);
  const std::string wish = w.wanted ? std::string(w.compare) + " " + text::number(*w.wanted) : "";
  const std::string happens = text::render(row.text,
                                           std::array{named(w), wish, w.actual ? text::number(*w.actual) : "",
                                                      w.word, w.axis, text::number(wait.value, 3)},
                                           language);
  if (w.remedy.empty())
    w.remedy = text::render(row.remedy, std::array{named(w), std::string(), plc_sources(m), w.word, w.axis},
                            language);
  w.text = placed(w, happens, language);
  return w;
}

std::optional<WaitWords> wait_words(Control& control, const image::ProcessImage& image, int process,
                                    text::Language language) {
  const image::Wait& wait = image.processes[static_cast<std::size_t>(process)].wait;
  if (wait.reason == WaitReason::none) return std::nullopt;
  return wait_words(control, image, process, wait, language);
}

std::string program_message(Control& control, const image::ProcessImage& image, int process) {
  return control.process(process)
      .texts()
      .message(image.processes[static_cast<std::size_t>(process)].message)
      .value_or("");
}

}  // namespace servogate::gateway
