// SPDX-License-Identifier: Apache-2.0
#include "machine/keys/reader.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <tuple>

#include "firmware_if/text/decimal_comma.hpp"
#include "firmware_if/text/nearest.hpp"
#include "machine/keys/findings.hpp"

namespace servogate::machine {

namespace {

/// One key being read: the key, its path, the axis units in force.
struct Slot {
  const Key& key;
  std::string path;
  AxisUnits axis;
  Reading& reading;

  template <typename... Arguments>
  void error(const Element& at, const text::Entry& entry, Arguments... arguments) const {
    reading.error(at.at, entry, {shown(), std::string(arguments)...});
  }
  /// The path as a person sees it: "axis.home.fast" without list positions.
  std::string shown() const {
    std::string out;
    std::size_t begin = 0;
    while (begin <= path.size()) {
      const std::size_t end = std::min(path.find('.', begin), path.size());
      const std::string part = path.substr(begin, end - begin);
      if (part.empty() || part.find_first_not_of("0123456789") != std::string::npos)
        out += (out.empty() ? "" : ".") + part;
      begin = end + 1;
    }
    return out;
  }
};

std::string element_name(const Element& e) {
  static constexpr std::string_view kEnglish[] = {"a boolean", "an integer", "a number", "a string",
                                                  "a date",    "a list",     "a table"};
  static constexpr std::string_view kRussian[] = {
      "логическое значение", "целое число", "число", "строка", "дата", "список", "таблица"};
  return text::both(kEnglish[static_cast<int>(e.kind)], kRussian[static_cast<int>(e.kind)]);
}

std::string expected_name(const Slot& slot) {
  const std::string unit = unit_name(slot.key.rule.unit, slot.axis);
  switch (slot.key.kind) {
    case KeyKind::boolean:
      return text::both("true or false", "true или false");
    case KeyKind::integer:
    case KeyKind::long_integer:
      return unit.empty() ? text::both("an integer", "целое число")
                          : text::both("an integer in " + unit + " or a string with a unit",
                                       "целое число в " + unit + " или строка с единицей");
    case KeyKind::number:
      return unit.empty() ? text::both("a number", "число")
                          : text::both("a number in " + unit + " or a string with a unit",
                                       "число в " + unit + " или строка с единицей");
    case KeyKind::text:
    case KeyKind::choice:
      return text::both("a string in quotes", "строка в кавычках");
    case KeyKind::place:
      return text::both("a place like \"SA16\"", "адрес вида \"SA16\"");
    case KeyKind::texts:
      return text::both("a list of strings", "список строк");
    case KeyKind::numbers:
      return text::both("a table of name = number", "таблица имя = число");
    case KeyKind::ratio:
      return text::both("a pair of integers like [3, 1]", "пара целых чисел вида [3, 1]");
    case KeyKind::pairs:
      return text::both("a list of pairs of numbers like [[0, 0.001], [50, 0.002]]",
                        "список пар чисел вида [[0, 0.001], [50, 0.002]]");
    case KeyKind::table:
      return text::both("a table", "таблица");
    case KeyKind::tables:
      return text::both("a list of tables", "список таблиц");
  }
  return {};
}

void wrong_type(const Slot& slot, const Element& e) {
  slot.error(e, finding::kWrongType, expected_name(slot), element_name(e));
}

/// `written`: the value as a person wrote it, with its unit; nullptr: a plain number.
bool in_range(const Slot& slot, const Element& e, double value, const Quantity* written = nullptr) {
  const Rule& rule = slot.key.rule;
  if (!std::isfinite(value)) {
    slot.error(e, finding::kNotFinite);
    return false;
  }
  if (value < rule.min || value > rule.max || (rule.above_min && value == rule.min)) {
    if (written == nullptr)
      slot.error(e, finding::kOutOfRange, text::number(value, 9), range_text(rule, slot.axis));
    else
      slot.error(e, finding::kOutOfRange,
                 text::number(value * written->per_unit, 9) + " " + std::string(written->unit),
                 range_text(rule, *written));
    return false;
  }
  return true;
}

/// A number, or a string with a unit where the key has one.
bool read_number(const Slot& slot, const Element& e, double& out) {
  const Unit unit = slot.key.rule.unit;
  if (e.numeric()) {
    if (!in_range(slot, e, e.number())) return false;
    out = e.number();
  } else if (e.kind == Element::Kind::string && unit != Unit::none) {
    Quantity q = parse_quantity(e.string, unit, slot.axis);
    const std::string name = unit_name(unit, slot.axis);
    if (const std::string point = text::with_decimal_point(e.string);
        q.error != QuantityError::none && !point.empty()) {
      q = parse_quantity(point, unit, slot.axis);
      if (q.error == QuantityError::none) slot.error(e, finding::kDecimalComma, e.string, point);
      if (q.error == QuantityError::none) return false;
    }
    if (q.error == QuantityError::not_a_number) {
      slot.error(e, finding::kNotANumber, e.string, text::both("a number in " + name, "число в " + name));
      return false;
    }
    if (q.error == QuantityError::no_unit) {
      slot.error(e, finding::kNoUnit, e.string, name);
      return false;
    }
    if (q.error == QuantityError::wrong_unit) {
      slot.error(e, finding::kWrongUnit, e.string, name, unit_spellings(unit, slot.axis));
      return false;
    }
    if (!in_range(slot, e, q.value, &q)) return false;
    out = q.value;
  } else {
    wrong_type(slot, e);
    return false;
  }
  return true;
}

template <typename Integer>
void read_integer(const Slot& slot, const Element& e, void* member) {
  double value = 0.0;
  if (e.kind == Element::Kind::real ||
      (e.kind == Element::Kind::string && slot.key.rule.unit == Unit::none)) {
    wrong_type(slot, e);
    return;
  }
  if (!read_number(slot, e, value)) return;
  // Every integer key has a range far inside 2^53, so the double is exact; a string may still hold a
  // fraction.
  if (value != std::nearbyint(value) || std::abs(value) > 9e15 ||
      (sizeof(Integer) == sizeof(int) && std::abs(value) > 2147483647.0)) {
    wrong_type(slot, e);
    return;
  }
  *static_cast<Integer*>(member) = static_cast<Integer>(value);
}

void read_text(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::string) return wrong_type(slot, e);
  if (slot.key.rule.required && e.string.empty()) return slot.error(e, finding::kEmptyText);
  *static_cast<std::string*>(member) = e.string;
}

void read_choice(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::string) return wrong_type(slot, e);
  std::string all;
  for (std::size_t i = 0; i < slot.key.choices.size(); ++i) {
    if (slot.key.choices[i] == e.string) {
      *static_cast<std::uint8_t*>(member) = static_cast<std::uint8_t>(i);
      return;
    }
    all += (i == 0 ? "" : ", ") + std::string(slot.key.choices[i]);
  }
  slot.error(e, finding::kUnknownChoice, e.string, all);
}

