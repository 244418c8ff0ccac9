// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "kernel/path/s_curve.hpp"
#include "kernel/path/track.hpp"

namespace servogate::path {

enum class FollowerState : std::uint8_t {
  idle,      ///< at rest, nothing to do
  moving,    ///< on the path (or about to start in the next cycle)
  holding,   ///< slowing down because of hold(), override 0 or stop()
  held,      ///< at rest on the path because of hold() or override 0
  at_stop,   ///< at rest at an exact stop that waits for release_stop()
  at_event,  ///< at rest at an event that waits for release_event()
  stopped,   ///< at rest after stop(); waits for Planner::restart()
  fault,  ///< the planner restarted elsewhere than the follower stands; set_position() or restart() clears it
};

/// The set-point of one cycle.
struct Sample {
  Vector position{}, velocity{}, acceleration{};  ///< mm, mm/s, mm/s2 (degrees)
  double feed = 0.0;                              ///< speed along the path, mm/s over the linear axes
  double distance_to_go = 0.0;                    ///< path length to the end of the block in motion
  Vector target{};                                ///< end point of the block in motion
  Tag tag;                                        ///< block in motion (or the last one)
  FollowerState state = FollowerState::idle;
  bool rapid = false;         ///< the block in motion is a rapid
  std::uint32_t event = 0;    ///< at_event: which
  std::uint32_t starved = 0;  ///< cycles so far in which planning was late
};

/// The motion inside the cycle: owns place, speed and acceleration along the path. All functions are
/// real-time safe (the constructor is not) and are called by one thread, the cycle. A wish given before
/// step() acts in that step.
class Follower {
 public:
  Follower(const Config& config, Track& track);

  /// Advances exactly one cycle. `visible`: how many entries of the track it may see, Track::visible() or a
  /// recorded value of it; never less than before.
  Sample step(std::uint64_t visible) noexcept;

  /// Slows down on the path at once and rests there until resume().
  void hold() noexcept { hold_ = true; }
  void resume() noexcept { hold_ = false; }
  /// Feed override, 0 - Config::largest_override (clamped); 0 holds. Rapids follow it up to 1.
  void set_override(double ratio) noexcept;
  double override_ratio() const noexcept { return override_; }
  /// Commanded speed of the spindle, revolutions a second without sign: elements with a feed per revolution
  /// follow it from the next step on, up to Config::largest_override times what they are planned for, and
  /// rest while it is 0. Below 0, as at the beginning: no such spindle, they are driven as planned.
  void set_spindle(double revolutions) noexcept;
  /// The path rests only because the spindle does.
  bool waits_for_spindle() const noexcept { return !rest_asked() && spindle_stands() && at_rest(); }
  /// Goes on behind the event that is being reported; ignored otherwise.
  void release_event() noexcept;
  /// Goes on behind an exact stop that waits; ignored otherwise.
  void release_stop() noexcept;
  /// Slows down on the path to rest, then drops what is left up to the next Planner::restart().
  void stop() noexcept { stopping_ = true; }
  /// Drops at once all that lies before the begin of a new path, whose restart entry is published: how much a
  /// given-up path had still put into the track makes no difference to the new one. Only at rest.
  void skip_to(const Track::Begin& begin) noexcept;
  /// Moves the set-point without motion (homing, drives off). False, and nothing done, while moving or with a
  /// path begun.
  bool set_position(const Vector& at) noexcept;
  /// True while neither speed nor acceleration is present.
  bool at_rest() const noexcept { return state_.v == 0.0 && state_.a == 0.0; }

 private:
  void take_entries(std::uint64_t visible) noexcept;
  void raise(const Span& update) noexcept;
  void start() noexcept;
  void pass_markers() noexcept;
  void drop() noexcept;
  bool pass_marker(const Entry& entry) noexcept;
  void enter() noexcept;
  void leave() noexcept;
  Goal goal(const MotionState& from) const noexcept;
  bool replan() noexcept;
  bool bridge() noexcept;
  bool bridge_clears(const Profile& way, int spans, const Box& least) const noexcept;
  void pass_spans() noexcept;
  void advance() noexcept;
  bool rest_asked() const noexcept { return hold_ || stopping_ || override_ <= 0.0; }
  bool wants_rest() const noexcept { return rest_asked() || spindle_stands(); }
  bool spindle_stands() const noexcept;
  double spindle_share(const Span& span) const noexcept;
  void locate() noexcept;
  FollowerState report() const noexcept;
  Sample sample() noexcept;
  const Entry& front() const noexcept { return window_[first_ % window_.size()]; }
  Entry& entry_at(std::uint64_t n) noexcept { return window_[n % window_.size()]; }
  bool empty() const noexcept { return first_ == last_; }

  Config config_;
  Track& track_;
  std::vector<Entry> window_;           ///< entries taken and not done, a ring
  std::uint64_t first_ = 0, last_ = 0;  ///< entries in use
  std::uint64_t staged_ = 0;            ///< end of those that wait for the rest of their batch, >= last_
  std::uint64_t taken_ = 0;             ///< entries taken from the track

  bool in_span_ = false;  ///< front() is a span that is being driven
  MotionState state_;     ///< within the span
  Profile profile_;
  double clock_ = 0.0;       ///< time within the profile
  bool bridging_ = false;    ///< the profile leads to rest across spans, with acceleration at their ends
  double base_ = 0.0;        ///< place of the present span's start in the profile's coordinate
  bool stale_ = false;       ///< the profile wants planning anew
  std::uint64_t piece_ = 0;  ///< number of the piece in motion

  bool resting_wanted_ = false;  ///< what the profile was planned for

  bool hold_ = false, stopping_ = false, dropping_ = false;
  bool wait_stop_ = false, wait_event_ = false, fault_ = false;
  bool open_ = false;  ///< motion has begun and no finish or event was met: rest is starvation
  double override_ = 1.0;
  double spindle_ = -1.0;  ///< revolutions a second, below 0: as planned
  std::uint32_t starved_ = 0;
  Sample sample_;
};

}  // namespace servogate::path
