// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

/// Test signals, one value a cycle. Pure functions; not real-time safe (they allocate).
namespace servogate::bench {

enum class SignalKind : std::uint8_t {
  step,          ///< `amplitude` at once, held for `duration_s`
  ramp,          ///< from 0 to `amplitude` over `duration_s`
  trapezoid,     ///< a move by `amplitude` within `speed` and `acceleration`, then held
  jerk_limited,  ///< the same within `jerk`, too
  sine,          ///< `from_hz`
  chirp,         ///< from `from_hz` to `to_hz`, the frequency rising by a constant factor a second
  multisine,     ///< sines at whole multiples of 1 / period between `from_hz` and `to_hz`, of equal size
  prbs,          ///< pseudo-random between -amplitude and +amplitude
};

struct Signal {
  SignalKind kind = SignalKind::step;
  double amplitude = 1.0;   ///< of multisine: its root mean square; otherwise the largest value
  double duration_s = 1.0;  ///< of all but multisine and prbs, which last whole periods
  double speed = 1.0, acceleration = 10.0, jerk = 1000.0;  ///< per s, s^2, s^3; above 0
  double from_hz = 1.0, to_hz = 100.0;
  double phase_rad = 0.0;     ///< of sine, at its first value
  std::size_t period = 1024;  ///< samples of multisine; prbs has the period 2^order - 1 next to it, held
  int periods = 1;
  /// Phases of multisine, beginning of prbs. 0: the phases of Schroeder (IEEE Trans. Inf. Theory 16, 1970),
  /// which keep the largest value low against the root mean square.
  std::uint64_t seed = 0;
};

/// "step", "ramp", "trapezoid", "jerk", "sine", "chirp", "multisine", "prbs".
std::string_view signal_name(SignalKind kind) noexcept;
/// False: no such signal.
bool signal_named(std::string_view name, SignalKind& kind) noexcept;

/// The values at 0, period_s, 2 period_s ... Empty: a parameter is out of its range (period_s or duration_s
/// not above 0, a frequency at or above half the sample rate, no line of multisine in its band).
std::vector<double> samples(const Signal& signal, double period_s);

/// Where a move is at `t`, and how fast: three moving means over an even speed, so that speed, acceleration
/// and jerk stay within their limits. jerk 0: no limit of it.
struct MovePoint {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;
};
MovePoint move_at(double distance, double speed, double acceleration, double jerk, double t) noexcept;
/// How long that move takes, s.
double move_time(double distance, double speed, double acceleration, double jerk) noexcept;

}  // namespace servogate::bench
