// SPDX-License-Identifier: Apache-2.0
// `servogate bench move` and `bench jog`: the motor turns.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bench/drive/excitation/signal.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/session.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::OperationMode;
using canopen::supported_bit;
using nlohmann::json;

const text::Entry kNoNumber{"bench.no-number", "'{0}' is no number", "«{0}» — не число"};
const text::Entry kArrived{"bench.arrived", "stands at {0} rev, {1} rev from its target; after {2} s",
                           "стоит на {0} об., до цели {1} об.; через {2} с"};
const text::Entry kJogged{
    "bench.jogged", "turned {0} rev at {1} rev/s on average, with {2} N m; ended by {3}",
    "повернулся на {0} об. со средней скоростью {1} об/с и моментом {2} Н·м; завершено: {3}"};

constexpr double kSettle_s = 0.5;
/// How long a drive in pp must show that it has arrived.
constexpr double kArrived_s = 0.1;

struct Mode {
  const char* word;
  bench::Loop loop;
  OperationMode mode;
};
constexpr Mode kModes[] = {{"csp", bench::Loop::position, OperationMode::cyclic_sync_position},
                           {"pp", bench::Loop::position, OperationMode::profile_position},
                           {"csv", bench::Loop::velocity, OperationMode::cyclic_sync_velocity},
                           {"pv", bench::Loop::velocity, OperationMode::profile_velocity},
                           {"vl", bench::Loop::velocity, OperationMode::velocity},
                           {"cst", bench::Loop::torque, OperationMode::cyclic_sync_torque},
                           {"tq", bench::Loop::torque, OperationMode::profile_torque}};

const Mode& mode_named(const std::string& word) {
  const auto found =
      std::find_if(std::begin(kModes), std::end(kModes), [&](const Mode& m) { return m.word == word; });
  return found != std::end(kModes) ? *found : kModes[0];
}

DriveUse use_of(const Mode& mode) {
  DriveUse use;
  use.modes = supported_bit(mode.mode);
  (mode.loop == bench::Loop::position   ? use.position
   : mode.loop == bench::Loop::velocity ? use.velocity
                                        : use.torque) = mode.mode;
  return use;
}

/// Until the drive shows that it has reached its target and stands. False: the guard has tripped, or it did
/// not arrive, which is in `why`.
bool follow_profile(BenchWork& work, double target, double patience_s) {
  bench::Guard& guard = work.guard;
  const double h = guard.period_s();
  double there = 0.0;
  for (double t = 0.0; t < patience_s && there < kArrived_s; t += h) {
    if (!guard.lead_to(target)) return false;
    const bool reached = (guard.answer().statusword & canopen::statusword::kTargetReached) != 0;
    // Before the drive has taken the set-point it shows that it has reached the one before.
    there = reached && t > 0.05 ? there + h : 0.0;
  }
  if (there < kArrived_s) work.why = "arrival (bit 10 of 6041h)";
  return there >= kArrived_s;
}

bool move_work(BenchWork& work, double distance) {
  const BenchOptions& o = work.options;
  bench::Guard& guard = work.guard;
  const bool profile = o.mode == "pp";
  const double speed = o.move_speed * kTurnRad, acceleration = o.acceleration * kTurnRad;
  const double takes = bench::move_time(distance, speed, acceleration, profile ? 0.0 : o.jerk * kTurnRad);
  bench::Signal s;
  s.kind = bench::SignalKind::jerk_limited;
  s.amplitude = distance;
  s.duration_s = takes + kSettle_s;
  s.speed = speed;
  s.acceleration = acceleration;
  s.jerk = o.jerk * kTurnRad;
  const std::vector<double> course = profile ? std::vector<double>{} : bench::samples(s, guard.period_s());
  const bool fits = profile ? guard.accepts_travel(std::min(0.0, distance), std::max(0.0, distance)) &&
                                  guard.accepts(bench::Loop::velocity, std::vector<double>{speed})
                            : guard.accepts(bench::Loop::position, course);
  if (!fits || !guard.enable(bench::Loop::position)) return false;
  guard.stage("move");
  const std::size_t first = guard.samples().size();
  double greatest = 0.0;
  for (const double at : course) {
    if (!guard.step(bench::Loop::position, at)) return false;
    greatest = std::max(greatest, std::abs(at - guard.answer().position_rad));
  }
  if (profile && !follow_profile(work, distance, 2.0 * takes + 2.0)) return false;
  const double at = guard.answer().position_rad, error = distance - at;
  const double took = static_cast<double>(guard.samples().size() - first) * guard.period_s();
  work.meta["figures"] = {
      {"position_rev", at / kTurnRad}, {"error_at_end_rev", error / kTurnRad}, {"time_s", took}};
  if (!profile) work.meta["figures"]["greatest_error_rev"] = greatest / kTurnRad;
  if (!o.json)
    print_line(text::render(kArrived,
                            std::vector<std::string>{text::number(at / kTurnRad),
                                                     text::number(error / kTurnRad), text::number(took, 3)},
                            text::user_language()));
  return true;
}

/// Turns with a speed or torque until something ends it, then ramps down.
class Jog {
 public:
  Jog(BenchWork& work, const Mode& mode, double value)
      : work_(work), guard_(work.guard), mode_(mode), value_(value), h_(guard_.period_s()) {}

