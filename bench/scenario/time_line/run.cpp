// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/time_line/run.hpp"

#include <algorithm>
#include <deque>
#include <limits>
#include <memory>

#include "bench/scenario/reading/findings.hpp"
#include "bench/scenario/time_line/recent.hpp"
#include "bench/scenario/watch/watcher.hpp"
#include "firmware_if/text/in_both.hpp"

namespace servogate::scenario {

namespace {

const text::Entry kNotNow{"scenario.expected", "expected {0}, got {1} at {2} s",
                          "ожидалось {0}, получено {1} в {2} с"};
const text::Entry kNotWithin{"scenario.expected_within", "expected {0} within {1}, got {2} at {3} s",
                             "ожидалось {0} за {1}, получено {2} в {3} с"};
const text::Entry kNotAlways{"scenario.expected_always", "expected {0} {1}, got {2} at {3} s",
                             "ожидалось {0} {1}, получено {2} в {3} с"};
const text::Entry kHappened{"scenario.never", "expected never {0}, got {1} at {2} s",
                            "не ожидалось {0}, получено {1} в {2} с"};
const text::Entry kRefused{"scenario.refused", "expected `{0}` to be accepted, got \"{1}\" [{2}] at {3} s",
                           "ожидалось, что «{0}» примут, получено «{1}» [{2}] в {3} с"};
const text::Entry kNotRefused{"scenario.not_refused", "expected `{0}` to be refused{1}, got {2} at {3} s",
                              "ожидался отказ в «{0}»{1}, получено {2} в {3} с"};
const text::Entry kNotEnded{"scenario.not_done", "expected `{0}` to end as asked, got: {1} at {2} s",
                            "ожидалось, что «{0}» выполнится, получено: {1} в {2} с"};
const text::Entry kTimeout{"scenario.timeout",
                           "expected an end within {0} (timeout), got no further than {1} at {2} s",
                           "ожидался конец за {0} (timeout), дошло только до {1} в {2} с"};
const text::Entry kEnded{"scenario.ended", "expected the machine to go on, got its end at {0} s",
                         "ожидалось продолжение работы станка, получен её конец в {0} с"};
const text::Entry kNotInjected{"scenario.not_injected", "expected the fault to be possible, got: {0}",
                               "ожидалось, что неисправность возможна, получено: {0}"};
const text::Entry kXpass{"scenario.unexpected_pass", "expected a failure ({0}), got a pass",
                         "ожидался провал ({0}), получен успех"};

/// A run is over: what is left of it is not done.
struct Over {};

std::string seconds(double s) { return text::number(s, 3); }
std::string time_words(Nanoseconds t) {
  return t < image::kSecond ? text::number(static_cast<double>(t) * 1e-6, 3) + " ms"
                            : text::number(static_cast<double>(t) * 1e-9, 3) + " s";
}

/// An expectation that is watched while the steps go on.
struct Watch {
  const Step* step;
  Watcher watcher;
  std::optional<Watcher> until;
  Nanoseconds ends = 0;  ///< 0: with the run
  bool done = false;
};

/// A step with its conditions made for the machine.
struct Made {
  const Step* step;
  std::optional<Watcher> after, condition, until;
};

}  // namespace

/// The steps of a scenario on a machine.
class Run {
 public:
  Run(const Scenario& scenario, bench::Machine& machine, Operator& who, const Signals& signals,
      const RunManner& manner)
      : scenario_(scenario), machine_(machine), who_(who), signals_(signals), manner_(manner) {}

  Outcome run() {
    if (!prepare()) {
      outcome_.status = Outcome::Status::impossible;
      return std::move(outcome_);
    }
    try {
      cycle();
      for (const Made& made : given_) perform(made);
      began_ = now();
      for (const Made& made : steps_) perform(made);
      finish();
    } catch (const Over&) {
    }
    outcome_.virtual_s = static_cast<double>(machine_.image().now.t_ns) * 1e-9;
    expected_failure();
    return std::move(outcome_);
  }

