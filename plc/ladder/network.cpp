// SPDX-License-Identifier: Apache-2.0
#include "plc/ladder/network.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "plc/terms/texts.hpp"

namespace servogate::plc::ladder {

using syntax::Expression;
using syntax::ExpressionKind;
using syntax::ExpressionPtr;
using syntax::Operator;
using syntax::StatementKind;
using syntax::StatementPtr;

namespace {

ExpressionPtr expression_of(ExpressionKind kind, const Location& at) {
  auto e = std::make_unique<Expression>();
  e->kind = kind;
  e->location = at;
  return e;
}
ExpressionPtr truth(bool value, const Location& at) {
  ExpressionPtr e = expression_of(ExpressionKind::literal, at);
  e->literal.kind = Kind::boolean;
  e->literal.magnitude = value;
  return e;
}
ExpressionPtr name_of(std::string name, const Location& at) {
  ExpressionPtr e = expression_of(ExpressionKind::name, at);
  e->name = std::move(name);
  return e;
}
ExpressionPtr inverse(ExpressionPtr e, bool wanted, const Location& at) {
  if (!wanted) return e;
  ExpressionPtr out = expression_of(ExpressionKind::unary, at);
  out->op = Operator::not_;
  out->operands.push_back(std::move(e));
  return out;
}
bool is_true(const Expression& e) {
  return e.kind == ExpressionKind::literal && e.literal.kind == Kind::boolean && e.literal.magnitude == 1;
}
ExpressionPtr joined(Operator op, ExpressionPtr a, ExpressionPtr b, const Location& at) {
  if (op == Operator::and_ && is_true(*a)) return b;
  if (op == Operator::or_ && is_true(*a)) return a;
  if (op == Operator::or_ && is_true(*b)) return b;
  ExpressionPtr e = expression_of(ExpressionKind::binary, at);
  e->op = op;
  e->operands.push_back(std::move(a));
  e->operands.push_back(std::move(b));
  return e;
}
StatementPtr statement_of(StatementKind kind, const Location& at) {
  auto s = std::make_unique<syntax::Statement>();
  s->kind = kind;
  s->location = at;
  return s;
}
StatementPtr assignment(ExpressionPtr target, ExpressionPtr value, const Location& at) {
  StatementPtr s = statement_of(StatementKind::assign, at);
  s->target = std::move(target);
  s->value = std::move(value);
  return s;
}

class Lowering {
 public:
  Lowering(std::vector<Element> elements, syntax::Unit& unit, syntax::Report& report)
      : elements_(std::move(elements)), unit_(unit), report_(report), state_(elements_.size()) {}

  void run() {
    connect_links();
    for (const int i : order()) evaluate(i);
  }

 private:
  enum class Progress : std::uint8_t { waiting, running, done };
  struct State {
    Progress progress = Progress::waiting;
    std::uint64_t power = 0;  ///< number of the held power behind contacts, coils, actions
    bool has_power = false;
    std::vector<std::pair<std::string, std::uint64_t>> pins;  ///< of a function: numbers of its held outputs
    std::uint64_t enabled = 0;                                ///< number of the held ENO
    bool has_enabled = false;
    std::vector<std::pair<std::string, std::uint64_t>> pulses;  ///< of a block: held outputs with an edge
  };

  Element& at(int i) { return elements_[static_cast<std::size_t>(i)]; }
  State& state(int i) { return state_[static_cast<std::size_t>(i)]; }
  void emit(StatementPtr s) { unit_.body.push_back(std::move(s)); }

  // A continuation is its connector.
  void connect_links() {
    for (Element& e : elements_)
      for (Pin& p : e.inputs)
        for (Wire& w : p.wires) {
          if (w.element < 0 || at(w.element).kind != ElementKind::continued) continue;
          const auto link = std::find_if(elements_.begin(), elements_.end(), [&](const Element& c) {
            return c.kind == ElementKind::link && same_name(c.name, at(w.element).name);
          });
          if (link == elements_.end())
            report_.error(at(w.element).location, texts::kNoConnector, {at(w.element).name});
          w = {link == elements_.end() ? -1 : static_cast<int>(link - elements_.begin()), ""};
        }
  }

