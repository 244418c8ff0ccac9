// SPDX-License-Identifier: Apache-2.0
// `servogate bench record`: objects by PDO, without power.
#include <nlohmann/json.hpp>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/limits.hpp"
#include "gateway/command/bench/run_record.hpp"
#include "gateway/command/bench/session.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kRecorded{"bench.recorded", "{0} rows every {1} ms, {2} of them late; kept in {3}",
                            "строк: {0}, через {1} мс, из них с опозданием {2}; сохранено в {3}"};
const text::Entry kOffline{"bench.record-offline", "node {0} sent no process data after {1} s",
                           "узел {0} не прислал данных процесса за {1} с"};

/// Least and greatest value of each object.
json ranges_of(const ObjectRecorder& recorder, std::size_t first) {
  json out = json::object();
  for (std::size_t k = 0; k < recorder.objects().size(); ++k) {
    double least = 1e300, greatest = -1e300;
    for (std::size_t n = first; n < recorder.rows(); ++n) {
      least = std::min(least, recorder.row(n)[k]);
      greatest = std::max(greatest, recorder.row(n)[k]);
    }
    out[recorder.objects()[k].name] = {{"least", least}, {"greatest", greatest}};
  }
  return out;
}

int record_on(ToolBus& bus, const BenchOptions& o, const DriveUse& use, ReadObjects& objects,
              const std::optional<RunLimits>& limits) {
  int code = kDone;
  objects.read(bus, o.node, "before");
  const auto drive = BusDrive::open(bus, o, use, o.out + "/bus.log", code);
  if (drive == nullptr) return code;
  const std::size_t first = drive->recorder().rows();
  const auto cycles = static_cast<std::size_t>(o.duration_s / drive->period_s() + 0.5);
  bench::DriveAnswer answer;
  for (std::size_t n = 0; n < cycles && !drive->ended(); ++n) {
    if (!drive->cycle({}, answer)) return kInfrastructure;
    if (answer.online) continue;
    complain(kOffline, {std::to_string(o.node), text::number(static_cast<double>(n) * drive->period_s(), 3)});
    return kAlarm;
  }
  // Without process data no SYNC is missed.
  drive->leave();
  objects.read(bus, o.node, "after");
  json meta{{"schema", 1},
            {"command", "bench record"},
            {"bus", o.bus},
            {"node", o.node},
            {"drive", drive_json(drive->facts())},
            {"cycle_us", o.cycle_us},
            {"rows", drive->recorder().rows() - first},
            {"late_cycles", drive->late_cycles()},
            {"figures", ranges_of(drive->recorder(), first)}};
  if (const json facts = objects.facts(); !facts.empty()) meta["objects"] = facts;
  const bool passed = !limits || judge(*limits, meta);
  if (!write_objects(o.out, drive->recorder(), first, drive->period_s(), meta)) return kInfrastructure;
  if (o.json) {
    print_exact(meta.dump(1, ' ', false, json::error_handler_t::replace));
    return passed ? kDone : kAlarm;
  }
  if (limits) print_judgement(meta);
  print_line(
      text::render(kRecorded,
                   std::vector<std::string>{meta["rows"].dump(), text::number(drive->period_s() * 1e3, 3),
                                            std::to_string(drive->late_cycles()), o.out},
                   text::user_language()));
  return passed ? kDone : kAlarm;
}

}  // namespace

int bench_record(const BenchOptions& options) {
  BenchOptions o = options;
  o.cycle_us = 1e6 / o.rate_hz;
  DriveUse use;
  use.moves = false;
  ReadObjects objects;
  if (!read_record_option(o, use.record) || !objects.set(o)) return kWrongUse;
  std::optional<RunLimits> limits;
  if (!o.limits.empty() && !(limits = read_limits(o.limits))) return kWrongUse;
  int code = kDone;
  std::optional<Holder> holder;
  if (!find_holder(o.bus, holder, code)) return code;
  if (holder) return refuse_held(*holder, o.bus, "`bench`");
  const auto bus = ToolBus::open(o, code);
  if (bus == nullptr) return code;
  if (code = must_be_idle(*bus, "`bench record`", o); code != kDone) return bus->finish(code);
  if (!make_run_directory(o.out)) return bus->finish(kInfrastructure);
  return bus->finish(record_on(*bus, o, use, objects, limits));
}

}  // namespace servogate::gateway::command
