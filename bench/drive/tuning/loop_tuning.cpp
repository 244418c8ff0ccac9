// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/tuning/loop_tuning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kLeastPositionGain = 1.0;  ///< 1/s

Complex controller(const LoopGains& g, double hz) {
  const Complex pi = g.velocity_gain * (1.0 + g.velocity_integral / Complex(0.0, kTurn * hz));
  return g.notch_hz > 0.0 ? pi * notch_at({g.notch_hz, std::max(1e-3, g.notch_depth)}, hz) : pi;
}

bool valid(const FrequencyResponse& r, double hz) { return hz >= r.valid_from_hz && hz <= r.valid_to_hz; }

double db(double ratio) { return 20.0 * std::log10(std::max(ratio, 1e-15)); }

FrequencyResponse closed_of(FrequencyResponse open) {
  for (ResponseLine& line : open.lines) line.value = line.value / (1.0 + line.value);
  return open;
}

double sensitivity_db_of(const FrequencyResponse& open) {
  double greatest = 0.0;
  for (const ResponseLine& line : open.lines)
    if (valid(open, line.hz)) greatest = std::max(greatest, 1.0 / std::abs(1.0 + line.value));
  return db(greatest);
}

double peak_db_of(const FrequencyResponse& closed) {
  double greatest = 0.0;
  for (const ResponseLine& line : closed.lines)
    if (valid(closed, line.hz)) greatest = std::max(greatest, std::abs(line.value));
  return db(greatest);
}

/// At the end of the range: nothing is measured beyond it, and the loop has to be quiet there.
double last_db(const FrequencyResponse& open) {
  double last = 0.0;
  for (const ResponseLine& line : open.lines)
    if (valid(open, line.hz)) last = std::abs(line.value);
  return db(last);
}

bool keeps(const Tuning& t, const FrequencyResponse& open, const TuningWish& wish) {
  if (t.velocity.phase_margin_deg.value_or(-1.0) < wish.phase_margin_deg) return false;
  if (t.velocity.gain_margin_db && *t.velocity.gain_margin_db < wish.gain_margin_db) return false;
  if (!t.velocity.gain_margin_db && last_db(open) > -wish.gain_margin_db) return false;
  if (wish.most_crossover_hz > 0.0 && t.velocity.crossover_hz.value_or(1e300) > wish.most_crossover_hz)
    return false;
  return t.sensitivity_db <= wish.sensitivity_db;
}

/// K / s on the closed velocity loop, which is 1 below its range.
FrequencyResponse position_loop(const FrequencyResponse& closed_velocity, double gain) {
  FrequencyResponse open;
  open.valid_to_hz = closed_velocity.valid_to_hz;
  constexpr int kBelow = 200;
  const double first = closed_velocity.valid_from_hz;
  // Below where the softest gain crosses, whatever the range.
  open.valid_from_hz = std::min(first / 100.0, 0.5 * kLeastPositionGain / kTurn);
  for (int i = 0; i < kBelow; ++i) {
    const double hz =
        open.valid_from_hz * std::pow(first / open.valid_from_hz, static_cast<double>(i) / kBelow);
    open.lines.push_back({hz, gain / Complex(0.0, kTurn * hz), 1.0});
  }
  for (const ResponseLine& line : closed_velocity.lines)
    if (valid(closed_velocity, line.hz))
      open.lines.push_back({line.hz, gain / Complex(0.0, kTurn * line.hz) * line.value, line.coherence});
  return open;
}

double stiffest_position_gain(const FrequencyResponse& closed_velocity, const TuningWish& wish) {
  double best = 0.0;
  for (double gain = kLeastPositionGain; gain < 2000.0; gain *= 1.05) {
    const FrequencyResponse open = position_loop(closed_velocity, gain);
    const Margins m = margins(open);
    const bool good = m.phase_margin_deg.value_or(0.0) >= 60.0 &&
                      m.gain_margin_db.value_or(100.0) >= wish.gain_margin_db &&
                      peak_db_of(closed_of(open)) <= wish.position_peak_db;
    if (!good) break;
    best = gain;
  }
  return best;
}

}  // namespace

Complex notch_at(const Notch& notch, double hz) noexcept {
  const Complex s(0.0, hz / notch.hz);
  return (s * s + 2.0 * notch.damping * s + 1.0) / (s * s + 2.0 * s + 1.0);
}

FrequencyResponse velocity_loop(const FrequencyResponse& plant, const LoopGains& gains, double delay) {
  FrequencyResponse out = plant;
  for (ResponseLine& line : out.lines)
    line.value *= controller(gains, line.hz) * std::polar(1.0, -kTurn * line.hz * delay);
  return out;
}

