// SPDX-License-Identifier: Apache-2.0
#include <iterator>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/reading/step_reading.hpp"
#include "bench/scenario/reading/table.hpp"
#include "machine/keys/findings.hpp"

namespace servogate::scenario {

namespace {

using Test = Condition::Test;
using Kind = Condition::Kind;

constexpr struct {
  std::string_view key;
  Test test;
} kTests[] = {{"equals", Test::equals},   {"differs", Test::differs},   {"above", Test::above},
              {"below", Test::below},     {"at_least", Test::at_least}, {"at_most", Test::at_most},
              {"between", Test::between}, {"edge", Test::rising}};

constexpr struct {
  std::string_view key;
  Kind kind;
} kKinds[] = {{"signal", Kind::signal},
              {"alarm", Kind::alarm},
              {"no_alarm", Kind::no_alarm},
              {"standstill", Kind::standstill},
              {"path_deviation", Kind::path_deviation},
              {"reference", Kind::reference},
              {"order", Kind::order},
              {"all", Kind::all},
              {"any", Kind::any}};

template <class Rows>
std::string names_of(const Rows& rows) {
  std::string names;
  for (const auto& row : rows) names += (names.empty() ? "" : ", ") + std::string(row.key);
  return names;
}

/// The one of `rows` whose key is there; nullptr: none or several, which is a finding.
template <class Rows>
const typename std::remove_reference_t<decltype(*std::begin(std::declval<Rows&>()))>* only(
    const Rows& rows, const Table& table, const char* what, machine::Reading& reading) {
  const typename std::remove_reference_t<decltype(*std::begin(rows))>* found = nullptr;
  std::string there;
  for (const auto& row : rows) {
    if (!table.has(row.key)) continue;
    there += (there.empty() ? "" : ", ") + std::string(row.key);
    found = found == nullptr ? &row : found;
  }
  if (found == nullptr)
    reading.error(table.at(), finding::kNoneOf, {what, names_of(rows)});
  else if (there.find(',') != std::string::npos)
    reading.error(table.at(), finding::kOneOf, {what, there});
  else
    return found;
  return nullptr;
}

void read_test(Table& table, Condition& c, machine::Reading& reading) {
  const auto* const row = only(kTests, table, "signal", reading);
  if (row == nullptr) return;
  c.test = row->test;
  if (row->key == "edge") {
    const std::string edge = table.text("edge");
    c.test = edge == "falling" ? Test::falling : edge == "any" ? Test::changes : Test::rising;
    if (edge != "rising" && edge != "falling" && edge != "any")
      reading.error(table.find("edge")->at, machine::finding::kUnknownChoice,
                    {"edge", edge, "\"rising\", \"falling\", \"any\""});
  } else if (row->key == "between") {
    const machine::Element& range = *table.find("between");
    if (range.kind != machine::Element::Kind::array || range.children.size() != 2) {
      reading.error(range.at, finding::kNotRange, {"between"});
      return;
    }
    machine::Element ends = range;  // its two values as keys of a table
    ends.kind = machine::Element::Kind::table;
    ends.children[0].key = "above";
    ends.children[1].key = "below";
    Table pair(ends, Part::condition, reading);
    c.value = pair.value("above").value_or(Value{});
    c.upper = pair.value("below").value_or(Value{});
  } else {
    c.value = table.value(row->key).value_or(Value{});
  }
  c.tolerance = table.value("tolerance");
}

void belongs(const Table& table, std::string_view key, std::string_view owner, bool there,
             machine::Reading& reading) {
  if (table.has(key) && !there)
    reading.error(table.find(key)->key_at, finding::kBelongs, {std::string(key), std::string(owner)});
}

}  // namespace

Condition read_condition(const machine::Element& element, machine::Reading& reading) {
  Table table(element, Part::condition, reading);
  Condition c;
  c.at = element.at;
  if (!table.is_table()) return c;
  const auto* const row = only(kKinds, table, "condition", reading);
  if (row == nullptr) return c;
  c.kind = row->kind;
  for (const auto& test : kTests) belongs(table, test.key, "signal", c.kind == Kind::signal, reading);
  belongs(table, "tolerance", "equals, differs, reference",
          c.kind == Kind::reference || table.count({"equals", "differs"}) > 0, reading);
  belongs(table, "but", "no_alarm", c.kind == Kind::no_alarm, reading);
  belongs(table, "distance", "standstill", c.kind == Kind::standstill, reading);
  belongs(table, "signals", "reference", c.kind == Kind::reference, reading);
  belongs(table, "from", "reference", c.kind == Kind::reference, reading);
  switch (c.kind) {
    case Kind::signal:
      c.signal = table.text("signal");
      read_test(table, c, reading);
      break;
    case Kind::alarm:
      c.numbers = table.wholes("alarm");
      break;
    case Kind::no_alarm:
      if (!table.flag("no_alarm", true)) table.wrong(*table.find("no_alarm"), "no_alarm", "true", "true");
      c.numbers = table.wholes("but");
      break;
    case Kind::standstill:
      c.names = table.texts("standstill");
      c.limited = table.has("distance");
      if (c.limited) c.value = table.value("distance").value_or(Value{});
      break;
    case Kind::path_deviation:
      c.value = table.value("path_deviation").value_or(Value{});
      break;
    case Kind::reference:
      c.file = table.text("reference");
      c.names = table.texts("signals");
      c.begins = table.time("from").value_or(0);
      c.value = table.value("tolerance").value_or(Value{.is = 1e-9, .at = c.at});
      break;
    default:
      for (const machine::Element* part : table.list(row->key))
        c.parts.push_back(read_condition(*part, reading));
      break;
  }
  return c;
}

}  // namespace servogate::scenario
