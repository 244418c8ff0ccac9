// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "kernel/path/shape/piece.hpp"
#include "kernel/path/shape/smoothing.hpp"

namespace servogate::path {

/// How fast a piece is to be driven by its program.
struct Pace {
  double feed = std::numeric_limits<double>::infinity();  ///< mm/s, as Element::feed; infinite: a rapid
  double turns = 0.0;  ///< revolutions a second that belong to it, 0: feed per time
  Lock lock{};         ///< by the angle of the spindle; of the whole element
  double cap = std::numeric_limits<double>::infinity();  ///< parameter speed that a corner rule allows
};

/// Where a contour goes, in order.
class ContourSink {
 public:
  virtual void put(const Piece& piece, const Pace& pace) = 0;
  /// The path comes to rest behind what was put so far.
  virtual void rest(bool confirm) = 0;

 protected:
  ~ContourSink() = default;
};

/// Elements as one contour: exact shapes, corners rounded, runs of short lines smoothed, rests where the
/// program or a corner asks for them. Nothing here knows of time. Not real-time safe.
class Contour {
 public:
  Contour(const Config& config, ContourSink& sink);

  /// Forgets what was not put yet; the path goes on at `at`.
  void restart(const Vector& at);
  /// False: the element cannot be driven, last_flaw() says why, and nothing has changed.
  bool add(const Element& element);
  Flaw last_flaw() const { return flaw_; }
  /// Puts all that was added, with a rest at its end.
  void finish();
  /// End of the elements added so far.
  const Vector& position() const { return at_; }

 private:
  struct RunLine {
    Pace pace;
    double corner;  ///< speed allowed at its end
  };
  bool add_shaped(const Element& element);
  void put_left_out();
  bool leave_out(const Element& element);
  bool always_stops(const Element& element) const;
  bool corner_stops(const Piece& next) const;
  double corner_speed(const Piece& next) const;
  void join(const Element& element, const Piece& next);
  bool join_run(const Element& element, const Piece& next);
  void take_run(bool end);
  void end_run();
  double joint_tolerance(const Element& element) const;
  void put_rest_of_waiting();
  void rest_behind_waiting();

  Config config_;
  ContourSink& sink_;
  Flaw flaw_ = Flaw::none;
  Vector at_{};                      ///< end of the elements added
  Vector shaped_to_{};               ///< end of `waiting_`, where the next geometry starts
  std::optional<Element> left_out_;  ///< too short to matter, so far
  double left_out_length_ = 0.0;
  std::optional<Piece> waiting_;  ///< last element, its end not decided
  Element waiting_element_;
  double waiting_from_ = 0.0;  ///< what the blend at its start has taken

  Smoothing run_;  ///< of short lines; `waiting_` is its last one
  std::deque<RunLine> run_lines_;
  std::size_t run_done_ = 0;  ///< lines before run_lines_[0]
  std::vector<Smoothing::Slice> slices_;
  double run_tolerance_ = 0.0;
};

}  // namespace servogate::path
