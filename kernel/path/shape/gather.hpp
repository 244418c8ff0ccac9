// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/path/shape/run.hpp"

namespace servogate::path {

/// Where runs go, in order.
class RunSink {
 public:
  virtual void put(const Leg& leg) = 0;
  /// The run goes on along a line or an arc at a constant speed of its parameter: `leg`; behind it another
  /// run begins, at that speed.
  virtual void cruise(const Leg& leg, double speed) = 0;
  /// The run ends behind what was put.
  virtual void rest(bool confirm) = 0;

 protected:
  ~RunSink() = default;
};

/// The path does not rest behind this element by its own transition.
bool goes_on(const Element& element);

/// And it rests between the two, by their corner.
bool rests_between(const Config& config, const Transition& transition, const Piece& before,
                   const Element& element, const Piece& piece);

/// Programmed elements as runs from rest to rest: exact shapes, and rests where the program asks for them.
/// What happens at corners inside a run is the curve's. Not real-time safe.
class Gather {
 public:
  Gather(const Config& config, RunSink& sink) : config_(config), sink_(sink) {}

  /// Forgets the open run; the path goes on at `at`.
  void restart(const Vector& at);
  /// False: the element cannot be driven, last_flaw() says why, and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return flaw_; }
  /// The path rests behind the elements added so far.
  void finish() { rest(false); }
  /// End of the elements added so far.
  const Vector& position() const { return at_; }
  /// The open run does not go on into an element of this shape.
  bool rests_before(const Element& element, const Piece& piece) const {
    return open_ && rests_between(config_, before_, last_, element, piece);
  }
  bool open() const { return open_; }

 private:
  void put(const Element& element, const Piece& piece);
  void rest(bool confirm);
  bool put_with_cruise(const Leg& leg);
  double cruise_speed(const Leg& leg, double& end) const;
  double bulge() const;

  Config config_;
  RunSink& sink_;
  Flaw flaw_ = Flaw::none;
  Vector at_{};
  bool open_ = false;  ///< a run is
  Transition before_;  ///< of its last element
  Piece last_;
};

}  // namespace servogate::path