  // Rungs from top to bottom; in a rung as drawn. A given order of execution comes before all that.
  std::vector<int> order() {
    std::vector<int> group(elements_.size());
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&](int i) {
      while (group[static_cast<std::size_t>(i)] != i) i = group[static_cast<std::size_t>(i)];
      return i;
    };
    for (std::size_t i = 0; i < elements_.size(); ++i)
      for (const Pin& p : elements_[i].inputs)
        for (const Wire& w : p.wires)
          if (w.element >= 0 && at(w.element).kind != ElementKind::rail)
            group[static_cast<std::size_t>(root(static_cast<int>(i)))] = root(w.element);
    std::map<int, double> top;
    std::map<int, int> first;
    for (int i = 0; i < static_cast<int>(elements_.size()); ++i) {
      if (at(i).kind == ElementKind::rail) continue;
      const int r = root(i);
      if (!top.contains(r)) top[r] = at(i).y, first[r] = i;
      top[r] = std::min(top[r], at(i).y);
    }
    std::vector<int> out;
    for (int i = 0; i < static_cast<int>(elements_.size()); ++i)
      if (at(i).kind != ElementKind::rail) out.push_back(i);
    std::stable_sort(out.begin(), out.end(), [&](int a, int b) {
      const int x = at(a).order > 0 ? at(a).order : 1 << 30, y = at(b).order > 0 ? at(b).order : 1 << 30;
      const int p = root(a), q = root(b);
      return std::tuple(x, top[p], first[p], at(a).y, at(a).x) <
             std::tuple(y, top[q], first[q], at(b).y, at(b).x);
    });
    return out;
  }

  void evaluate(int i) {
    if (state(i).progress != Progress::waiting) return;
    constexpr int kDeepest = 2000;
    if (++depth_ > kDeepest) {
      report_.error(at(i).location, texts::kTooDeep, {std::to_string(kDeepest)});
      return;
    }
    state(i).progress = Progress::running;
    for (const Pin& p : at(i).inputs)
      for (const Wire& w : p.wires)
        if (w.element >= 0 && !written_later(w.element)) evaluate(w.element);
    write(i);
    state(i).progress = Progress::done;
    --depth_;
  }

  // A variable that takes what is being computed from it closes a loop: here it is read as it is, wherever
  // the loop was entered, and written when its turn comes.
  bool written_later(int i) {
    if (at(i).kind != ElementKind::sink || state(i).progress != Progress::waiting) return false;
    std::vector<int> open = {i};
    std::vector<bool> seen(elements_.size());
    while (!open.empty()) {
      const int next = open.back();
      open.pop_back();
      if (state(next).progress == Progress::running) return true;
      if (seen[static_cast<std::size_t>(next)] || state(next).progress == Progress::done) continue;
      seen[static_cast<std::size_t>(next)] = true;
      for (const Pin& p : at(next).inputs)
        for (const Wire& w : p.wires)
          if (w.element >= 0) open.push_back(w.element);
    }
    return false;
  }

  void write(int i) {
    Element& e = at(i);
    switch (e.kind) {
      case ElementKind::rail:
      case ElementKind::continued:
        return;
      case ElementKind::source:
        if (e.edge != 0) keep_pulse(i, inverse(syntax::copy(*e.operand), e.inverted, e.location), e.edge);
        return;
      case ElementKind::contact:
        return contact(i);
      case ElementKind::coil:
        return coil(i);
      case ElementKind::block:
        return e.instance.empty() ? function(i) : block(i);
      case ElementKind::action:
        return action(i);
      case ElementKind::sink:
        return sink(i);
      case ElementKind::label: {
        StatementPtr s = statement_of(StatementKind::label, e.location);
        s->name = e.name;
        return emit(std::move(s));
      }
      case ElementKind::jump: {
        StatementPtr s = statement_of(StatementKind::jump, e.location);
        s->name = e.name;
        return under(input(i), std::move(s), e.location);
      }
      case ElementKind::leave:
        return under(input(i), statement_of(StatementKind::return_, e.location), e.location);
      case ElementKind::link:
        return keep_power(i, input(i));
    }
  }

  void under(ExpressionPtr power, StatementPtr s, const Location& at_location) {
    if (is_true(*power)) return emit(std::move(s));
    StatementPtr test = statement_of(StatementKind::if_, at_location);
    syntax::Branch& b = test->branches.emplace_back();
    b.condition = std::move(power);
    b.body.push_back(std::move(s));
    emit(std::move(test));
  }

