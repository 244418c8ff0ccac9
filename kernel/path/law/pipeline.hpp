// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "kernel/path/law/estimate.hpp"
#include "kernel/path/law/even_time.hpp"
#include "kernel/path/law/knot.hpp"
#include "kernel/path/law/speed_windows.hpp"
#include "kernel/path/shape/tube_windows.hpp"

namespace servogate::path {

/// A way along a line or an arc at constant speed between two runs.
struct Cruise {
  Piece piece;
  double seconds = 0.0;
};

/// Where knots go, in order.
class KnotSink {
 public:
  /// A run begins; the two controls before that of its first knot.
  virtual void begin(const Vector& before_last, const Vector& last) = 0;
  /// The next knot of the run, the first one at its start.
  virtual void put(const Knot& knot) = 0;
  /// The last knot was the rest at the end of the run.
  virtual void rest() = 0;
  /// The last knot was where the cruise begins; behind it another run begins.
  virtual void cruise(const Cruise& cruise) = 0;

 protected:
  ~KnotSink() = default;
};

/// Shape and law over one clock: elements of a run in, knots out. The first clock is an estimate; each pass
/// makes a curve in the tolerance that is smooth in the clock, then the law on it, whose time is the clock of
/// the next pass. What is put depends on the legs alone, never on when they come; it is final. Memory is
/// bounded by windows, not by the run. Not real-time safe.
class Pipeline {
 public:
  struct Settings {
    int axes = 3;
    double reserve = 0.01;  ///< share of the limits that stays for a change of rate
    const Transformation* transformation = &identity();  ///< from the legs' coordinates to the axes
    int passes = 2;
  };
  struct Counts {
    std::int64_t runs = 0, knots = 0;
    /// Places that the curve of the last pass could not be brought near enough to by the pairing of place and
    /// parameter; mostly another pairing keeps the tolerance.
    std::int64_t released = 0;
    std::int64_t outside = 0;   ///< and where no other one does: the tolerance is broken there
    std::int64_t failed = 0;    ///< windows of the last pass without a law inside of the limits
    std::int64_t repaired = 0;  ///< windows mended by the judge
    std::int64_t tube_steps = 0, law_steps = 0;  ///< of Newton's method by knots
    std::int64_t windows = 0;                    ///< of curves and laws, in all passes
  };

  Pipeline(const Settings& settings, KnotSink& sink);

  /// The next element, from where the one before ends. Behind the end of a run that is not planned yet it
  /// waits, as all that follows does.
  void add(const Leg& leg);
  /// The run rests behind the last element; the next one begins another run.
  void end();
  /// The run goes on along `leg`, a line or an arc, at a constant speed of its parameter; the next element
  /// begins another run, at that speed.
  void cruise(const Leg& leg, double speed);
  /// Forgets the run in work, and what waits behind it.
  void abandon();
  /// There is no law inside of the limits for what comes next in this run; nothing more of it is put.
  bool broken() const { return broken_; }
  /// Plans one window of the curve or of the law, where what it looks at is known, and puts what comes of it.
  /// Call it after some elements, and after end(), until it has nothing to do: false.
  bool work();
  const Counts& counts() const { return counts_; }
  /// Legs and knots that are kept now, for tests of memory.
  std::size_t kept() const;

 private:
  struct Pass {
    Pass(const TubeWindows::Settings& t, const SpeedWindows::Settings& s, int axes)
        : even(axes, 0.0), tube(t), speed(s) {}
    EvenTime even;  // from the pass before; not of the first
    TubeWindows tube;
    SpeedWindows speed;
    Kept<double> places, beta;
    Kept<Vector> start, controls;
  };
  /// What comes: an element, or the end of a run.
  struct Order {
    enum class Kind : std::uint8_t { leg, rest, cruise };
    Kind kind = Kind::leg;
    Leg leg;             // not of a rest
    double speed = 0.0;  // of a cruise
  };
  void begin_run();
  void take(const Order& order);
  void close_run();
  bool advance();
  bool work_pass(std::size_t n);
  bool make_places(std::size_t n);
  void forget();
  void count(const Pass& pass);
  void publish();
  double step_of(const Leg& leg) const;

  Settings settings_;
  KnotSink& sink_;
  Counts counts_;
  Run run_;
  bool begun_ = false, broken_ = false;
  std::optional<Order> end_;  // of the run in work
  std::deque<Order> behind_;  // it
  ClockEstimate estimate_;
  std::vector<std::unique_ptr<Pass>> passes_;
  std::size_t published_ = 0;  // knots
  std::size_t leg_ = 0;        // of the last one
  LawTime time_;
};

}  // namespace servogate::path
