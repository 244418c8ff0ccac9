// SPDX-License-Identifier: Apache-2.0
#include "bench/scenario/watch/watcher.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "bench/scenario/reading/findings.hpp"
#include "firmware_if/text/in_both.hpp"

namespace servogate::scenario {

namespace {

using Kind = Condition::Kind;
using Test = Condition::Test;

constexpr int kStillCycles = 10;           ///< without motion: it stands
constexpr double kStill = 1e-3;            ///< mm/s or degrees/s: less is standing
constexpr double kNewPoint = 1e-6;         ///< mm: nearer points of a path are one
constexpr std::size_t kPathPoints = 4000;  ///< of the set-points that are remembered

const text::Entry kTooFar{"scenario.too_far", "{0} has moved {1}, further than {2}",
                          "{0}: пройдено {1}, больше чем {2}"};
const text::Entry kWrongOrder{"scenario.wrong_order", "{0} came before {1}", "{0} раньше, чем {1}"};

/// What a signal is, for a message about a value that it cannot have.
std::string nature_of(const Signal& signal) {
  if (signal.words.empty())
    return signal.unit.empty() ? text::both("a number", "число")
                               : text::both("in ", "в ") + std::string(signal.unit);
  std::string words;
  for (const std::string_view w : signal.words) words += (words.empty() ? "" : ", ") + std::string(w);
  return words;
}

using Point = std::array<double, image::kMaxPathAxes>;

double distance_to(const Point& p, const Point& a, const Point& b) {
  double along = 0.0, length = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    length += (b[i] - a[i]) * (b[i] - a[i]);
  }
  const double share = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double d = p[i] - (a[i] + share * (b[i] - a[i]));
    sum += d * d;
  }
  return std::sqrt(sum);
}

}  // namespace

std::optional<Watcher> Watcher::make(const Condition& c, const Signals& signals, const std::string& folder,
                                     machine::Reading& reading) {
  Watcher w;
  w.condition_ = &c;
  w.machine_ = &signals;
  const std::size_t before = reading.findings.size();
  const auto number = [&](const Value& value, const Signal& signal, double& out) {
    if (const auto n = Signals::number(value, signal))
      out = *n;
    else
      reading.error(
          value.at, finding::kNotOfSignal,
          {signal.name, nature_of(signal),
           std::holds_alternative<std::string>(value.is) ? std::get<std::string>(value.is)
           : std::holds_alternative<bool>(value.is) ? std::string(std::get<bool>(value.is) ? "true" : "false")
                                                    : text::number(std::get<double>(value.is), 6)});
  };
  const auto length = [&](const Value& value, int axis) {
    const auto n = signals.length(value, axis);
    if (!n) {
      const std::string unit =
          axis < 0 ? "mm" : signals.machine().axes[static_cast<std::size_t>(axis)].unit();
      const auto* text = std::get_if<std::string>(&value.is);
      reading.error(
          value.at, finding::kNotOfSignal,
          {text::both("a length", "длина"), text::both("in ", "в ") + unit, text != nullptr ? *text : "?"});
    }
    return n.value_or(0.0);
  };
  switch (c.kind) {
    case Kind::signal:
      w.signal_ = signals.find(c.signal);
      if (!w.signal_) {
        reading.error(c.at, finding::kUnknownSignal, {c.signal});
        break;
      }
      if (c.test != Test::rising && c.test != Test::falling && c.test != Test::changes)
        number(c.value, *w.signal_, w.value_);
      if (c.test == Test::between) number(c.upper, *w.signal_, w.upper_);
      if (c.tolerance) number(*c.tolerance, *w.signal_, w.tolerance_);
      break;
    case Kind::standstill: {
      w.axes_ = signals.axes(c.names);
      for (const int axis : w.axes_) {
        if (axis < 0) {
          std::string letters;
          for (const std::string& l : signals.machine().letters())
            letters += (letters.empty() ? "" : ", ") + l;
          std::string unknown;
          for (const std::string& name : c.names)
            if (name != "all" && signals.machine().axis_index(name) < 0) unknown = name;
          reading.error(c.at, finding::kUnknownAxis, {unknown, letters});
          break;
        }
        w.limits_.push_back(c.limited ? length(c.value, axis) : std::numeric_limits<double>::infinity());
      }
      break;
    }
    case Kind::path_deviation:
      w.value_ = length(c.value, -1);
      break;
    case Kind::reference: {
      w.value_ = length(c.value, -1);
      const std::filesystem::path file(c.file);
      auto read = read_reference(
          c, signals,
          file.is_absolute() ? c.file : (std::filesystem::path(folder) / file).lexically_normal().string(),
          reading);
      if (read) w.reference_ = std::make_shared<const Reference>(std::move(*read));
      break;
    }
    default:
      for (const Condition& part : c.parts)
        if (auto made = make(part, signals, folder, reading)) w.parts_.push_back(std::move(*made));
      break;
  }
  return reading.findings.size() == before ? std::optional(std::move(w)) : std::nullopt;
}

