// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "kernel/path/shape/piece.hpp"
#include "kernel/path/shape/smoothing.hpp"

namespace servogate::path {

/// Where the path of a chain of threads goes, in order.
class ChainSink {
 public:
  /// A piece that is driven as `element` says.
  virtual void put(const Piece& piece, const Element& element) = 0;
  /// The path comes to rest behind what was put so far.
  virtual void rest() = 0;

 protected:
  ~ChainSink() = default;
};

/// Threads one behind the other as one path that is passed without a rest: corners rounded with continuous
/// curvature, and runs of short lines smoothed, as nothing slows down into a corner. It rests behind an
/// element that asks for it, and in corners that lead back. Nothing here knows of time. Not real-time safe.
class ThreadChain {
 public:
  ThreadChain(const Config& config, ChainSink& sink);

  /// Forgets what was not put yet; the path goes on at `at`.
  void restart(const Vector& at);
  /// Appends a line with a length and Lock::Kind::thread.
  void add(const Element& line);
  /// Puts all that was added, with a rest at its end.
  void finish();

 private:
  bool leave_out(const Element& line);
  void add_shaped(const Element& line);
  void put_left_out();
  void join(const Element& line, const Piece& next);
  bool join_run(const Element& line, const Piece& next);
  void put_corner(const Element& line, const Piece& next, const Blend& corner);
  void take_run(bool end);
  void end_run();
  double joint_tolerance(const Element& line) const;
  void put_rest_of_waiting();

  Config config_;
  ChainSink& sink_;
  Vector at_{};                      ///< end of the elements added
  Vector shaped_to_{};               ///< end of `waiting_`, where the next geometry starts
  std::optional<Element> left_out_;  ///< too short to matter, so far
  double left_out_length_ = 0.0;
  std::optional<Piece> waiting_;  ///< last element, its end not decided
  Element waiting_element_;
  double waiting_from_ = 0.0;  ///< what the corner at its start has taken

  Smoothing run_;  ///< of short lines; `waiting_` is its last one
  std::deque<Element> run_lines_;
  std::size_t run_done_ = 0;  ///< lines before run_lines_[0]
  std::vector<Smoothing::Slice> slices_;
  double run_tolerance_ = 0.0;
};

}  // namespace servogate::path
