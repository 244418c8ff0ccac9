// SPDX-License-Identifier: Apache-2.0
#include "report/report.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "firmware_if/text/hex.hpp"
#include "report/report_json.hpp"

namespace servogate::report {

using Json = nlohmann::ordered_json;
using text::Language;

namespace {

constexpr const char* kReactions[] = {"none",         "warn",      "stop_at_block_end",
                                      "stop_on_path", "stop_axes", "stop_and_power_off",
                                      "quick_stop",   "power_off"};

const text::Entry kFinished{"report.finished", "the program came to its end: {0} blocks in {1} s",
                            "программа выполнена до конца: кадров {0} за {1} с"};
const text::Entry kFinishedWith{"report.finished-with",
                                "the program came to its end, with {0} alarms; the first: {1}",
                                "программа выполнена до конца, аварий: {0}; первая: {1}"};
const text::Entry kRefused{"report.refused", "the program was not begun: {0}", "программа не начата: {0}"};
const text::Entry kNotBegun{"report.not-begun", "nothing was begun: {0}", "ничего не начато: {0}"};
const text::Entry kNotBegunFrom{"report.not-begun", "nothing was begun: {0}; alarm {1}: {2}",
                                "ничего не начато: {0}; авария {1}: {2}"};
const text::Entry kWaited{"report.waited", "stopped because nothing moved for {0} s any more: {1}",
                          "остановлено: за {0} с ничего не сдвинулось: {1}"};
const text::Entry kByAlarm{"report.by-alarm", "{0}, at {1} s{2} (alarm {3})",
                           "{0}, на {1} с{2} (авария {3})"};
const text::Entry kInLine{"report.in-line", ", in line {0}", ", в строке {0}"};
const text::Entry kStopped{"report.stopped", "stopped by the operator after {0} blocks",
                           "остановлено оператором после кадров: {0}"};
const text::Entry kUnfinished{"report.unfinished", "the program did not come to its end: {0} blocks in {1} s",
                              "программа не дошла до конца: кадров {0} за {1} с"};

std::string hex(std::uint32_t value, int digits) {
  return std::string("0x") + text::hex_number(value, digits);
}

/// What was measured, to the ninth decimal: no tail of binary fractions.
double rounded(double value) {
  constexpr double kNinth = 1e9, kExact = 1e6;
  return std::abs(value) < kExact ? std::round(value * kNinth) / kNinth : value;
}

Json to_json(const FileIdentity& f) { return {{"path", f.path}, {"sha256", f.sha256}}; }
Json to_json(const Quantiles& q) {
  return {{"p50", q.p50}, {"p99", q.p99}, {"p999", q.p999}, {"max", q.max}};
}

Json to_json(const Provenance& p) {
  Json out;
  out["version"] = p.version;
  out["commit"] = p.commit;
  out["machine"] = p.machine ? to_json(*p.machine) : Json();
  out["program"] = p.program ? to_json(*p.program) : Json();
  out["plc"] = Json::array();
  for (const FileIdentity& f : p.plc) out["plc"].push_back(to_json(f));
  out["dialect"] = p.dialect;
  out["seed"] = p.seed;
  out["clock"] = p.clock;
  out["buses"] = Json::array();
  for (const BusProvenance& b : p.buses)
    out["buses"].push_back({{"name", b.name},
                            {"protocol", b.protocol},
                            {"transport", b.transport},
                            {"kind", b.mock ? "mock" : "real"}});
  out["kernel"] = p.kernel;
  out["processor"] = p.processor;
  out["nodes"] = Json::array();
  for (const NodeIdentity& n : p.nodes)
    out["nodes"].push_back({{"bus", n.bus},
                            {"node", n.node},
                            {"name", n.name},
                            {"vendor", hex(n.vendor, 8)},
                            {"product", hex(n.product, 8)},
                            {"revision", hex(n.revision, 8)},
                            {"serial", hex(n.serial, 8)}});
  out["command_line"] = p.command_line;
  return out;
}

Json to_json(const text::Finding& f, Language language) {
  return {{"file", f.file},
          {"line", f.line},
          {"column", f.column},
          {"severity", f.severity == text::Severity::error ? "error" : "warning"},
          {"code", f.entry != nullptr ? std::string(f.entry->id) : std::string()},
          {"text", f.entry != nullptr ? text::render(*f.entry, f.arguments, language) : std::string()}};
}

Json to_json(const WaitEntry& w, Language language) {
  return {{"reason", w.reason},
          {"text", text::in_language(w.text, language)},
          {"remedy", text::in_language(w.remedy, language)},
          {"file", w.file},
          {"line", w.line},
          {"for_s", w.for_s}};
}

Json to_json(const Verdict& v) {
  Json out{{"outcome", v.outcome}, {"text", v.text}};
  if (!v.remedy.empty()) out["remedy"] = v.remedy;
  return out;
}

Json to_json(const AlarmEntry& a, Language language) {
  const image::AlarmRecord& r = a.record;
  Json out;
  out["number"] = r.number;
  out["id"] = a.id;
  out["text"] = text::in_language(a.text, language);
  out["remedy"] = text::in_language(a.remedy, language);
  out["sequence"] = r.sequence;
  out["first_fault"] = r.first_fault;
  out["reaction"] =
      kReactions[std::min<std::size_t>(static_cast<std::size_t>(r.reaction), std::size(kReactions) - 1)];
  out["active"] = r.active;
  out["cycle"] = r.cycle;
  out["t"] = static_cast<double>(r.t_ns) / 1e9;  // 9.69, not 9.690000000000001
  if (!a.axis.empty()) out["axis"] = a.axis;
  if (r.process >= 0) out["process"] = r.process + 1;
  if (r.source >= 0) out["source"] = r.source;
  for (const image::AlarmFact& fact : a.facts)
    std::visit([&](const auto& value) { out[fact.key] = value; }, fact.value);
  if (r.line > 0) out["line"] = r.line;
  if (r.block >= 0) out["block"] = r.block;
  if (a.finding) out["finding"] = to_json(*a.finding, language);
  if (!a.finding && (r.limit != 0.0 || r.value != 0.0)) {
    out["limit"] = rounded(r.limit);
    out["value"] = rounded(r.value);
  }
  return out;
}

Json to_json(const AxisReport& a) {
  Json out{{"unit", a.unit},
           {"diameter", a.diameter},
           {"max_velocity", rounded(a.max_velocity)},
           {"max_acceleration", rounded(a.max_acceleration)},
           {"max_jerk", rounded(a.max_jerk)},
           {"max_following_error", rounded(a.max_following_error)}};
  Json limits = Json::object();
  if (a.limit_velocity > 0) limits["velocity"] = a.limit_velocity;
  if (a.limit_acceleration > 0) limits["acceleration"] = a.limit_acceleration;
  if (a.limit_jerk > 0) limits["jerk"] = a.limit_jerk;
  if (a.limit_following_error > 0) limits["following_error"] = a.limit_following_error;
  if (a.travel_min < a.travel_max) {
    limits["travel_min"] = a.travel_min;
    limits["travel_max"] = a.travel_max;
  }
  out["limits"] = limits;
  return out;
}

Json to_json(const TouchGroup& t) {
  const Repeatability r = repeatability(t.places);
  Json out{{"axis", t.letter},
           {"unit", t.unit},
           {"diameter", t.diameter},
           {"direction", t.direction},
           {"feed_mm_min", rounded(t.feed_mm_min)},
           {"mean", rounded(r.mean)},
           {"spread", rounded(r.spread)},
           {"deviation", rounded(r.deviation)},
           {"places", Json::array()}};
  for (const double place : t.places) out["places"].push_back(rounded(place));
  return out;
}

Json to_json(const ThreadPass& t) {
  Json out{{"process", t.process + 1},
           {"spindle", t.spindle + 1},
           {"line", t.line},
           {"t", rounded(t.begin_s)},
           {"duration_s", rounded(t.duration_s)},
           {"axis", t.letter},
           {"lead_mm", rounded(t.lead)},
           {"revolutions", rounded(t.revolutions)},
           {"speed_rpm", {rounded(t.speed_min_rpm), rounded(t.speed_max_rpm)}},
           {"off_mm",
            {{"mean", rounded(t.off_mean)},
             {"least", rounded(t.off_least)},
             {"greatest", rounded(t.off_greatest)}}},
           {"profile_mm", Json::array()}};
  if (!t.file_name.empty()) out["file"] = t.file_name;
  for (const ThreadPass::Part& part : t.profile)
    out["profile_mm"].push_back({rounded(part.least), rounded(part.greatest)});
  return out;
}

Json to_json(const SegmentReport& s) {
  Json out{{"name", s.name},
           {"load", rounded(s.load)},
           {"load_worst_cycle", rounded(s.load_worst_cycle)},
           {"frames_sent", s.frames_sent},
           {"frames_received", s.frames_received},
           {"errors", s.errors}};
  if (s.sync) {
    out["sync_late_us"] = to_json(s.sync->us);
    out["sync_late_histogram"] = Json::array();
    for (const SyncReport::Band& b : s.sync->bands)
      out["sync_late_histogram"].push_back({{"from_us", b.from_us}, {"to_us", b.to_us}, {"count", b.count}});
  }
  return out;
}

/// What stopped the run: the first fault that asked for more than attention.
const AlarmEntry* stopping(const Report& r) {
  const auto found = std::find_if(r.alarms.begin(), r.alarms.end(), [](const AlarmEntry& a) {
    return !a.consequence && a.record.reaction > image::Reaction::warn;
  });
  return found != r.alarms.end() ? &*found : nullptr;
}

std::string place_and_words(const text::Finding& f, Language language) {
  const std::string words = f.entry != nullptr ? text::render(*f.entry, f.arguments, language) : "";
  return f.line > 0 ? f.file + ":" + std::to_string(f.line) + ": " + words : words;
}

Verdict not_begun(const Report& r, Language language) {
  const auto say = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    return text::render(entry, arguments, language);
  };
  const AlarmEntry* cause = stopping(r);
  if (cause == nullptr && !r.alarms.empty()) cause = &r.alarms.back();
  const std::string words = text::in_language(r.error->text, language);
  if (cause == nullptr) return {"not_begun", say(kNotBegun, {words}), {}};
  return {"not_begun",
          say(kNotBegunFrom,
              {words.substr(0, words.find('\n')), std::to_string(cause->record.number), cause->text}),
          text::in_language(cause->remedy, language)};
}

}  // namespace

