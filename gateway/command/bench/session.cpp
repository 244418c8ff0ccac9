// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/session.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "firmware_if/canopen/402/statusword.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/limits.hpp"
#include "gateway/command/bench/run_record.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/data_sheet.hpp"
#include "gateway/command/canopen/object_value.hpp"
#include "gateway/command/canopen/sdo_request.hpp"

namespace servogate::gateway::command {
namespace {

using nlohmann::json;

const text::Entry kBadTravel{"bench.travel",
                             "--travel {0}: expected FROM..TO in revolutions with 0 between, as -5..50",
                             "--travel {0}: нужно ОТ..ДО в оборотах, с нулём между ними, например -5..50"};
const text::Entry kEndedBy{"bench.ended-by", "the run has ended: {0}", "прогон завершён: {0}"};
const text::Entry kNotFound{"bench.not-found", "the measurement does not show the {0}; see {1}/report.html",
                            "измерение не показывает: {0}; см. {1}/report.html"};
const text::Entry kResetIt{"bench.reset",
                           "look the code up in the manual of the drive and remove its cause; then "
                           "`servogate sdo {0} {1} write controlword 0x80 "
                           "u16 --i-may-move` resets the fault",
                           "найдите код в руководстве привода и устраните причину; затем `servogate sdo {0} "
                           "{1} write controlword 0x80 u16 "
                           "--i-may-move` сбросит неисправность"};
const text::Entry kNoInertia{"bench.no-inertia",
                             "--loop torque needs --inertia: without the least inertia of motor and load "
                             "nobody can say beforehand where the "
                             "shaft goes (data sheet of the motor, or `bench identify`)",
                             "для --loop torque нужен --inertia: без наименьшего момента инерции мотора и "
                             "нагрузки нельзя заранее сказать, куда "
                             "уйдёт вал (паспорт мотора или `bench identify`)"};
const text::Entry kLive{"bench.live", "{0} s {1}: {2} rev, {3} rev/s, {4} N m; {5}",
                        "{0} с {1}: {2} об., {3} об/с, {4} Н·м; {5}"};
const text::Entry kKept{"bench.kept", "kept in {0}", "сохранено в {0}"};
const text::Entry kStillOn{"bench.still-on",
                           "the drive does not show that it is without torque: switch it off by hand",
                           "привод не подтверждает снятие момента: отключите его вручную"};
const text::Entry kAnyKey{"bench.any-key", "any key stops the drive", "любая клавиша останавливает привод"};

constexpr double kLive_s = 0.5;

std::optional<bench::Envelope> envelope_of(const BenchOptions& o) {
  bench::Envelope e;
  const std::size_t dots = o.travel.find("..");
  const auto from =
      dots == std::string::npos ? std::nullopt : number_word(std::string_view(o.travel).substr(0, dots));
  const auto to =
      dots == std::string::npos ? std::nullopt : number_word(std::string_view(o.travel).substr(dots + 2));
  if (!from || !to || *from > 0.0 || *to < 0.0) {
    complain(kBadTravel, {o.travel});
    return std::nullopt;
  }
  e.travel_min_rad = *from * kTurnRad;
  e.travel_max_rad = *to * kTurnRad;
  e.speed_rad_s = o.speed_rev_s * kTurnRad;
  e.torque_nm = o.torque_nm;
  e.time_s = o.time_s;
  e.following_rad = o.following_rev * kTurnRad;
  return e;
}

void tell_live(const bench::Guard& g) {
  const bench::DriveAnswer& a = g.answer();
  tell(text::render(
      kLive,
      std::vector<std::string>{text::number(static_cast<double>(g.samples().size()) * g.period_s(), 3),
                               g.stages().back(), text::number(a.position_rad / kTurnRad, 4),
                               text::number(g.speed_rad_s() / kTurnRad, 3), text::number(a.torque_nm, 3),
                               canopen::describe_statusword(a.statusword, text::user_language())},
      text::user_language()));
}

/// Why a run came to no result, in words; its exit code.
int verdict(const BenchOptions& o, const bench::Guard& guard, bool found, const std::string& why) {
  if (guard.trip() != bench::Trip::none) {
    const std::string node =
        o.with.empty() ? "" : text::both("node ", "узел ") + std::to_string(o.node) + ": ";
    complain(kEndedBy, {node + trip_words(guard)});
    if (guard.trip() == bench::Trip::fault) complain(kResetIt, {o.bus, std::to_string(o.node)});
    return guard.trip() == bench::Trip::ended ? kStopped : kAlarm;
  }
  if (found) return kDone;
  if (!why.empty()) complain(kNotFound, {why, o.out});
  return kAlarm;
}

}  // namespace

json meta_of(const char* command, const BenchOptions& o, const BusDrive& drive, std::size_t axis) {
  return {{"schema", 1},
          {"command", command},
          {"bus", o.bus},
          {"node", o.node},
          {"drive", drive_json(drive.facts(axis))},
          {"envelope",
           {{"travel_rev", o.travel},
            {"speed_rev_s", o.speed_rev_s},
            {"torque_nm", o.torque_nm},
            {"time_s", o.time_s},
            {"following_rev", o.following_rev}}},
          {"cycle_us", o.cycle_us}};
}

int finish(BenchWork& work, bool found, const std::optional<RunLimits>& limits, bool off) {
  const BenchOptions& o = work.options;
  work.meta["trip"] = trip_name(work.guard.trip());
  work.meta["late_cycles"] = work.drive.late_cycles();
  work.meta["off"] = off;
  const bool passed = !limits || judge(*limits, work.meta);
  if (!off) complain(kStillOn, {});
  const bool written = write_run(o.out, work.guard, work.drive.recorder(work.axis), work.meta);
  if (o.json && !o.part) print_exact(work.meta.dump(1, ' ', false, json::error_handler_t::replace));
  const int code = verdict(o, work.guard, found, work.why);
  if (limits && !o.json) print_judgement(work.meta);
  if (code != kDone || !written) return written ? code : kInfrastructure;
  if (!o.json && !o.part)
    print_line(text::render(kKept, std::vector<std::string>{o.out}, text::user_language()));
  return off && passed ? kDone : kAlarm;
}

std::unique_ptr<bench::Guard> begin_guard(bench::BenchDrive& drive, const BenchPlan& plan,
                                          const DriveFacts& facts) {
  bench::Envelope envelope = plan.envelope;
  envelope.quick_stop_rad_s2 = facts.quick_stop_rev_s2 * kTurnRad;
  return std::make_unique<bench::Guard>(drive, envelope);
}

void watch_live(bench::Guard& guard) {
  guard.watch = tell_live;
  guard.watch_s = kLive_s;
}

std::optional<double> number_word(std::string_view word) {
  double value = 0.0;
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [at, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || at != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

bool knows_least_load(const BenchOptions& o) {
  if (o.loop != "torque" || o.inertia_kg_m2 > 0.0) return true;
  complain(kNoInertia, {});
  return false;
}

bool accepts_signal(bench::Guard& guard, const BenchOptions& o, bench::Loop loop,
                    std::span<const double> set_points) {
  return loop == bench::Loop::torque ? guard.accepts_torque(set_points, {o.inertia_kg_m2, o.friction_nm})
                                     : guard.accepts(loop, set_points);
}

json optional_number(const std::optional<std::int64_t>& v) { return v ? json(*v) : json(nullptr); }
json optional_number(const std::optional<double>& v) { return v ? json(*v) : json(nullptr); }

json drive_json(const DriveFacts& f) {
  return {{"name", f.name},
          {"vendor", optional_number(f.vendor)},
          {"product", optional_number(f.product)},
          {"revision", optional_number(f.revision)},
          {"serial", optional_number(f.serial)},
          {"dc_link_mv", optional_number(f.dc_link_mv)},
          {"quick_stop_rev_s2", f.quick_stop_rev_s2 > 0.0 ? json(f.quick_stop_rev_s2) : json(nullptr)},
          {"counts_per_rev", f.counts_per_rev},
          {"rated_torque_nm", f.rated_torque_nm}};
}

bool read_record_option(const BenchOptions& options, std::vector<RecordedObject>& out) {
  if (options.record.empty()) return true;
  std::optional<canopen::Eds> eds;
  if (!options.eds.empty() && !(eds = read_data_sheet(options.eds))) return false;
  auto objects = recorded_objects(options.record, canopen::ObjectCatalogue(eds ? &*eds : nullptr));
  if (objects) out = std::move(*objects);
  return objects.has_value();
}

namespace {

/// What a drive measures and its data sheet calls a temperature. CiA 402 has no object for it.
std::vector<canopen::ObjectAddress> temperatures_of(const canopen::Eds& eds) {
  constexpr std::size_t kMost = 8;
  std::vector<canopen::ObjectAddress> out;
  const auto take = [&](std::uint16_t index, std::uint8_t subindex, const canopen::EdsEntry& entry) {
    std::string name = entry.name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool measured = entry.access == canopen::EdsAccess::ro || entry.access == canopen::EdsAccess::rwr;
    if (measured && canopen::eds_type_bits(entry.data_type) != 0 &&
        name.find("temperature") != std::string::npos && out.size() < kMost)
      out.push_back({index, subindex});
  };
  for (const auto& [index, object] : eds.objects) {
    if (object.subs.empty()) take(index, 0, object.entry);
    for (const auto& [subindex, entry] : object.subs)
      if (subindex != 0) take(index, subindex, entry);
  }
  return out;
}

}  // namespace

bool ReadObjects::set(const BenchOptions& options) {
  if (options.read.empty() && options.eds.empty()) return true;
  std::optional<canopen::Eds> eds;
  if (!options.eds.empty() && !(eds = read_data_sheet(options.eds))) return false;
  const canopen::ObjectCatalogue catalogue(eds ? &*eds : nullptr);
  std::vector<canopen::ObjectAddress> wanted;
  for (const std::string& word : options.read) {
    const auto at = object_of_word(word, catalogue);
    if (!at) return false;
    wanted.push_back(*at);
  }
  if (eds)
    for (const canopen::ObjectAddress& t : temperatures_of(*eds)) {
      const auto same = [&t](const canopen::ObjectAddress& w) {
        return w.index == t.index && w.subindex == t.subindex;
      };
      if (std::none_of(wanted.begin(), wanted.end(), same)) wanted.push_back(t);
    }
  for (const canopen::ObjectAddress& at : wanted)
    objects_.push_back(
        {at, catalogue.type(at.index, at.subindex), catalogue.name(at.index, at.subindex), {}, {}});
  return true;
}

void ReadObjects::read(ToolBus& bus, int node, const char* when) {
  for (One& o : objects_) {
    const SdoOutcome outcome = bus.read(static_cast<canopen::NodeId>(node), o.at.index, o.at.subindex);
    const canopen::ValueType* type = o.type != nullptr ? o.type : canopen::guess_type(outcome.data);
    const json value = outcome.ok() ? json_value(outcome.data, type) : json({{"error", outcome.why()}});
    (when == std::string_view("before") ? o.before : o.after) =
        value.dump(-1, ' ', false, json::error_handler_t::replace);
  }
}

json ReadObjects::facts() const {
  json out = json::object();
  for (const One& o : objects_) {
    json row{{"name", o.name}};
    if (!o.before.empty()) row["before"] = json::parse(o.before);
    if (!o.after.empty()) row["after"] = json::parse(o.after);
    out[canopen::address_text(o.at.index, o.at.subindex)] = std::move(row);
  }
  return out;
}

std::unique_ptr<ToolBus> open_bench(const BenchOptions& o, int& code) {
  std::optional<Holder> holder;
  if (!find_holder(o.bus, holder, code)) return nullptr;
  if (holder) {
    code = refuse_held(*holder, o.bus, "`bench`");
    return nullptr;
  }
  auto bus = ToolBus::open(o, code);
  if (bus == nullptr) return bus;
  code = may_move(*bus, text::both("the bench", "стенд"), o);
  if (code == kDone && BusDrive::put_right(*bus, o)) return bus;
  code = bus->finish(code == kDone ? kAlarm : code);
  return nullptr;
}

std::optional<BenchPlan> plan_of(const BenchOptions& o, const DriveUse& use) {
  const auto envelope = envelope_of(o);
  if (!envelope) return std::nullopt;
  BenchPlan plan{*envelope, use, {}, {}};
  if (!read_record_option(o, plan.use.record) || !plan.objects.set(o)) return std::nullopt;
  if (!o.limits.empty() && !(plan.limits = read_limits(o.limits))) return std::nullopt;
  return plan;
}

int run_on_bus(ToolBus& bus, const char* command, const BenchOptions& o, BenchPlan& plan,
               const std::function<bool(BenchWork&)>& work) {
  if (!make_run_directory(o.out)) return kInfrastructure;
  int code = kDone;
  plan.objects.read(bus, o.node, "before");
  const auto drive = BusDrive::open(bus, o, plan.use, o.out + "/bus.log", code);
  if (drive == nullptr) return code;
  json meta = meta_of(command, o, *drive);
  const auto guard = begin_guard(*drive, plan, drive->facts());
  watch_live(*guard);
  if (drive->key().listening()) tell(text::render(kAnyKey, {}, text::user_language()));
  BenchWork one{o, *guard, *drive, meta, {}};
  const bool found = work(one);
  const bool off = guard->release();
  // Without process data no SYNC is missed.
  drive->leave();
  plan.objects.read(bus, o.node, "after");
  if (const json facts = plan.objects.facts(); !facts.empty()) meta["objects"] = facts;
  return finish(one, found, plan.limits, off);
}

int on_drive(const char* command, const BenchOptions& o, const DriveUse& use,
             const std::function<bool(BenchWork&)>& work) {
  auto plan = plan_of(o, use);
  if (!plan) return kWrongUse;
  int code = kDone;
  const auto bus = open_bench(o, code);
  return bus == nullptr ? code : bus->finish(run_on_bus(*bus, command, o, *plan, work));
}

}  // namespace servogate::gateway::command
