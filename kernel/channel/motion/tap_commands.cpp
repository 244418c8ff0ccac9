// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/motion/tap_commands.hpp"

#include <cmath>
#include <utility>

#include "kernel/channel/motion/texts.hpp"
#include "kernel/path/law/master_motion.hpp"

namespace servogate::channel {
namespace {

constexpr double kSamePlace = 1e-6;  // mm
constexpr double kRounding = 1e-9;

path::Vector way(const path::Vector& from, const path::Vector& to) {
  path::Vector d{};
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = to[i] - from[i];
  return d;
}

double length(const path::Vector& d) {
  double square = 0.0;
  for (const double x : d) square += x * x;
  return std::sqrt(square);
}

/// Cosine of their angle is 1 or -1 within what is no distance aside: that sign, otherwise 0.
int sense(const path::Vector& a, const path::Vector& b) {
  double product = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) product += a[i] * b[i];
  const double la = length(a), lb = length(b);
  if (la <= kSamePlace || lb <= kSamePlace) return 0;
  const double along = product / la;
  if (lb * lb - along * along > kSamePlace * kSamePlace) return 0;
  return product > 0.0 ? 1 : -1;
}

std::string millimetres(double value) { return text::number(value, 3); }

}  // namespace

void TapCommands::clear() {
  legs_.clear();
  turned_ = false;
}

text::Finding TapCommands::flaw() const {
  text::Finding finding;
  finding.entry = flaw_ != nullptr ? flaw_ : &texts::kTapOpen;
  if (flaw_ == &texts::kTapLegs) finding.arguments = {std::to_string(path::MasterMotion::kMostLegs)};
  return finding;
}

TapCommands::Taken TapCommands::wrong(const text::Entry& entry) {
  flaw_ = &entry;
  clear();
  return Taken::wrong;
}

TapCommands::Taken TapCommands::take(const program::Command& command, PathElements& elements,
                                     const path::Vector& at) {
  const auto* thread = std::get_if<program::Thread>(&command.what);
  const bool taps = thread != nullptr && thread->tap;
  if (legs_.empty()) {
    if (const auto* coupling = std::get_if<program::SpindleCoupling>(&command.what); coupling != nullptr)
      coupled_ = coupling->on;
    if (!taps) return Taken::no;
    if (coupled_) return wrong(texts::kTapCoupled);
    start_ = at;
    turned_ = false;
  }
  if (taps) return leg(command, elements);
  if (const auto* spindle = std::get_if<program::Spindle>(&command.what); spindle != nullptr && !turned_)
    return turn(*spindle, elements);
  const auto* dwell = std::get_if<program::Dwell>(&command.what);
  if (dwell == nullptr || turned_) return wrong(texts::kTapOpen);
  legs_.back().dwell_s += dwell->seconds;
  return Taken::yes;
}

TapCommands::Taken TapCommands::turn(const program::Spindle& spindle, PathElements& elements) {
  const bool turns = spindle.mode == program::SpindleMode::cw || spindle.mode == program::SpindleMode::ccw;
  if (!turns || spindle.surface_speed) return wrong(texts::kTapOpen);
  legs_.back().turn = spindle;
  turned_ = true;
  elements.take(spindle);
  return Taken::yes;
}

/// Two ways in the same sense, without a reversal between them, are one.
TapCommands::Taken TapCommands::leg(const program::Command& command, PathElements& elements) {
  const bool first = legs_.empty();
  const path::Vector from = first ? start_ : legs_.back().element.to;
  path::Element element = elements.element(command, from);
  const path::Vector d = way(from, element.to);
  if (!first) {
    const Leg& last = legs_.back();
    const path::Vector before =
        way(legs_.size() > 1 ? legs_[legs_.size() - 2].element.to : start_, last.element.to);
    if (sense(before, d) != (turned_ ? -1 : 1) || element.lock.per_turn != last.element.lock.per_turn)
      return wrong(texts::kTapOpen);
    if (!turned_) {
      if (last.dwell_s > 0.0) return wrong(texts::kTapOpen);
      legs_.pop_back();
    }
  }
  if (legs_.size() == path::MasterMotion::kMostLegs) return wrong(texts::kTapLegs);
  turned_ = false;
  if (Leg* last = legs_.empty() ? nullptr : &legs_.back()) {
    path::Lock& lock = last->element.lock;
    lock.dwell = last->dwell_s;
    lock.turn_rpm = last->turn.speed;
    lock.turn = last->turn.mode == program::SpindleMode::cw ? 1 : -1;
  }
  legs_.push_back({command, 0.0, {}, element});
  if (legs_.size() % 2 != 0 || length(way(start_, element.to)) > kSamePlace) return Taken::yes;
  legs_.back().element.to = start_;
  legs_.back().element.lock.kind = path::Lock::Kind::tap_out;
  return Taken::complete;
}

std::optional<text::Finding> undrivable_tap(const path::Config& config, const AxisMap& axes,
                                            const path::Vector& from,
                                            const std::vector<TapCommands::Leg>& legs) {
  const path::Threads& threads = config.threads;
  path::Vector begin = from;
  double next_rpm = 0.0;
  for (const TapCommands::Leg& leg : legs) {
    const path::Vector d = way(begin, leg.element.to);
    const double whole = length(d);
    begin = leg.element.to;
    // How fast it goes in is seen when it begins; how fast the ways behind it go is ordered by the program.
    const double turns_s = std::exchange(next_rpm, std::abs(leg.element.lock.turn_rpm)) / 60.0;
    for (std::size_t i = 0; whole > kSamePlace && i < axes.machine.size(); ++i) {
      const double speed = leg.element.lock.per_turn * turns_s * std::abs(d[i]) / whole,
                   most = config.limits[i].velocity;
      if (!(speed > most * (1.0 + kRounding))) continue;
      text::Finding finding;
      finding.entry = &texts::kTapTooFast;
      finding.arguments = {i < axes.letters.size() ? axes.letters[i] : std::to_string(i + 1),
                           text::number(60.0 * speed, 0), text::number(60.0 * turns_s, 0),
                           text::number(60.0 * most, 0)};
      return finding;
    }
    if (leg.element.lock.kind == path::Lock::Kind::tap_out || whole <= kSamePlace) continue;
    for (std::size_t i = 0; i < axes.machine.size(); ++i) {
      const double rest = begin[i] + d[i] / whole * threads.tap_overshoot;
      const bool over = d[i] > 0.0 && rest > threads.travel_max[i],
                 under = d[i] < 0.0 && rest < threads.travel_min[i];
      if (!over && !under) continue;
      text::Finding finding;
      finding.entry = &texts::kTapLeavesTravel;
      finding.arguments = {i < axes.letters.size() ? axes.letters[i] : std::to_string(i + 1),
                           millimetres(threads.tap_overshoot), millimetres(rest),
                           millimetres(over ? threads.travel_max[i] : threads.travel_min[i])};
      return finding;
    }
  }
  return std::nullopt;
}

}  // namespace servogate::channel
