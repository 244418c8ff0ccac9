// SPDX-License-Identifier: Apache-2.0
#include <cctype>

#include "plc/syntax/cursor.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc::syntax {

void Parser::file() {
  while (!at_end()) {
    const std::size_t before = at_;
    try {
      declaration();
    } catch (const SyntaxError&) {
      recover({"PROGRAM", "FUNCTION", "FUNCTION_BLOCK", "TYPE", "VAR_GLOBAL", "CONFIGURATION"});
      if (at_ == before) take();
    }
  }
}

void Parser::declaration() {
  if (at("PROGRAM")) return unit(UnitKind::program);
  if (at("FUNCTION")) return unit(UnitKind::function);
  if (at("FUNCTION_BLOCK")) return unit(UnitKind::function_block);
  if (at("TYPE")) return types();
  if (at("VAR_GLOBAL")) return variables(source_.globals, Section::global, false);
  if (at("CONFIGURATION")) return configuration();
  if (accept(";") || skip_unsupported()) return;
  fail(text::both("PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE, VAR_GLOBAL or CONFIGURATION",
                  "PROGRAM, FUNCTION, FUNCTION_BLOCK, TYPE, VAR_GLOBAL или CONFIGURATION"));
}

void Parser::unit(UnitKind kind) {
  const char* names[] = {"PROGRAM", "FUNCTION", "FUNCTION_BLOCK"};
  const std::string opener = names[static_cast<int>(kind)];
  const Location begin = take().location;
  Unit u;
  u.kind = kind;
  skip_specifiers();
  u.location = now().location;
  u.name = identifier(text::both("a name", "имя"));
  skip_ancestry();
  if (kind == UnitKind::function && accept(":")) u.result = std::make_unique<TypeReference>(type_reference());
  struct {
    std::string_view key;
    Section section;
  } const sections[] = {{"VAR", Section::local},         {"VAR_TEMP", Section::temp},
                        {"VAR_INPUT", Section::input},   {"VAR_OUTPUT", Section::output},
                        {"VAR_IN_OUT", Section::in_out}, {"VAR_EXTERNAL", Section::external}};
  for (bool more = true; more;) {
    more = false;
    for (const auto& s : sections)
      if (at(s.key)) variables(u.variables, s.section, true), more = true;
    if (kind == UnitKind::program && at("VAR_ACCESS")) {
      report_.warning(now().location, texts::kAccessInProgram);
      Configuration none;
      paths(none, true);
      more = true;
    } else if (at_any({"VAR_GLOBAL", "VAR_ACCESS", "VAR_CONFIG"})) {
      report_.error(now().location, texts::kSectionPlace, {now().key, opener});
      recover({"END_VAR"});
      accept("END_VAR");
      more = true;
    }
  }
  const std::string closer = "END_" + opener;
  const std::size_t errors = report_.errors(), unsupported = unsupported_, first = at_;
  if (now().kind == TokenKind::ladder) {
    u.ladder_location = now().location;
    u.ladder = take().literal.text;
    accept(";");
  } else {
    u.body = at_instruction_list() ? instruction_list(u.variables) : block({closer});
  }
  // With something left out, what the rest of the bodies says of it would be no mistake.
  source_.body_errors += report_.errors() - errors - (unsupported_ - unsupported);
  for (std::size_t i = first; i < at_; ++i) source_.body_errors += list_[i].wrong;
  source_.units.push_back(std::move(u));
  expect_closing(closer, opener, begin);
}

void Parser::variables(std::vector<Variable>& out, Section section, bool in_unit) {
  const Token& head = take();
  const Location begin = head.location;
  const std::string opener = head.key;
  Variable prototype;
  prototype.section = section;
  for (;; take())
    if (at_any({"RETAIN", "PERSISTENT"})) {
      prototype.retain = true;
      if (section == Section::temp || section == Section::in_out || section == Section::external)
        report_.error(now().location, texts::kSectionPlace, {now().key, opener});
    } else if (at("CONSTANT")) {
      prototype.constant = true;
    } else if (at("NON_RETAIN")) {
      prototype.non_retain = true;
      if (section == Section::temp || section == Section::in_out || section == Section::external)
        report_.error(now().location, texts::kSectionPlace, {now().key, opener});
    } else if (skip_specifiers(); !at_any({"RETAIN", "PERSISTENT", "CONSTANT", "NON_RETAIN"})) {
      break;
    }
  if (prototype.retain && prototype.non_retain)
    report_.error(begin, texts::kSectionPlace, {"NON_RETAIN", opener + " RETAIN"});
  while (!at_end() && !at("END_VAR")) {
    const bool names = ahead().is(":") || ahead().is(",") || ahead().is("AT") || nameless_place();
    if (now().kind == TokenKind::word && is_keyword(now().key) && in_unit && !names) break;
    // A statement: END_VAR is missing.
    if (in_unit && now().kind == TokenKind::word &&
        (ahead().is(":=") || ahead().is("(") || ahead().is("[") || ahead().is(".")))
      break;
    const std::size_t before = at_;
    try {
      variable_list(out, prototype);
    } catch (const SyntaxError&) {
      recover({";", "END_VAR", "END_PROGRAM", "END_FUNCTION", "END_FUNCTION_BLOCK", "VAR", "VAR_INPUT",
               "VAR_OUTPUT", "IF", "FOR", "CASE", "WHILE"});
      accept(";");
      if (at_ == before) take();
    }
  }
  expect_closing("END_VAR", opener, begin);
  accept(";");
}