  /// One step that nobody knew before; the first one begins the run.
  Outcome perform_alone(const Step& step) {
    outcome_ = {};
    machine::Reading reading;
    const std::vector<Made> made{made_of(step, reading)};
    if (!reading.findings.empty()) {
      outcome_.status = Outcome::Status::impossible;
      outcome_.findings = std::move(reading.findings);
      return outcome_;
    }
    show(made);
    try {
      perform(made.front());
    } catch (const Over&) {
      // What has failed is told once.
      std::erase_if(watches_, [&](const Watch& w) { return w.step->at.line == outcome_.at.line && !w.done; });
    }
    outcome_.virtual_s = static_cast<double>(now()) * 1e-9;
    return outcome_;
  }
  void begin() {
    show({});
    cycle();
    began_ = now();
  }
  bool advance() { return cycle(); }

 private:
  Nanoseconds now() const { return machine_.image().now.t_ns; }
  double since() const { return static_cast<double>(now() - began_) * 1e-9; }
  View view() const { return {machine_.image(), alarms_}; }
  /// Behind a cycle. Copying all alarms costs more than a cycle's watching, and most cycles have none.
  void read_alarms() {
    const bool any = machine_.image().alarms_active > 0;
    if (any || had_alarms_) alarms_ = machine_.alarms();
    had_alarms_ = any;
  }

  Made made_of(const Step& step, machine::Reading& reading) {
    const auto make = [&](const Condition& c) {
      return Watcher::make(c, signals_, scenario_.folder(), reading);
    };
    const auto possible = [&](const std::string& device, const fault::Fault* fault) {
      std::string why;
      if (!machine_.possible(device, fault, why)) reading.error(step.at, finding::kImpossible, {why});
    };
    Made made{&step, {}, {}, {}};
    if (step.after) made.after = make(*step.after);
    if (const auto* expect = std::get_if<Expect>(&step.what)) {
      made.condition = make(expect->condition);
      if (expect->until) made.until = make(*expect->until);
    } else if (const auto* what = std::get_if<Do>(&step.what)) {
      if (const std::string problem = who_.problem(*what); !problem.empty())
        reading.error(step.at, finding::kImpossible, {problem});
    } else if (const auto* inject = std::get_if<Inject>(&step.what)) {
      possible(inject->device, &inject->fault);
    } else {
      possible(std::get<Clear>(step.what).device, nullptr);
    }
    return made;
  }

  void show(const std::vector<Made>& steps) {
    std::vector<Signal> shown;
    for (const Made& made : steps)
      for (const auto* watcher : {&made.condition, &made.after, &made.until})
        if (*watcher) (*watcher)->signals(shown);
    recent_ = std::make_unique<Recent>(std::move(shown));
  }

  /// Everything that the file names is looked for before anything moves.
  bool prepare() {
    machine::Reading reading;
    reading.file = scenario_.file;
    for (const Step& step : scenario_.given) given_.push_back(made_of(step, reading));
    for (const Step& step : scenario_.steps) steps_.push_back(made_of(step, reading));
    machine::sort_findings(reading.findings);
    outcome_.findings = std::move(reading.findings);
    show(steps_);
    return outcome_.findings.empty();
  }

  [[noreturn]] void fail(const Step& step, std::string message) {
    outcome_.status = Outcome::Status::failed;
    outcome_.message = std::move(message);
    outcome_.at = step.at;
    outcome_.t_s = since();
    outcome_.diagram = recent_->diagram(began_);
    throw Over{};
  }

  /// One cycle of the machine, and all that looks at it.
  bool cycle() {
    if (!machine_.step()) return false;
    who_.poll(step_);
    read_alarms();
    const View seen = view();
    recent_->add(seen);
    for (Watch& watch : watches_)
      if (!watch.done) judge(watch, seen);
    return true;
  }

  void step(const Step& at) {
    if (!cycle()) fail(at, text::in_both(kEnded, {seconds(since())}));
    if (now() > scenario_.timeout)
      fail(at, text::in_both(kTimeout, {time_words(scenario_.timeout), waiting_for_, seconds(since())}));
  }

