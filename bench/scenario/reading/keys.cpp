// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/reading/keys.hpp"

#include <algorithm>
#include <iterator>

#include "firmware_if/fault/fault.hpp"
#include "machine/keys/json.hpp"

namespace servogate::scenario {

namespace {

constexpr KeyRow kKeys[] = {
    {Part::file, "schema", Form::whole, "version of this form of file: 1", "версия формы файла: 1", true},
    {Part::file, "title", Form::text, "what is claimed, in one sentence; unique in the file's folder",
     "что утверждается, одним предложением", true},
    {Part::file, "verifies", Form::texts, "requirements that it verifies, for the table of `--trace-table`",
     "требования, которые он проверяет, для таблицы `--trace-table`"},
    {Part::file, "machine", Form::text, "machine file, relative to this file",
     "файл станка, относительно этого файла"},
    {Part::file, "tags", Form::texts, "words to choose scenarios by (`--tag`)",
     "слова для выбора сценариев (`--tag`)"},
    {Part::file, "timeout", Form::time, "machine time in which it must have ended (60 s)",
     "машинное время, за которое он должен закончиться (60 s)"},
    {Part::file, "include", Form::texts,
     "files whose `given` come before its own, and whose other keys count where this file has none",
     "файлы, чьи `given` идут перед его собственными, а прочие ключи действуют там, где здесь их нет"},
    {Part::file, "expected_failure", Form::text, "why it is known to fail: failing passes, passing fails",
     "почему он заведомо не проходит: провал засчитывается, успех нет"},
    {Part::file, "skip", Form::text, "why it is not run", "почему он не выполняется"},
    {Part::file, "cases", Form::cases,
     "tables of parameters: the scenario runs once with each, and \"$speed\" stands for its `speed`; `name` "
     "is what it is called",
     "таблицы параметров: сценарий выполняется с каждой, «$speed» заменяется её `speed`; `name` — её "
     "название"},
    {Part::file, "given", Form::steps, "steps that bring about the beginning; each is waited for",
     "шаги, создающие исходное положение; каждый ожидается до конца"},
    {Part::file, "step", Form::steps, "the steps, in their order", "шаги по порядку"},
    {Part::file, "random", Form::random, "steps that are drawn by chance, behind the others",
     "случайные шаги, после остальных"},

    {Part::step, "title", Form::text, "what the step is about, for its message",
     "о чём шаг, для его сообщения"},
    {Part::step, "at", Form::time, "when: since the beginning, which is behind `given`",
     "когда: от начала, которое следует за `given`"},
    {Part::step, "after", Form::anchor,
     "when: a time behind the step before, or as soon as a condition is true",
     "когда: через время после предыдущего шага или как только условие выполнено"},
    {Part::step, "plus", Form::time, "so much later than the condition of `after`",
     "на столько позже условия `after`"},
    {Part::step, "do", Form::words, "what an operator or client does: see the words below",
     "что делает оператор или клиент: слова ниже"},
    {Part::step, "wait", Form::boolean, "until what `do` begins has ended (in `given`: true)",
     "ждать конца того, что начал `do` (в `given`: true)"},
    {Part::step, "refused", Form::refusal,
     "the control must refuse `do`: true, or the code of the refusal (\"gate.not_homed\")",
     "управление должно отказать в `do`: true или код отказа («gate.not_homed»)"},
    {Part::step, "fault", Form::fault, "a fault of something simulated",
     "неисправность чего-либо имитируемого"},
    {Part::step, "clear", Form::clear, "ends a lasting fault", "завершает длящуюся неисправность"},
    {Part::step, "expect", Form::condition, "what must be true", "что должно быть истинно"},
    {Part::step, "never", Form::condition, "what must not become true: with `always` or `until`",
     "что не должно стать истинным: с `always` или `until`"},
    {Part::step, "within", Form::time, "it must become true within this time; the steps behind wait",
     "должно стать истинным за это время; следующие шаги ждут"},
    {Part::step, "always", Form::time_or_true,
     "it must be true in every cycle of this time, true: to the end; the steps behind go on meanwhile",
     "должно быть истинно в каждом цикле этого времени, true: до конца; следующие шаги тем временем идут"},
    {Part::step, "until", Form::condition, "it must be true in every cycle until this is; the same",
     "должно быть истинно в каждом цикле, пока не выполнится это; так же"},

    {Part::condition, "signal", Form::text, "a name: see the signals below", "имя: сигналы ниже"},
    {Part::condition, "equals", Form::value, "it has this value", "имеет это значение"},
    {Part::condition, "differs", Form::value, "it has another value", "имеет другое значение"},
    {Part::condition, "above", Form::value, "it is larger", "больше"},
    {Part::condition, "below", Form::value, "it is smaller", "меньше"},
    {Part::condition, "at_least", Form::value, "it is as large or larger", "не меньше"},
    {Part::condition, "at_most", Form::value, "it is as large or smaller", "не больше"},
    {Part::condition, "between", Form::values, "it is in this range", "в этих пределах"},
    {Part::condition, "tolerance", Form::value, "of `equals`, `differs` and `reference`",
     "для `equals`, `differs` и `reference`"},
    {Part::condition, "edge", Form::text,
     "\"rising\", \"falling\" or \"any\": it has changed so since the watch began",
     "\"rising\", \"falling\" или \"any\": изменилось так с начала наблюдения"},
    {Part::condition, "alarm", Form::wholes, "these alarms are active, or came since the watch began",
     "эти аварии активны или появились с начала наблюдения"},
    {Part::condition, "no_alarm", Form::boolean, "no alarm is active", "ни одной активной аварии"},
    {Part::condition, "but", Form::wholes, "alarms that `no_alarm` lets pass",
     "аварии, которые `no_alarm` пропускает"},
    {Part::condition, "standstill", Form::texts, "these axes stand; \"all\": all of them",
     "эти оси стоят; \"all\": все"},
    {Part::condition, "distance", Form::value, "each has moved at most so far since the watch began",
     "каждая прошла не больше этого с начала наблюдения"},
    {Part::condition, "path_deviation", Form::value,
     "the place of the axes is at most so far beside the path of the set-points",
     "место осей не дальше этого от пути уставок"},
    {Part::condition, "reference", Form::text,
     "CSV file with a column `t` and one for each signal (a trace): at equal times the signals are alike",
     "файл CSV со столбцом `t` и столбцами сигналов (трасса): в равные моменты сигналы одинаковы"},
    {Part::condition, "signals", Form::texts, "of `reference`: which; none: all columns that are signals",
     "для `reference`: какие; без ключа: все столбцы-сигналы"},
    {Part::condition, "from", Form::time, "of `reference`: its time at which the watch begins (0 s)",
     "для `reference`: его время, с которого начинается наблюдение (0 s)"},
    {Part::condition, "order", Form::conditions, "these have become true one after the other",
     "они стали истинны одно за другим"},
    {Part::condition, "all", Form::conditions, "all of these are true", "все они истинны"},
    {Part::condition, "any", Form::conditions, "one of these is true", "хотя бы одно истинно"},

    {Part::fault, "device", Form::text,
     "name in the machine file: \"can.x\", \"panel\", \"door\", \"control\"",
     "имя из файла станка: \"can.x\", \"panel\", \"door\", \"control\"", true},
    {Part::fault, "kind", Form::text, "what happens (docs/faults.md)", "что происходит (docs/faults.md)",
     true},

    {Part::clear, "device", Form::text, "name in the machine file", "имя из файла станка", true},
    {Part::clear, "kind", Form::text, "which fault; none: all of the device",
     "какая неисправность; без ключа: все у устройства"},

    {Part::random, "runs", Form::whole, "how many such runs (1)", "сколько таких прогонов (1)"},
    {Part::random, "steps", Form::whole, "actions of each (10)", "действий в каждом (10)"},
    {Part::random, "pause", Form::values, "shortest and longest time between two ([\"10 ms\", \"1 s\"])",
     "кратчайшая и длиннейшая пауза между ними ([\"10 ms\", \"1 s\"])"},
    {Part::random, "action", Form::actions, "what may be drawn", "из чего выбирать", true},

    {Part::action, "weight", Form::whole, "how often it is drawn, beside the others (1)",
     "как часто выбирается среди прочих (1)"},
    {Part::action, "range", Form::cases,
     "a table: name = [smallest, largest]; \"$name\" stands for a number drawn from it",
     "таблица: имя = [наименьшее, наибольшее]; «$имя» заменяется выбранным числом"},
    {Part::action, "do", Form::words, "as in a step; the control may refuse it",
     "как в шаге; управление может отказать"},
    {Part::action, "fault", Form::fault, "as in a step", "как в шаге"},
    {Part::action, "clear", Form::clear, "as in a step", "как в шаге"},
};

constexpr WordRow kWords[] = {
    {"ready", "", "alarms reset, drives on, all axes homed that need it: what a shift begins with",
     "аварии сброшены, приводы включены, оси выведены в ноль: начало смены"},
    {"run", "PROGRAM", "load and start; the path is relative to the file that says so",
     "load и start; путь относительно файла, в котором он указан"},
    {"load", "PROGRAM", "loads a part program", "загружает управляющую программу"},
    {"start", "", "starts the loaded program, or goes on behind M00 and M01",
     "запускает загруженную программу, продолжает после M00 и M01"},
    {"step", "", "runs one block", "выполняет один кадр"},
    {"hold", "", "feed hold", "останов подачи"},
    {"resume", "", "goes on after a hold", "продолжает после останова"},
    {"return", "", "axes that were jogged away from a held program return",
     "оси, уведённые от остановленной программы, возвращаются"},
    {"stop", "", "controlled stop on the path; the program ends",
     "управляемый останов на контуре; программа кончается"},
    {"quick_stop", "", "stops the axes at once", "немедленный останов осей"},
    {"reset", "", "ends the program, clears alarms whose cause is gone",
     "завершает программу, сбрасывает аварии без причины"},
    {"acknowledge", "", "clears alarms whose cause is gone", "сбрасывает аварии, причина которых устранена"},
    {"power", "on | off", "drives on or off", "приводы включить или выключить"},
    {"home", "[AXIS...]", "references axes; none: all", "выводит оси в ноль; без имени все"},
    {"jog", "AXIS +5 mm | + | -", "moves an axis by hand; + and -: until jog_stop",
     "перемещает ось вручную; + и -: до jog_stop"},
    {"jog_stop", "[AXIS]", "lets the button of a jog go", "отпускает кнопку ручного перемещения"},
    {"fall_silent", "", "the client of a jog dies: nothing keeps it alive any more",
     "клиент ручного перемещения умирает: его больше ничто не поддерживает"},
    {"override", "80 %", "feed override", "коррекция подачи"},
    {"mdi", "BLOCK", "runs a block typed by hand", "выполняет кадр, набранный вручную"},
    {"zero", "AXIS [VALUE]", "gives the present place of an axis a value in the origin in force",
     "присваивает нынешнему месту оси значение в действующем начале"},
    {"assign", "AXIS PROCESS", "another process moves the axis from now on",
     "дальше ось перемещает другой процесс"},
    {"set", "POINT on | off | auto | NUMBER", "plays an input; auto: it follows the world again",
     "задаёт вход; auto: снова следует за миром"},
    {"press", "POINT [TIME]", "input on, and off again after 100 ms, or TIME",
     "вход включить и через 100 ms (или TIME) выключить"},
    {"handwheel", "POINT +20", "adds counts to the input of a handwheel",
     "добавляет отсчёты входу маховичка"},
    {"write", "PLACE NUMBER", "writes a place of packet K, as its operator",
     "записывает место пакета K от имени оператора"},
    {"force", "NAME VALUE", "holds a variable of the PLC or a place at a value",
     "удерживает переменную ПЛК или место"},
    {"release", "[NAME]", "lets it go; none: all", "отпускает; без имени всё"},
    {"wait", "TIME", "nothing happens for so long", "ничего не происходит столько времени"},
};

std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out;
}

using machine::Json;

Json described(const KeyRow& row) {
  const auto reference = [](const char* name) { return Json{{"$ref", std::string("#/$defs/") + name}}; };
  const auto list_of = [](Json of) { return Json{{"type", "array"}, {"items", std::move(of)}}; };
  const auto one_or_many = [&](const Json& of) { return Json{{"anyOf", Json::array({of, list_of(of)})}}; };
  const Json text = {{"type", "string"}}, whole = {{"type", "integer"}};
  const Json time = {{"type", "string"}, {"pattern", "^[0-9.]+ *(s|ms|us|min)$|\\$"}};
  const Json value = {{"type", Json::array({"number", "boolean", "string"})}};
  switch (row.form) {
    case Form::text:
      return text;
    case Form::texts:
      return one_or_many(text);
    case Form::whole:
      return row.name == "schema" ? Json{{"const", 1}} : whole;
    case Form::wholes:
      return one_or_many(whole);
    case Form::boolean:
      return {{"type", "boolean"}};
    case Form::time:
      return time;
    case Form::time_or_true:
      return {{"anyOf", Json::array({time, Json{{"const", true}}})}};
    case Form::value:
      return value;
    case Form::values:
      return list_of(value);
    case Form::words: {
      std::string names;
      for (const WordRow& w : kWords) names += (names.empty() ? "" : "|") + std::string(w.name);
      return {{"anyOf", Json::array({Json{{"type", "string"}, {"pattern", "^(" + names + ")\\b|^\\$"}},
                                     Json{{"type", "object"}, {"required", Json::array({"cmd"})}}})}};
    }
    case Form::refusal:
      return {{"anyOf", Json::array({text, Json{{"const", true}}})}};
    case Form::condition:
      return reference("condition");
    case Form::conditions:
      return list_of(reference("condition"));
    case Form::anchor:
      return {{"anyOf", Json::array({time, reference("condition")})}};
    case Form::fault:
      return reference("fault");
    case Form::clear:
      return reference("clear");
    case Form::cases:
      return row.part == Part::action ? Json{{"type", "object"}} : list_of(Json{{"type", "object"}});
    case Form::steps:
      return list_of(reference("step"));
    case Form::random:
      return reference("random");
    case Form::actions:
      return list_of(reference("action"));
  }
  return {};
}

Json object_of(Part part) {
  Json properties = Json::object(), needed = Json::array();
  for (const KeyRow& row : kKeys) {
    if (row.part != part) continue;
    Json key = described(row);
    key["description"] = std::string(row.english);
    properties[std::string(row.name)] = std::move(key);
    // An included file need not have the title, nor a case's file the machine.
    if (row.needed && (part != Part::file || row.name == "schema")) needed.push_back(std::string(row.name));
  }
  if (part == Part::fault)
    for (const fault::ParameterRow& p : fault::parameters())
      properties[std::string(p.name)] = {{"type", Json::array({"number", "string"})},
                                         {"description", std::string(p.unit)}};
  Json out = {{"type", "object"}, {"additionalProperties", false}, {"properties", std::move(properties)}};
  if (!needed.empty()) out["required"] = std::move(needed);
  return out;
}

}  // namespace