void Parser::variable_list(std::vector<Variable>& out, const Variable& prototype) {
  std::vector<Variable> list;
  do {
    Variable v = prototype;
    v.location = now().location;
    if (nameless_place())  // its address is its name
      v.name = ahead().text;
    else
      v.name = refuse_reserved() ? take().text
                                 : identifier(text::both("the name of a variable", "имя переменной"));
    if (at("AT")) address(v);
    list.push_back(std::move(v));
  } while (accept(","));
  expect(":");
  const auto type = std::make_shared<TypeReference>(type_reference());
  const int edge = at("R_EDGE") ? 1 : at("F_EDGE") ? -1 : 0;
  if (edge != 0) take();
  std::shared_ptr<Expression> initial;
  if (at("=")) {
    report_.error(now().location, texts::kAssignEqual);
    throw SyntaxError{};
  }
  if (accept(":=")) initial = initializer();
  expect(";");
  for (Variable& v : list) {
    v.type = type;
    v.edge = edge;
    v.initial = initial;
    out.push_back(std::move(v));
  }
}

// VAR AT %IX1.1 : BOOL; (IEC 61131-3:2013, 6.5.5.2)
bool Parser::nameless_place() const { return at("AT") && ahead().kind == TokenKind::direct; }

// Behind AT: %IX0.0, or a place of a packet such as SK7.3CH, which is no sequence of IEC tokens.
void Parser::address(Variable& v) {
  take();
  v.address_location = now().location;
  if (now().kind == TokenKind::direct) {
    v.address = take().text;
    return;
  }
  if (now().kind != TokenKind::word)
    fail(text::both("an address such as %QX0.0 or SA128", "адрес вида %QX0.0 или SA128"));
  std::size_t end = now().offset;
  const auto part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_';
  };
  while (end < text_.size() && part(text_[end])) ++end;
  v.address = text_.substr(now().offset, end - now().offset);
  while (!at_end() && now().offset < end) take();
}

TypeReference Parser::type_reference() {
  const Nesting nesting(*this);
  TypeReference t;
  t.location = now().location;
  if (at("ARRAY")) {
    array_type(t);
    return t;
  }
  if (at("STRUCT")) {
    structure_type(t);
    return t;
  }
  if (at("REF_TO") && ahead().kind == TokenKind::word) {
    t.name = take().key;
    t.element = std::make_unique<TypeReference>(type_reference());
    return t;
  }
  if (at_any({"POINTER", "REFERENCE"}) && ahead().is("TO")) {
    report_.error(now().location, texts::kForeign, {now().key + " TO", "REF_TO"});
    throw SyntaxError{};
  }
  if (at("(")) {
    enumeration_type(t);
    return t;
  }
  t.name = identifier(text::both("a type", "тип"));
  if (t.name.empty()) fail(text::both("a type", "тип"));
  const std::string key = key_of(t.name);
  if ((key == "STRING" || key == "WSTRING") && at_any({"[", "("})) {
    const bool square = take().key == "[";
    t.length = expression();
    expect(square ? "]" : ")");
  } else if (at("(")) {
    const Token& inside = ahead();
    const bool names =
        inside.kind == TokenKind::word && (ahead(2).is(",") || ahead(2).is(":=") || ahead(2).is(")"));
    if (names) {  // an enumeration with its own base: INT (red, green)
      const std::string base = t.name;
      enumeration_type(t);
      t.name = base;
      return t;
    }
    take();
    t.low = expression();
    expect("..");
    t.high = expression();
    expect(")");
  }
  return t;
}