void read_place(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::string) return wrong_type(slot, e);
  // A bare packet is its first place to a program; here nobody means it.
  const bool indexed = e.string.find_first_of("0123456789") < e.string.find('.');
  if (const auto place = image::parse_place(e.string); place && indexed)
    *static_cast<image::Place*>(member) = *place;
  else
    slot.error(e, finding::kNotAPlace, e.string);
}

void read_texts(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::array) return wrong_type(slot, e);
  auto& list = *static_cast<std::vector<std::string>*>(member);
  list.clear();
  for (std::size_t i = 0; i < e.children.size(); ++i) {
    const Element& child = e.children[i];
    if (child.kind != Element::Kind::string) {
      wrong_type(slot, child);
      continue;
    }
    slot.reading.places[slot.path + "." + std::to_string(list.size())] = child.at;
    list.push_back(child.string);
  }
}

void read_numbers(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::table) return wrong_type(slot, e);
  auto& map = *static_cast<std::map<std::string, double>*>(member);
  for (const Element& child : e.children) {
    double value = 0.0;
    if (!child.numeric())
      wrong_type(slot, child);
    else if (in_range(slot, child, child.number())) {
      value = child.number();
      slot.reading.places[slot.path + "." + child.key] = child.key_at;
      map[child.key] = value;
    }
  }
}

