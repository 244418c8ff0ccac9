// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "kernel/path/law/master_motion.hpp"
#include "kernel/path/law/motion.hpp"
#include "kernel/path/law/rate_motion.hpp"
#include "kernel/path/law/retract.hpp"
#include "kernel/path/track/window.hpp"

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

/// A motion by the spindle's angle (Element::lock), while one is under way.
struct ByMaster {
  bool underway = false;                  ///< begun, or waiting for its angle
  bool waits = false;                     ///< for its angle
  bool leaving = false;                   ///< off its master: it slows down, and goes off the path
  bool locked = false;                    ///< behind its lead-in, its angle is the master's
  bool taps = false;                      ///< a tap, otherwise a thread
  bool bound = false;                     ///< MasterMotion::bound()
  bool halt = false;                      ///< a tap asks for its spindle to stand
  std::int8_t turn = 0;                   ///< how it asks it to turn from here on (Lock::turn); 0: as it does
  double turn_rpm = 0.0;                  ///< and how fast; 0: as before
  MasterFault fault = MasterFault::none;  ///< why it is being left
  double value = 0.0, limit = 0.0;        ///< of the fault, see MasterFault
  double phase_error = 0.0;               ///< mm of path, MasterMotion::phase_error()
  double overshoot = 0.0;  ///< mm that a tap went beyond its depth; below 0: it has not reached it
};

/// The set-point of one cycle, of the axes.
struct Sample {
  Vector position{}, velocity{}, acceleration{};  ///< mm, mm/s, mm/s2 (degrees)
  double feed = 0.0;                              ///< speed of the vector over mm and degrees, per s
  double distance_to_go = 0.0;                    ///< path length to the end of the block in motion
  Vector target{};                                ///< end point of the block in motion
  Tag tag;                                        ///< block in motion (or the last one)
  FollowerState state = FollowerState::idle;
  bool rapid = false;         ///< the block in motion is a rapid
  std::uint32_t event = 0;    ///< at_event: which
  std::uint32_t starved = 0;  ///< cycles so far in which planning was late
  std::uint32_t passed = 0;   ///< marks passed in this cycle (Planner::add_mark())
  ByMaster master;
  double passed_at = 0.0;  ///< where in the cycle the last of them was, 0 - 1 (its end)
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
  /// rest while it is 0. Below 0, as at the beginning: no such spindle, they are driven as planned. Along a
  /// course it acts as an override does: on all of it, where limits bind too, and to 0.05 %.
  void set_spindle(double revolutions) noexcept;
  /// The spindle as it is measured, in each cycle: elements with a lock are driven by it. One that leaves its
  /// master, or is stopped, goes off its path by Threads::retract and ends as behind stop().
  void set_master(const MasterReading& reading) noexcept;
  /// The path rests only because the spindle does.
  bool waits_for_spindle() const noexcept { return !rest_asked() && spindle_stands() && at_rest(); }
  /// It is to rest, and goes on all the same: to the end of the thread, or until the tap has left its hole.
  bool holds_later() const noexcept {
    return rest_asked() && !stopping_ && by_master_ && !at_rest() && !master_.leaving();
  }
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
  /// Where the motion is in the running sum of planned times (Knot::planned, Piece::time), s; nullopt:
  /// nothing is in motion.
  std::optional<double> driven() const noexcept;
  /// True while neither speed nor acceleration is present.
  bool at_rest() const noexcept {
    if (by_master_) return master_.at_rest() && !retract_.moving();
    return on_course_ ? rate_.at_rest() : motion_.at_rest();
  }

 private:
  void take_entries(std::uint64_t visible) noexcept;
  void start() noexcept;
  void pass_markers() noexcept;
  bool pass_marker(const Entry& entry) noexcept;
  void drop() noexcept;
  void drop_span(const Span& span) noexcept;
  void drop_course(const Entry& known) noexcept;
  void begin_course(const Entry& course) noexcept;
  void follow_course() noexcept;
  void leave_course() noexcept;
  void leave_broken_course() noexcept;
  void free_course() noexcept;
  void enter() noexcept;
  void leave() noexcept;
  void arrive(const Piece& last, bool waits) noexcept;
  bool rest_asked() const noexcept { return hold_ || stopping_ || override_ <= 0.0; }
  bool wants_rest() const noexcept { return rest_asked() || spindle_stands(); }
  bool spindle_stands() const noexcept;
  Wish wish() const noexcept { return {wants_rest(), override_, spindle_}; }
  double course_share() const noexcept;
  double rate_wanted() noexcept;
  void locate(double s) noexcept;
  // follower_master.cpp
  bool begin_by_master() noexcept;
  void follow_master() noexcept;
  void leave_spans_behind() noexcept;
  void begin_retract() noexcept;
  void move_off_path() noexcept;
  void place_master_on_axes() noexcept;
  void show_master() noexcept;
  void place_span_on_axes() noexcept;
  void place_on_axes(double s, const MotionState& state) noexcept;
  void place_course_on_axes() noexcept;
  void show_feed(const Vector& velocity) noexcept;
  void show_piece(double s, double v) noexcept;
  void pass_marks(std::uint32_t marks, double beyond) noexcept;
  double behind_mark(std::uint32_t marks, double s) const noexcept;
  FollowerState report() const noexcept;
  Sample sample() noexcept;
  const Span& front() const noexcept { return *window_.span(0); }

  Config config_;
  Track& track_;
  Window window_;
  std::uint64_t taken_ = 0;  ///< entries taken from the track
  Motion motion_;            ///< along a span from rest to rest
  CourseAhead course_;
  RateMotion rate_;           ///< along a course
  MasterMotion master_;       ///< through spans, by the spindle's angle
  MasterEstimate estimate_;   ///< of the measured angle
  MasterEstimate commanded_;  ///< of the commanded one, where threads go by it
  MasterReading reading_;
  Retract retract_;
  Vector along_{};          ///< the most that each axis moves for a path of 1, on that run
  double run_begin_ = 0.0;  ///< of the first span in the run
  bool by_master_ = false, off_path_ = false;
  int legs_behind_ = 0;  ///< of a tap

  bool in_span_ = false;     ///< the first entry is a span or a course that is being driven
  bool on_course_ = false;   ///< and it is a course
  std::uint64_t piece_ = 0;  ///< number of the piece in motion
  std::uint64_t begun_ = 0;  ///< of the first piece of this path
  std::uint32_t marks_ = 0;  ///< passed or dropped so far

  bool hold_ = false, stopping_ = false, dropping_ = false;
  bool wait_stop_ = false, wait_event_ = false, fault_ = false;
  bool open_ = false;  ///< motion has begun and no finish or event was met: rest is starvation
  double override_ = 1.0;
  double spindle_ = -1.0;        ///< revolutions a second, below 0: as planned
  double asked_override_ = 1.0;  ///< for which the rate of a course was asked last
  double share_ = 1.0;           ///< of the spindle, then
  std::uint32_t starved_ = 0;
  Sample sample_;
  std::uint64_t shown_ = ~std::uint64_t{0};  ///< number of the piece whose target the sample shows
};

}  // namespace servogate::path
