// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/reading/table.hpp"

#include <algorithm>
#include <cmath>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/reading/parameters.hpp"
#include "machine/keys/findings.hpp"
#include "machine/keys/units.hpp"

namespace servogate::scenario {

using Kind = machine::Element::Kind;

Table::Table(const machine::Element& element, Part part, machine::Reading& reading, bool more)
    : element_(element), reading_(reading) {
  if (!is_table()) {
    wrong(element, element.key, "a table", "таблица");
    return;
  }
  for (const machine::Element& child : element.children)
    if (find_key(part, child.key) == nullptr && !more)
      reading_.error(child.key_at, machine::finding::kUnknownKeyList, {child.key, key_names(part)});
  for (const KeyRow& row : keys())
    if (row.part == part && row.needed && !has(row.name))
      reading_.error(element.at, machine::finding::kMissingKey,
                     {std::string(row.name), text::both(row.english, row.russian)});
}

int Table::count(std::initializer_list<std::string_view> names) const {
  return static_cast<int>(
      std::count_if(names.begin(), names.end(), [&](std::string_view n) { return has(n); }));
}

void Table::wrong(const machine::Element& value, std::string_view key, std::string_view english,
                  std::string_view russian) {
  const std::string stands = value.kind == Kind::table   ? text::both("a table", "таблица")
                             : value.kind == Kind::array ? text::both("a list", "список")
                             : value.kind == Kind::date  ? text::both("a date", "дата")
                                                         : "\"" + words_of(value) + "\"";
  reading_.error(value.at, machine::finding::kWrongType,
                 {std::string(key), text::both(english, russian), stands});
}

std::string Table::text(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return {};
  if (e->kind == Kind::string) return e->string;
  wrong(*e, key, "a text", "текст");
  return {};
}

std::vector<std::string> Table::texts(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return {};
  if (e->kind == Kind::string) return {e->string};
  std::vector<std::string> out;
  for (const machine::Element& child : e->children)
    if (e->kind == Kind::array && child.kind == Kind::string) out.push_back(child.string);
  if (e->kind != Kind::array || out.size() != e->children.size())
    wrong(*e, key, "a text or a list of texts", "текст или список текстов");
  return out;
}

std::optional<std::int64_t> Table::whole(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return std::nullopt;
  if (e->kind == Kind::integer) return e->integer;
  wrong(*e, key, "a whole number", "целое число");
  return std::nullopt;
}

std::vector<int> Table::wholes(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return {};
  std::vector<int> out;
  const auto add = [&](const machine::Element& n) {
    if (n.kind == Kind::integer && n.integer >= 0 && n.integer < 100'000)
      out.push_back(static_cast<int>(n.integer));
  };
  if (e->kind == Kind::array)
    for (const machine::Element& child : e->children) add(child);
  else
    add(*e);
  if (out.size() != (e->kind == Kind::array ? e->children.size() : 1))
    wrong(*e, key, "a number of an alarm, or a list of them", "номер аварии или их список");
  return out;
}

bool Table::flag(std::string_view key, bool otherwise) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return otherwise;
  if (e->kind == Kind::boolean) return e->boolean;
  wrong(*e, key, "true or false", "true или false");
  return otherwise;
}

std::optional<Nanoseconds> Table::time_of(const machine::Element& value, std::string_view key) {
  if (value.kind == Kind::string) {
    const auto read =
        machine::parse_quantity(value.string, machine::Unit::second, machine::AxisUnits::either);
    const double ns = read.value * 1e9;
    if (read.error == machine::QuantityError::none && ns >= 0.0 && ns < 1e15)
      return static_cast<Nanoseconds>(std::llround(ns));
  }
  reading_.error(value.at, finding::kNotTime, {std::string(key), words_of(value)});
  return std::nullopt;
}

std::optional<Nanoseconds> Table::time(std::string_view key) {
  const machine::Element* const e = find(key);
  return e == nullptr ? std::nullopt : time_of(*e, key);
}

std::optional<Value> Table::value(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return std::nullopt;
  Value v{.is = {}, .at = e->at};
  if (e->kind == Kind::boolean)
    v.is = e->boolean;
  else if (e->numeric())
    v.is = e->number();
  else if (e->kind == Kind::string)
    v.is = e->string;
  else {
    wrong(*e, key, "a number, true, false or a text", "число, true, false или текст");
    return std::nullopt;
  }
  return v;
}

std::vector<const machine::Element*> Table::list(std::string_view key) {
  const machine::Element* const e = find(key);
  if (e == nullptr) return {};
  std::vector<const machine::Element*> out;
  if (e->kind == Kind::array)
    for (const machine::Element& child : e->children) out.push_back(&child);
  else
    out.push_back(e);
  return out;
}

}  // namespace servogate::scenario
