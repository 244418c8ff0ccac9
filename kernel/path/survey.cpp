// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/survey.hpp"

#include <algorithm>
#include <utility>

namespace servogate::path {
namespace {

constexpr double kSlow = 0.9, kStands = 0.005;   // of the programmed feed
constexpr double kRises = 1.0;                   // a second, while it speeds up from rest
constexpr std::size_t kKept = 256;               // places
constexpr double kLongest = 0.5, kLeast = 0.01;  // s lost in one place; in several blocks, and at all

}  // namespace

Survey::Survey(const Config& config, const Vector& start) : time_(config, start, this) {}

bool Survey::add(const Element& element) {
  Element numbered = element;
  numbered.tag.command = first_ + elements_.size();
  elements_.push_back(
      {element.tag, element.kind == Element::Kind::rapid ? 0.0 : element.feed, element.revolutions});
  if (time_.add(numbered)) return true;
  elements_.pop_back();
  return false;
}

void Survey::rest() {
  time_.rest();
  close();
}

void Survey::open(const Programmed& in, bool from_rest) {
  open_ = Open{};
  open_->from_rest = from_rest;
  open_->place.first = open_->place.last = in.tag;
  open_->place.slowest = open_->place.feed = in.feed;
  before_.reset();
}

void Survey::put(const Moment& moment) {
  while (first_ < moment.command && elements_.size() > 1) {
    elements_.pop_front();
    ++first_;
  }
  if (elements_.empty()) return;
  Programmed in = elements_.front();
  if (moment.turns > 0.0 && in.revolutions > 0.0) in.feed *= moment.turns / in.revolutions;
  const double feed_before = std::exchange(feed_, moment.feed);
  if (in.feed == 0.0 || moment.feed >= kSlow * in.feed) return close();
  // The way up from a rest is a place of its own.
  if (open_ && open_->from_rest && moment.feed < feed_before * (1.0 + kRises * moment.seconds)) close();
  if (open_ && !(open_->place.last == in.tag) && open_->place.lost > kLongest) close();
  if (!open_) open(in, feed_before < kStands * in.feed);
  if (moment.feed >= feed_before) before_ = open_;
  SlowPlace& place = open_->place;
  const double lost = moment.seconds * (1.0 - moment.feed / in.feed);
  open_->by_brake[static_cast<std::size_t>(moment.brake)][static_cast<std::size_t>(moment.axis + 1)] += lost;
  place.seconds += moment.seconds;
  place.lost += lost;
  place.last = in.tag;
  if (moment.feed > place.slowest) return;
  place.slowest = moment.feed;
  place.feed = in.feed;
}

void Survey::close() {
  if (!open_) return;
  const bool rests = open_->place.slowest < kStands * open_->place.feed;
  // And so is the way down to one.
  if (rests && !open_->from_rest && before_ && before_->place.lost >= kLeast) {
    keep(*before_);
    open_->place.first = before_->place.last;
    open_->place.lost -= before_->place.lost;
    open_->place.seconds -= before_->place.seconds;
  }
  keep(*open_);
  open_.reset();
  before_.reset();
}

void Survey::keep(const Open& part) {
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
