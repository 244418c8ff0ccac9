// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/execution/contour/contour_state.hpp"
#include "kernel/program/execution/flow/output.hpp"
#include "kernel/program/execution/frames/frames.hpp"

namespace servogate::program {

/// Radius compensation and what stands between two elements (arcs, chamfers). The tool's centre runs along
/// the elements shifted to a side by its radius and passes from one to the next where these meet, or by an
/// arc about the corner where they do not meet or a word asks for it. What a program gives meanwhile keeps
/// its place. Source: specification A 14, B 1.6. Not for the cycle.
class Contour {
 public:
  Contour(const Dialect& dialect, const MachineModel& machine, const Flow& flow, FramesState& at,
          Frames& frames, ContourState& state, CommandQueue& queue, const int& process,
          const ArcFeed& arc_feed, const ContourWatch& watch)
      : dialect_(dialect),
        machine_(machine),
        flow_(flow),
        at_(at),
        frames_(frames),
        state_(state),
        queue_(queue),
        process_(process),
        arc_feed_(arc_feed),
        watch_(watch) {}

  /// Nothing is kept back, and nothing has to be: a motion can be given as it is.
  bool idle() const {
    return !state_.engaged() && !state_.shifted() && state_.coming.kind == CornerWord::Kind::none &&
           !corner_ahead();
  }
  bool engaged() const noexcept { return state_.engaged(); }
  bool compensates() const noexcept { return state_.mode == ContourState::Mode::on; }

  /// Of the block that is executed.
  Place place(int column, std::int32_t block) const {
    return {flow_.file(), flow_.line_number(), column, block};
  }
  /// Compensation begins with the next motion; `side` +1: the tool is left of the programmed path.
  void begin(int side, double radius, int column);
  void take(ContourElement element);
  /// The next element follows with this in between.
  void corner(CornerWord word);
  /// The same of a word in the block of the element before it.
  void corner_behind(CornerWord word) { state_.coming = std::move(word); }
  /// The next element continues a closed contour whose last element is this one.
  void begin_behind(const ContourElement& last) { state_.before = last; }
  /// A command keeps its place behind what is kept back.
  void follow(Command command);
  /// Ends the element kept back where it meets the first one of its closed contour.
  void close(ContourElement first);
  /// Gives what is kept back, up to the end of its element.
  void flush();
  /// The compensation ends: the next motion in the plane leads to its programmed point.
  void end();
  /// The axes stand where they stand: forgets all of it.
  void drop() { state_ = ContourState{}; }
  /// Ends all of it; the programmed position is where the tool's centre stands.
  void settle();
  /// After an error: as before its block, with nothing kept back. The element whose end the block would have
  /// told is not given: in an inner corner its own end is too far.
  void rescue(const ContourState& before);
  /// End of the last command given, where the programmed position is `programmed`.
  Position position(const Position& programmed) const;

 private:
  struct Joint {
    Point end;    ///< of the element
    Point begin;  ///< of the next one
    bool rolls = false;
    double roll_deg = 0.0;
  };
  bool corner_ahead() const;
  void hold(ContourElement element, Point from);
  void join(ContourElement next);
  static ContourElement between(ContourElement& first, ContourElement& second, const CornerWord& word);
  static ContourElement chamfer(ContourElement& first, ContourElement& second, const CornerWord& word);
  Joint joint(const ContourElement& first, const ContourElement& second, bool rolled) const;
  void pass(const ContourElement& first, const ContourElement& second, bool rolled);
  void give(const ContourElement& element, Point end);
  void give_line(const ContourElement& element, Point end, const Position& to);
  void give_arc(const ContourElement& element, Point end, const Position& to);
  void release(Point at);
  double across(const Position& to) const;
  template <typename What>
  void emit(const Place& place, What&& what);
  void check(const ContourElement& element, int axis, double value) const;
  void put(Command command);
  void watch(const ContourElement& element, Point end, double sweep_deg);
  void end_watch();

  const Dialect& dialect_;
  const MachineModel& machine_;
  const Flow& flow_;
  FramesState& at_;
  Frames& frames_;
  ContourState& state_;
  CommandQueue& queue_;
  const int& process_;
  const ArcFeed& arc_feed_;
  const ContourWatch& watch_;
};

}  // namespace servogate::program