void read_ratio(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::array || e.children.size() != 2) return wrong_type(slot, e);
  std::array<std::int64_t, 2> ratio{};
  for (std::size_t i = 0; i < 2; ++i) {
    if (e.children[i].kind != Element::Kind::integer) return wrong_type(slot, e.children[i]);
    if (!in_range(slot, e.children[i], e.children[i].number())) return;
    ratio[i] = e.children[i].integer;
  }
  *static_cast<std::array<std::int64_t, 2>*>(member) = ratio;
}

void read_pairs(const Slot& slot, const Element& e, void* member) {
  if (e.kind != Element::Kind::array) return wrong_type(slot, e);
  auto& list = *static_cast<std::vector<std::array<double, 2>>*>(member);
  list.clear();
  for (const Element& pair : e.children) {
    if (pair.kind != Element::Kind::array || pair.children.size() != 2 || !pair.children[0].numeric() ||
        !pair.children[1].numeric())
      return wrong_type(slot, pair);
    if (!in_range(slot, pair, pair.children[0].number()) || !in_range(slot, pair, pair.children[1].number()))
      return;
    slot.reading.places[slot.path + "." + std::to_string(list.size())] = pair.at;
    list.push_back({pair.children[0].number(), pair.children[1].number()});
  }
}

void read_table(const Element& table, const Section& section, void* object, const std::string& path,
                AxisUnits axis, Reading& reading);

void read_tables(const Slot& slot, const Element& e, void* member) {
  // A single [axis] for [[axis]] is the usual slip and gets its own words through the type names.
  if (e.kind != Element::Kind::array) {
    slot.reading.unread.insert(slot.path);
    return wrong_type(slot, e);
  }
  for (const Element& child : e.children) {
    if (child.kind != Element::Kind::table) {
      wrong_type(slot, child);
      continue;
    }
    const std::string path = slot.path + "." + std::to_string(slot.key.count(member));
    read_table(child, slot.key.child(), slot.key.append(member), path, slot.axis, slot.reading);
  }
}

void read_value(const Slot& slot, const Element& e, void* member) {
  switch (slot.key.kind) {
    case KeyKind::boolean:
      if (e.kind == Element::Kind::boolean)
        *static_cast<bool*>(member) = e.boolean;
      else
        wrong_type(slot, e);
      return;
    case KeyKind::integer:
      return read_integer<int>(slot, e, member);
    case KeyKind::long_integer:
      return read_integer<std::int64_t>(slot, e, member);
    case KeyKind::number:
      read_number(slot, e, *static_cast<double*>(member));
      return;
    case KeyKind::text:
      return read_text(slot, e, member);
    case KeyKind::choice:
      return read_choice(slot, e, member);
    case KeyKind::place:
      return read_place(slot, e, member);
    case KeyKind::texts:
      return read_texts(slot, e, member);
    case KeyKind::numbers:
      return read_numbers(slot, e, member);
    case KeyKind::ratio:
      return read_ratio(slot, e, member);
    case KeyKind::pairs:
      return read_pairs(slot, e, member);
    case KeyKind::table:
      if (e.kind == Element::Kind::table)
        read_table(e, slot.key.child(), member, slot.path, slot.axis, slot.reading);
      else
        wrong_type(slot, e);
      return;
    case KeyKind::tables:
      return read_tables(slot, e, member);
  }
}