Verdict verdict_of(const Report& r, Language language) {
  const auto say = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    return text::render(entry, arguments, language);
  };
  const auto remedy = [&](const std::string& words) { return text::in_language(words, language); };
  const std::string blocks = std::to_string(r.blocks), time = text::number(r.time_s, 3);
  if (r.finished && !r.alarms.empty())
    return {"finished", say(kFinishedWith, {std::to_string(r.alarms.size()), r.alarms.front().text}),
            remedy(r.alarms.front().remedy)};
  if (r.finished) return {"finished", say(kFinished, {blocks, time}), {}};
  if (!r.findings.empty())
    return {"refused", say(kRefused, {place_and_words(r.findings.front(), language)}), {}};
  if (r.error) return not_begun(r, language);
  if (r.wait)
    return {"waited", say(kWaited, {text::number(r.wait->for_s, 1), r.wait->text}), remedy(r.wait->remedy)};
  if (const AlarmEntry* a = stopping(r); a != nullptr)
    return {
        "alarm",
        say(kByAlarm, {a->text, text::number(static_cast<double>(a->record.t_ns) / 1e9, 3),
                       a->record.line > 0 ? say(kInLine, {std::to_string(a->record.line)}) : std::string(),
                       std::to_string(a->record.number)}),
        remedy(a->remedy)};
  if (r.stopped) return {"stopped", say(kStopped, {blocks}), {}};
  return {"unfinished", say(kUnfinished, {blocks, time}), {}};
}

