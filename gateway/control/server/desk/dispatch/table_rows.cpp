// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/dispatch/table_rows.hpp"

#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "machine/state/table_text.hpp"
#include "machine/tables/exchange.hpp"

namespace servogate::gateway {

namespace {

using machine::MachineConfig;

/// A value of a tool's row that is no axis letter.
struct ToolField {
  std::string_view name;
  double min, max;
  bool whole;
};
constexpr ToolField kToolFields[] = {{"length", -machine::kLongestEntry, machine::kLongestEntry, false},
                                     {"wear", -machine::kLongestEntry, machine::kLongestEntry, false},
                                     {"radius", 0.0, machine::kLongestEntry, false},
                                     {"diameter", 0.0, machine::kLongestEntry, false},
                                     {"radius_wear", -machine::kLongestEntry, machine::kLongestEntry, false},
                                     {"wear_limit", 0.0, machine::kLongestEntry, false},
                                     {"radius_wear_limit", 0.0, machine::kLongestEntry, false},
                                     {"quadrant", 0.0, 9.0, true},
                                     {"life", 0.0, machine::kLongestLife, false},
                                     {"used", 0.0, machine::kLongestLife, false},
                                     {"alternate", 0.0, machine::kLastTool, true}};

std::string upper(std::string letter) {
  for (char& c : letter) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return letter;
}

/// Index of an axis that programs move; -1: none.
int axis_of_entry(const MachineConfig& machine, const std::string& name) {
  const int index = machine.axis_index(upper(name));
  return index >= 0 && !machine.axes[static_cast<std::size_t>(index)].auxiliary ? index : -1;
}

/// The axis along which a tool's one length lies: Z, the last linear one where there is no Z.
std::string tool_axis(const MachineConfig& machine) {
  if (machine.axis_index("Z") >= 0) return "Z";
  std::string last = machine.axes.front().letter;
  for (std::size_t a = 0; a < machine.program_axes(); ++a)
    if (machine.axes[a].type == machine::AxisType::linear) last = machine.axes[a].letter;
  return last;
}

double shown(const MachineConfig& machine, int axis) {
  return machine.axes[static_cast<std::size_t>(axis)].diameter ? 2.0 : 1.0;
}

std::string possible(const MachineConfig& machine, ask::Table table) {
  std::string list;
  for (const std::string& a : table_axes(machine)) list += (list.empty() ? "" : ", ") + a;
  if (table == ask::Table::tool) {
    for (const ToolField& f : kToolFields) list += ", " + std::string(f.name);
    for (const std::string& a : table_axes(machine)) list += ", wear_" + a;
    for (const std::string& a : table_axes(machine)) list += ", wear_limit_" + a;
  }
  return list;
}

bool refuse(FormProblem& problem, const text::Entry& entry, std::vector<std::string> arguments) {
  problem.entry = &entry;
  problem.arguments = std::move(arguments);
  return false;
}

bool in_range(const std::string& name, double value, double min, double max, bool whole,
              FormProblem& problem) {
  if (std::isfinite(value) && value >= min && value <= max && (!whole || value == std::floor(value)))
    return true;
  return refuse(problem, says::kEntryRange,
                {name, text::number(value, 4), text::number(min, 3), text::number(max, 3)});
}

bool check_entry(const MachineConfig& machine, const ask::TableSet& wanted, const std::string& name,
                 double value, FormProblem& problem) {
  const bool tool = *wanted.table == ask::Table::tool;
  const bool limit = tool && name.starts_with("wear_limit_"),
             wear = tool && !limit && name.starts_with("wear_");
  if (axis_of_entry(machine, name.substr(limit ? 11 : wear ? 5 : 0)) >= 0) {
    if ((wear || limit) && wanted.here) return refuse(problem, says::kEntryHere, {name});
    if (limit) return in_range(name, value, 0.0, machine::kLongestEntry, false, problem);
    return in_range(name, value, -machine::kLongestEntry, machine::kLongestEntry, false, problem);
  }
  const auto* field = std::find_if(std::begin(kToolFields), std::end(kToolFields),
                                   [&](const auto& f) { return f.name == name; });
  if (!tool || field == std::end(kToolFields))
    return refuse(problem, says::kEntryUnknown,
                  {name, table_word(*wanted.table), possible(machine, *wanted.table)});
  if (wanted.here) return refuse(problem, says::kEntryHere, {name});
  return in_range(name, value, field->min, field->max, field->whole, problem);
}

void set_tool_entry(const MachineConfig& machine, program::Tables::Corrector& tool, const std::string& name,
                    double value) {
  if (name == "radius")
    tool.radius = value;
  else if (name == "diameter")
    tool.radius = value / 2.0;
  else if (name == "radius_wear")
    tool.radius_wear = value;
  else if (name == "quadrant")
    tool.quadrant = static_cast<int>(value);
  else if (name == "life")
    tool.life_min = value;
  else if (name == "used")
    tool.used_min = value;
  else if (name == "alternate")
    tool.alternate = static_cast<int>(value);
  else if (name == "length")
    tool.length[tool_axis(machine)] = value;
  else if (name == "wear")
    tool.wear[tool_axis(machine)] = value;
  else if (name == "wear_limit")
    tool.wear_limit[tool_axis(machine)] = value;
  else if (name == "radius_wear_limit")
    tool.radius_wear_limit = value;
  else if (name.starts_with("wear_limit_"))
    tool.wear_limit[upper(name.substr(11))] = value / shown(machine, axis_of_entry(machine, name.substr(11)));
  else if (name.starts_with("wear_"))
    tool.wear[upper(name.substr(5))] = value / shown(machine, axis_of_entry(machine, name.substr(5)));
  else
    tool.length[upper(name)] = value / shown(machine, axis_of_entry(machine, name));
}

std::string entry_words(const MachineConfig& machine, const std::map<std::string, double>& values,
                        const std::string& before) {
  std::string out;
  for (const auto& [letter, value] : values) {
    const int axis = machine.axis_index(letter);
    if (axis < 0) continue;
    const machine::AxisConfig& a = machine.axes[static_cast<std::size_t>(axis)];
    out += (out.empty() ? "" : ", ") + before + letter + " " + text::number(value * shown(machine, axis), 4) +
           " " + text::unit_words(a.unit()) + (a.diameter ? text::both(" (diameter)", " (диаметр)") : "");
  }
  return out;
}

void join(std::string& list, const std::string& more) {
  if (!more.empty()) list += (list.empty() ? "" : ", ") + more;
}

}  // namespace

machine::TableKind kind_of(ask::Table table) {
  return table == ask::Table::origin ? machine::TableKind::origins : machine::TableKind::tools;
}

std::vector<std::string> table_axes(const MachineConfig& machine) {
  std::vector<std::string> letters = machine.letters();
  letters.resize(machine.program_axes());
  return letters;
}

std::string table_word(ask::Table table) {
  return table == ask::Table::origin ? text::both("origin", "начало") : text::both("tool", "инструмент");
}

bool take_inches(const MachineConfig& machine, ask::TableSet& wanted, FormProblem& problem) {
  constexpr double kInch = 25.4;
  for (const std::string& name : wanted.inches) {
    const auto value = wanted.values.find(name);
    if (value == wanted.values.end()) continue;
    const std::size_t last = name.rfind('_');
    const int axis = axis_of_entry(machine, last == std::string::npos ? name : name.substr(last + 1));
    const bool whole = name == "quadrant" || name == "life" || name == "used" || name == "alternate";
    if (whole ||
        (axis >= 0 && machine.axes[static_cast<std::size_t>(axis)].type == machine::AxisType::rotary))
      return refuse(problem, says::kNotUnit,
                    {text::unit_words("in"), name, whole ? "1" : text::unit_words("deg")});
    value->second *= kInch;
  }
  wanted.inches.clear();
  return true;
}

bool check_row(const MachineConfig& machine, const ask::TableSet& wanted, FormProblem& problem) {
  const bool tool = *wanted.table == ask::Table::tool;
  const int first = tool ? 1 : 0, last = tool ? machine::kLastTool : machine::kLastOrigin;
  if (wanted.number < first || wanted.number > last)
    return refuse(problem, says::kRowRange,
                  {table_word(*wanted.table), std::to_string(first), std::to_string(last)});
  if (wanted.values.empty() && !(tool && wanted.name && !wanted.here))
    return refuse(problem, says::kNothingGiven, {});
  for (const auto& [name, value] : wanted.values)
    if (!check_entry(machine, wanted, name, value, problem)) return false;
  return true;
}

bool row_known(const program::Tables& tables, ask::Table table, int number, FormProblem& problem) {
  std::string list;
  const auto look = [&](const auto& rows) {
    for (const auto& [n, row] : rows) list += (list.empty() ? "" : ", ") + std::to_string(n);
    return rows.contains(number);
  };
  if (table == ask::Table::origin ? look(tables.origins) : look(tables.correctors)) return true;
  return refuse(
      problem, says::kRowMissing,
      {table_word(table), std::to_string(number), list.empty() ? text::both("no row", "нет строк") : list});
}

std::uint32_t touched_axes(const MachineConfig& machine, const ask::TableSet& wanted) {
  std::uint32_t bits = 0;
  for (const auto& [name, value] : wanted.values)
    if (wanted.here) bits |= std::uint32_t{1} << axis_of_entry(machine, name);
  return bits;
}

program::Tables with_row(Resident& resident, const ask::TableSet& wanted) {
  const MachineConfig& machine = resident.control().machine();
  program::Tables tables = resident.tables();
  if (*wanted.table == ask::Table::origin) {
    std::map<std::string, double>& row = tables.origins[wanted.number];
    for (const auto& [name, value] : wanted.values) {
      const int axis = axis_of_entry(machine, name);
      row[upper(name)] = wanted.here ? resident.touch(axis, value).origin : value / shown(machine, axis);
    }
    return tables;
  }
  program::Tables::Corrector& tool = tables.correctors[wanted.number];
  if (wanted.name) tool.name = *wanted.name;
  for (const auto& [name, value] : wanted.values) {
    if (!wanted.here) {
      set_tool_entry(machine, tool, name, value);
      continue;
    }
    const std::string letter = upper(name);
    const double worn = tool.wear.contains(letter) ? tool.wear.at(letter) : 0.0;
    tool.length[letter] = resident.touch(axis_of_entry(machine, name), value).length - worn;
  }
  return tables;
}

std::string row_words(const MachineConfig& machine, const program::Tables& tables, ask::Table table,
                      int number) {
  std::string out;
  if (table == ask::Table::origin) {
    out = entry_words(machine, tables.origins.at(number), "");
  } else {
    const program::Tables::Corrector& c = tables.correctors.at(number);
    const std::string mm = " " + text::unit_words("mm");
    out = c.name;
    join(out, entry_words(machine, c.length, text::both("length ", "вылет ")));
    if (c.radius != 0.0) join(out, text::both("radius ", "радиус ") + text::number(c.radius, 4) + mm);
    join(out, entry_words(machine, c.wear, text::both("wear ", "износ ")));
    if (c.radius_wear != 0.0)
      join(out, text::both("wear of the radius ", "износ радиуса ") + text::number(c.radius_wear, 4) + mm);
    join(out, entry_words(machine, c.wear_limit, text::both("wear at most ", "износ не более ")));
    if (c.radius_wear_limit != 0.0)
      join(out, text::both("wear of the radius at most ", "износ радиуса не более ") +
                    text::number(c.radius_wear_limit, 4) + mm);
    if (c.quadrant != 0) join(out, text::both("quadrant ", "квадрант ") + std::to_string(c.quadrant));
    join(out, machine::life_words(c.life_min, c.used_min, c.alternate));
  }
  return out.empty() ? text::both("nothing set", "ничего не задано") : out;
}

TablesReport tables_report(Resident& resident) {
  const MachineConfig& machine = resident.control().machine();
  TablesReport report;
  report.tables = resident.tables();
  for (std::size_t i = 0; i < machine.program_axes(); ++i) {
    const machine::AxisConfig& a = machine.axes[i];
    report.axes.push_back({a.letter, a.unit(), a.diameter});
    if (!a.diameter) continue;
    for (auto& [number, row] : report.tables.origins)
      if (const auto entry = row.find(a.letter); entry != row.end()) entry->second *= 2.0;
    for (auto& [number, c] : report.tables.correctors)
      for (auto* values : {&c.length, &c.wear, &c.wear_limit})
        if (const auto entry = values->find(a.letter); entry != values->end()) entry->second *= 2.0;
  }
  return report;
}

}  // namespace servogate::gateway
