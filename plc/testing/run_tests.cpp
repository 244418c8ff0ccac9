// SPDX-License-Identifier: Apache-2.0
#include "plc/testing/run_tests.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "firmware_if/text/nearest.hpp"
#include "plc/engine/engine.hpp"
#include "plc/syntax/time_literal.hpp"
#include "plc/testing/texts.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc::testing {

namespace {

using Bytes = std::array<std::uint8_t, kMaxElementarySize>;

/// A variable of the program, or a symbol that the program does not use.
struct Target {
  std::optional<Handle> handle;
  image::Place place;
  const Type* type = nullptr;
};

std::string time_text(image::Nanoseconds t_ns) {
  char buffer[48];
  const std::string text(buffer, syntax::print_time(Kind::time, t_ns, buffer));
  return text.substr(2);  // without T#
}

std::string shown(const Type& type, const std::uint8_t* at) {
  if (type.kind == Kind::boolean) return *at != 0 ? "TRUE" : "FALSE";
  return to_literal(type, at);
}

constexpr const char* kSigns[] = {"=", "<>", "<", "<=", ">", ">="};

bool holds(Comparison c, int order) {
  switch (c) {
    case Comparison::equal:
      return order == 0;
    case Comparison::not_equal:
      return order != 0;
    case Comparison::less:
      return order < 0;
    case Comparison::less_equal:
      return order <= 0;
    case Comparison::greater:
      return order > 0;
    case Comparison::greater_equal:
      return order >= 0;
  }
  return false;
}

/// One test under way.
class Run {
 public:
  Run(const TestFile& file, std::shared_ptr<const Image> image, const std::vector<image::Symbol>& symbols,
      const Options& options, Outcome& out)
      : file_(file), symbols_(symbols), engine_(std::move(image)), out_(out) {
    packets_.resize(options.k_bytes, options.v_bytes);
  }
  void steps(const std::vector<Step>& steps) {
    for (const Step& s : steps) {
      if (!out_.passed()) return;
      step(s);
    }
  }
  /// A fault that no line has expected.
  void end(const Word& name) {
    if (out_.passed() && engine_.fault().fault != Fault::none && !fault_expected_) faulted(name);
  }

 private:
  void step(const Step& s);
  void scan();
  bool scan_on(const Step& s);
  void until(const Step& s);
  void expect(const Step& s);
  void assign(const Step& s);
  void wrong(const Word& at, const text::Entry& entry, std::vector<std::string> arguments) {
    out_.findings.push_back(finding_at(file_, at, entry, std::move(arguments)));
  }
  void faulted(const Word& at) {
    const text::Finding f = engine_.describe(engine_.fault());
    wrong(at, texts::kFaulted,
          {text::both(f.str(text::Language::english), f.str(text::Language::russian)),
           std::to_string(out_.scans), time_text(out_.time_ns)});
  }
  std::optional<Target> find(const Word& name);
  bool value_of(const Target& target, const Word& name, const Word& value, Bytes& out);
  void read(const Target& target, Bytes& out) const;
  /// nullopt: a mistake that has been said.
  std::optional<bool> fulfilled(const Term& term, std::string& wanted, std::string& got);
  bool close_enough(const Target& target, const Term& term, const Bytes& is, const Bytes& wanted);

