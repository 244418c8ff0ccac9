// SPDX-License-Identifier: Apache-2.0
// `servogate bench response`: the frequency response of a loop.
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/drive/measurement/loop_response.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/response_json.hpp"
#include "gateway/command/bench/session.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kNoSignal{
    "bench.no-excitation", "this excitation cannot be sampled every {0} ms: check --from, --to and --period",
    "такое возбуждение нельзя задать с шагом {0} мс: проверьте --from, --to и --period"};
const text::Entry kClosed{"bench.closed-loop", "closed loop   bandwidth {0} Hz, peak {1} dB",
                          "замкнутый контур   полоса {0} Гц, пик {1} дБ"};
const text::Entry kOpen{
    "bench.open-loop", "open loop     crossover {0} Hz, phase margin {1} deg, gain margin {2} dB",
    "разомкнутый контур частота среза {0} Гц, запас по фазе {1} град, по усилению {2} дБ"};
const text::Entry kPeak{"bench.peak", "resonance     {0} Hz, {1} dB", "резонанс           {0} Гц, {1} дБ"};
const text::Entry kDip{"bench.dip", "antiresonance {0} Hz, {1} dB", "антирезонанс       {0} Гц, {1} дБ"};
const text::Entry kValid{"bench.valid", "valid         {0} to {1} Hz; nothing is said beyond it",
                         "достоверно         от {0} до {1} Гц; вне этого ничего не утверждается"};

std::string words(const std::optional<double>& value, int digits = 1) {
  return value ? text::number(*value, digits) : "?";
}

void say(const text::Entry& entry, const std::vector<std::string>& arguments) {
  print_line(text::render(entry, arguments, text::user_language()));
}

bool response_work(BenchWork& work) {
  const BenchOptions& o = work.options;
  bench::LoopResponsePlan plan;
  plan.loop = loop_named(o.loop);
  const double unit = plan.loop == bench::Loop::torque ? 1.0 : kTurnRad;
  if (plan.loop == bench::Loop::position) plan.hold = bench::Hold::interpolated;
  plan.excitation = o.amplitude * unit;
  plan.offset = o.offset * unit;
  plan.from_hz = o.from_hz;
  plan.to_hz = o.to_hz;
  plan.block = static_cast<std::size_t>(o.period);
  plan.blocks = o.periods;
  const std::vector<double> wanted = bench::loop_excitation(plan, work.guard.period_s());
  if (wanted.empty()) {
    complain(kNoSignal, {text::number(work.guard.period_s() * 1e3)});
    return false;
  }
  if (!accepts_signal(work.guard, o, plan.loop, wanted) || !work.guard.enable(plan.loop)) return false;
  const auto found = bench::take_loop_response(work.guard, plan);
  if (!found) {
    work.why = text::both("response of the loop", "характеристика контура");
    return false;
  }
  put_loop_response(*found, o.loop, work.meta);
  if (!o.json) say_loop_response(*found);
  return true;
}

}  // namespace

json lines_json(const bench::FrequencyResponse& response) {
  json rows = json::array();
  for (const bench::ResponseLine& line : response.lines)
    rows.push_back({{"hz", line.hz},
                    {"db", 20.0 * std::log10(std::abs(line.value))},
                    {"deg", std::arg(line.value) * 360.0 / kTurnRad},
                    {"coherence", line.coherence}});
  return rows;
}

void put_loop_response(const bench::LoopResponse& r, const std::string& loop, json& meta) {
  json extremes = json::array();
  for (const bench::Extreme& e : r.extremes)
    extremes.push_back({{"kind", e.peak ? "resonance" : "antiresonance"}, {"hz", e.hz}, {"db", e.db}});
  meta["figures"] = {{"loop", loop},
                     {"bandwidth_hz", optional_number(r.bandwidth_hz)},
                     {"peak_db", r.peak_db},
                     {"crossover_hz", optional_number(r.margins.crossover_hz)},
                     {"phase_margin_deg", optional_number(r.margins.phase_margin_deg)},
                     {"gain_margin_db", optional_number(r.margins.gain_margin_db)},
                     {"valid_from_hz", r.closed.valid_from_hz},
                     {"valid_to_hz", r.closed.valid_to_hz},
                     {"extremes", extremes}};
  meta["closed_loop"] = lines_json(r.closed);
  meta["open_loop"] = lines_json(r.open);
}

void say_loop_response(const bench::LoopResponse& r) {
  say(kClosed, {words(r.bandwidth_hz), text::number(r.peak_db, 1)});
  say(kOpen,
      {words(r.margins.crossover_hz), words(r.margins.phase_margin_deg), words(r.margins.gain_margin_db)});
  for (const bench::Extreme& e : r.extremes)
    say(e.peak ? kPeak : kDip, {text::number(e.hz, 1), text::number(e.db, 1)});
  say(kValid, {text::number(r.closed.valid_from_hz, 1), text::number(r.closed.valid_to_hz, 1)});
}

int bench_response(const BenchOptions& options) {
  if (!knows_least_load(options)) return kWrongUse;
  return on_drive("bench response", options, use_of_loop(loop_named(options.loop)), response_work);
}

}  // namespace servogate::gateway::command
