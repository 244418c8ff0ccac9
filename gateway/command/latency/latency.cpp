// SPDX-License-Identifier: Apache-2.0
// `servogate latency`: how exactly this computer keeps a cycle.
#include "gateway/command/latency/latency.hpp"

#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bus_drive.hpp"
#include "gateway/command/bench/session.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/latency/cyclictest.hpp"
#include "gateway/command/latency/machine_cycle.hpp"
#include "gateway/command/latency/this_computer.hpp"
#include "gateway/command/latency/wake_up.hpp"
#include "report/report.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kHead{"latency.head", "{0}: median {1} us, 99 % {2} us, 99.9 % {3} us, worst {4} us",
                        "{0}: медиана {1} мкс, 99 % {2} мкс, 99,9 % {3} мкс, наихудшее {4} мкс"};
const text::Entry kBar{"latency.bar", "  up to {0} us {1} {2}", "  до {0} мкс {1} {2}"};
const text::Entry kOther{"latency.cyclictest", "cyclictest: least {0} us, mean {1} us, worst {2} us",
                         "cyclictest: наименьшее {0} мкс, среднее {1} мкс, наихудшее {2} мкс"};
const text::Entry kNoOther{"latency.no-cyclictest", "cyclictest is not installed (package rt-tests)",
                           "cyclictest не установлен (пакет rt-tests)"};
const text::Entry kFit{"latency.fit", "cycle of {0} us: {1}", "цикл {0} мкс: {1}"};
const text::Entry kRefused{"latency.refused", "the system refused {0} ({1}): {2}",
                           "система отказала: {0} ({1}): {2}"};
const text::Entry kAdvice{"latency.advice", "{0}: {1}", "{0}: {1}"};
const text::Entry kMissed{"latency.missed", "{0} of {1} cycles were missed", "пропущено циклов: {0} из {1}"};
const text::Entry kReal{
    "latency.real",
    "{0} has a bus that is not simulated: --machine runs simulated ones only. The report of `run "
    "--realtime` has the phases of a real one",
    "в {0} есть не имитируемая шина: --machine работает только с имитируемыми. Фазы настоящей — в "
    "отчёте `run --realtime`"};
const text::Entry kNoCycle{"latency.no-cycle", "the machine was stopped before its first cycle",
                           "станок остановлен до первого цикла"};
const text::Entry kNode{"latency.node", "BUS needs the number of a node behind it",
                        "после ШИНЫ нужен номер узла"};

constexpr double kCycles_us[] = {1000.0, 500.0, 250.0};

std::string fit_words(Fit fit) {
  switch (fit) {
    case Fit::good:
      return text::both("good enough", "подходит");
    case Fit::doubtful:
      return text::both("doubtful: the worst wake-up takes more than a fifth of it",
                        "сомнительно: наихудшее пробуждение занимает больше пятой части");
    case Fit::no:
      break;
  }
  return text::both("no: the worst wake-up takes more than half of it",
                    "нет: наихудшее пробуждение занимает больше половины");
}

void say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  print_line(text::render(entry, arguments, text::user_language()));
}

/// Powers of two of a microsecond.
json bands_of(const report::Histogram& h) {
  json bands = json::array();
  for (const auto& band : report::sync_report(h).bands)
    bands.push_back({{"from_us", band.from_us}, {"to_us", band.to_us}, {"count", band.count}});
  return bands;
}

json histogram_json(const report::Histogram& h) {
  const report::Quantiles q = report::quantiles_us(h);
  return {{"count", h.count()}, {"p50_us", q.p50}, {"p99_us", q.p99},
          {"p999_us", q.p999},  {"max_us", q.max}, {"bands", bands_of(h)}};
}

void print_quantiles(const std::string& name, const json& h) {
  const auto number = [&](const char* key) { return text::number(h[key].get<double>(), 1); };
  say(kHead, {name, number("p50_us"), number("p99_us"), number("p999_us"), number("max_us")});
}

void print_histogram(const std::string& name, const json& h) {
  print_quantiles(name, h);
  const double all = std::max(1.0, h["count"].get<double>());
  for (const json& band : h["bands"]) {
    const double count = band["count"].get<double>();
    if (count == 0.0) continue;
    const auto width = static_cast<std::size_t>(1.0 + 50.0 * count / all);
    say(kBar, {text::number(band["to_us"].get<double>(), 1), std::string(width, '#'), text::number(count)});
  }
}

/// Of a bus with a node: SYNC against its time, and from SYNC to the first process data of the node.
struct BusTimes {
  report::Histogram sync, round_trip;
};

WakeUpPlan plan_of(const LatencyOptions& o) {
  WakeUpPlan plan;
  plan.cycle_ns = static_cast<image::Nanoseconds>(o.cycle_us * 1e3);
  plan.seconds = o.seconds;
  plan.realtime.priority = o.priority;
  plan.realtime.cpu = o.cpu;
  plan.realtime.best_effort = true;
  plan.load = o.load;
  return plan;
}

/// What takes the time of a machine's cycle.
json phases_json(const report::CycleTimes& times) {
  json out{{"cycle", histogram_json(times.duration())}, {"phases", json::array()}};
  for (std::size_t n = 0; n < times.phase_names().size(); ++n) {
    json row = histogram_json(times.phase(n));
    row["phase"] = times.phase_names()[n];
    out["phases"].push_back(std::move(row));
  }
  return out;
}