Json json_of(const Report& r, Language language) {
  Json out;
  out["schema"] = kReportSchema;
  out["verdict"] = to_json(verdict_of(r, language));
  out["provenance"] = to_json(r.provenance);
  out["finished"] = r.finished;
  out["time_s"] = r.time_s;
  out["cycles"] = r.cycles;
  out["overruns"] = r.overruns;
  out["starved"] = r.starved;
  out["blocks"] = r.blocks;
  if (r.blocks_expected > 0) out["blocks_expected"] = r.blocks_expected;
  if (r.wait) out["wait"] = to_json(*r.wait, language);
  if (r.error) out["error"] = {{"code", r.error->code}, {"text", text::in_language(r.error->text, language)}};
  for (const text::Finding& f : r.findings) out["findings"].push_back(to_json(f, language));
  out["alarms"] = Json::array();
  for (const AlarmEntry& a : r.alarms) out["alarms"].push_back(to_json(a, language));
  for (const ForceEntry& f : r.forces) out["forces"].push_back({{"name", f.name}, {"value", f.value}});
  out["axes"] = Json::object();
  for (const AxisReport& a : r.axes) out["axes"][a.letter] = to_json(a);
  for (const TouchGroup& t : r.touches) out["touches"].push_back(to_json(t));
  for (const ThreadPass& t : r.threads) out["threads"].push_back(to_json(t));
  out["virtual_speed"] = rounded(r.virtual_speed);
  out["cycle_us"] = to_json(r.cycle_us);
  if (r.lateness_us) out["lateness_us"] = to_json(*r.lateness_us);
  out["phases_us"] = Json::object();
  for (const PhaseReport& p : r.phases) out["phases_us"][p.name] = to_json(p.us);
  out["segments"] = Json::array();
  for (const SegmentReport& s : r.segments) out["segments"].push_back(to_json(s));
  if (r.sync_skew_us) out["sync_skew_us"] = to_json(*r.sync_skew_us);
  out["trace_dropped"] = r.trace_dropped;
  return out;
}

