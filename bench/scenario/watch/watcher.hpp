// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/scenario/signals/signals.hpp"
#include "machine/keys/reader.hpp"

namespace servogate::scenario {

/// A condition as a sentence of names and signs, the same in every language: "X.velocity = 0 mm/s".
std::string words_of(const Condition& condition);

/// A condition being watched in a machine. begin() once, then see() behind every cycle.
class Watcher {
 public:
  /// `folder`: that the paths of files start from. nullopt: `reading` says what is wrong.
  static std::optional<Watcher> make(const Condition& condition, const Signals& signals,
                                     const std::string& folder, machine::Reading& reading);

  /// The watch begins with what is seen now.
  void begin(const View& view);
  /// Whether it is true now. Behind every cycle since begin().
  bool see(const View& view);
  /// It can never become true any more: why, in both languages; empty: it can.
  const std::string& lost() const noexcept { return lost_; }
  /// What there is instead, for a message.
  std::string got(const View& view) const;
  /// The signals that it looks at, for a picture.
  void signals(std::vector<Signal>& out) const;

 private:
  struct Reference {
    std::vector<Signal> signals;
    std::vector<double> t;                    ///< s
    std::vector<std::vector<double>> values;  ///< by signal
  };
  static std::optional<Reference> read_reference(const Condition& condition, const Signals& signals,
                                                 const std::string& path, machine::Reading& reading);
  bool test(const View& view);
  bool see_alarms(const View& view) const;
  bool see_standstill(const View& view);
  bool see_path(const View& view);
  bool see_reference(const View& view);
  bool see_order(const View& view);

  const Condition* condition_ = nullptr;
  const Signals* machine_ = nullptr;
  std::optional<Signal> signal_;
  double value_ = 0.0, upper_ = 0.0, tolerance_ = 0.0;
  double first_ = 0.0;
  image::Nanoseconds began_ = 0;
  std::vector<int> axes_;
  std::vector<double> limits_, ways_, places_;  ///< by axis of `axes_`
  int still_ = 0;                               ///< cycles in a row without motion
  using Point = std::array<double, image::kMaxPathAxes>;
  std::deque<Point> path_;
  double deviation_ = 0.0;
  std::shared_ptr<const Reference> reference_;
  std::string off_;  ///< which signal is how far off the reference
  std::vector<Watcher> parts_;
  std::size_t reached_ = 0;  ///< parts of an order that have been true
  std::string lost_;
};

}  // namespace servogate::scenario