json facts_of(const LatencyOptions& o, const WakeUp& measured) {
  json out{{"schema", 1},
           {"cycle_us", o.cycle_us},
           {"load", o.load},
           {"wake_up", histogram_json(measured.late)},
           {"missed", measured.missed}};
  for (const double cycle : kCycles_us)
    out["fit"][text::number(cycle)] =
        fit_name(fit_of(measured.late.max(), static_cast<std::int64_t>(cycle * 1e3)));
  out["advice"] = json::array();
  for (const cycle::RealtimeRefusal& r : measured.refusals)
    out["advice"].push_back({{"what", text::in_language(r.what)}, {"remedy", text::in_language(r.remedy)}});
  for (const Advice& a : advice_for(""))
    out["advice"].push_back({{"what", text::in_language(a.what)}, {"remedy", text::in_language(a.remedy)}});
  if (const auto other = run_cyclictest(o.cycle_us, o.seconds, o.priority))
    out["cyclictest"] = {{"min_us", other->min_us}, {"mean_us", other->mean_us}, {"max_us", other->max_us}};
  return out;
}

void print_facts(const WakeUp& measured, const json& facts) {
  print_histogram(text::both("wake-up", "пробуждение"), facts["wake_up"]);
  if (facts.contains("sync")) print_histogram("SYNC", facts["sync"]);
  if (facts.contains("round_trip"))
    print_histogram(text::both("SYNC to process data", "от SYNC до данных процесса"), facts["round_trip"]);
  if (const auto machine = facts.find("machine"); machine != facts.end()) {
    print_histogram(text::both("whole cycle", "весь цикл"), (*machine)["cycle"]);
    for (const json& phase : (*machine)["phases"])
      print_quantiles("  " + phase["phase"].get<std::string>(), phase);
  }
  if (measured.missed > 0)
    say(kMissed, {std::to_string(measured.missed), std::to_string(measured.late.count())});
  if (const auto other = facts.find("cyclictest"); other != facts.end())
    say(kOther, {text::number((*other)["min_us"].get<double>(), 1),
                 text::number((*other)["mean_us"].get<double>(), 1),
                 text::number((*other)["max_us"].get<double>(), 1)});
  else
    say(kNoOther, {});
  for (const double cycle : kCycles_us)
    say(kFit, {text::number(cycle),
               fit_words(fit_of(measured.late.max(), static_cast<std::int64_t>(cycle * 1e3)))});
  for (const cycle::RealtimeRefusal& r : measured.refusals) say(kRefused, {r.what, r.cause, r.remedy});
  for (const Advice& a : advice_for("")) say(kAdvice, {a.what, a.remedy});
}

int finish(const LatencyOptions& o, const WakeUp& measured, const BusTimes* bus,
           const report::CycleTimes* machine = nullptr) {
  json facts = facts_of(o, measured);
  if (bus != nullptr) {
    facts["sync"] = histogram_json(bus->sync);
    facts["round_trip"] = histogram_json(bus->round_trip);
  }
  if (machine != nullptr) facts["machine"] = phases_json(*machine);
  o.json ? static_cast<void>(print_exact(facts.dump(1))) : print_facts(measured, facts);
  return fit_of(measured.late.max(), static_cast<std::int64_t>(o.cycle_us * 1e3)) == Fit::no ? kAlarm : kDone;
}

int on_machine(const LatencyOptions& o) {
  const machine::LoadResult loaded = machine::load(o.machine);
  if (print_findings(loaded.findings) > 0) return kWrongUse;
  if (!loaded.machine.nothing_real()) {
    complain(kReal, {o.machine});
    return kWrongUse;
  }
  const EndBySignal signals;
  const auto cycle = measure_machine(loaded, o.seconds, o.load, [&] { return signals.ended(); });
  if (!cycle) return kAlarm;
  if (signals.ended()) return kStopped;
  if (cycle->times.lateness().count() == 0) {
    complain(kNoCycle, {});
    return kAlarm;
  }
  LatencyOptions own = o;
  own.cycle_us = static_cast<double>(loaded.machine.cycle_ns()) / 1e3;
  own.priority = loaded.machine.realtime.priority;
  if (!o.json)
    for (const drivers::Notice& n : cycle->refusals) complain(*n.entry, n.arguments);
  WakeUp measured;
  measured.late = cycle->times.lateness();
  measured.missed = cycle->overruns;
  return finish(own, measured, nullptr, &cycle->times);
}

int on_bus(const LatencyOptions& o) {
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(o.bus, holder, code)) return code;
  if (holder) return refuse_held(*holder, o.bus, "`latency`");
  const auto bus = ToolBus::open(o, code);
  if (bus == nullptr) return code;
  if (code = must_be_idle(*bus, "`latency`", o); code != kDone) return bus->finish(code);
  BenchOptions bench;
  static_cast<CanopenBusOptions&>(bench) = o;
  bench.node = o.node;
  bench.cycle_us = o.cycle_us;
  DriveUse use;
  use.moves = false;
  use.key_ends = false;
  const auto drive = BusDrive::open(*bus, bench, use, "", code);
  if (drive == nullptr) return bus->finish(code);
  drive->begin_times();
  bench::DriveAnswer answer;
  // The cycle waits by itself; this thread is the one that sends.
  const WakeUp measured = measure_wake_up(
      plan_of(o), [&] { return bus->ended(); },
      [&](image::Nanoseconds due) { return drive->cycle_at(due, {}, answer); });
  const BusTimes times{drive->sync_lateness(), drive->round_trip()};
  return bus->finish(finish(o, measured, &times));
}

}  // namespace

int latency(const LatencyOptions& options) {
  if (!options.machine.empty()) return on_machine(options);
  if (!options.bus.empty()) {
    if (options.node > 0) return on_bus(options);
    complain(kNode, {});
    return kWrongUse;
  }
  const EndBySignal signals;
  const WakeUp measured = measure_wake_up(plan_of(options), [&] { return signals.ended(); });
  if (signals.ended()) return kStopped;
  return finish(options, measured, nullptr);
}

}  // namespace servogate::gateway::command