  // What an output of an element gives; null: there is no such value, which was reported.
  ExpressionPtr output(const Wire& w, const Location& from) {
    Element& e = at(w.element);
    switch (e.kind) {
      case ElementKind::rail:
        return truth(true, from);
      case ElementKind::source:
        if (e.edge != 0) break;
        return inverse(syntax::copy(*e.operand), e.inverted, e.location);
      case ElementKind::sink:
        if (e.read_edge != 0) break;
        return inverse(syntax::copy(*e.operand), e.read_inverted, e.location);
      case ElementKind::block:
        return block_output(w, from);
      default:
        break;
    }
    if (state(w.element).has_power) return held(state(w.element).power, from);
    report_.error(from, state(w.element).progress == Progress::running ? texts::kLoop : texts::kNoPower);
    return expression_of(ExpressionKind::bad, from);
  }

  ExpressionPtr block_output(const Wire& w, const Location& from) {
    Element& e = at(w.element);
    State& s = state(w.element);
    if (same_name(w.pin, "ENO") && s.has_enabled) return held(s.enabled, from);
    for (Pin& in : e.inputs)  // the right side of an in-out is its variable
      if (in.in_out && same_name(in.name, w.pin)) return joined_wires(in, e);
    for (const auto& [name, number] : s.pulses)
      if (same_name(name, w.pin)) return held(number, from);
    bool inverted = false;
    for (const Pin& out : e.outputs) inverted = inverted || (same_name(out.name, w.pin) && out.inverted);
    ExpressionPtr value;
    if (!e.instance.empty()) {
      value = expression_of(ExpressionKind::member, e.location);
      value->name = w.pin;
      value->operands.push_back(name_path(e.instance, e.location));
    } else if (const auto pin = find_pin(s, w.pin); pin != s.pins.end()) {
      value = held(pin->second, from);
    } else {
      report_.error(from, texts::kLoop);
      return expression_of(ExpressionKind::bad, from);
    }
    return inverse(std::move(value), inverted, e.location);
  }

  static std::vector<std::pair<std::string, std::uint64_t>>::iterator find_pin(State& s,
                                                                               const std::string& name) {
    return std::find_if(s.pins.begin(), s.pins.end(),
                        [&](const auto& pin) { return same_name(pin.first, name); });
  }

  static ExpressionPtr name_path(const std::string& path, const Location& at_location) {
    const std::size_t dot = path.rfind('.');
    if (dot == std::string::npos) return name_of(path, at_location);
    ExpressionPtr e = expression_of(ExpressionKind::member, at_location);
    e->name = path.substr(dot + 1);
    e->operands.push_back(name_path(path.substr(0, dot), at_location));
    return e;
  }

  ExpressionPtr held(std::uint64_t number, const Location& at_location) const {
    ExpressionPtr e = expression_of(ExpressionKind::held, at_location);
    e->literal.magnitude = number;
    return e;
  }
  std::uint64_t hold(ExpressionPtr value, const Location& at_location) {
    StatementPtr s = statement_of(StatementKind::hold, at_location);
    s->number = holds_++;
    s->value = std::move(value);
    const std::uint64_t number = s->number;
    emit(std::move(s));
    return number;
  }
  void keep_power(int i, ExpressionPtr value) {
    state(i).power = hold(std::move(value), at(i).location);
    state(i).has_power = true;
  }
  void keep_pulse(int i, ExpressionPtr value, int edge) {
    state(i).power = pulse(std::move(value), edge, at(i).location)->literal.magnitude;
    state(i).has_power = true;
  }

