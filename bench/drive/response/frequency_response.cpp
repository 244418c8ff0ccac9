// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/response/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <kissfft/kissfft.hh>
#include <numbers>

namespace servogate::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Spectrum of one block, its mean taken out.
class Spectra {
 public:
  Spectra(std::size_t block, bool window) : fft_(block, false), window_(block, 1.0), in_(block) {
    if (window)
      for (std::size_t i = 0; i < block; ++i)
        window_[i] = 0.5 - 0.5 * std::cos(kTurn * static_cast<double>(i) / static_cast<double>(block));
  }
  void take(std::span<const double> block, std::vector<Complex>& out) {
    double mean = 0.0;
    for (const double v : block) mean += v;
    mean /= static_cast<double>(block.size());
    for (std::size_t i = 0; i < in_.size(); ++i) in_[i] = (block[i] - mean) * window_[i];
    out.resize(in_.size());
    fft_.transform(in_.data(), out.data());
  }

 private:
  kissfft<double> fft_;
  std::vector<double> window_;
  std::vector<Complex> in_;
};

struct Sums {
  Complex ri, ro;
  double rr = 0.0, oo = 0.0;
};

void find_valid_range(FrequencyResponse& response, double step_hz) {
  std::size_t best = 0, first = 0;
  const auto& lines = response.lines;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i > 0 && lines[i].hz - lines[i - 1].hz > 1.5 * step_hz) first = i;
    if (i - first + 1 <= best) continue;
    best = i - first + 1;
    response.valid_from_hz = lines[first].hz;
    response.valid_to_hz = lines[i].hz;
  }
}

double db_of(Complex v) { return 20.0 * std::log10(std::max(std::abs(v), 1e-300)); }

/// Share of the way from a to b at which `level` is.
double share(double a, double b, double level) { return b == a ? 0.0 : (level - a) / (b - a); }
double between(double a, double b, double x) { return a + x * (b - a); }

}  // namespace

FrequencyResponse frequency_response(std::span<const double> reference, std::span<const double> input,
                                     std::span<const double> output, const SpectrumSettings& s) {
  FrequencyResponse response;
  const std::size_t n = std::min({reference.size(), input.size(), output.size()});
  if (s.block < 4 || n < s.block) return response;
  Spectra spectra(s.block, !s.periodic);
  std::vector<Sums> sums(s.block / 2);
  std::vector<Complex> r, i, o;
  for (std::size_t at = 0; at + s.block <= n; at += s.periodic ? s.block : s.block / 2) {
    spectra.take(reference.subspan(at, s.block), r);
    spectra.take(input.subspan(at, s.block), i);
    spectra.take(output.subspan(at, s.block), o);
    for (std::size_t k = 1; k < sums.size(); ++k) {
      sums[k].ri += std::conj(r[k]) * i[k];
      sums[k].ro += std::conj(r[k]) * o[k];
      sums[k].rr += std::norm(r[k]);
      sums[k].oo += std::norm(o[k]);
    }
    ++response.averages;
  }
  double strongest = 0.0;
  for (const Sums& sum : sums) strongest = std::max(strongest, sum.rr);
  const double line_hz = 1.0 / (static_cast<double>(s.block) * s.period_s);
  double step_hz = 0.0, last_hz = 0.0;
  for (std::size_t k = 1; k < sums.size(); ++k) {
    const Sums& sum = sums[k];
    if (!(sum.rr > strongest * s.least_excitation * s.least_excitation) || std::abs(sum.ri) == 0.0) continue;
    const double hz = static_cast<double>(k) * line_hz;
    if (last_hz > 0.0) step_hz = step_hz > 0.0 ? std::min(step_hz, hz - last_hz) : hz - last_hz;
    last_hz = hz;
    const double coherence = sum.oo > 0.0 ? std::min(1.0, std::norm(sum.ro) / (sum.rr * sum.oo)) : 0.0;
    if (coherence < s.least_coherence) continue;
    response.lines.push_back({hz, sum.ro / sum.ri, coherence});
  }
  find_valid_range(response, step_hz > 0.0 ? step_hz : line_hz);
  return response;
}