std::span<const KeyRow> keys() noexcept { return kKeys; }
std::span<const WordRow> words() noexcept { return kWords; }

const KeyRow* find_key(Part part, std::string_view name) noexcept {
  const auto row = std::find_if(std::begin(kKeys), std::end(kKeys),
                                [&](const KeyRow& r) { return r.part == part && r.name == name; });
  return row == std::end(kKeys) ? nullptr : row;
}

std::string key_names(Part part) {
  std::string names;
  for (const KeyRow& row : kKeys)
    if (row.part == part) names += (names.empty() ? "" : ", ") + std::string(row.name);
  return names;
}

std::string json_schema() {
  Json schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                 {"title", "servogate scenario, schema 1"}};
  schema.update(object_of(Part::file));
  schema["$defs"] = {{"step", object_of(Part::step)},     {"condition", object_of(Part::condition)},
                     {"fault", object_of(Part::fault)},   {"clear", object_of(Part::clear)},
                     {"random", object_of(Part::random)}, {"action", object_of(Part::action)}};
  return machine::written(schema, 1) + "\n";
}

std::string key_reference(bool russian) {
  constexpr struct {
    Part part;
    std::string_view english, russian;
  } kParts[] = {{Part::file, "The file", "Файл"},
                {Part::step, "`[[given]]` and `[[step]]`", "`[[given]]` и `[[step]]`"},
                {Part::condition, "A condition", "Условие"},
                {Part::fault, "`fault`, beside the parameters of docs/faults.md",
                 "`fault`, кроме параметров из docs/faults.md"},
                {Part::clear, "`clear`", "`clear`"},
                {Part::random, "`[random]`", "`[random]`"},
                {Part::action, "`[[random.action]]`", "`[[random.action]]`"}};
  std::string out;
  for (const auto& part : kParts) {
    out += "\n### " + std::string(russian ? part.russian : part.english) + "\n\n";
    out += russian ? "| ключ | смысл |\n|---|---|\n" : "| key | meaning |\n|---|---|\n";
    for (const KeyRow& row : kKeys)
      if (row.part == part.part)
        out += "| `" + std::string(row.name) + "` | " + cell(russian ? row.russian : row.english) + " |\n";
  }
  return out;
}

std::string word_reference(bool russian) {
  std::string out =
      russian ? "| слово | что происходит |\n|---|---|\n" : "| word | what happens |\n|---|---|\n";
  for (const WordRow& w : kWords)
    out += "| `" + cell(w.name) + (w.arguments.empty() ? "" : " ") + cell(w.arguments) + "` | " +
           cell(russian ? w.russian : w.english) + " |\n";
  return out;
}

}  // namespace servogate::scenario
