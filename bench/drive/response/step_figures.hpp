// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>

/// Figures of an answer in time. Pure functions; not real-time safe.
namespace servogate::bench {

/// How something followed a step from `from` to `to` that was asked for at the first sample.
struct StepFigures {
  std::optional<double> dead_s;      ///< until 5 % of the step; nullopt: never
  std::optional<double> rise_s;      ///< from 10 % to 90 %; nullopt: 90 % is never reached
  double overshoot = 0.0;            ///< beyond `to`, as a share of the step; 0: none
  std::optional<double> settling_s;  ///< until it stays within `band` of the step for good
  double steady_error = 0.0;         ///< `to` less the mean of the last tenth
  double iae = 0.0, itae = 0.0;      ///< integral of |error|, and of t * |error|
};
/// `actual` with one value every `period_s`, of at least 10; `band` as a share of the step. nullopt: there is
/// no step, or too little of an answer.
std::optional<StepFigures> step_figures(std::span<const double> actual, double period_s, double from,
                                        double to, double band = 0.02);

/// How a wanted course was followed.
struct FollowingFigures {
  double greatest = 0.0, root_mean_square = 0.0, at_end = 0.0;  ///< wanted less actual; at_end with its sign
  double itae = 0.0;
};
/// Both of the same length.
FollowingFigures following_figures(std::span<const double> wanted, std::span<const double> actual,
                                   double period_s);

}  // namespace servogate::bench
