// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/reading/read_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/reading/parameters.hpp"
#include "bench/scenario/reading/step_reading.hpp"
#include "bench/scenario/reading/table.hpp"
#include "machine/files/read_file.hpp"
#include "machine/keys/findings.hpp"

namespace servogate::scenario {

namespace {

using machine::Element;
using machine::Reading;

constexpr int kDeepestInclude = 4;

std::string beside(const std::string& file, const std::string& path) {
  const std::filesystem::path p(path);
  if (path.empty() || p.is_absolute()) return path;
  return (std::filesystem::path(file).parent_path() / p).lexically_normal().string();
}

/// What a file and those that it includes say, before parameters are put in.
struct Whole {
  Element root;                                        ///< of the file itself
  std::vector<std::pair<std::string, Element>> given;  ///< with the file that each stands in
  std::string machine;                                 ///< path
  std::string machine_file;                            ///< that `machine` stands in
};

/// Adds what an included file brings.
void include(const std::string& from, const Element& root, int depth, Whole& whole, Reading& reading) {
  const Element* const list = root.find("include");
  if (list == nullptr) return;
  Table table(root, Part::file, reading, true);
  if (depth >= kDeepestInclude)
    return reading.error(list->at, finding::kDeepInclude, {std::to_string(kDeepestInclude)});
  for (const std::string& name : table.texts("include")) {
    const std::string path = beside(from, name);
    std::string why;
    const auto text = files::read_file(path, files::kMostOfSettings, why);
    if (!text) {
      reading.error(list->at, finding::kInclude, {name, why});
      continue;
    }
    const machine::Document document = machine::read_document(*text);
    if (!document.ok()) {
      reading.error(list->at, finding::kInclude, {name, document.error});
      continue;
    }
    include(path, document.root, depth + 1, whole, reading);
    for (const Element& child : document.root.children) {
      if (child.key == "given") {
        for (const Element& step : child.children) whole.given.emplace_back(path, step);
      } else if (child.key == "machine") {
        whole.machine_file = path;
        whole.machine = child.string;
      } else if (whole.root.find(child.key) == nullptr && child.key != "include" && child.key != "title") {
        whole.root.children.push_back(child);
      }
    }
  }
}

/// One drawn run: its actions at their times.
class Draw {
 public:
  Draw(const Element& random, const Parameters& parameters, std::uint64_t seed, Reading& reading)
      : table_(random, Part::random, reading), parameters_(parameters), engine_(seed), reading_(reading) {}

