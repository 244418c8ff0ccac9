// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/survey.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

constexpr double kSlow = 0.9, kStands = 0.005;   // of the programmed feed
constexpr double kRises = 1.001;                 // from cycle to cycle, while it speeds up from rest
constexpr std::size_t kKept = 256;               // places
constexpr double kReached = 0.6;                 // of a limit: it is what binds
constexpr double kLongest = 0.5, kLeast = 0.01;  // s lost in one place; in several blocks, and at all

}  // namespace

Survey::Survey(const Config& config, const Vector& start)
    : config_(config), track_(config_), planner_(config_, track_), follower_(config_, track_) {
  follower_.set_position(to_axes(config_, start));
  planner_.restart(start);
}

bool Survey::add(const Element& element) {
  Element numbered = element;
  numbered.tag.command = first_ + elements_.size();
  numbered.lock = {};  // no spindle turns here: at the speed that its lead is planned for
  if (!planner_.add(numbered)) return false;
  elements_.push_back({element.tag, element.kind == Element::Kind::rapid ? 0.0 : element.feed});
  for (planner_.work(); !planner_.wants_more(); planner_.work()) step();
  return true;
}

void Survey::rest() {
  planner_.finish();
  do {
    planner_.work();
    step();
  } while (!idle_);
  close();
}

void Survey::step() {
  const Sample sample = follower_.step(track_.visible());
  follower_.release_stop();
  idle_ = sample.state == FollowerState::idle;
  if (!idle_) {
    ++cycles_;
    look(sample);
  }
  acceleration_ = sample.acceleration;
}

/// The limit that is used most.
std::pair<Brake, int> Survey::brake(const Sample& sample) const {
  std::pair<Brake, int> found{Brake::shape, -1};
  double most = kReached;
  const auto look_at = [&](Brake brake, int axis, double share) {
    if (share <= most) return;
    most = share;
    found = {brake, axis};
  };
  for (int i = 0; i < config_.axis_count; ++i) {
    const auto a = static_cast<std::size_t>(i);
    const AxisLimits& limits = config_.limits[a];
    look_at(Brake::velocity, i, std::abs(sample.velocity[a]) / limits.velocity);
    look_at(Brake::acceleration, i, std::abs(sample.acceleration[a]) / limits.acceleration);
    look_at(Brake::jerk, i,
            std::abs(sample.acceleration[a] - acceleration_[a]) / config_.period_s / limits.jerk);
  }
  return found;
}

void Survey::open(const Programmed& in, bool from_rest) {
  open_.emplace();
  open_->from_rest = from_rest;
  open_->place.first = open_->place.last = in.tag;
  open_->place.slowest = open_->place.feed = in.feed;
  before_.reset();
}

void Survey::look(const Sample& sample) {
  const std::uint64_t number = sample.tag.command;
  while (first_ < number && elements_.size() > 1) {
    elements_.pop_front();
    ++first_;
  }
  if (elements_.empty()) return;
  const Programmed& in = elements_.front();
  const double feed_before = std::exchange(feed_, sample.feed);
  if (in.feed == 0.0 || sample.feed >= kSlow * in.feed) return close();
  // The way up from a rest is a place of its own.
  if (open_ && open_->from_rest && sample.feed < kRises * feed_before) close();
  if (open_ && !(open_->place.last == in.tag) && open_->place.lost > kLongest) close();
  if (!open_) open(in, feed_before < kStands * in.feed);
  if (sample.feed >= feed_before) before_ = open_;
  SlowPlace& place = open_->place;
  const double period = config_.period_s, lost = period * (1.0 - sample.feed / in.feed);
  const auto [brake, axis] = this->brake(sample);
  open_->by_brake[static_cast<std::size_t>(brake)][static_cast<std::size_t>(axis + 1)] += lost;
  place.seconds += period;
  place.lost += lost;
  place.last = in.tag;
  if (sample.feed > place.slowest) return;
  place.slowest = sample.feed;
  place.feed = in.feed;
}

void Survey::close() {
  if (!open_) return;
  const bool rests = open_->place.slowest < kStands * open_->place.feed;
  // And so is the way down to one.
  if (rests && !open_->from_rest && before_ && before_->place.lost >= kLeast) {
    put(*before_);
    open_->place.first = before_->place.last;
    open_->place.lost -= before_->place.lost;
    open_->place.seconds -= before_->place.seconds;
  }
  put(*open_);
  open_.reset();
  before_.reset();
}

void Survey::put(const Open& part) {
  SlowPlace place = part.place;
  if (place.lost < kLeast) return;
  double most = 0.0;
  for (std::size_t b = 0; b < part.by_brake.size(); ++b)
    for (std::size_t a = 0; a < part.by_brake[b].size(); ++a)
      if (part.by_brake[b][a] > most) {
        most = part.by_brake[b][a];
        place.brake = static_cast<Brake>(b);
        place.axis = static_cast<int>(a) - 1;
      }
  if (part.from_rest || place.slowest < kStands * place.feed) {
    place.brake = Brake::rest;
    place.axis = -1;
  }
  // In a loop or a subprogram it is the same place again.
  const auto same = std::find_if(places_.begin(), places_.end(), [&](const SlowPlace& other) {
    return other.first == place.first && other.last == place.last && other.brake == place.brake &&
           other.axis == place.axis;
  });
  if (same != places_.end()) {
    place.times += same->times;
    place.seconds += same->seconds;
    place.lost += same->lost;
    place.slowest = std::min(place.slowest, same->slowest);
    places_.erase(same);
  }
  const auto after = std::find_if(places_.begin(), places_.end(),
                                  [&](const SlowPlace& other) { return other.lost < place.lost; });
  places_.insert(after, place);
  if (places_.size() > kKept) places_.pop_back();
}

std::vector<SlowPlace> Survey::slowest() const {
  return {places_.begin(), places_.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, places_.size()))};
}

}  // namespace servogate::path
