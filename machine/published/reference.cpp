// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "machine/keys/reader.hpp"
#include "machine/keys/sections.hpp"
#include "machine/load.hpp"
#include "machine/published/published.hpp"

namespace servogate::machine {

namespace {

/// Writes the reference in one language.
class Reference {
 public:
  explicit Reference(text::Language language) : language_(language) {}
  std::string all();

 private:
  bool russian() const { return language_ == text::Language::russian; }
  std::string word(const char* in_english, const char* in_russian) const {
    return russian() ? in_russian : in_english;
  }
  std::string type_of(const Key& key) const;
  std::string type_cell(const Key& key) const;
  std::string default_cell(const Key& key, void* defaults) const;
  void section(const Section& section, const std::string& heading);
  void sections(const Section& section, const std::string& path, bool list);
  void units();

  text::Language language_;
  std::string out_;
};

/// A cell of a Markdown table.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

std::string Reference::type_of(const Key& key) const {
  switch (key.kind) {
    case KeyKind::boolean:
      return word("boolean", "логическое");
    case KeyKind::integer:
    case KeyKind::long_integer:
      return word("integer", "целое");
    case KeyKind::number:
      return word("number", "число");
    case KeyKind::text:
      return word("string", "строка");
    case KeyKind::choice: {
      std::string out;
      for (std::string_view c : key.choices) out += (out.empty() ? "" : ", ") + ("`" + std::string(c) + "`");
      return out;
    }
    case KeyKind::place:
      return word("place", "ячейка");
    case KeyKind::texts:
      return word("list of strings", "список строк");
    case KeyKind::numbers:
      return word("table name = number", "таблица имя = число");
    case KeyKind::ratio:
      return word("pair of integers", "пара целых");
    case KeyKind::pairs:
      return word("list of pairs", "список пар");
    case KeyKind::table:
      return word("table", "таблица");
    case KeyKind::tables:
      return word("list of tables", "список таблиц");
  }
  return {};
}

std::string Reference::type_cell(const Key& key) const {
  std::string out = type_of(key);
  const bool ranged = std::isfinite(key.rule.min) || std::isfinite(key.rule.max);
  const std::string unit = unit_name(key.rule.unit, AxisUnits::either);
  if (ranged)
    out += ", " + text::in_language(range_text(key.rule, AxisUnits::either), language_);
  else if (!unit.empty())
    out += ", " + unit;
  return out;
}

std::string Reference::default_cell(const Key& key, void* defaults) const {
  const std::string none = word("none", "нет");
  if (key.rule.required) return word("**required**", "**обязателен**");
  if (key.rule.computed) return word("computed", "вычисляется");
  void* member = key.member(defaults);
  switch (key.kind) {
    case KeyKind::boolean:
      return *static_cast<bool*>(member) ? "true" : "false";
    case KeyKind::integer:
      return std::to_string(*static_cast<int*>(member));
    case KeyKind::long_integer:
      return std::to_string(*static_cast<std::int64_t*>(member));
    case KeyKind::number:
      return std::isfinite(*static_cast<double*>(member)) ? text::number(*static_cast<double*>(member), 9)
                                                          : none;
    case KeyKind::text:
      return static_cast<std::string*>(member)->empty() ? none : *static_cast<std::string*>(member);
    case KeyKind::choice:
      return std::string(key.choices[*static_cast<std::uint8_t*>(member)]);
    case KeyKind::ratio: {
      const auto& pair = *static_cast<std::array<std::int64_t, 2>*>(member);
      if (pair[0] == 0 && pair[1] == 0) return none;
      return '[' + std::to_string(pair[0]) + ", " + std::to_string(pair[1]) + ']';
    }
    default:
      return none;
  }
}

void Reference::section(const Section& section, const std::string& heading) {
  if (!heading.empty()) out_ += "### " + heading + "\n\n";
  out_ += std::string(russian() ? section.russian : section.english) + "\n\n";
  out_ += word("| key | type, unit, range | default | meaning |\n",
               "| ключ | тип, единица, пределы | без ключа | значение |\n");
  out_ += "|---|---|---|---|\n";
  for (const Key& key : section.keys)
    out_ += "| `" + std::string(key.name) + "` | " + cell(type_cell(key)) + " | " +
            cell(default_cell(key, section.defaults())) + " | " +
            cell(russian() ? key.russian : key.english) + " |\n";
  out_ += "\n";
}

void Reference::sections(const Section& section, const std::string& path, bool list) {
  this->section(section, path.empty() ? "" : list ? "`[[" + path + "]]`" : "`[" + path + "]`");
  for (const Key& key : section.keys)
    if (key.child != nullptr)
      sections(key.child(), path.empty() ? std::string(key.name) : path + "." + std::string(key.name),
               key.kind == KeyKind::tables);
}

void Reference::units() {
  out_ += word("| kept in | spellings |\n|---|---|\n", "| единица | написания |\n|---|---|\n");
  for (int u = static_cast<int>(Unit::none) + 1; u <= static_cast<int>(Unit::bytes); ++u) {
    const auto unit = static_cast<Unit>(u);
    out_ +=
        "| " + unit_name(unit, AxisUnits::either) + " | " + unit_spellings(unit, AxisUnits::either) + " |\n";
  }
  out_ += "\n";
}

constexpr const char* kEnglish = R"(# The machine file, all keys

Generated from the table of keys that reads the files (`machine/keys/`); do not edit. The same table gives
[machine.schema.json](machine.schema.json), which editors with a TOML language server understand.
[По-русски](ru/machine-file.md).

- A quantity is a number in the unit named here, or a string with a unit: `500`, `"500 mm/s"`, `"0.5 m/s"`. A wrong unit
  is an error. A rotary axis (`type = "rotary"`) has degrees where a linear one has mm.
- An axis in diameter is described in radii; only programs and displays show the diameter.
- A place is written as in part programs: `SA16` (bit 16 of packet A), `SA16.IN` (word 16: bytes 32 and 33), `SK8.RE`.
- `[[name]]` is a list: write the heading once for every element.
- The file is never rewritten; what the machine learns stands in the state directory.

## Units

)";
constexpr const char* kRussian = R"(# Файл станка: все ключи

Создано из таблицы ключей, по которой читаются файлы (`machine/keys/`); не редактируйте. Из той же таблицы —
[machine.schema.json](../machine.schema.json) для редакторов с поддержкой TOML. [In English](../machine-file.md).

- Величина — число в указанной единице или строка с единицей: `500`, `"500 mm/s"`, `"0.5 m/s"`. Неверная единица — ошибка.
  У поворотной оси (`type = "rotary"`) градусы там, где у линейной мм.
- Ось с диаметром описывается в радиусах; диаметр показывают только программы и индикация.
- Ячейка пишется, как в программах обработки: `SA16` (бит 16 пакета A), `SA16.IN` (слово 16: байты 32 и 33), `SK8.RE`.
- `[[имя]]` — список: заголовок пишется для каждого элемента.
- Файл никогда не переписывается; то, что станок узнаёт, хранится в каталоге состояния.

## Единицы

)";

std::string Reference::all() {
  out_ = word(kEnglish, kRussian);
  units();
  out_ += word("## Machine file\n\n", "## Файл станка\n\n");
  sections(section_of<MachineConfig>(), {}, false);
  out_ += word("## Device file\n\n", "## Файл устройства\n\n");
  sections(section_of<DeviceConfig>(), {}, false);
  while (out_.ends_with("\n\n")) out_.pop_back();
  return out_;
}

}  // namespace

std::string reference_markdown(text::Language language) { return Reference(language).all(); }

}  // namespace servogate::machine