FrequencyResponse with_gains(const FrequencyResponse& open_loop, const LoopGains& present,
                             const LoopGains& wanted) {
  FrequencyResponse out = open_loop;
  for (ResponseLine& line : out.lines)
    line.value *= controller(wanted, line.hz) / controller(present, line.hz);
  return out;
}

std::optional<Tuning> expect(const FrequencyResponse& open_loop, const LoopGains& present,
                             const LoopGains& wanted) {
  const FrequencyResponse open = with_gains(open_loop, present, wanted);
  Tuning t;
  t.gains = wanted;
  t.velocity = margins(open);
  if (!t.velocity.crossover_hz) return std::nullopt;
  t.sensitivity_db = sensitivity_db_of(open);
  t.closed = closed_of(open);
  t.velocity_bandwidth_hz = bandwidth_hz(t.closed).value_or(0.0);
  if (wanted.position_gain > 0.0) t.position = margins(position_loop(t.closed, wanted.position_gain));
  return t;
}

std::optional<Tuning> tune(const FrequencyResponse& open_loop, const LoopGains& present,
                           const TuningWish& wish, const Notch* notch) {
  constexpr double kStep = 1.04;
  std::optional<Tuning> best;
  for (double times = wish.most_times; times >= 1.0 / wish.most_times && !best; times /= kStep) {
    LoopGains g = present;
    if (notch != nullptr) {
      g.notch_hz = notch->hz;
      g.notch_depth = notch->damping;
    }
    g.velocity_gain = present.velocity_gain * times;
    // An integral rate as a share of the crossover costs its angle: atan(share).
    for (const double share : {0.35, 0.3, 0.25, 0.2, 0.15, 0.1}) {
      g.velocity_integral = 0.0;
      const auto rough = expect(open_loop, present, g);
      if (!rough) break;
      g.velocity_integral = share * kTurn * *rough->velocity.crossover_hz;
      const auto now = expect(open_loop, present, g);
      if (!now || !keeps(*now, with_gains(open_loop, present, g), wish)) continue;
      best = now;
      break;
    }
  }
  if (!best) return best;
  best->gains.position_gain = stiffest_position_gain(best->closed, wish);
  best->position = best->gains.position_gain > 0.0
                       ? margins(position_loop(best->closed, best->gains.position_gain))
                       : Margins{};
  return best;
}

std::optional<Notch> notch_for(const FrequencyResponse& open_loop) {
  const Margins m = margins(open_loop);
  std::optional<Notch> best;
  double strongest = -300.0;
  for (const Extreme& e : extremes(open_loop)) {
    if (!e.peak || (m.crossover_hz && e.hz < *m.crossover_hz) || e.db <= strongest) continue;
    strongest = e.db;
    best = Notch{e.hz, 0.2};
  }
  return best;
}

// y(t) = 2 / pi times the integral of Re T(w) sin(w t) / w: the answer of a causal loop follows from the real
// part alone. Between two lines Re T is a straight line.
std::vector<double> step_of(const FrequencyResponse& closed, double period, double seconds) {
  std::vector<double> hz, real;
  for (const ResponseLine& line : closed.lines) {
    if (!valid(closed, line.hz)) continue;
    if (hz.empty()) {
      hz.push_back(0.0);
      real.push_back(1.0);
    }
    // The end of the range is no edge: it would ring.
    const double share = line.hz / closed.valid_to_hz;
    const double fade = share < 0.8 ? 1.0 : 0.5 + 0.5 * std::cos(std::numbers::pi * (share - 0.8) / 0.2);
    hz.push_back(line.hz);
    real.push_back(line.value.real() * fade);
  }
  std::vector<double> y;
  if (hz.size() < 2) return y;
  constexpr int kFine = 8;
  for (double t = 0.0; t < seconds; t += period) {
    double sum = 0.0;
    for (std::size_t i = 1; i < hz.size(); ++i)
      for (int k = 0; k < kFine; ++k) {
        const double at = (k + 0.5) / kFine, f = hz[i - 1] + at * (hz[i] - hz[i - 1]);
        const double re = real[i - 1] + at * (real[i] - real[i - 1]);
        sum += re * std::sin(kTurn * f * t) / f * (hz[i] - hz[i - 1]) / kFine;
      }
    y.push_back(2.0 / std::numbers::pi * sum);
  }
  return y;
}

}  // namespace servogate::bench