std::string to_json(const Report& report) {
  return json_of(report, text::user_language()).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Quantiles quantiles_us(const Histogram& h) {
  const auto us = [&](double q) { return static_cast<double>(h.quantile(q)) / 1000.0; };
  return {us(0.5), us(0.99), us(0.999), us(1.0)};
}

SyncReport sync_report(const Histogram& lateness) {
  SyncReport out{quantiles_us(lateness), {}};
  for (const Histogram::Bucket& b : lateness.buckets()) {
    if (out.bands.empty()) out.bands.push_back({0.0, 1.0, 0});
    while (static_cast<double>(b.from) / 1000.0 >= out.bands.back().to_us)
      out.bands.push_back({out.bands.back().to_us, 2.0 * out.bands.back().to_us, 0});
    out.bands.back().count += b.count;
  }
  return out;
}

void fill_axes(Report& report, const TraceLayout& layout, const RunStatistics& statistics) {
  const auto& axes = statistics.axes();
  if (report.axes.size() < axes.size()) report.axes.resize(axes.size());
  for (std::size_t a = 0; a < axes.size(); ++a) {
    AxisReport& out = report.axes[a];
    if (out.letter.empty()) out.letter = layout.axes[a];
    out.max_velocity = axes[a].max_velocity();
    out.max_acceleration = axes[a].max_acceleration();
    out.max_jerk = axes[a].max_jerk();
    out.max_following_error = axes[a].max_following_error();
  }
}

void fill_cycle_times(Report& report, const CycleTimes& times, bool realtime) {
  report.cycle_us = quantiles_us(times.duration());
  report.lateness_us.reset();
  if (realtime) report.lateness_us = quantiles_us(times.lateness());
  report.phases.clear();
  for (std::size_t n = 0; n < times.phase_names().size(); ++n)
    report.phases.push_back({times.phase_names()[n], quantiles_us(times.phase(n))});
}

}  // namespace servogate::report
