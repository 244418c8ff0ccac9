// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "kernel/channel/motion/path_elements.hpp"

namespace servogate::channel {

/// The commands of a rigid tap, gathered until they are one motion: a way in, a dwell where there is one, the
/// spindle reversed, a way back along the same line; the same again from where chips were broken; until the
/// tap stands where it began. Not real-time safe.
class TapCommands {
 public:
  struct Leg {
    program::Command command;
    double dwell_s = 0.0;
    program::Spindle turn;  ///< behind it, but for the last
    path::Element element;  ///< without its tag
  };
  enum class Taken {
    no,        ///< it does not belong to a tap
    yes,       ///< more is to come
    complete,  ///< legs() are a tap
    wrong,     ///< a tap is not like this; flaw() says why
  };

  /// The next command of the program, whose motion begins at `at`.
  Taken take(const program::Command& command, PathElements& elements, const path::Vector& at);
  const std::vector<Leg>& legs() const noexcept { return legs_; }
  /// Nothing is open.
  void clear();
  /// No spindle follows the first one, whatever was said before.
  void uncouple() noexcept { coupled_ = false; }
  /// Of Taken::wrong; its place is for the caller to fill in.
  text::Finding flaw() const;

 private:
  Taken leg(const program::Command& command, PathElements& elements);
  Taken turn(const program::Spindle& spindle, PathElements& elements);
  Taken wrong(const text::Entry& entry);

  std::vector<Leg> legs_;
  bool turned_ = false;   ///< the spindle was reversed behind the last leg
  bool coupled_ = false;  ///< the second spindle follows the first one: nothing is tapped
  path::Vector start_{};
  const text::Entry* flaw_ = nullptr;
};

/// A tap that would leave the travel within what it may go beyond its depth, or whose ways behind the first
/// one are faster than an axis: which axis, and why; nullopt: it is none. The place is for the caller to fill
/// in.
std::optional<text::Finding> undrivable_tap(const path::Config& config, const AxisMap& axes,
                                            const path::Vector& from,
                                            const std::vector<TapCommands::Leg>& legs);

}  // namespace servogate::channel