  // Several wires into one input are OR.
  ExpressionPtr joined_wires(const Pin& p, const Element& e) {
    if (p.value) return syntax::copy(*p.value);
    ExpressionPtr out;
    constexpr std::size_t kMostWires = 500;
    if (p.wires.size() > kMostWires) {
      report_.error(e.location, texts::kTooDeep, {std::to_string(kMostWires)});
      return expression_of(ExpressionKind::bad, e.location);
    }
    for (const Wire& w : p.wires) {
      if (w.element < 0) continue;
      ExpressionPtr one = output(w, p.location.line > 0 ? p.location : e.location);
      const bool power = e.kind != ElementKind::sink && e.kind != ElementKind::block;
      if (power && only_when_enabled(w))
        one = joined(Operator::and_, held(state(w.element).enabled, e.location), std::move(one), e.location);
      out = out ? joined(Operator::or_, std::move(out), std::move(one), e.location) : std::move(one);
    }
    // What is wired to something that is not there was reported.
    return out || p.wires.empty() ? std::move(out) : expression_of(ExpressionKind::bad, e.location);
  }
  // The result of a function is worth something only when its EN was TRUE.
  bool only_when_enabled(const Wire& w) {
    return w.element >= 0 && at(w.element).kind == ElementKind::block && at(w.element).instance.empty() &&
           state(w.element).has_enabled && !same_name(w.pin, "ENO");
  }
  ExpressionPtr pin_value(const Pin& p, const Element& e) {
    ExpressionPtr value = joined_wires(p, e);
    if (!value) return value;
    value = inverse(std::move(value), p.inverted, e.location);
    return p.edge == 0 ? std::move(value) : pulse(std::move(value), p.edge, e.location);
  }
  ExpressionPtr input(int i) {
    const Element& e = at(i);
    ExpressionPtr value = e.inputs.empty() ? nullptr : pin_value(e.inputs[0], e);
    if (value) return value;
    report_.error(e.location, texts::kNotConnected);
    return expression_of(ExpressionKind::bad, e.location);
  }

  // Stays TRUE for the one run in which the value rises (falls), held. The value is computed once.
  ExpressionPtr pulse(ExpressionPtr value, int edge, const Location& where) {
    const std::string last = "edge$" + std::to_string(unit_.variables.size());
    syntax::Variable v;
    v.name = last;
    v.location = where;
    v.type = std::make_shared<syntax::TypeReference>();
    v.type->location = where;
    v.type->name = "BOOL";
    unit_.variables.push_back(std::move(v));
    const std::uint64_t now = hold(std::move(value), where);
    const std::uint64_t out = hold(joined(Operator::and_, inverse(held(now, where), edge < 0, where),
                                          inverse(name_of(last, where), edge > 0, where), where),
                                   where);
    emit(assignment(name_of(last, where), held(now, where), where));
    return held(out, where);
  }

  void contact(int i) {
    Element& e = at(i);
    ExpressionPtr power = input(i);
    ExpressionPtr reads = inverse(syntax::copy(*e.operand), e.inverted, e.location);
    if (e.edge != 0) reads = pulse(std::move(reads), e.edge, e.location);
    keep_power(i, joined(Operator::and_, std::move(power), std::move(reads), e.location));
  }

  void coil(int i) {
    Element& e = at(i);
    keep_power(i, input(i));
    emit(store(e, held(state(i).power, e.location), e.location));
  }

  // What a coil or a variable does with the value that comes to it.
  StatementPtr store(const Element& e, ExpressionPtr value, const Location& where) {
    if (e.edge != 0) value = pulse(std::move(value), e.edge, e.location);
    value = inverse(std::move(value), e.inverted, e.location);
    if (e.storage == Storage::none) return assignment(syntax::copy(*e.operand), std::move(value), where);
    StatementPtr s = statement_of(e.storage == Storage::set ? StatementKind::set : StatementKind::reset,
                                  e.operand->location);
    s->target = syntax::copy(*e.operand);
    s->value = std::move(value);
    return s;
  }

  void action(int i) {
    Element& e = at(i);
    keep_power(i, input(i));
    under(held(state(i).power, e.location), std::move(e.statement), e.location);
  }

  // The variable takes the value; behind a block that was not enabled it keeps its own.
  void sink(int i) {
    Element& e = at(i);
    StatementPtr s = store(e, input(i), e.operand->location);
    const Wire* w = e.inputs[0].wires.size() == 1 ? &e.inputs[0].wires[0] : nullptr;
    if (w != nullptr && only_when_enabled(*w))
      under(held(state(w->element).enabled, e.location), std::move(s), e.location);
    else
      emit(std::move(s));
    if (e.read_edge != 0)
      keep_pulse(i, inverse(syntax::copy(*e.operand), e.read_inverted, e.location), e.read_edge);
  }