  void judge(Watch& watch, const View& seen) {
    const Expect& expect = std::get<Expect>(watch.step->what);
    if (watch.until && watch.until->see(seen)) {
      watch.done = true;
      return;
    }
    if (watch.ends > 0 && now() > watch.ends) {
      watch.done = true;
      return;
    }
    if (watch.watcher.see(seen) != expect.never) return;
    const std::string words = words_of(expect.condition), got = got_of(watch.watcher, seen);
    if (expect.never) fail(*watch.step, text::in_both(kHappened, {words, got, seconds(since())}));
    const std::string span = expect.manner == Expect::Manner::until
                                 ? text::both("until ", "до ") + words_of(*expect.until)
                             : expect.time > 0 ? text::both("for ", "в течение ") + time_words(expect.time)
                                               : text::both("always", "всегда");
    fail(*watch.step, text::in_both(kNotAlways, {words, span, got, seconds(since())}));
  }

  static std::string got_of(const Watcher& watcher, const View& seen) {
    return watcher.lost().empty() ? watcher.got(seen) : watcher.lost();
  }

  void await(const Made& made) {
    const Step& s = *made.step;
    switch (s.anchor) {
      case Step::Anchor::step_before:
        return;
      case Step::Anchor::at:
        return await_time(s, began_ + s.time);
      case Step::Anchor::after_time:
        return await_time(s, now() + s.time);
      case Step::Anchor::after:
        break;
    }
    Watcher after = *made.after;
    after.begin(view());
    waiting_for_ = words_of(*s.after);
    while (!after.see(view())) {
      if (!after.lost().empty())
        fail(s, text::in_both(kNotNow, {words_of(*s.after), after.lost(), seconds(since())}));
      step(s);
    }
    await_time(s, now() + s.time);
  }

  void await_time(const Step& s, Nanoseconds end) {
    waiting_for_ = seconds(static_cast<double>(end - began_) * 1e-9) + " s";
    // The cycle whose time is nearest: a cycle's time may lie a little before.
    while (now() + machine_.image().now.period_ns / 2 < end) step(s);
  }

  void perform(const Made& made) {
    await(made);
    if (const auto* what = std::get_if<Do>(&made.step->what)) return carry_out(*made.step, *what);
    if (const auto* fault = std::get_if<Inject>(&made.step->what)) {
      std::string why;
      if (!manner_.without_faults && !machine_.inject(fault->device, fault->fault, why))
        fail(*made.step, text::in_both(kNotInjected, {why}));
    } else if (const auto* clear = std::get_if<Clear>(&made.step->what)) {
      std::string why;
      if (!machine_.clear(clear->device, clear->kind, why))
        fail(*made.step, text::in_both(kNotInjected, {why}));
    } else {
      expect(made);
    }
  }

  static std::string words_of_do(const Do& what) {
    if (!what.command) return what.words;
    const machine::Element* const cmd = what.command->find("cmd");
    return cmd != nullptr ? cmd->string : "cmd";
  }

  void carry_out(const Step& step_of, const Do& what) {
    const std::string words = words_of_do(what);
    waiting_for_ = "`" + words + "`";
    const Said said = who_.carry_out(what, [&] {
      step(step_of);
      return true;
    });
    if (what.refused) {
      const std::string wanted = what.refused->empty() ? "" : " (" + *what.refused + ")";
      if (said.accepted)
        fail(step_of, text::in_both(kNotRefused,
                                    {words, wanted, text::both("acceptance", "согласие"), seconds(since())}));
      if (!what.refused->empty() && said.code != *what.refused)
        fail(step_of, text::in_both(kNotRefused, {words, wanted, "\"" + said.text + "\" [" + said.code + "]",
                                                  seconds(since())}));
      return;
    }
    if (!said.accepted && !what.either) outcome_.code = said.code;
    if (!said.accepted && !what.either)
      fail(step_of, text::in_both(kRefused, {words, said.text, said.code, seconds(since())}));
    if (!what.wait) return;
    while (who_.under_way()) step(step_of);
    if (const std::string failure = who_.failure(); !failure.empty())
      fail(step_of, text::in_both(kNotEnded, {words, failure, seconds(since())}));
  }