void Parser::array_type(TypeReference& t) {
  t.name = take().key;
  expect("[");
  do {
    if (accept("*")) {
      t.ranges.emplace_back();
      continue;
    }
    ExpressionPtr low = expression();
    expect("..");
    t.ranges.emplace_back(std::move(low), expression());
  } while (accept(","));
  expect("]");
  expect("OF");
  t.element = std::make_unique<TypeReference>(type_reference());
}

void Parser::structure_type(TypeReference& t) {
  const Location begin = now().location;
  t.name = take().key;
  while (!at_end() && !at("END_STRUCT")) variable_list(t.members, Variable{});
  expect_closing("END_STRUCT", "STRUCT", begin);
}

void Parser::enumeration_type(TypeReference& t) {
  t.name.clear();
  expect("(");
  do {
    t.value_locations.push_back(now().location);
    std::string name = identifier(text::both("a name for the value", "имя значения"));
    t.values.emplace_back(std::move(name), accept(":=") ? expression() : nullptr);
  } while (accept(","));
  expect(")");
}

void Parser::types() {
  const Location begin = take().location;
  while (!at_end() && !at("END_TYPE")) {
    try {
      TypeDeclaration d;
      d.location = now().location;
      d.name = identifier(text::both("the name of a type", "имя типа"));
      expect(":");
      d.type = type_reference();
      if (at("(") && !d.type.name.empty() && d.type.values.empty()) fail("';'");
      if (accept(":=")) d.initial = initializer();
      // After END_STRUCT the semicolon is often forgotten and nothing is unclear without it.
      if (d.type.members.empty() || at(";")) expect(";");
      source_.types.push_back(std::move(d));
    } catch (const SyntaxError&) {
      recover({";", "END_TYPE", "PROGRAM", "FUNCTION", "FUNCTION_BLOCK"});
      if (!accept(";")) break;
    }
  }
  expect_closing("END_TYPE", "TYPE", begin);
  accept(";");
}

ExpressionPtr Parser::initializer() {
  const Nesting nesting(*this);
  if (at("[")) return list_initializer();
  if (at_record()) return record_initializer();
  return expression();
}

bool Parser::at_record() const { return at("(") && ahead().kind == TokenKind::word && ahead(2).is(":="); }

ExpressionPtr Parser::list_initializer() {
  ExpressionPtr e = make(ExpressionKind::list, take().location);
  while (!at("]")) {
    // 3(0): three times; 2([1, 2]) likewise.
    if (now().kind == TokenKind::literal && now().literal.kind == Kind::untyped_int && ahead().is("(")) {
      const std::uint64_t times = take().literal.magnitude;
      expect("(");
      e->repeats.push_back(times > 10'000'000 ? 10'000'000 : static_cast<std::int64_t>(times));
      e->operands.push_back(at(")") ? nullptr : initializer());
      expect(")");
    } else {
      e->repeats.push_back(1);
      e->operands.push_back(initializer());
    }
    if (!accept(",")) break;
  }
  expect_closing("]", "'['", e->location);
  return e;
}

ExpressionPtr Parser::record_initializer() {
  ExpressionPtr e = make(ExpressionKind::record, take().location);
  do {
    Argument a;
    a.location = now().location;
    a.name = identifier(text::both("the name of a member", "имя элемента"));
    expect(":=");
    a.value = initializer();
    e->arguments.push_back(std::move(a));
  } while (accept(","));
  expect_closing(")", "'('", e->location);
  return e;
}

void Parser::configuration_part(Configuration& c, int& resources, Location& resource) {
  const std::string inside = resources > 0 ? c.resources.back() : "";
  if (at("VAR_GLOBAL")) {
    const std::size_t first = source_.globals.size();
    variables(source_.globals, Section::global, false);
    for (std::size_t i = first; i < source_.globals.size(); ++i) source_.globals[i].resource = inside;
  } else if (at("RESOURCE")) {
    resource = take().location;
    c.resources.push_back(identifier(text::both("a name", "имя")));
    expect("ON");
    identifier(text::both("a processor", "процессор"));
    ++resources;
  } else if (accept("END_RESOURCE")) {
    --resources;
  } else if (at("TASK")) {
    task(c);
    c.tasks.back().resource = inside;
  } else if (at("PROGRAM")) {
    program_instance(c);
    c.programs.back().resource = inside;
  } else if (at_any({"VAR_ACCESS", "VAR_CONFIG"})) {
    paths(c, at("VAR_ACCESS"));
  } else if (!accept(";")) {
    fail(text::both("VAR_GLOBAL, RESOURCE, TASK, PROGRAM or END_CONFIGURATION",
                    "VAR_GLOBAL, RESOURCE, TASK, PROGRAM или END_CONFIGURATION"));
  }
}

