// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "plc/sema/analyzer.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::sema {

using syntax::Section;
using syntax::UnitKind;

// Memory of a program's instance; the only one makes its addresses fixed.
std::uint32_t Analyzer::instance(const std::string& name, int unit, bool retain) {
  lay_out(unit);
  const auto index = static_cast<std::size_t>(unit);
  const std::uint32_t base = allocate(*scopes_[index].frame);
  ir::Unit& u = program_.units[index];
  u.fixed_base = ++instances_[index] == 1 ? static_cast<std::int64_t>(base) : -1;
  program_.programs.push_back({name, scopes_[index].frame, base, -1, retain});
  return base;
}

namespace {
ir::Stmt invoke_at(std::uint32_t base, const Type* frame, int unit, const Location& at) {
  ir::Stmt s;
  s.kind = ir::StmtKind::invoke;
  s.at = at;
  s.place.root = ir::Root::fixed;
  s.place.cell = base;
  s.place.type = frame;
  s.unit = unit;
  return s;
}
}  // namespace

// Without a variable behind it a VAR_IN_OUT of a program would lead nowhere.
void Analyzer::all_bound(int unit, const std::vector<const Variable*>& given, const Location& at) {
  const UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  for (const Variable& v : u.variables)
    if (v.bound() && std::find(given.begin(), given.end(), &v) == given.end())
      report_.error(at, v.section == Section::input ? texts::kInputMissing : texts::kInOutMissing,
                    {u.source->name, v.name});
}

void Analyzer::default_task() {
  ir::Unit body_unit;
  body_unit.name = "cycle";
  for (std::size_t i = 0; i < source_.units.size(); ++i) {
    const syntax::Unit& u = source_.units[i];
    if (u.kind != UnitKind::program || scopes_[i].frame == nullptr) continue;
    const std::uint32_t base = instance(u.name, static_cast<int>(i), false);
    all_bound(static_cast<int>(i), {}, u.location);
    body_unit.body.push_back(invoke_at(base, scopes_[i].frame, static_cast<int>(i), u.location));
  }
  const auto own = [this](const auto& d) { return d.location.file != library_file_; };
  const bool library =
      options_.program_optional && (std::any_of(source_.units.begin(), source_.units.end(), own) ||
                                    std::any_of(source_.types.begin(), source_.types.end(), own) ||
                                    std::any_of(source_.globals.begin(), source_.globals.end(), own));
  if (body_unit.body.empty() && !library) report_.error({0, 1, 1}, texts::kNoProgram);
  ir::Task task;
  task.name = "cycle";
  task.unit = static_cast<int>(program_.units.size());
  body_unit.fixed_base = 0;
  program_.units.push_back(std::move(body_unit));
  program_.tasks.push_back(std::move(task));
}

int Analyzer::program_unit(const syntax::ProgramInstance& p) {
  const int unit = unit_named(p.type);
  if (unit >= 0 && scopes_[static_cast<std::size_t>(unit)].source->kind == UnitKind::program) return unit;
  std::vector<std::string> names;
  for (const syntax::Unit& u : source_.units)
    if (u.kind == UnitKind::program) names.push_back(u.name);
  report_.error(p.type_location, texts::kUnknownType, {p.type, syntax::suggestion(p.type, names)});
  return -1;
}

ir::Task Analyzer::task_of(const syntax::Task& t) {
  ir::Task task;
  task.name = t.name;
  current_ = -1;
  resource_ = t.resource;
  if (!t.interval && !t.single) report_.error(t.location, texts::kTaskInterval);
  if (t.interval)
    if (const auto ns = constant(*t.interval, elementary(Kind::time))) {
      task.interval = ns->i;
      if (ns->i <= 0) report_.error(t.location, texts::kTaskInterval);
      Constant cycle;
      cycle.i = options_.cycle_ns;
      if (ns->i > 0 && ns->i < cycle.i)
        report_.warning(
            t.interval->location, texts::kTaskShort,
            {constant_text(*elementary(Kind::time), *ns), constant_text(*elementary(Kind::time), cycle)});
    }
  if (t.single)
    if (auto p = place(*t.single, false)) {
      if (p->type->kind != Kind::boolean || !p->steps.empty() || p->bit >= 0)
        report_.error(t.location, texts::kMismatch, {"BOOL", p->type->name, ""});
      task.has_single = true;
      task.single = std::move(*p);
    }
  if (t.priority)
    if (const auto n = constant_integer(*t.priority)) {
      task.priority = static_cast<std::int32_t>(std::clamp<std::int64_t>(*n, 0, 65535));
      if (*n != task.priority) report_.error(t.location, texts::kFastTask, {std::to_string(*n)});
    }
  return task;
}