  void expect(const Made& made) {
    const Step& s = *made.step;
    const Expect& expect = std::get<Expect>(s.what);
    Watcher watcher = *made.condition;
    watcher.begin(view());
    const std::string words = words_of(expect.condition);
    if (expect.manner == Expect::Manner::always || expect.manner == Expect::Manner::until) {
      Watch watch{&s, std::move(watcher), made.until, expect.time > 0 ? now() + expect.time : 0};
      if (watch.until) watch.until->begin(view());
      watches_.push_back(std::move(watch));
      judge(watches_.back(), view());
      return;
    }
    const Nanoseconds end = expect.manner == Expect::Manner::within ? now() + expect.time : now();
    waiting_for_ = words;
    for (;;) {
      if (watcher.see(view())) return;
      if (now() >= end || !watcher.lost().empty()) break;
      step(s);
    }
    const std::string got = got_of(watcher, view());
    if (expect.manner == Expect::Manner::within)
      fail(s, text::in_both(kNotWithin, {words, time_words(expect.time), got, seconds(since())}));
    fail(s, text::in_both(kNotNow, {words, got, seconds(since())}));
  }

  /// What is watched for a time, or until something, is watched to its end.
  void finish() {
    for (;;) {
      const auto open = std::find_if(watches_.begin(), watches_.end(),
                                     [](const Watch& w) { return !w.done && (w.ends > 0 || w.until); });
      if (open == watches_.end()) return;
      waiting_for_ = open->until ? words_of(*std::get<Expect>(open->step->what).until)
                                 : words_of(std::get<Expect>(open->step->what).condition);
      step(*open->step);
    }
  }

  void expected_failure() {
    if (scenario_.expected_failure.empty()) return;
    if (outcome_.status == Outcome::Status::failed) {
      outcome_.status = Outcome::Status::skipped;
      outcome_.message = scenario_.expected_failure;
    } else if (outcome_.status == Outcome::Status::passed) {
      outcome_.status = Outcome::Status::failed;
      outcome_.at = scenario_.at;
      outcome_.message = text::in_both(kXpass, {scenario_.expected_failure});
    }
  }

  const Scenario& scenario_;
  bench::Machine& machine_;
  Operator& who_;
  const Signals& signals_;
  const RunManner manner_;
  const std::function<bool()> step_ = [this] { return cycle(); };
  Outcome outcome_;
  std::vector<Made> given_, steps_;
  std::deque<Watch> watches_;
  std::unique_ptr<Recent> recent_;
  cycle::AlarmSnapshot alarms_;
  bool had_alarms_ = false;
  Nanoseconds began_ = 0;
  std::string waiting_for_;
};

Outcome run(const Scenario& scenario, bench::Machine& machine, Operator& who, const Signals& signals,
            const RunManner& manner) {
  if (!scenario.skip.empty()) return {.status = Outcome::Status::skipped, .message = scenario.skip};
  return Run(scenario, machine, who, signals, manner).run();
}

struct Session::Impl {
  Scenario scenario;
  std::deque<Step> steps;  ///< conditions are watched where they are
  std::unique_ptr<Run> run;
};

Session::Session(bench::Machine& machine, Operator& who, const Signals& signals)
    : impl_(std::make_unique<Impl>()) {
  impl_->scenario.timeout = std::numeric_limits<Nanoseconds>::max();
  impl_->run = std::make_unique<Run>(impl_->scenario, machine, who, signals, RunManner{});
  impl_->run->begin();
}

Session::~Session() = default;

Outcome Session::perform(Step step) {
  step.at = {static_cast<int>(impl_->steps.size()) + 1, 1};  // its number
  impl_->steps.push_back(std::move(step));
  return impl_->run->perform_alone(impl_->steps.back());
}

bool Session::advance() { return impl_->run->advance(); }

}  // namespace servogate::scenario