  // Arguments in the order of the drawing. EN becomes a test around the call, ENO is held.
  ExpressionPtr call(int i, ExpressionPtr callee) {
    Element& e = at(i);
    ExpressionPtr c = expression_of(ExpressionKind::call, e.location);
    c->operands.push_back(std::move(callee));
    bool enable = false;
    for (const Pin& p : e.inputs) {
      ExpressionPtr value = pin_value(p, e);
      if (!value) continue;
      if (same_name(p.name, "EN")) {
        if (is_true(*value)) continue;
        enable = true;
        c->enable = std::move(value);
        continue;
      }
      syntax::Argument a;
      a.name = p.name;
      a.location = p.location.line > 0 ? p.location : e.location;
      a.value = std::move(value);
      c->arguments.push_back(std::move(a));
    }
    for (syntax::Argument& a : e.written) c->arguments.push_back(std::move(a));
    const bool wanted = std::any_of(elements_.begin(), elements_.end(), [&](const Element& other) {
      return std::any_of(other.inputs.begin(), other.inputs.end(), [&](const Pin& p) {
        return std::any_of(p.wires.begin(), p.wires.end(),
                           [&](const Wire& w) { return w.element == i && same_name(w.pin, "ENO"); });
      });
    });
    if (enable || wanted) {
      state(i).enabled = hold(truth(false, e.location), e.location);
      state(i).has_enabled = true;
      c->enabled = held(state(i).enabled, e.location);
    }
    return c;
  }

  void block(int i) {
    Element& e = at(i);
    StatementPtr s = statement_of(StatementKind::call, e.location);
    s->value = call(i, name_path(e.instance, e.location));
    s->value->name = e.name;
    emit(std::move(s));
    hold_pulses(i);
  }
  // Outputs with an edge are looked at once, behind the call.
  void hold_pulses(int i) {
    Element& e = at(i);
    for (const Pin& out : e.outputs) {
      if (out.edge == 0) continue;
      const Wire self{i, out.name};
      const std::uint64_t number =
          pulse(block_output(self, e.location), out.edge, e.location)->literal.magnitude;
      state(i).pulses.emplace_back(out.name, number);
    }
  }

  // Every output that is used is held, for it lasts until the next call of the same function only.
  void function(int i) {
    Element& e = at(i);
    std::vector<syntax::Argument> drawn;
    for (syntax::Argument& a : e.written)
      if (a.drawn) drawn.push_back(std::move(a));
    std::erase_if(e.written, [](const syntax::Argument& a) { return a.drawn; });
    StatementPtr s = statement_of(StatementKind::call, e.location);
    s->value = call(i, name_of(e.name, e.location));
    for (const Element& other : elements_)
      for (const Pin& p : other.inputs)
        for (const Wire& w : p.wires)
          if (w.element == i && !same_name(w.pin, "ENO")) hold_pin(i, w.pin, e.location, *s);
    for (const syntax::Argument& a : drawn) hold_pin(i, a.name, a.location, *s);
    for (const Pin& out : e.outputs)
      if (out.edge != 0) hold_pin(i, out.name, e.location, *s);
    emit(std::move(s));
    hold_pulses(i);
    for (syntax::Argument& a : drawn) {
      const Location written = a.location;
      ExpressionPtr value = inverse(held(find_pin(state(i), a.name)->second, written), a.inverted, written);
      StatementPtr store = assignment(std::move(a.value), std::move(value), written);
      under(state(i).has_enabled ? held(state(i).enabled, written) : truth(true, written), std::move(store),
            written);
    }
  }
  void hold_pin(int i, const std::string& name, const Location& where, syntax::Statement& s) {
    if (find_pin(state(i), name) != state(i).pins.end()) return;
    state(i).pins.emplace_back(name, holds_);
    s.kind = StatementKind::hold;
    s.number = holds_;
    syntax::Argument a;
    a.name = name;
    a.location = where;
    a.output = a.drawn = true;
    a.value = held(holds_++, where);
    s.value->arguments.push_back(std::move(a));
  }

  std::vector<Element> elements_;
  syntax::Unit& unit_;
  syntax::Report& report_;
  std::vector<State> state_;
  std::uint64_t holds_ = 0;
  int depth_ = 0;
};

}  // namespace

void lower(std::vector<Element> elements, syntax::Unit& unit, syntax::Report& report) {
  Lowering(std::move(elements), unit, report).run();
}

}  // namespace servogate::plc::ladder
