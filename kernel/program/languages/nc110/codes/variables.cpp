// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/nc110/codes/codes.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "kernel/program/languages/nc110/values/own.hpp"

namespace servogate::program::nc110::variable {
namespace {

void check(const char* name, double value, double min, double max, int column) {
  if (!(value >= min && value <= max))
    fail(Fault::variable_range, column, {name, text::number(value), text::number(min), text::number(max)});
}

void check_switch(const char* name, double value, int column) {
  if (value != 0.0 && value != 1.0)
    fail(Fault::variable_range, column, {name, text::number(value), "0", "1"});
}

void need_sync(const Execution& run, const char* name, int column) {
  if (run.block().sync != Sync::request) fail(Wrong::sync_missing, column, {name});
}

double unit(Execution& run) { return run.state().modes.unit == Function::inch ? 25.4 : 1.0; }

}  // namespace

void tmr(Execution& run, double value, int, int column) {
  check("TMR", value, 0.0, run.state().modes.feed == Function::feed_revolution ? 30000.0 : 60.0, column);
  run.state().motion.dwell = value;
}

void uov(Execution& run, double value, int, int column) {
  check("UOV", value, -99999.9999, 99999.9999, column);
  run.state().motion.allowance = value * unit(run);
}

void erf(Execution& run, double value, int, int column) {
  check("ERF", value, 0.0, 1000.0, column);
  run.state().motion.corner_error_mm = value * unit(run);
}

/// sin of the angle up to 90 degrees, 1 + sin(angle - 90) beyond. Source: specification A 13.4.
void mcd(Execution& run, double value, int, int column) {
  check("MCD", value, 0.0, 2.0, column);
  const double beyond = value > 1.0 ? 90.0 : 0.0;
  const double sine = value > 1.0 ? value - 1.0 : value;
  run.state().motion.max_angle_deg = beyond + std::asin(sine) * 180.0 / std::numbers::pi;
}

void usb(Execution& run, double value, int, int column) {
  check_switch("USB", value, column);
  std::uint16_t& levels = run.state().skip_levels;
  levels = static_cast<std::uint16_t>(value != 0.0 ? levels & ~1u : levels | 1u);
}

void uvr(Execution& run, double value, int, int column) {
  check_switch("UVR", value, column);
  run.state().motion.dry_run = value != 0.0;
}

void uso(Execution& run, double value, int, int column) {
  check_switch("USO", value, column);
  run.state().optional_stop = value != 0.0 ? 1 : 0;
}

/// Times, in seconds. The manual wants the motion before them to have ended, and G00 (specification A 19.4).
void tim(Execution& run, double value, int index, int column) {
  if (index < 1 || index > kMostTimer)
    fail(Wrong::timer_index, column, {"TIM", "1", std::to_string(kMostTimer)});
  need_sync(run, "TIM", column);
  if (run.state().modes.motion != Function::rapid) fail(Wrong::timer_rapid, column);
  run.state().own[at(Own::tim) + static_cast<std::size_t>(index)] = value;
}

/// Sums, of the format RE.
void tot(Execution& run, double value, int index, int column) {
  if (index < 0 || index > kMostTimer)
    fail(Wrong::timer_index, column, {"TOT", "0", std::to_string(kMostTimer)});
  need_sync(run, "TOT", column);
  run.state().own[at(Own::tot) + static_cast<std::size_t>(index)] =
      static_cast<double>(static_cast<float>(value));
}

void rms(Execution& run, double value, int, int column) {
  check("RMS", value, 1.0, 255.0, column);
  run.state().own[at(Own::rms)] = value;
}

void rta(Execution& run, double value, int, int column) {
  check("RTA", value, -99999.9999, 99999.9999, column);
  run.state().own[at(Own::rta)] = value * unit(run);
}

void rto(Execution& run, double value, int, int column) {
  check("RTO", value, -99999.9999, 99999.9999, column);
  run.state().own[at(Own::rto)] = value * unit(run);
}

/// The control writes it.
void rmn(Execution&, double, int, int column) { fail(Wrong::read_only, column, {"RMN"}); }

}  // namespace servogate::program::nc110::variable
