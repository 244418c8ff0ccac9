// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/kept.hpp"
#include "kernel/path/shape/run.hpp"

namespace servogate::path {

/// From one pass to the next: the curve and its law at places that are even in the law's time, which is the
/// clock of the next pass. Not real-time safe.
class EvenTime {
 public:
  EvenTime(int axes, double step) : axes_(axes), step_(step) {}
  void clear(double step);

  /// `places`, `controls` and `beta` of the pass before, as far as they are final. `complete`: the run ends
  /// with them, and `open` of their intervals were final before that was known. Appends path parameters at
  /// the new knots, and controls to begin with. False: nothing was to be done.
  bool work(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
            const Kept<double>& beta, bool complete, std::size_t open, Kept<double>& new_places,
            Kept<Vector>& new_controls);
  bool done() const { return done_; }
  /// Knots of the pass before that are no longer looked at.
  std::size_t needs_from() const { return at_; }
  /// s of a knot interval: of the whole run where it was known at once, so that it ends with a knot.
  double step() const { return step_; }

 private:
  bool advance(const Kept<double>& beta, double t, std::size_t known);
  void take(const Run& run, const Kept<double>& places, const Kept<Vector>& controls,
            const Kept<double>& beta, double t, Kept<double>& new_places, Kept<Vector>& new_controls);
  void put(const Run& run, const Vector& x, double place, Kept<double>& new_places,
           Kept<Vector>& new_controls);

  int axes_;
  double step_, old_step_ = 0.0;
  bool done_ = false;
  std::size_t at_ = 0, leg_ = 0;      // interval of the pass before
  double begins_ = 0.0, ends_ = 0.0;  // its times
  std::size_t next_ = 0;              // knot
  Vector before_{}, last_{};          // points at the knots before
};

}  // namespace servogate::path
