// SPDX-License-Identifier: Apache-2.0
// `servogate bench identify`: what motor and load are.
#include "bench/drive/measurement/identify.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bench/bench.hpp"
#include "gateway/command/bench/session.hpp"

namespace servogate::gateway::command {
namespace {

using canopen::OperationMode;
using canopen::supported_bit;
using nlohmann::json;

json of_response(const bench::Identified& f) {
  json rows = json::array();
  for (const bench::ResponseLine& line : f.response.lines)
    rows.push_back({{"hz", line.hz},
                    {"db", 20.0 * std::log10(std::abs(line.value))},
                    {"deg", std::arg(line.value) * 360.0 / kTurnRad},
                    {"coherence", line.coherence},
                    {"model_db", 20.0 * std::log10(std::abs(bench::response_of(f.masses, line.hz)))}});
  return rows;
}

void put_identified(const bench::Identified& f, json& meta) {
  meta["friction"] = {
      {"coulomb_nm", f.friction.coulomb_nm},       {"viscous_nm_s_rad", f.friction.viscous_nm_s},
      {"stribeck_nm", f.friction.stribeck_nm},     {"stribeck_speed_rad_s", f.friction.stribeck_speed_rad_s},
      {"breakaway_nm", f.friction.breakaway_nm()}, {"load_nm", f.friction.load_nm},
      {"residual_nm", f.friction.residual_nm}};
  for (const bench::FrictionPoint& p : f.friction_points)
    meta["friction_points"].push_back(
        {{"speed_rev_s", p.speed_rad_s / kTurnRad}, {"torque_nm", p.torque_nm}});
  meta["inertia_kg_m2"] = f.masses.inertia_kg_m2;
  if (const auto& c = f.masses.coupling)
    meta["coupling"] = {
        {"motor_inertia_kg_m2", c->motor_inertia_kg_m2}, {"load_inertia_kg_m2", c->load_inertia_kg_m2},
        {"stiffness_nm_rad", c->stiffness_nm_rad},       {"damping_nm_s_rad", c->damping_nm_s},
        {"antiresonance_hz", c->antiresonance_hz},       {"resonance_hz", c->resonance_hz}};
  if (f.cogging)
    meta["cogging"] = {{"amplitude_nm", f.cogging->amplitude_nm}, {"periods", f.cogging->periods}};
  if (f.lost_motion)
    meta["lost_motion"] = {{"backlash_rad", f.lost_motion->backlash_rad},
                           {"stiffness_nm_rad", f.lost_motion->stiffness_nm_rad},
                           {"deviation_rad", f.lost_motion->deviation_rad}};
  meta["command_delay_ms"] = f.command_delay_s ? json(*f.command_delay_s * 1e3) : json(nullptr);
  meta["misfit"] = f.masses.misfit;
  meta["valid_hz"] = {f.response.valid_from_hz, f.response.valid_to_hz};
  meta["response"] = of_response(f);
}

void say_identified(const bench::Identified& f) {
  print_formatted("inertia                 %.4g kg m2\n", f.masses.inertia_kg_m2);
  print_formatted("friction                %.4g N m Coulomb, %.4g N m s/rad viscous, %.4g N m breakaway\n",
                  f.friction.coulomb_nm, f.friction.viscous_nm_s, f.friction.breakaway_nm());
  if (f.cogging)
    print_formatted("cogging                 %.4g N m, %d periods in a turn\n", f.cogging->amplitude_nm,
                    f.cogging->periods);
  if (const auto& c = f.masses.coupling)
    print_formatted(
        "resonance               %.1f Hz, antiresonance %.1f Hz; load %.4g kg m2 behind %.4g N m/rad\n",
        c->resonance_hz, c->antiresonance_hz, c->load_inertia_kg_m2, c->stiffness_nm_rad);
  if (f.lost_motion) print_formatted("backlash                %.4g rad\n", f.lost_motion->backlash_rad);
  if (f.command_delay_s) print_formatted("command to measurement  %.2f ms\n", *f.command_delay_s * 1e3);
  print_formatted("response valid from     %.1f to %.1f Hz, misfit %.1f %%\n", f.response.valid_from_hz,
                  f.response.valid_to_hz, 100.0 * f.masses.misfit);
}

bool identify_work(BenchWork& work) {
  const BenchOptions& o = work.options;
  bench::Guard& guard = work.guard;
  bench::IdentifyPlan plan;
  plan.slow_rad_s = o.slowest_rev_s * kTurnRad;
  plan.fast_rad_s = 0.8 * guard.envelope().speed_rad_s;
  plan.bias_rad_s = 0.5 * plan.fast_rad_s;
  plan.torque_nm = o.excitation_nm;
  plan.from_hz = o.from_hz;
  plan.to_hz = o.to_hz;
  plan.lost_motion = !o.no_lost_motion;
  // Nothing gets power that does not fit.
  const bench::Reach reach = bench::reach_of(plan, guard.period_s());
  if (!guard.accepts_travel(reach.from_rad, reach.to_rad) || !guard.enable(bench::Loop::velocity))
    return false;
  const auto found = bench::identify(guard, plan, work.why);
  if (!found) return false;
  put_identified(*found, work.meta);
  if (!o.json) say_identified(*found);
  return true;
}

}  // namespace

int bench_identify(const BenchOptions& options) {
  DriveUse use;
  use.modes =
      supported_bit(OperationMode::cyclic_sync_velocity) | supported_bit(OperationMode::cyclic_sync_torque);
  return on_drive("bench identify", options, use, identify_work);
}

}  // namespace servogate::gateway::command
