// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "bench/drive/excitation/signal.hpp"
#include "bench/drive/response/frequency_response.hpp"
#include "bench/drive/response/step_figures.hpp"

namespace servogate::bench {
namespace {

constexpr double kPeriod = 0.001;
constexpr double kTurn = 2.0 * std::numbers::pi;

/// Step of a second-order system, exact.
std::vector<double> second_order(double w, double zeta, double seconds) {
  std::vector<double> y;
  const double wd = w * std::sqrt(1.0 - zeta * zeta);
  for (double t = 0.0; t < seconds; t += kPeriod)
    y.push_back(1.0 - std::exp(-zeta * w * t) * (std::cos(wd * t) + zeta * w / wd * std::sin(wd * t)));
  return y;
}

TEST(StepFigures, are_those_of_the_textbook_for_a_second_order_system) {
  const double w = 40.0, zeta = 0.3;
  const auto y = second_order(w, zeta, 2.0);
  const auto f = step_figures(y, kPeriod, 0.0, 1.0);
  ASSERT_TRUE(f && f->rise_s && f->settling_s);
  EXPECT_NEAR(f->overshoot, std::exp(-zeta * std::numbers::pi / std::sqrt(1.0 - zeta * zeta)), 1e-3);
  EXPECT_NEAR(*f->rise_s, (1.0 + 1.1 * zeta + 1.4 * zeta * zeta) / w, 0.004);
  EXPECT_NEAR(*f->settling_s, 3.9 / (zeta * w), 0.08);
  EXPECT_NEAR(f->steady_error, 0.0, 1e-6);
}

TEST(StepFigures, of_a_step_down_are_those_of_the_step_up) {
  auto y = second_order(40.0, 0.3, 2.0);
  const auto up = step_figures(y, kPeriod, 0.0, 1.0);
  for (double& v : y) v = 5.0 - 2.0 * v;
  const auto down = step_figures(y, kPeriod, 5.0, 3.0);
  ASSERT_TRUE(up && down);
  EXPECT_NEAR(*up->rise_s, *down->rise_s, 1e-9);
  EXPECT_NEAR(up->overshoot, down->overshoot, 1e-9);
  EXPECT_NEAR(2.0 * up->itae, down->itae, 1e-9);
}

TEST(StepFigures, claim_nothing_that_the_answer_does_not_show) {
  const std::vector<double> half(100, 0.5);
  const auto f = step_figures(half, kPeriod, 0.0, 1.0);
  ASSERT_TRUE(f);
  EXPECT_FALSE(f->rise_s);
  EXPECT_FALSE(f->settling_s);
  EXPECT_NEAR(f->steady_error, 0.5, 1e-12);
  EXPECT_FALSE(step_figures(half, kPeriod, 1.0, 1.0)) << "there is no step";
}

TEST(FollowingFigures, know_the_greatest_error_and_the_last) {
  const std::vector<double> wanted = {0, 1, 2, 3}, actual = {0, 0, 3, 3.5};
  const auto f = following_figures(wanted, actual, kPeriod);
  EXPECT_EQ(f.greatest, 1.0);
  EXPECT_EQ(f.at_end, -0.5);
  EXPECT_NEAR(f.root_mean_square, 0.75, 1e-12);
}

/// y = a y + b x, one sample behind, with noise on what is measured of it.
struct Lag {
  double a = 0.9, b = 0.1;
  Complex at(double hz) const {
    const Complex z = std::polar(1.0, kTurn * hz * kPeriod);
    return b / (z - a);
  }
  std::vector<double> run(const std::vector<double>& x) const {
    std::vector<double> y(x.size(), 0.0);
    for (std::size_t i = 1; i < x.size(); ++i) y[i] = a * y[i - 1] + b * x[i - 1];
    return y;
  }
};

Signal multisine(int periods) {
  Signal s;
  s.kind = SignalKind::multisine;
  s.from_hz = 2.0;
  s.to_hz = 200.0;
  s.period = 1000;
  s.periods = periods;
  return s;
}

TEST(FrequencyResponse, of_a_periodic_signal_is_exact_once_the_system_has_settled) {
  const Lag lag;
  const auto x = samples(multisine(4), kPeriod);
  const auto y = lag.run(x);
  const auto cut = [](const std::vector<double>& v) { return std::span(v).subspan(1000); };
  const auto h = frequency_response(cut(x), cut(x), cut(y), {kPeriod, 1000});
  ASSERT_EQ(h.lines.size(), 199u);
  EXPECT_EQ(h.averages, 3u);
  for (const ResponseLine& line : h.lines) {
    EXPECT_LT(std::abs(line.value / lag.at(line.hz) - 1.0), 1e-9) << line.hz;
    EXPECT_GT(line.coherence, 1.0 - 1e-9);
  }
}

TEST(FrequencyResponse, of_other_signals_by_windowed_blocks_is_right_within_their_band) {
  const Lag lag;
  Signal s;
  s.kind = SignalKind::prbs;
  s.to_hz = 400.0;
  s.period = 16'000;
  const auto x = samples(s, kPeriod);
  const auto h = frequency_response(x, x, lag.run(x), {kPeriod, 512, false});
  ASSERT_GT(h.lines.size(), 150u);
  for (const ResponseLine& line : h.lines)
    if (line.hz > 10.0 && line.hz < 200.0) {
      EXPECT_LT(std::abs(line.value / lag.at(line.hz) - 1.0), 0.08) << line.hz;
    }
}

TEST(FrequencyResponse, noise_lowers_the_coherence_and_what_drowns_in_it_is_not_claimed) {
  Lag lag;
  lag.a = 0.98;
  lag.b = 0.02;
  const auto x = samples(multisine(12), kPeriod);
  auto y = lag.run(x);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.1);
  for (double& v : y) v += noise(random);
  const auto h = frequency_response(x, x, y, {kPeriod, 1000});
  EXPECT_GE(h.valid_from_hz, 2.0 - 1e-9);
  EXPECT_LT(h.valid_to_hz, 100.0) << "beyond it there is noise alone";
  for (const ResponseLine& line : h.lines) EXPECT_GE(line.coherence, 0.9);
}

TEST(FrequencyResponse, a_reference_outside_of_the_loop_takes_the_bias_of_feedback_away) {
  // x = r - 3 y + noise: the plain ratio of spectra would see the inverse of the feedback in the noise.
  const Lag lag;
  const auto r = samples(multisine(40), kPeriod);
  std::mt19937_64 random(11);
  std::normal_distribution<double> noise(0.0, 3.0);
  std::vector<double> x(r.size(), 0.0), y(r.size(), 0.0);
  for (std::size_t i = 1; i < r.size(); ++i) {
    y[i] = lag.a * y[i - 1] + lag.b * x[i - 1];
    x[i] = r[i] - 3.0 * y[i] + noise(random);
  }
  SpectrumSettings settings{kPeriod, 1000};
  settings.least_coherence = 0.0;
  const auto h = frequency_response(r, x, y, settings);
  Complex sum;
  for (const ResponseLine& line : h.lines) sum += line.value / lag.at(line.hz);
  EXPECT_LT(std::abs(sum / static_cast<double>(h.lines.size()) - 1.0), 0.05);
}

TEST(Margins, are_those_of_an_integrator_with_a_delay) {
  // L = 2 pi 20 exp(-s 4 ms) / s: crossover at 20 Hz, phase -90 - 28.8 degrees; -180 degrees at 62.5 Hz.
  FrequencyResponse l;
  for (double hz = 1.0; hz <= 100.0; hz += 0.5)
    l.lines.push_back({hz, 20.0 / Complex(0.0, hz) * std::polar(1.0, -kTurn * hz * 0.004), 1.0});
  l.valid_from_hz = 1.0;
  l.valid_to_hz = 100.0;
  const Margins m = margins(l);
  ASSERT_TRUE(m.crossover_hz && m.gain_margin_db);
  EXPECT_NEAR(*m.crossover_hz, 20.0, 1e-6);
  EXPECT_NEAR(*m.phase_margin_deg, 61.2, 1e-6);
  EXPECT_NEAR(*m.phase_crossover_hz, 62.5, 1e-6);
  EXPECT_NEAR(*m.gain_margin_db, 9.897, 1e-3);
  l.valid_to_hz = 30.0;
  EXPECT_FALSE(margins(l).gain_margin_db) << "the crossing is beyond the valid range";
}

TEST(Margins, the_closed_loop_gives_its_open_one_and_its_bandwidth) {
  FrequencyResponse t;
  for (double hz = 0.5; hz <= 60.0; hz += 0.5)
    t.lines.push_back({hz, 1.0 / (1.0 + Complex(0.0, hz / 20.0)), 1.0});
  const auto l = open_loop_of(t);
  for (const ResponseLine& line : l.lines)
    EXPECT_LT(std::abs(line.value - 20.0 / Complex(0.0, line.hz)), 1e-9);
  const auto b = bandwidth_hz(t);
  ASSERT_TRUE(b);
  EXPECT_NEAR(*b, 20.0, 0.1);
}

TEST(Extremes, of_two_masses_are_a_dip_and_a_peak_behind_it) {
  FrequencyResponse h;
  for (double hz = 2.0; hz <= 200.0; hz += 1.0) {
    const Complex s(0.0, kTurn * hz), a(kTurn * 40.0), r(kTurn * 70.0);
    h.lines.push_back({hz, (s * s + 0.04 * a * s + a * a) / (s * (s * s + 0.04 * r * s + r * r)), 1.0});
  }
  const auto found = extremes(h);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_FALSE(found[0].peak);
  EXPECT_NEAR(found[0].hz, 40.0, 1.0);
  EXPECT_TRUE(found[1].peak);
  EXPECT_NEAR(found[1].hz, 70.0, 1.0);
}

}  // namespace
}  // namespace servogate::bench
