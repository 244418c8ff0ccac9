// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Frequency responses by averaged cross spectra. Pure functions; not real-time safe.
namespace servogate::bench {

using Complex = std::complex<double>;

/// One line of a response.
struct ResponseLine {
  double hz = 0.0;
  Complex value;
  double coherence = 0.0;  ///< 0 ... 1, of what came out with the reference; 1: nothing else was in it
  bool operator==(const ResponseLine&) const = default;
};
struct FrequencyResponse {
  std::vector<ResponseLine> lines;  ///< excited and coherent ones only, by rising frequency
  /// Where it is valid: the longest run of lines without a gap; both 0: nowhere.
  double valid_from_hz = 0.0, valid_to_hz = 0.0;
  std::size_t averages = 0;
};

/// How the spectra are taken.
struct SpectrumSettings {
  double period_s = 0.001;  ///< between two samples
  std::size_t block = 1024;
  /// The reference repeats every block: no window, no overlap. Otherwise Hann's with half overlap.
  bool periodic = true;
  double least_coherence = 0.9;
  double least_excitation = 1e-3;  ///< of the strongest line of the reference, as a share of its amplitude
};

/// From `input` to `output`, both as far as they follow `reference`, so that noise in either and a closed
/// loop around them bias nothing: S_ro / S_ri. All of the same length, of at least one block; coherence
/// needs two. Without a reference of its own give `input`. Source: Pintelon and Schoukens, System
/// Identification, 2nd edition, 2.6 and 7.2 (periodic signals, indirect method).
FrequencyResponse frequency_response(std::span<const double> reference, std::span<const double> input,
                                     std::span<const double> output, const SpectrumSettings& settings);

/// Slope of `values` by central differences, one value shorter at each end: sample i is at i + 1.
std::vector<double> slope(std::span<const double> values, double period_s);
/// What central differences make of a sine of that frequency: they give the slope times this.
double slope_gain(double hz, double period_s) noexcept;

/// Margins of an open loop L, at the first crossings within its valid range; nullopt: there is no crossing.
struct Margins {
  std::optional<double> crossover_hz;      ///< |L| = 1
  std::optional<double> phase_margin_deg;  ///< there
  std::optional<double> phase_crossover_hz;
  std::optional<double> gain_margin_db;  ///< there
};
Margins margins(const FrequencyResponse& open_loop);
/// L = T / (1 - T) of a loop with unit feedback that answers its reference by T.
FrequencyResponse open_loop_of(const FrequencyResponse& closed_loop);
/// Where |T| has fallen by 3 dB below its first line, for good within the range; nullopt: it has not.
std::optional<double> bandwidth_hz(const FrequencyResponse& closed_loop);

/// Peaks and dips of |H| that stand out by `least_db` on both sides, by rising frequency.
struct Extreme {
  double hz = 0.0, db = 0.0;
  bool peak = true;
};
std::vector<Extreme> extremes(const FrequencyResponse& response, double least_db = 3.0);

}  // namespace servogate::bench