void Parser::configuration() {
  const Location begin = take().location;
  Configuration c;
  c.location = now().location;
  c.name = identifier(text::both("a name", "имя"));
  int resources = 0;
  Location resource = begin;
  while (!at_end() && !at("END_CONFIGURATION")) {
    const std::size_t before = at_;
    try {
      configuration_part(c, resources, resource);
    } catch (const SyntaxError&) {
      recover({";", "END_RESOURCE", "END_CONFIGURATION"});
      accept(";");
      if (at_ == before) take();
    }
  }
  if (resources > 0) expect_closing("END_RESOURCE", "RESOURCE", resource);
  source_.configurations.push_back(std::move(c));
  expect_closing("END_CONFIGURATION", "CONFIGURATION", begin);
  accept(";");
}

// A name and the subscripts behind it.
void Parser::path_part(std::vector<std::string>& out) {
  out.push_back(identifier(text::both("the path of a variable", "путь к переменной")));
  while (accept("[")) {
    do {
      const std::string sign = accept("-") ? "-" : "";
      if (now().kind != TokenKind::literal || now().literal.kind != Kind::untyped_int)
        fail(text::both("a subscript", "индекс"));
      out.push_back("[" + sign + std::to_string(take().literal.magnitude) + "]");
    } while (accept(","));
    expect("]");
  }
}

// VAR_ACCESS name : path : type READ_WRITE; and VAR_CONFIG path AT %QX0.0 : type := value;
void Parser::paths(Configuration& c, bool access) {
  const std::string opener = now().key;
  const Location begin = take().location;
  while (!at_end() && !at("END_VAR")) {
    try {
      PathDeclaration p;
      p.location = now().location;
      if (access) {
        p.name = identifier(text::both("the name of the access path", "имя пути доступа"));
        expect(":");
      }
      p.path_location = now().location;
      do path_part(p.path);
      while (accept("."));
      if (!access && at("AT")) {
        Variable v;
        address(v);
        p.address = v.address;
        p.address_location = v.address_location;
      }
      expect(":");
      p.type = type_reference();
      if (access && now().kind == TokenKind::word && (now().key == "READ_ONLY" || now().key == "READ_WRITE"))
        take();
      if (!access && accept(":=")) p.initial = initializer();
      expect(";");
      c.paths.push_back(std::move(p));
    } catch (const SyntaxError&) {
      recover({";", "END_VAR", "END_CONFIGURATION"});
      if (!accept(";")) break;
    }
  }
  expect_closing("END_VAR", opener, begin);
  accept(";");
}

void Parser::task(Configuration& c) {
  take();
  Task t;
  t.location = now().location;
  t.name = identifier(text::both("the name of a task", "имя задачи"));
  expect("(");
  do {
    const std::string key = now().key;
    if (key != "INTERVAL" && key != "PRIORITY" && key != "SINGLE")
      fail(text::both("INTERVAL, PRIORITY or SINGLE", "INTERVAL, PRIORITY или SINGLE"));
    take();
    expect(":=");
    (key == "INTERVAL" ? t.interval : key == "PRIORITY" ? t.priority : t.single) = expression();
  } while (accept(","));
  expect(")");
  expect(";");
  c.tasks.push_back(std::move(t));
}

void Parser::program_instance(Configuration& c) {
  take();
  ProgramInstance p;
  p.retain = at("RETAIN");
  if (at_any({"RETAIN", "NON_RETAIN"})) take();
  p.location = now().location;
  p.name = identifier(text::both("the name of a program", "имя программы"));
  if (accept("WITH")) {
    p.task_location = now().location;
    p.task = identifier(text::both("the name of a task", "имя задачи"));
  }
  expect(":");
  p.type_location = now().location;
  p.type = identifier(text::both("a PROGRAM", "PROGRAM"));
  if (at("(")) program_elements(p);
  expect(";");
  c.programs.push_back(std::move(p));
}

// Inputs, outputs, and blocks that a task of their own runs.
void Parser::program_elements(ProgramInstance& p) {
  const Location begin = take().location;
  Expression call;
  while (!at(")")) {
    if (now().kind == TokenKind::word && ahead().is("WITH")) {
      BlockTask b;
      b.location = now().location;
      b.name = take().text;
      take();
      b.task_location = now().location;
      b.task = identifier(text::both("the name of a task", "имя задачи"));
      p.blocks.push_back(std::move(b));
    } else {
      argument(call);
    }
    if (!accept(",")) break;
  }
  expect_closing(")", "'('", begin);
  p.arguments = std::move(call.arguments);
}

}  // namespace servogate::plc::syntax
