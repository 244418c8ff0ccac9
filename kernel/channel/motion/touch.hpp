// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/program/commands/canonical.hpp"

namespace servogate::channel {

/// A place that is measured by hand, without a program: along one axis to the probe's first touch, then again
/// slowly from a little further back, as often as is asked for, and back to where it began.
struct TouchOrder {
  int axis = 0;       ///< of the machine
  double by = 0.0;    ///< mm from where it stands, with its sign: the way to the first touch is no longer
  double fast = 0.0;  ///< mm/min to the first touch
  double slow = 0.0;  ///< mm/min of all others
  double back = 0.0;  ///< mm between two touches, and so far beyond the last one the next is looked for
  std::int32_t times = 1;  ///< slow touches, from 1
};

/// For a record; touch_from() gives what to_text() was given, nullopt for anything else.
std::string to_text(const TouchOrder& order);
std::optional<TouchOrder> touch_from(std::string_view text);

/// The commands of an order, one behind the other; each measuring one waits for where it touched. Not for the
/// cycle.
class Touch {
 public:
  Touch(const TouchOrder& order, const program::Position& from) : order_(order), from_(from) {}
  /// nullopt: it is over.
  std::optional<program::Command> next();
  /// Machine coordinate of the axis at the touch of the last measuring command.
  void touched(double at);
  int axis() const { return order_.axis; }
  /// Of the slow touches so far.
  const std::vector<double>& places() const { return places_; }

 private:
  program::Command to(double place, double feed, bool measures) const;

  TouchOrder order_;
  program::Position from_;
  std::vector<double> places_;
  double last_ = 0.0;
  bool begun_ = false, ended_ = false;
  bool slow_ = false;   ///< the fast touch has been
  bool behind_ = true;  ///< it stands at a touch, not free of it
};

/// What the last order found: written by the thread that reads programs, read by any thread outside the
/// cycle.
class Touches {
 public:
  struct Found {
    std::uint32_t run = 0;  ///< that measured, 0: none
    int axis = 0;
    std::vector<double> places;  ///< machine coordinates of the slow touches
  };
  void put(std::uint32_t run, const Touch& touch) {
    const std::scoped_lock lock(mutex_);
    found_ = {run, touch.axis(), touch.places()};
  }
  Found found() const {
    const std::scoped_lock lock(mutex_);
    return found_;
  }

 private:
  mutable std::mutex mutex_;
  Found found_;
};

}  // namespace servogate::channel