std::vector<double> slope(std::span<const double> values, double h) {
  std::vector<double> out;
  if (values.size() < 3) return out;
  out.resize(values.size() - 2);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = (values[i + 2] - values[i]) / (2.0 * h);
  return out;
}

double slope_gain(double hz, double h) noexcept {
  const double x = kTurn * hz * h;
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}

Margins margins(const FrequencyResponse& open_loop) {
  Margins m;
  double phase_before = 0.0, db_before = 0.0, hz_before = 0.0;
  for (const ResponseLine& line : open_loop.lines) {
    if (line.hz < open_loop.valid_from_hz || line.hz > open_loop.valid_to_hz) continue;
    double phase = std::arg(line.value) * 180.0 / std::numbers::pi;
    if (hz_before == 0.0 && phase > 90.0) phase -= 360.0;  // a loop lags
    if (hz_before > 0.0) phase -= 360.0 * std::round((phase - phase_before) / 360.0);
    const double db = db_of(line.value);
    if (hz_before > 0.0) {
      if (!m.crossover_hz && db_before >= 0.0 && db < 0.0) {
        const double x = share(db_before, db, 0.0);
        m.crossover_hz = between(hz_before, line.hz, x);
        m.phase_margin_deg = 180.0 + between(phase_before, phase, x);
      }
      if (!m.phase_crossover_hz && phase_before > -180.0 && phase <= -180.0) {
        const double x = share(phase_before, phase, -180.0);
        m.phase_crossover_hz = between(hz_before, line.hz, x);
        m.gain_margin_db = -between(db_before, db, x);
      }
    }
    phase_before = phase;
    db_before = db;
    hz_before = line.hz;
  }
  return m;
}

FrequencyResponse open_loop_of(const FrequencyResponse& closed_loop) {
  FrequencyResponse out = closed_loop;
  for (ResponseLine& line : out.lines) line.value = line.value / (1.0 - line.value);
  return out;
}

std::optional<double> bandwidth_hz(const FrequencyResponse& t) {
  if (t.lines.empty()) return std::nullopt;
  const double limit = db_of(t.lines.front().value) - 20.0 * std::log10(std::numbers::sqrt2);
  for (std::size_t i = t.lines.size(); i-- > 0;) {
    const double db = db_of(t.lines[i].value);
    if (db < limit) continue;
    if (i + 1 == t.lines.size()) return std::nullopt;
    const double next = db_of(t.lines[i + 1].value);
    return between(t.lines[i].hz, t.lines[i + 1].hz, share(db, next, limit));
  }
  return std::nullopt;
}

std::vector<Extreme> extremes(const FrequencyResponse& response, double least_db) {
  std::vector<Extreme> out;
  const auto& lines = response.lines;
  if (lines.size() < 3) return out;
  std::vector<double> db;
  for (const ResponseLine& line : lines) db.push_back(db_of(line.value));
  // A peak or dip counts once the curve has left it by least_db. The first side is not asked for: a curve
  // that begins by falling has no peak at its first line.
  std::size_t high = 0, low = 0;
  int rising = 0;
  for (std::size_t i = 1; i < db.size(); ++i) {
    if (db[i] > db[high]) high = i;
    if (db[i] < db[low]) low = i;
    if (rising >= 0 && db[i] < db[high] - least_db) {
      if (rising > 0) out.push_back({lines[high].hz, db[high], true});
      rising = -1;
      low = i;
    } else if (rising <= 0 && db[i] > db[low] + least_db) {
      if (rising < 0) out.push_back({lines[low].hz, db[low], false});
      rising = 1;
      high = i;
    }
  }
  return out;
}

}  // namespace servogate::bench