void Watcher::begin(const View& view) {
  began_ = view.image.now.t_ns;
  lost_.clear();
  still_ = 0;
  reached_ = 0;
  path_.clear();
  off_.clear();
  if (signal_) first_ = signal_->read(view);
  ways_.assign(axes_.size(), 0.0);
  places_.clear();
  for (const int axis : axes_) places_.push_back(view.image.axes[static_cast<std::size_t>(axis)].actual);
  for (Watcher& part : parts_) part.begin(view);
}

bool Watcher::see(const View& view) {
  switch (condition_->kind) {
    case Kind::signal:
      return test(view);
    case Kind::alarm:
    case Kind::no_alarm:
      return see_alarms(view);
    case Kind::standstill:
      return see_standstill(view);
    case Kind::path_deviation:
      return see_path(view);
    case Kind::reference:
      return see_reference(view);
    case Kind::order:
      return see_order(view);
    case Kind::all:
    case Kind::any:
      break;
  }
  const bool all = condition_->kind == Kind::all;
  bool result = all;
  for (Watcher& part : parts_) {
    const bool seen = part.see(view);  // every one sees every cycle
    result = all ? result && seen : result || seen;
    if (all && lost_.empty()) lost_ = part.lost();
  }
  return result;
}

bool Watcher::test(const View& view) {
  const double now = signal_->read(view);
  switch (condition_->test) {
    case Test::equals:
      return std::abs(now - value_) <= tolerance_;
    case Test::differs:
      return !(std::abs(now - value_) <= tolerance_);
    case Test::above:
      return now > value_;
    case Test::below:
      return now < value_;
    case Test::at_least:
      return now >= value_;
    case Test::at_most:
      return now <= value_;
    case Test::between:
      return now >= value_ && now <= upper_;
    case Test::rising: {
      const bool rose = now > first_;
      first_ = std::min(first_, now);  // a switch that is on falls first
      return rose;
    }
    case Test::falling: {
      const bool fell = now < first_;
      first_ = std::max(first_, now);
      return fell;
    }
    case Test::changes:
      return now != first_;
  }
  return false;
}

bool Watcher::see_alarms(const View& view) const {
  const auto listed = [&](int number) {
    return std::find(condition_->numbers.begin(), condition_->numbers.end(), number) !=
           condition_->numbers.end();
  };
  const auto count = static_cast<std::size_t>(view.alarms.count);
  if (condition_->kind == Kind::no_alarm) {
    for (std::size_t n = 0; n < count; ++n)
      if (view.alarms.records[n].active && !listed(view.alarms.records[n].number)) return false;
    return true;
  }
  return std::all_of(condition_->numbers.begin(), condition_->numbers.end(), [&](int number) {
    for (std::size_t n = 0; n < count; ++n)
      if (view.alarms.records[n].number == number &&
          (view.alarms.records[n].active || view.alarms.records[n].t_ns >= began_))
        return true;
    return false;
  });
}

bool Watcher::see_standstill(const View& view) {
  const double still = kStill * static_cast<double>(view.image.now.period_ns) * 1e-9;
  bool moved = false;
  for (std::size_t n = 0; n < axes_.size(); ++n) {
    const image::AxisImage& axis = view.image.axes[static_cast<std::size_t>(axes_[n])];
    const double step = std::abs(axis.actual - places_[n]);
    places_[n] = axis.actual;
    // Coordinates that are set anew by homing are no way.
    if (step < 10.0) ways_[n] += step;
    moved = moved || axis.moving || step > still;
    if (ways_[n] > limits_[n] && lost_.empty()) {
      const machine::AxisConfig& config = machine_->machine().axes[static_cast<std::size_t>(axes_[n])];
      lost_ = text::in_both(kTooFar, {config.letter, text::number(ways_[n], 3) + " " + config.unit(),
                                      text::number(limits_[n], 3) + " " + config.unit()});
    }
  }
  still_ = moved ? 0 : still_ + 1;
  return still_ >= kStillCycles && lost_.empty();
}