/// Returns the name that was probably meant, empty when none is near.
std::string report_unknown(const Element& child, const Section& section, const std::string& path,
                           Reading& reading) {
  std::vector<std::string> names;
  std::string all;
  for (const Key& key : section.keys) {
    names.emplace_back(key.name);
    all += (all.empty() ? "" : ", ") + std::string(key.name);
  }
  const Slot slot{section.keys[0], path.empty() ? child.key : path + "." + child.key, AxisUnits::linear,
                  reading};
  for (const MovedKey& moved : section.moved) {
    if (moved.name != child.key) continue;
    reading.error(child.key_at, finding::kMovedKey, {slot.shown(), text::both(moved.english, moved.russian)});
    return {};
  }
  const std::string near = text::nearest(child.key, names);
  if (near.empty())
    reading.error(child.key_at, finding::kUnknownKeyList, {slot.shown(), all});
  else
    reading.error(child.key_at, finding::kUnknownKey, {slot.shown(), near});
  return near;
}

AxisUnits units_of_axis(const Element& table) {
  const Element* type = table.find("type");
  return type != nullptr && type->string == "rotary" ? AxisUnits::rotary : AxisUnits::linear;
}

/// What names an axis of the file has its units.
AxisUnits axis_units(const Element& table, const Section& section, AxisUnits around, const Reading& reading) {
  if (section.is_axis) return units_of_axis(table);
  for (const Key& key : section.keys) {
    const Element* letter = key.rule.refers == Refers::axis ? table.find(key.name) : nullptr;
    if (letter == nullptr) continue;
    const auto axis = reading.axes.find(letter->string);
    if (axis != reading.axes.end()) return axis->second;
  }
  return around;
}

void read_table(const Element& table, const Section& section, void* object, const std::string& path,
                AxisUnits axis, Reading& reading) {
  reading.places[path] = table.at;
  axis = axis_units(table, section, axis, reading);
  for (const Element& child : table.children) {
    const auto known = std::find_if(section.keys.begin(), section.keys.end(),
                                    [&](const Key& k) { return k.name == child.key; });
    if (known != section.keys.end()) continue;
    // A misspelt key is not missing as well.
    if (const std::string meant = report_unknown(child, section, path, reading); !meant.empty())
      reading.unread.insert(path.empty() ? meant : path + "." + meant);
  }
  for (const Key& key : section.keys) {
    const Slot slot{key, path.empty() ? std::string(key.name) : path + "." + std::string(key.name), axis,
                    reading};
    if (const Element* e = table.find(key.name)) {
      reading.places[slot.path] = e->at;
      const std::size_t before = reading.findings.size();
      read_value(slot, *e, key.member(object));
      if (key.child == nullptr && reading.findings.size() != before) reading.unread.insert(slot.path);
    } else if (key.rule.required && !reading.unread.contains(slot.path)) {
      reading.error(table.at, finding::kMissingKey, {slot.shown(), text::both(key.english, key.russian)});
    }
  }
}

}  // namespace

void Reading::error(Where at, const text::Entry& entry, std::vector<std::string> arguments) {
  findings.push_back({text::Severity::error, file, at.line, at.column, &entry, std::move(arguments)});
}

void Reading::warning(Where at, const text::Entry& entry, std::vector<std::string> arguments) {
  findings.push_back({text::Severity::warning, file, at.line, at.column, &entry, std::move(arguments)});
}

void read_section(const Element& table, const Section& section, void* object, Reading& reading) {
  if (const Element* axes = table.find("axis"))
    for (const Element& axis : axes->children)
      if (const Element* letter = axis.find("letter")) reading.axes[letter->string] = units_of_axis(axis);
  read_table(table, section, object, {}, AxisUnits::either, reading);
}