// The instance's inputs, its call, its outputs.
bool Analyzer::program_call(const syntax::ProgramInstance& p, const std::string& name, ir::Block& out) {
  current_ = -1;
  resource_ = p.resource;
  const int unit = program_unit(p);
  if (unit < 0) return false;
  ir::Place where;
  where.root = ir::Root::fixed;
  where.cell = instance(name, unit, p.retain);
  where.type = scopes_[static_cast<std::size_t>(unit)].frame;
  current_ = -1;
  std::vector<const Variable*> matched;
  for (const syntax::Argument& a : p.arguments) {
    const Variable* v = a.name.empty() ? nullptr : match(a, 0, unit);
    if (v == nullptr)
      report_.error(a.location, texts::kNoParameter,
                    {p.type, a.output ? "VAR_OUTPUT" : "VAR_INPUT", a.name, ""});
    matched.push_back(v);
  }
  if (std::find(matched.begin(), matched.end(), nullptr) != matched.end()) return false;
  all_bound(unit, matched, p.location);
  for (std::size_t i = 0; i < matched.size(); ++i)
    if (!p.arguments[i].output) block_input(p.arguments[i], *matched[i], where, out);
  out.push_back(invoke_at(where.cell, where.type, unit, p.location));
  for (std::size_t i = 0; i < matched.size(); ++i) {
    if (!p.arguments[i].output) continue;
    ir::Place from = where.copy();
    from.offset += matched[i]->cell;
    from.type = matched[i]->type;
    output_argument(p.arguments[i], from, out);
  }
  return true;
}

// With its resource before it where two resources have a program of that name.
std::string Analyzer::program_name(const syntax::Configuration& c, const syntax::ProgramInstance& p) {
  std::string name = p.name;
  for (const syntax::ProgramInstance& other : c.programs) {
    if (&other == &p || !same_name(other.name, p.name)) continue;
    if (!same_name(other.resource, p.resource))
      name = p.resource.empty() ? p.name : p.resource + "." + p.name;
    else if (&other < &p)
      report_.error(p.location, texts::kDuplicate, {p.name, seen_at(other.location, p.location)});
  }
  return name;
}

// A task runs it, not the program that declares it (IEC 61131-3:2013, 6.8.2).
void Analyzer::block_task(const syntax::BlockTask& b, const ir::Global& program, ir::Block& out) {
  UnitScope& u = scopes_[static_cast<std::size_t>(program.type->block)];
  const auto at = u.by_name.find(key_of(b.name));
  if (at == u.by_name.end()) {
    report_.error(b.location, texts::kNoMember, {program.type->name, b.name, ""});
    return;
  }
  Variable& v = u.variables[at->second];
  if (v.type->kind != Kind::block || v.root != ir::Root::instance) {
    report_.error(b.location, texts::kMismatch, {"FUNCTION_BLOCK", v.type->name, ""});
    return;
  }
  v.used = true;
  all_bound(v.type->block, {}, b.location);
  u.calls.insert(v.type->block);
  block_tasks_.emplace_back(Instance{program.type->block, v.cell}, &b);
  out.push_back(invoke_at(program.address + v.cell, v.type, v.type->block, b.location));
}

void Analyzer::check_block_tasks() {
  for (const auto& [instance, b] : block_tasks_)
    if (called_.contains(instance))
      report_.error(b->location, texts::kBlockTask,
                    {b->name, b->task, scopes_[static_cast<std::size_t>(instance.first)].source->name});
}

// Calls and actual parameters of each task are a body of their own. A program without a task runs every
// cycle, after all others.
void Analyzer::configured_tasks() {
  for (const syntax::Configuration& c : source_.configurations) {
    std::vector<ir::Task> tasks;
    std::vector<std::pair<std::string, std::string>> names;  // resource and name of each
    const auto find = [&](const std::string& resource, const std::string& name) {
      const auto at = std::find_if(names.begin(), names.end(), [&](const auto& n) {
        return same_name(n.first, resource) && same_name(n.second, name);
      });
      return static_cast<std::size_t>(at - names.begin());
    };
    for (const syntax::Task& t : c.tasks) {
      if (const std::size_t other = find(t.resource, t.name); other != names.size())
        report_.error(t.location, texts::kDuplicate, {t.name, seen_at(c.tasks[other].location, t.location)});
      names.emplace_back(t.resource, t.name);
      tasks.push_back(task_of(t));
      const bool shared = std::any_of(c.tasks.begin(), c.tasks.end(), [&](const syntax::Task& other) {
        return same_name(other.name, t.name) && !same_name(other.resource, t.resource);
      });
      if (shared && !t.resource.empty()) tasks.back().name = t.resource + "." + t.name;
    }
    constexpr const char* kUnnamed = "cycle";
    std::vector<ir::Unit> bodies(tasks.size());
    for (const syntax::ProgramInstance& p : c.programs) {
      const std::size_t index = p.task.empty() ? find("", kUnnamed) : find(p.resource, p.task);
      if (index == tasks.size() && !p.task.empty()) {
        report_.error(p.task_location, texts::kNoTask, {p.task});
        continue;
      }
      if (index == tasks.size()) {
        ir::Task task;
        task.name = kUnnamed;
        task.priority = 65536;
        tasks.push_back(std::move(task));
        names.emplace_back("", kUnnamed);
        bodies.emplace_back();
      }
      if (!program_call(p, program_name(c, p), bodies[index].body)) continue;
      const ir::Global program = program_.programs.back();
      for (const syntax::BlockTask& b : p.blocks) {
        const std::size_t own = find(p.resource, b.task);
        if (own == tasks.size())
          report_.error(b.task_location, texts::kNoTask, {b.task});
        else
          block_task(b, program, bodies[own].body);
      }
    }
    resource_.clear();
    configured_paths(c);
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      tasks[i].unit = static_cast<int>(program_.units.size());
      bodies[i].name = tasks[i].name;
      bodies[i].fixed_base = 0;
      program_.units.push_back(std::move(bodies[i]));
      program_.tasks.push_back(std::move(tasks[i]));
    }
  }
  std::stable_sort(program_.tasks.begin(), program_.tasks.end(),
                   [](const ir::Task& a, const ir::Task& b) { return a.priority < b.priority; });
  if (program_.programs.empty() && !options_.program_optional && !report_.failed())
    report_.error({0, 1, 1}, texts::kNoProgram);
}