  void add_to(Scenario& scenario) {
    const auto pauses = pause();
    std::vector<const Element*> actions = table_.list("action");
    std::vector<double> weights;
    for (const Element* a : actions) {
      Table action(*a, Part::action, reading_);
      weights.push_back(static_cast<double>(std::max<std::int64_t>(0, action.whole("weight").value_or(1))));
    }
    if (actions.empty()) return;
    const auto steps = std::clamp<std::int64_t>(table_.whole("steps").value_or(10), 1, 10'000);
    for (std::int64_t n = 0; n < steps; ++n) {
      Element chosen = *actions[choose(weights)];
      Parameters values = parameters_;
      if (const Element* range = chosen.find("range")) draw(*range, values);
      std::erase_if(chosen.children, [](const Element& e) { return e.key == "range" || e.key == "weight"; });
      substitute(chosen, values, reading_);
      Step step = read_step(chosen, StepKind::drawn, reading_);
      step.anchor = Step::Anchor::after_time;
      step.time = static_cast<Nanoseconds>(
          uniform(static_cast<double>(pauses.first), static_cast<double>(pauses.second)));
      scenario.steps.push_back(std::move(step));
    }
  }

 private:
  // The library's distributions differ from one library to the next; the seed is to mean the same everywhere.
  double uniform(double from, double to) {
    return from + (to - from) * static_cast<double>(engine_() >> 11) / 9007199254740992.0;
  }
  std::size_t choose(const std::vector<double>& weights) {
    double sum = 0.0;
    for (const double w : weights) sum += w;
    double at = uniform(0.0, sum);
    for (std::size_t n = 0; n < weights.size(); ++n)
      if ((at -= weights[n]) < 0.0) return n;
    return weights.size() - 1;
  }
  std::pair<Nanoseconds, Nanoseconds> pause() {
    std::pair<Nanoseconds, Nanoseconds> p{10 * image::kMillisecond, image::kSecond};
    const Element* const e = table_.find("pause");
    if (e == nullptr) return p;
    if (e->kind != Element::Kind::array || e->children.size() != 2) {
      reading_.error(e->at, finding::kNotRange, {"pause"});
      return p;
    }
    p.first = table_.time_of(e->children[0], "pause").value_or(p.first);
    p.second = table_.time_of(e->children[1], "pause").value_or(p.second);
    return p;
  }
  void draw(const Element& range, Parameters& values) {
    for (const Element& e : range.children) {
      if (e.kind != Element::Kind::array || e.children.size() != 2 || !e.children[0].numeric() ||
          !e.children[1].numeric()) {
        reading_.error(e.at, finding::kNotRange, {e.key});
        continue;
      }
      const bool whole =
          e.children[0].kind == Element::Kind::integer && e.children[1].kind == Element::Kind::integer;
      const double from = e.children[0].number(), to = e.children[1].number() + (whole ? 1.0 : 0.0);
      Element value;
      value.kind = whole ? Element::Kind::integer : Element::Kind::real;
      const double drawn = uniform(from, to);
      value.integer = static_cast<std::int64_t>(std::floor(drawn));
      value.real = std::round(drawn * 1000.0) / 1000.0;
      values.emplace_back(e.key, value);
    }
  }

  Table table_;
  const Parameters& parameters_;
  std::mt19937_64 engine_;
  Reading& reading_;
};

bool expects(const Scenario& s) {
  return std::any_of(s.steps.begin(), s.steps.end(), [](const Step& step) {
    const auto* const what = std::get_if<Do>(&step.what);
    return std::holds_alternative<Expect>(step.what) || (what != nullptr && (what->refused || what->wait));
  });
}

class Reader {
 public:
  Reader(const std::string& path, std::uint64_t seed, Reading& reading)
      : path_(path), seed_(seed), reading_(reading) {}

  std::vector<Scenario> read(Element root) {
    whole_.root = std::move(root);
    const Element own = whole_.root;
    include(path_, own, 0, whole_, reading_);
    if (const Element* const machine = own.find("machine")) {
      whole_.machine_file = path_;
      whole_.machine = machine->string;
    }
    Table file(whole_.root, Part::file, reading_);
    if (const auto schema = file.whole("schema"); schema && *schema != 1)
      reading_.error(file.find("schema")->at, finding::kSchema, {std::to_string(*schema)});
    if (whole_.machine.empty())
      reading_.error(whole_.root.at, machine::finding::kMissingKey,
                     {"machine", text::both("machine file", "файл станка")});
    std::vector<const Element*> cases = file.list("cases");
    const Element none;
    const bool single = cases.empty();
    if (single) cases.push_back(&none);
    for (const Element* c : cases) {
      Parameters parameters;
      for (const Element& value : c->children) parameters.emplace_back(value.key, value);
      if (c->kind != Element::Kind::table) file.wrong(*c, "cases", "a table", "таблица");
      one(parameters, single ? whole_.root.at : c->at);
    }
    names();
    return std::move(out_);
  }

