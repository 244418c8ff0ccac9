// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/loop_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/drive/excitation/signal.hpp"

namespace servogate::bench {
namespace {

std::size_t ramp_samples(const LoopResponsePlan& plan, double period) {
  return plan.offset == 0.0 ? 0 : static_cast<std::size_t>(std::ceil(plan.ramp_s / period));
}

std::size_t tail(const LoopResponsePlan& plan) { return static_cast<std::size_t>(plan.bus_cycles) + 2; }

}  // namespace

Complex hold_response(Hold hold, double hz, double period) noexcept {
  const double angle = std::numbers::pi * hz * period;
  const Complex held = (angle == 0.0 ? 1.0 : std::sin(angle) / angle) * std::polar(1.0, -angle);
  return hold == Hold::held ? held : held * held;
}

std::vector<double> loop_excitation(const LoopResponsePlan& plan, double period) {
  Signal signal;
  signal.kind = SignalKind::multisine;
  signal.amplitude = plan.excitation;
  signal.from_hz = plan.from_hz;
  signal.to_hz = std::min(plan.to_hz, 0.45 / period);
  signal.period = plan.block;
  const std::vector<double> once = samples(signal, period);
  if (once.empty() || plan.blocks < 2) return {};
  const std::size_t ramp = ramp_samples(plan, period);
  const std::size_t n = plan.block * static_cast<std::size_t>(plan.blocks + 1) + tail(plan);
  std::vector<double> out;
  out.reserve(ramp + n);
  // The ramp ends where the excitation begins, so that nothing jumps.
  for (std::size_t i = 0; i < ramp; ++i)
    out.push_back((plan.offset + once.front()) * static_cast<double>(i) / static_cast<double>(ramp));
  for (std::size_t i = 0; i < n; ++i) out.push_back(plan.offset + once[i % once.size()]);
  return out;
}

namespace {

/// What the course of a run says.
std::optional<LoopResponse> evaluate(const LoopResponsePlan& plan, double period,
                                     const std::vector<double>& wanted, const std::vector<double>& angle,
                                     const std::vector<double>& torque) {
  const std::vector<double> speed = slope(angle, period);  // value i is of sample i + 1
  const std::size_t begin = ramp_samples(plan, period) + plan.block;
  const std::size_t length = plan.block * static_cast<std::size_t>(plan.blocks);
  const auto late = begin + static_cast<std::size_t>(plan.bus_cycles);
  const auto cut = [&](const std::vector<double>& v, std::size_t from) {
    return std::span(v).subspan(from, length);
  };
  const auto output = plan.loop == Loop::velocity   ? cut(speed, late - 1)
                      : plan.loop == Loop::position ? cut(angle, late)
                                                    : cut(torque, late);
  SpectrumSettings settings;
  settings.period_s = period;
  settings.block = plan.block;
  LoopResponse out;
  out.closed = frequency_response(cut(wanted, begin), cut(wanted, begin), output, settings);
  for (ResponseLine& line : out.closed.lines) {
    line.value /= hold_response(plan.hold, line.hz, period);
    if (plan.loop == Loop::velocity) line.value /= slope_gain(line.hz, period);
  }
  if (out.closed.lines.empty()) return std::nullopt;
  out.plant = frequency_response(cut(wanted, begin), cut(torque, late), cut(speed, late - 1), settings);
  for (ResponseLine& line : out.plant.lines) line.value /= slope_gain(line.hz, period);
  out.open = open_loop_of(out.closed);
  out.margins = margins(out.open);
  out.bandwidth_hz = bandwidth_hz(out.closed);
  out.peak_db = -300.0;
  for (const ResponseLine& line : out.closed.lines)
    if (line.hz >= out.closed.valid_from_hz && line.hz <= out.closed.valid_to_hz)
      out.peak_db = std::max(out.peak_db, 20.0 * std::log10(std::abs(line.value)));
  out.extremes = extremes(out.open);
  return out;
}

}  // namespace

std::optional<LoopResponse> take_loop_response(Guard& guard, const LoopResponsePlan& plan) {
  const double period = guard.period_s();
  const std::vector<double> wanted = loop_excitation(plan, period);
  if (wanted.empty()) return std::nullopt;
  guard.stage("response");
  const std::size_t first = guard.samples().size();
  for (const double v : wanted)
    if (!guard.step(plan.loop, v)) return std::nullopt;
  std::vector<double> angle, torque;
  for (std::size_t i = first; i < guard.samples().size(); ++i) {
    angle.push_back(guard.samples()[i].position_rad);
    torque.push_back(guard.samples()[i].torque_nm);
  }
  guard.release();
  std::optional<LoopResponse> out;
  guard.meanwhile([&] { out = evaluate(plan, period, wanted, angle, torque); });
  return out;
}

}  // namespace servogate::bench