bool Watcher::see_path(const View& view) {
  Point set{}, actual{};
  bool follows = true;  // the set-point of an axis without power is its place, and no path
  const std::size_t axes = std::min<std::size_t>(machine_->machine().program_axes(), set.size());
  for (std::size_t a = 0; a < axes; ++a) {
    set[a] = view.image.axes[a].command;
    actual[a] = view.image.axes[a].actual;
    follows = follows && view.image.axes[a].enabled;
  }
  // The axes lag behind the set-point: what lies between was path before the watch began.
  if (path_.empty()) path_.push_back(actual);
  double apart = 0.0;
  for (std::size_t a = 0; a < axes && !path_.empty(); ++a) apart += std::abs(set[a] - path_.back()[a]);
  if (follows && apart > kNewPoint) path_.push_back(set);
  if (path_.size() > kPathPoints) path_.pop_front();
  deviation_ = distance_to(actual, path_.front(), path_.front());
  for (std::size_t n = 1; n < path_.size(); ++n)
    deviation_ = std::min(deviation_, distance_to(actual, path_[n - 1], path_[n]));
  return deviation_ <= value_;
}

bool Watcher::see_reference(const View& view) {
  const Reference& r = *reference_;
  const double t = static_cast<double>(view.image.now.t_ns - began_ + condition_->begins) * 1e-9;
  const auto next = std::lower_bound(r.t.begin(), r.t.end(), t);
  off_.clear();
  if (next == r.t.end()) return true;  // the reference has ended
  const auto hi = static_cast<std::size_t>(next - r.t.begin());
  const std::size_t lo = hi == 0 ? 0 : hi - 1;
  const double share = hi == lo ? 0.0 : (t - r.t[lo]) / (r.t[hi] - r.t[lo]);
  for (std::size_t s = 0; s < r.signals.size(); ++s) {
    const double wanted = r.values[s][lo] + share * (r.values[s][hi] - r.values[s][lo]);
    const double now = r.signals[s].read(view);
    if (!(std::abs(now - wanted) <= value_)) {
      off_ = r.signals[s].name + " = " + words_of(now, r.signals[s]) + " ≠ " + words_of(wanted, r.signals[s]);
      return false;
    }
  }
  return true;
}

bool Watcher::see_order(const View& view) {
  std::vector<bool> seen;
  for (Watcher& part : parts_) seen.push_back(part.see(view));
  while (reached_ < parts_.size() && seen[reached_]) ++reached_;
  for (std::size_t n = reached_ + 1; n < parts_.size(); ++n)
    if (seen[n] && lost_.empty())
      lost_ = text::in_both(kWrongOrder,
                            {words_of(*parts_[n].condition_), words_of(*parts_[reached_].condition_)});
  return reached_ == parts_.size();
}

std::string Watcher::got(const View& view) const {
  switch (condition_->kind) {
    case Kind::signal:
      return signal_->name + " = " + words_of(signal_->read(view), *signal_);
    case Kind::alarm:
    case Kind::no_alarm: {
      std::string out;
      for (int n = 0; n < view.alarms.count; ++n) {
        const image::AlarmRecord& r = view.alarms.records[static_cast<std::size_t>(n)];
        if (r.active) out += (out.empty() ? "alarm " : ", ") + std::to_string(r.number);
      }
      return out.empty() ? "no_alarm" : out;
    }
    case Kind::standstill: {
      std::string out;
      for (std::size_t n = 0; n < axes_.size(); ++n) {
        const machine::AxisConfig& config = machine_->machine().axes[static_cast<std::size_t>(axes_[n])];
        out += (out.empty() ? "" : ", ") + config.letter + ": " + text::number(ways_[n], 3) + " " +
               config.unit();
      }
      return out;
    }
    case Kind::path_deviation:
      return text::number(deviation_, 4) + " mm";
    case Kind::reference:
      return off_;
    case Kind::order:
      return std::to_string(reached_) + "/" + std::to_string(parts_.size());
    default: {
      std::string out;
      for (const Watcher& part : parts_) out += (out.empty() ? "" : "; ") + part.got(view);
      return out;
    }
  }
}

void Watcher::signals(std::vector<Signal>& out) const {
  const auto add = [&](const Signal& s) {
    if (std::none_of(out.begin(), out.end(), [&](const Signal& o) { return o.name == s.name; }))
      out.push_back(s);
  };
  if (signal_) add(*signal_);
  for (const int axis : axes_)
    if (const auto s =
            machine_->find(machine_->machine().axes[static_cast<std::size_t>(axis)].letter + ".velocity"))
      add(*s);
  if (reference_)
    for (const Signal& s : reference_->signals) add(s);
  for (const Watcher& part : parts_) part.signals(out);
}

}  // namespace servogate::scenario