 private:
  void one(const Parameters& parameters, Where at) {
    Element root = whole_.root;
    const Element* const random = whole_.root.find("random");
    std::erase_if(root.children, [](const Element& e) {
      return e.key == "random" || e.key == "cases" || e.key == "include";
    });
    substitute(root, parameters, reading_);
    Table file(root, Part::file, reading_);
    Scenario s;
    s.file = path_;
    s.at = at;
    s.title = s.name = file.text("title");
    s.verifies = file.texts("verifies");
    s.tags = file.texts("tags");
    Element machine;
    machine.kind = Element::Kind::string;
    machine.string = whole_.machine;
    substitute(machine, parameters, reading_);
    s.machine = beside(whole_.machine_file, machine.string);
    s.timeout = file.time("timeout").value_or(s.timeout);
    s.expected_failure = file.text("expected_failure");
    s.skip = file.text("skip");
    std::string label;
    for (const auto& [name, value] : parameters) {
      s.parameters.emplace_back(name, words_of(value));
      if (name != "name") label += (label.empty() ? "" : ", ") + name + "=" + words_of(value);
    }
    for (const auto& [name, value] : s.parameters)
      if (name == "name") label = value;
    if (!label.empty()) s.name += " [" + label + "]";
    for (const auto& [from, element] : whole_.given) {
      Element step = element;
      reading_.file = from;  // where a mistake in it stands
      substitute(step, parameters, reading_);
      s.given.push_back(read_step(step, StepKind::given, reading_));
      reading_.file = path_;
    }
    for (const Element* step : file.list("given"))
      s.given.push_back(read_step(*step, StepKind::given, reading_));
    for (const Element* step : file.list("step"))
      s.steps.push_back(read_step(*step, StepKind::step, reading_));
    if (random == nullptr) return add(std::move(s));
    Table table(*random, Part::random, reading_);
    const auto runs = std::clamp<std::int64_t>(table.whole("runs").value_or(1), 1, 100'000);
    for (std::int64_t n = 0; n < runs; ++n) {
      Scenario run = s;
      run.seed = seed_ + static_cast<std::uint64_t>(n);
      run.name += " [seed " + std::to_string(*run.seed) + "]";
      Draw(*random, parameters, *run.seed, reading_).add_to(run);
      add(std::move(run));
    }
  }

  void add(Scenario s) {
    // Where steps are wrong already, it would only be their consequence.
    if (reading_.findings.empty() && s.steps.empty()) reading_.error(s.at, finding::kNoSteps, {});
    if (reading_.findings.empty() && !expects(s)) reading_.error(s.at, finding::kNoExpectation, {});
    out_.push_back(std::move(s));
  }

  void names() {
    std::set<std::string> seen;
    for (const Scenario& s : out_)
      if (!seen.insert(s.name).second) reading_.error(s.at, finding::kSameName, {s.name});
  }

  const std::string& path_;
  std::uint64_t seed_;
  Reading& reading_;
  Whole whole_;
  std::vector<Scenario> out_;
};

void give(Reading& reading, std::vector<text::Finding>& findings) {
  machine::sort_findings(reading.findings);
  findings.insert(findings.end(), reading.findings.begin(), reading.findings.end());
}

}  // namespace

std::string Scenario::folder() const { return std::filesystem::path(file).parent_path().string(); }

std::vector<Scenario> read_scenarios(const std::string& path, std::string_view text, std::uint64_t seed,
                                     std::vector<text::Finding>& findings) {
  Reading reading;
  reading.file = path;
  machine::Document document = machine::read_document(text);
  if (!document.ok()) {
    reading.error(document.error_at, machine::finding::kSyntax, {document.error});
    give(reading, findings);
    return {};
  }
  std::vector<Scenario> scenarios = Reader(path, seed, reading).read(std::move(document.root));
  const bool wrong = !reading.findings.empty();
  give(reading, findings);
  if (wrong) scenarios.clear();
  return scenarios;
}

std::optional<Step> read_step(const Element& table, std::vector<text::Finding>& findings) {
  Reading reading;
  Step step = read_step(table, StepKind::step, reading);
  const bool wrong = !reading.findings.empty();
  give(reading, findings);
  return wrong ? std::nullopt : std::optional(std::move(step));
}

}  // namespace servogate::scenario
