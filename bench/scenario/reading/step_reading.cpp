// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/reading/step_reading.hpp"

#include <algorithm>
#include <filesystem>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/reading/parameters.hpp"
#include "bench/scenario/reading/table.hpp"
#include "machine/keys/findings.hpp"

namespace servogate::scenario {

namespace {

using Kind = machine::Element::Kind;

Inject read_fault(const machine::Element& element, machine::Reading& reading) {
  Table table(element, Part::fault, reading, true);
  Inject inject;
  if (!table.is_table()) return inject;
  inject.device = table.text("device");
  const std::string name = table.text("kind");
  const fault::KindRow* const kind = fault::find_kind(name);
  if (kind == nullptr) {
    if (table.has("kind"))
      reading.error(table.find("kind")->at, finding::kUnknownFault, {name, fault::names_for(~0u)});
    return inject;
  }
  inject.fault.kind = kind->kind;
  for (const machine::Element& child : element.children) {
    if (child.key == "device" || child.key == "kind") continue;
    const fault::ParameterRow* const parameter = fault::find_parameter(child.key);
    if (parameter == nullptr || !kind->takes(parameter->parameter)) {
      reading.error(child.key_at, finding::kNoFaultParameter, {name, child.key});
      continue;
    }
    std::string value = words_of(child);
    std::erase(value, ' ');
    if (child.kind == Kind::boolean) value = child.boolean ? "1" : "0";
    if (!parameter->set(value, inject.fault))
      reading.error(child.at, finding::kFaultValue,
                    {child.key, std::string(parameter->unit), words_of(child)});
  }
  return inject;
}

Clear read_clear(const machine::Element& element, machine::Reading& reading) {
  Table table(element, Part::clear, reading);
  Clear clear;
  if (!table.is_table()) return clear;
  clear.device = table.text("device");
  if (!table.has("kind")) return clear;
  const std::string name = table.text("kind");
  if (const fault::KindRow* const kind = fault::find_kind(name))
    clear.kind = kind->kind;
  else
    reading.error(table.find("kind")->at, finding::kUnknownFault, {name, fault::names_for(~0u)});
  return clear;
}

Do read_do(Table& table, StepKind kind, machine::Reading& reading) {
  const machine::Element& element = *table.find("do");
  Do what;
  what.folder = std::filesystem::path(reading.file).parent_path().string();
  what.either = kind == StepKind::drawn;
  if (element.kind == Kind::table) {
    what.command = element;
  } else if (element.kind == Kind::string) {
    what.words = element.string;
    const std::string word = what.words.substr(0, what.words.find(' '));
    const auto known = words();
    if (std::none_of(known.begin(), known.end(), [&](const WordRow& w) { return w.name == word; })) {
      std::string names;
      for (const WordRow& w : known) names += (names.empty() ? "" : ", ") + std::string(w.name);
      reading.error(element.at, finding::kUnknownWord, {word, names});
    }
  } else {
    table.wrong(element, "do", "a sentence or a table with `cmd`", "предложение или таблица с `cmd`");
  }
  if (kind == StepKind::drawn) return what;
  what.wait = table.flag("wait", kind == StepKind::given);
  if (const machine::Element* const refused = table.find("refused")) {
    if (refused->kind == Kind::boolean && refused->boolean)
      what.refused = "";
    else
      what.refused = table.text("refused");
    what.wait = false;
  }
  return what;
}

Expect read_expect(Table& table, machine::Reading& reading) {
  Expect expect;
  expect.never = table.has("never");
  expect.condition = read_condition(*table.find(expect.never ? "never" : "expect"), reading);
  using Manner = Expect::Manner;
  if (table.count({"within", "always", "until"}) > 1) {
    reading.error(table.at(), finding::kOneOf, {"expect", "within, always, until"});
  } else if (const machine::Element* const always = table.find("always")) {
    expect.manner = Manner::always;
    if (always->kind == Kind::boolean) {
      if (!always->boolean) table.wrong(*always, "always", "true or a time", "true или время");
    } else {
      expect.time = table.time("always").value_or(0);
    }
  } else if (const machine::Element* const until = table.find("until")) {
    expect.manner = Manner::until;
    expect.until = read_condition(*until, reading);
  } else if (table.has("within")) {
    expect.manner = Manner::within;
    expect.time = table.time("within").value_or(0);
  }
  if (expect.never && (expect.manner == Manner::now || expect.manner == Manner::within))
    reading.error(table.at(), finding::kNeedsTime, {});
  return expect;
}

void read_anchor(Table& table, Step& step, machine::Reading& reading) {
  using Anchor = Step::Anchor;
  if (table.count({"at", "after"}) > 1) reading.error(table.at(), finding::kOneOf, {"step", "at, after"});
  if (table.has("at")) {
    step.anchor = Anchor::at;
    step.time = table.time("at").value_or(0);
  } else if (const machine::Element* const after = table.find("after")) {
    if (after->kind == Kind::table) {
      step.anchor = Anchor::after;
      step.after = read_condition(*after, reading);
      step.time = table.time("plus").value_or(0);
    } else {
      step.anchor = Anchor::after_time;
      step.time = table.time("after").value_or(0);
    }
  }
  if (table.has("plus") && step.anchor != Anchor::after)
    reading.error(table.find("plus")->key_at, finding::kBelongs, {"plus", "after = {...}"});
}

}  // namespace

Step read_step(const machine::Element& element, StepKind kind, machine::Reading& reading) {
  Table table(element, kind == StepKind::drawn ? Part::action : Part::step, reading);
  Step step;
  step.at = element.at;
  step.drawn = kind == StepKind::drawn;
  if (!table.is_table()) return step;
  if (!step.drawn) {
    step.title = table.text("title");
    read_anchor(table, step, reading);
  }
  constexpr std::string_view kDeeds[] = {"do", "fault", "clear", "expect", "never"};
  std::string there, all;
  int count = 0;
  for (const std::string_view deed : kDeeds) {
    if (!step.drawn || deed == "do" || deed == "fault" || deed == "clear")
      all += (all.empty() ? "" : ", ") + std::string(deed);
    if (!table.has(deed)) continue;
    there += (there.empty() ? "" : ", ") + std::string(deed);
    ++count;
  }
  if (count != 1) {
    const char* const what = step.drawn ? "action" : "step";
    if (count == 0)
      reading.error(element.at, finding::kNoneOf, {what, all});
    else
      reading.error(element.at, finding::kOneOf, {what, there});
    return step;
  }
  const auto owned = [&](std::initializer_list<std::string_view> keys, std::string_view owner, bool has) {
    for (const std::string_view key : keys)
      if (table.has(key) && !has)
        reading.error(table.find(key)->key_at, finding::kBelongs, {std::string(key), std::string(owner)});
  };
  owned({"wait", "refused"}, "do", table.has("do"));
  owned({"within"}, "expect", table.has("expect"));
  owned({"always", "until"}, "expect, never", table.count({"expect", "never"}) > 0);
  if (table.has("do"))
    step.what = read_do(table, kind, reading);
  else if (table.has("fault"))
    step.what = read_fault(*table.find("fault"), reading);
  else if (table.has("clear"))
    step.what = read_clear(*table.find("clear"), reading);
  else
    step.what = read_expect(table, reading);
  return step;
}

}  // namespace servogate::scenario