namespace {

std::string lower(std::string word) {
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return word;
}

/// A word where a value is to stand, as X in `letter = X`; empty: the error at `at` is another one. `column`:
/// where it begins.
std::string bare_word(std::string_view text, const Where& at, int& column) {
  for (int line = 1; line < at.line && !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  text = text.substr(0, text.find('\n'));
  const std::size_t near =
      std::min<std::size_t>(static_cast<std::size_t>(std::max(at.column, 1)), text.size());
  const std::size_t before = near == 0 ? std::string_view::npos : text.find_last_of("=,[{", near - 1);
  const std::size_t key = text.find_first_not_of(" \t"), equals = text.find('=');
  const bool named = key != std::string_view::npos && key < equals && text[key] != '[' && text[key] != '#';
  if (before == std::string_view::npos || equals > before || !named) return {};
  std::size_t begin = text.find_first_not_of(" \t", before + 1);
  if (begin == std::string_view::npos || std::isalpha(static_cast<unsigned char>(text[begin])) == 0)
    return {};
  const std::size_t end = std::min(text.find_first_of(" \t,]}#\"'=\r", begin), text.size());
  column = static_cast<int>(begin) + 1;
  return std::string(text.substr(begin, end - begin));
}

}  // namespace

bool read_file_text(std::string_view text, const Section& section, void* object, Reading& reading) {
  const Document document = read_document(text);
  if (!document.ok()) {
    Where at = document.error_at;
    const std::string word = bare_word(text, document.error_at, at.column);
    if (!word.empty() && lower(word) != "true" && lower(word) != "false") {
      reading.error(at, finding::kNoQuotes, {word});
      return false;
    }
    reading.error(document.error_at, finding::kSyntax, {document.error});
    return false;
  }
  read_section(document.root, section, object, reading);
  return true;
}

void visit_keys(const Section& section, void* object, const Visitor& visit, const std::string& path) {
  for (const Key& key : section.keys) {
    const std::string here = path.empty() ? std::string(key.name) : path + "." + std::string(key.name);
    void* member = key.member(object);
    visit(key, member, here);
    if (key.kind == KeyKind::table) visit_keys(key.child(), member, visit, here);
    if (key.kind == KeyKind::tables)
      for (std::size_t i = 0; i < key.count(member); ++i)
        visit_keys(key.child(), key.item(member, i), visit, here + "." + std::to_string(i));
  }
}

Where find_place(const Places& places, std::string_view path) {
  while (true) {
    if (const auto it = places.find(path); it != places.end()) return it->second;
    if (path.empty()) return {1, 1};
    const std::size_t dot = path.rfind('.');
    path = dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
  }
}

Where MachineConfig::where(std::string_view path) const { return find_place(places, path); }

void sort_findings(std::vector<text::Finding>& findings) {
  const auto place = [](const text::Finding& f) { return std::tie(f.file, f.line, f.column); };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const text::Finding& a, const text::Finding& b) { return place(a) < place(b); });
  const auto same = [&](const text::Finding& a, const text::Finding& b) {
    return place(a) == place(b) && a.entry == b.entry && a.arguments == b.arguments;
  };
  findings.erase(std::unique(findings.begin(), findings.end(), same), findings.end());
}

namespace {

std::string range_text(const Rule& rule, const std::string& unit, double per_unit) {
  const std::string tail = unit.empty() ? "" : " " + unit;
  const bool low = std::isfinite(rule.min), high = std::isfinite(rule.max);
  const std::string min = text::number(rule.min * per_unit, 9), max = text::number(rule.max * per_unit, 9);
  if (low && rule.min == rule.max) return text::both("only " + min + tail, "только " + min + tail);
  if (low && high && rule.above_min)
    return text::both("above " + min + " up to " + max + tail,
                      "больше " + min + " и не больше " + max + tail);
  if (low && high) return text::both(min + " to " + max + tail, "от " + min + " до " + max + tail);
  if (low && rule.above_min) return text::both("above " + min + tail, "больше " + min + tail);
  if (low) return text::both("at least " + min + tail, "не меньше " + min + tail);
  if (high) return text::both("at most " + max + tail, "не больше " + max + tail);
  return text::both("any number" + tail, "любое число" + tail);
}

}  // namespace

std::string range_text(const Rule& rule, AxisUnits axis) {
  return range_text(rule, unit_name(rule.unit, axis), 1.0);
}

std::string range_text(const Rule& rule, const Quantity& written) {
  return range_text(rule, std::string(written.unit), written.per_unit);
}

}  // namespace servogate::machine