  const TestFile& file_;
  const std::vector<image::Symbol>& symbols_;
  Engine engine_;
  image::Packets packets_;
  Outcome& out_;
  bool fault_expected_ = false;
};

void Run::scan() {
  out_.time_ns = out_.scans * file_.cycle_ns;
  engine_.scan(packets_, out_.time_ns);
  ++out_.scans;
}

/// Scans on after a fault change nothing any more; only `expect fault` may come.
bool Run::scan_on(const Step& s) {
  if (engine_.fault().fault != Fault::none && !fault_expected_) {
    faulted(s.word);
    return false;
  }
  scan();
  return true;
}

void Run::step(const Step& s) {
  switch (s.kind) {
    case StepKind::run: {
      const std::int64_t scans = s.scans > 0 ? s.scans : (s.time_ns + file_.cycle_ns - 1) / file_.cycle_ns;
      for (std::int64_t n = 0; n < scans; ++n)
        if (!scan_on(s)) return;
      return;
    }
    case StepKind::expect_fault:
      if (engine_.fault().fault == Fault::none)
        wrong(s.word, texts::kNoFault, {std::to_string(out_.scans), time_text(out_.time_ns)});
      fault_expected_ = true;
      return;
    case StepKind::until:
      return until(s);
    case StepKind::expect:
      return expect(s);
    default:
      return assign(s);
  }
}

void Run::expect(const Step& s) {
  if (engine_.fault().fault != Fault::none && !fault_expected_) return faulted(s.word);
  for (const Term& term : s.terms) {
    std::string wanted, got;
    const auto good = fulfilled(term, wanted, got);
    if (good && !*good)
      wrong(term.name, texts::kFailed, {wanted, got, std::to_string(out_.scans), time_text(out_.time_ns)});
  }
}

void Run::until(const Step& s) {
  const image::Nanoseconds end = out_.scans * file_.cycle_ns + s.time_ns;
  for (;;) {
    if (!scan_on(s)) return;
    bool all = true;
    for (const Term& term : s.terms) {
      std::string wanted, got;
      const auto good = fulfilled(term, wanted, got);
      if (!good) return;
      all = all && *good;
      if (!*good && out_.scans * file_.cycle_ns >= end)
        wrong(term.name, texts::kTimedOut,
              {wanted, got, std::to_string(out_.scans), time_text(out_.time_ns), time_text(s.time_ns)});
    }
    if (all || !out_.passed()) return;
  }
}

void Run::assign(const Step& s) {
  for (const Term& term : s.terms) {
    const auto target = find(term.name);
    if (!target) continue;
    if (s.kind != StepKind::set && !target->handle) {
      wrong(term.name, texts::kCannotHold, {term.name.text});
      continue;
    }
    if (s.kind == StepKind::release) {
      engine_.release(*target->handle);
      continue;
    }
    Bytes bytes{};
    if (!value_of(*target, term.name, term.value, bytes)) continue;
    if (s.kind == StepKind::hold)
      engine_.force(*target->handle, term.value.text);
    else if (target->handle)
      engine_.write(packets_, *target->handle, term.value.text);
    else
      packets_.set_number(target->place, to_number(*target->type, bytes.data()));
  }
}

std::optional<Target> Run::find(const Word& name) {
  if (const auto handle = engine_.find(name.text)) return Target{handle, {}, handle->type};
  const TypeTable& types = *engine_.image().types;
  constexpr Kind kKinds[] = {Kind::boolean, Kind::usint, Kind::int_, Kind::dint, Kind::real, Kind::lreal};
  for (const image::Symbol& s : symbols_)
    if (same_name(s.name, name.text) && s.place.format != image::Format::ch)
      return Target{std::nullopt, s.place,
                    types.elementary(kKinds[static_cast<std::size_t>(s.place.format)])};
  std::vector<std::string> known = variable_names(engine_.image());
  for (const image::Symbol& s : symbols_) known.push_back(s.name);
  const std::string near = text::nearest(name.text, known);
  wrong(name, texts::kNoVariable,
        {name.text, near.empty()
                        ? std::string()
                        : text::both("; did you mean '" + near + "'?", "; может быть, «" + near + "»?")});
  return std::nullopt;
}

bool Run::value_of(const Target& target, const Word& name, const Word& value, Bytes& out) {
  if (is_elementary(target.type->kind) && parse_value(*target.type, value.text, out.data())) return true;
  wrong(value, texts::kNoValue, {value.text, name.text, target.type->name});
  return false;
}

void Run::read(const Target& target, Bytes& out) const {
  if (!target.handle) {
    from_number(*target.type, packets_.number(target.place), out.data());
  } else if (target.handle->bit >= 0) {
    out[0] = static_cast<std::uint8_t>(engine_.number(*target.handle));
  } else {
    std::memcpy(out.data(), engine_.data(*target.handle),
                std::min<std::size_t>(target.type->size, out.size()));
  }
}

std::optional<bool> Run::fulfilled(const Term& term, std::string& wanted, std::string& got) {
  const auto target = find(term.name);
  if (!target) return std::nullopt;
  const Type& type = *target->type;
  Bytes is{}, other{};
  if (!term.value.text.empty()) {
    if (!value_of(*target, term.name, term.value, other)) return std::nullopt;
  } else if (type.kind == Kind::boolean) {
    other[0] = term.negated ? 0 : 1;
  } else {
    wrong(term.name, texts::kNotBool, {term.name.text, type.name});
    return std::nullopt;
  }
  const bool text = is_text(type.kind) || is_character(type.kind);
  if (text && term.comparison > Comparison::not_equal) {
    wrong(term.value, texts::kNotOrdered, {type.name});
    return std::nullopt;
  }
  read(*target, is);
  wanted = term.name.text + " " + kSigns[static_cast<int>(term.comparison)] + " " + shown(type, other.data());
  got = shown(type, is.data());
  if (!term.tolerance.text.empty()) {
    wanted += " +- " + term.tolerance.text;
    return close_enough(*target, term, is, other);
  }
  int order = 0;
  if (text) {
    order = got == shown(type, other.data()) ? 0 : 1;
  } else {
    const double a = to_number(type, is.data()), b = to_number(type, other.data());
    if (std::isnan(a) || std::isnan(b)) return term.comparison == Comparison::not_equal;
    order = a < b ? -1 : a > b ? 1 : 0;
    // Beyond 2^53 the numbers above are rounded.
    if (order == 0 && type.size == 8 && !is_real(type.kind)) {
      std::uint64_t x = 0, y = 0;
      std::memcpy(&x, is.data(), 8);
      std::memcpy(&y, other.data(), 8);
      order = x < y ? -1 : x > y ? 1 : 0;
    }
  }
  return holds(term.comparison, order);
}

bool Run::close_enough(const Target& target, const Term& term, const Bytes& is, const Bytes& wanted) {
  Bytes by{};
  if (!value_of(target, term.name, term.tolerance, by)) return true;  // said; the test has failed by it
  const Type& type = *target.type;
  return std::abs(to_number(type, is.data()) - to_number(type, wanted.data())) <= to_number(type, by.data());
}

}  // namespace

std::vector<Outcome> run_tests(const TestFile& file, std::shared_ptr<const Image> image,
                               const std::vector<image::Symbol>& symbols, const Options& options) {
  std::vector<Outcome> outcomes;
  for (const Test& test : file.tests) {
    Outcome& out = outcomes.emplace_back();
    out.name = test.name.text;
    out.line = test.name.line;
    Run run(file, image, symbols, options, out);
    run.steps(file.before);
    run.steps(test.steps);
    run.end(test.name);
  }
  return outcomes;
}

}  // namespace servogate::plc::testing
