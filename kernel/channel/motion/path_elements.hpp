// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "kernel/path/shape/element.hpp"
#include "kernel/path/shape/piece.hpp"
#include "kernel/program/commands/canonical.hpp"

namespace servogate::channel {

/// How path axes lie among the machine's, and what an axis order means. The path of a process has the axes of
/// all of them: those of the others rest on it, so that an axis may be handed over between two runs.
struct AxisMap {
  std::vector<int> machine;          ///< machine axis of each path axis
  std::vector<std::string> letters;  ///< of each path axis, for messages
  int surface_speed_axis = -1;       ///< machine axis whose position is the radius for G96; -1: none
  double spindle_min_rpm = 0.0;      ///< to which the spindle limits what it is told
  double spindle_max_rpm = 0.0;      ///< 0: no limit
  double spindle_rpm_s = 0.0;        ///< by which it slows down, rpm/s; 0: at once
};

/// Which speed of the spindle a feed per revolution is reckoned with, where a cutting speed changes it along
/// an element.
enum class SpindleAt : std::uint8_t {
  fastest,  ///< what the path is planned for
  halfway,  ///< what its time is reckoned with
};

/// Motion commands of a program as elements of the path. Not real-time safe.
class PathElements {
 public:
  PathElements(const path::Config& config, AxisMap axes, SpindleAt spindle_at);

  /// The path axes of a machine position.
  path::Vector path_position(const program::Position& at) const;
  /// The machine axes that the programs move, as bits; without it all axes of the path.
  void own(std::uint32_t machine_axes) noexcept { own_ = machine_axes; }
  /// A machine axis that a command would take away from where it `stands`, or whose window it would set,
  /// although it is another process'; -1: none.
  int foreign_axis(const program::Command& command, const program::Position& stands) const;
  /// A new run: the spindle turns as its programs say.
  void restart(std::uint32_t machine_axes) noexcept;
  /// From here on feeds per revolution are those of this spindle word.
  void take(const program::Spindle& spindle);
  /// The path has led along an element, or rested so long: that is how far the spindle has slowed down at
  /// least.
  void driven(const path::Element& element, const path::Vector& from);
  void rested(double seconds) noexcept;
  /// Rapid, Line, Arc, Thread or Probe of a command that begins at `from`; its tag is left empty.
  path::Element element(const program::Command& command, const path::Vector& from) const;

 private:
  double length(const path::Element& element, const path::Vector& from, double arc_length) const;
  void set_thread(path::Element& element, const path::Vector& from, const program::Thread& thread) const;
  void set_feed(path::Element& element, const path::Vector& from, const program::Feed& feed,
                double arc_length) const;
  path::Surface surface(const path::Element& element, const path::Vector& from) const;
  double follow_spindle(const path::Element& element, const path::Vector& from, path::Surface& surface) const;
  bool by_surface() const;
  double shortest_time(const path::Element& element, const path::Vector& from) const;
  double rpm(const path::Element& element, const path::Vector& from, SpindleAt at) const;
  double radius_of(const path::Element& element, const path::Vector& from, SpindleAt at) const;

  path::Config config_;
  AxisMap axes_;
  SpindleAt spindle_at_;
  std::uint32_t own_ = 0;
  double spindle_rpm_ = 0.0;
  /// Revolutions a second that the spindle may have where the next element begins, and still be slowing down.
  double fastest_rps_ = 0.0;
  double surface_speed_ = 0.0, surface_limit_rpm_ = 0.0, surface_center_ = 0.0;
};

/// True for Rapid, Line, Arc, Thread and Probe.
bool is_motion(const program::Command& command);
/// Where one of them ends; nullptr: it is another command.
const program::Position* destination(const program::Command& command);
/// Why a motion of an axis of another process is refused; the place is for the caller to fill in.
text::Finding foreign(const std::string& letter);
/// Why an order to another process (from 1) is not carried out; the place is for the caller to fill in.
text::Finding no_such_process(int process, int processes);
text::Finding process_not_started(int process, const std::string& program);
text::Finding program_not_found(int process, const std::string& program);
/// What keeps an element with this flaw from being driven; the place is for the caller to fill in.
text::Finding cannot_drive(path::Flaw flaw);
/// The path rests inside a block, see path::Planner::take_unasked_rest().
text::Finding rests_inside();
}  // namespace servogate::channel