void Analyzer::check_recursion() {
  for (std::size_t u = 0; u < scopes_.size(); ++u) {
    std::vector<int> path;
    if (visit(static_cast<int>(u), path)) return;
  }
}

bool Analyzer::visit(int unit, std::vector<int>& path) {
  UnitScope& u = scopes_[static_cast<std::size_t>(unit)];
  if (u.depth_state == 2) return false;
  if (u.depth_state == 1) {
    std::string shown;
    for (auto at = std::find(path.begin(), path.end(), unit); at != path.end(); ++at)
      shown += scopes_[static_cast<std::size_t>(*at)].source->name + " -> ";
    report_.error(u.source->location, texts::kRecursion, {u.source->name, shown + u.source->name});
    return true;
  }
  u.depth_state = 1;
  path.push_back(unit);
  for (const int callee : u.calls)
    if (visit(callee, path)) return true;
  path.pop_back();
  u.depth_state = 2;
  return false;
}

// Behind an error a variable may only seem unused.
void Analyzer::check_usage() {
  if (report_.failed()) return;
  for (const UnitScope& u : scopes_) {
    if (u.from_library) continue;
    for (const Variable& v : u.variables)
      if (!v.used &&
          (v.section == Section::local || v.section == Section::temp || v.section == Section::external))
        report_.warning(v.at, texts::kUnused, {v.name});
  }
  // One at an address is there for others, a constant for whoever wants it.
  for (const Variable& v : globals_)
    if (!v.used && !v.written && !v.constant && v.root == ir::Root::fixed)
      report_.warning(v.at, texts::kUnused, {v.name});
}

void Analyzer::reach(int unit, std::set<int>& out) const {
  if (!out.insert(unit).second) return;
  for (const int callee : scopes_[static_cast<std::size_t>(unit)].calls) reach(callee, out);
}

// A variable or place written by two units; or by one that two instances of programs come to.
void Analyzer::check_writers() {
  std::vector<std::set<int>> reached;
  for (const ir::Global& p : program_.programs) reach(p.type->block, reached.emplace_back());
  const auto name_of = [&](int unit) { return scopes_[static_cast<std::size_t>(unit)].source->name; };
  const auto check = [&](const std::set<int>& writers, const Location& at, const std::string& name) {
    if (writers.empty() || *writers.begin() < 0) return;
    if (writers.size() > 1) {
      report_.warning(at, texts::kTwoWriters,
                      {name, name_of(*writers.begin()), name_of(*std::next(writers.begin()))});
      return;
    }
    std::vector<std::string> by;
    for (std::size_t i = 0; i < reached.size(); ++i)
      if (reached[i].contains(*writers.begin())) by.push_back(program_.programs[i].name);
    if (by.size() > 1) report_.warning(at, texts::kTwoWriters, {name, by[0], by[1]});
  };
  for (const Variable& v : globals_) check(v.writers, v.at, v.name);
  for (std::size_t i = 0; i < place_writers_.size(); ++i)
    check(place_writers_[i], program_.places[i].at, program_.places[i].name);
  check_overlapping_writers();
}

// Addresses in bodies that share bits. One that shares them with a declared variable was warned of where it
// stands.
void Analyzer::check_overlapping_writers() {
  const auto& places = program_.places;
  for (std::size_t j = 0; j < places.size(); ++j) {
    if (place_writers_[j].empty() || places[j].name[0] != '%') continue;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const bool both = places[i].name[0] == '%';
      if (i == j || (both && i > j) || place_writers_[i].empty() ||
          !places[i].place.overlaps(places[j].place))
        continue;
      if (!both && places[i].place != places[j].place) continue;
      std::set<int> writers = place_writers_[i];
      writers.insert(place_writers_[j].begin(), place_writers_[j].end());
      if (writers.size() < 2) continue;
      const int second = *place_writers_[j].rbegin();
      const int first = *std::find_if(place_writers_[i].begin(), place_writers_[i].end(),
                                      [&](int u) { return u != second || place_writers_[i].size() == 1; });
      const auto name_of = [&](int unit) { return scopes_[static_cast<std::size_t>(unit)].source->name; };
      report_.warning(places[j].at, texts::kTwoWritersOverlap,
                      {places[j].name, name_of(second), places[i].name, name_of(first)});
      break;
    }
  }
}

}  // namespace servogate::plc::sema