  bool run() {
    const bool torque = mode_.loop == bench::Loop::torque;
    const double rate = torque ? std::abs(value_) / kTorqueRamp_s : work_.options.acceleration * kTurnRad;
    position_ = guard_.answer().position_rad;
    guard_.stage("jog");
    double now = 0.0;
    for (;;) {
      if (ended_by_.empty() && ends()) guard_.stage("stop");
      const double wanted = ended_by_.empty() ? value_ : 0.0;
      // In pv the drive ramps by itself (6083h, 6084h).
      now = mode_.mode == OperationMode::profile_velocity
                ? wanted
                : now + std::clamp(wanted - now, -rate * h_, rate * h_);
      if (!ended_by_.empty() && now == 0.0 && stands()) break;
      position_ += now * h_;
      if (!guard_.step(mode_.loop, mode_.loop == bench::Loop::position ? position_ : now)) return false;
      time_ += h_;
      if (!ended_by_.empty() || now != value_) continue;
      speed_sum_ += guard_.speed_rad_s();
      torque_sum_ += guard_.answer().torque_nm;
      ++even_;
    }
    return true;
  }

  void tell() const {
    const double even = std::max(1, even_);
    json& meta = work_.meta;
    meta["figures"] = {{"position_rev", guard_.answer().position_rad / kTurnRad},
                       {"mean_speed_rev_s", speed_sum_ / even / kTurnRad},
                       {"mean_torque_nm", torque_sum_ / even},
                       {"ended_by", ended_by_}};
    if (!work_.options.json)
      print_line(
          text::render(kJogged,
                       std::vector<std::string>{text::number(guard_.answer().position_rad / kTurnRad, 4),
                                                text::number(speed_sum_ / even / kTurnRad, 4),
                                                text::number(torque_sum_ / even, 4), ended_by_},
                       text::user_language()));
  }

 private:
  static constexpr double kTorqueRamp_s = 0.1;

  bool stands() {
    const double speed = std::abs(guard_.speed_rad_s());
    // Torque gone it coasts; the release stops it.
    if (mode_.loop == bench::Loop::torque) return true;
    standing_ = speed < 0.1 ? standing_ + h_ : 0.0;
    return standing_ > 0.05;
  }

  bool ends() {
    const BenchOptions& o = work_.options;
    const double speed = guard_.speed_rad_s(), at = guard_.answer().position_rad;
    const double braking =
        mode_.loop == bench::Loop::torque
            ? 0.0
            : speed * speed / (2.0 * o.acceleration * kTurnRad) + 0.01 * std::abs(speed) + 0.02 * kTurnRad;
    const bool low = value_ < 0.0 && at - braking < guard_.envelope().travel_min_rad;
    const bool high = value_ > 0.0 && at + braking > guard_.envelope().travel_max_rad;
    if (low || high)
      ended_by_ = "travel";
    else if (o.duration_s > 0.0 && time_ >= o.duration_s)
      ended_by_ = "duration";
    else if (work_.drive.key().pressed())
      ended_by_ = "key";
    return !ended_by_.empty();
  }

  BenchWork& work_;
  bench::Guard& guard_;
  const Mode& mode_;
  double value_, h_, position_ = 0.0, time_ = 0.0, standing_ = 0.0;
  double speed_sum_ = 0.0, torque_sum_ = 0.0;
  int even_ = 0;
  std::string ended_by_;
};

bool jog_work(BenchWork& work, const Mode& mode, double value) {
  bench::Guard& guard = work.guard;
  const bench::Loop limit = mode.loop == bench::Loop::torque ? bench::Loop::torque : bench::Loop::velocity;
  if (!guard.accepts(limit, std::vector<double>{value}) || !guard.enable(mode.loop)) return false;
  Jog jog(work, mode, value);
  const bool done = jog.run();
  jog.tell();
  return done;
}

std::optional<double> value_of(const BenchOptions& options) {
  const auto value = number_word(options.value);
  if (!value) complain(kNoNumber, {options.value});
  return value;
}

}  // namespace

int bench_move(const BenchOptions& options) {
  const auto distance = value_of(options);
  if (!distance) return kWrongUse;
  DriveUse use = use_of(mode_named(options.mode));
  if (options.mode == "pp") {
    use.profile_speed_rev_s = options.move_speed;
    use.profile_acceleration = options.acceleration;
  }
  return on_drive("bench move", options, use,
                  [&](BenchWork& work) { return move_work(work, *distance * kTurnRad); });
}

int bench_jog(const BenchOptions& options) {
  const auto value = value_of(options);
  if (!value) return kWrongUse;
  const Mode& mode = mode_named(options.mode);
  DriveUse use = use_of(mode);
  use.key_ends = false;  // a key ends the jog by its ramp
  if (mode.mode == OperationMode::profile_velocity) use.profile_acceleration = options.acceleration;
  const double unit = mode.loop == bench::Loop::torque ? 1.0 : kTurnRad;
  return on_drive("bench jog", options, use,
                  [&](BenchWork& work) { return jog_work(work, mode, *value * unit); });
}

}  // namespace servogate::gateway::command
