// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/server/bus.hpp"

#include <algorithm>
#include <limits>

namespace servogate::usercan {
namespace {

mock::CanSegmentConfig settings(std::uint32_t bit_rate) {
  mock::CanSegmentConfig c;
  c.bit_rate = bit_rate;
  c.priority_mailboxes = false;  // what one participant says stays in its order
  c.automatic_restart = true;
  return c;
}

}  // namespace

Nanoseconds Bus::Place::next_action_ns() const noexcept { return std::numeric_limits<Nanoseconds>::max(); }

Bus::Bus(std::string name, std::uint32_t bit_rate) : name_(std::move(name)), segment_(settings(bit_rate)) {
  segment_.attach(listener_, "listener");
  segment_.set_monitor(this);
}

Bus::~Bus() = default;

bool Bus::join(Participant& who) {
  auto free = std::find_if(places_.begin(), places_.end(), [](const auto& p) { return p->who == nullptr; });
  if (free == places_.end()) {
    if (places_.size() == kPlaces) return false;
    places_.push_back(std::make_unique<Place>());
    free = places_.end() - 1;
    (*free)->endpoint = segment_.attach(**free);
  }
  (*free)->who = &who;
  who.port = static_cast<int>(free - places_.begin());
  segment_.set_connected((*free)->endpoint, true);
  return true;
}

void Bus::leave(Participant& who) {
  Place& place = *places_[static_cast<std::size_t>(who.port)];
  // Unplugging alone would leave its frames to whoever takes the place next.
  segment_.force_bus_off(place.endpoint);
  segment_.restart(place.endpoint);
  segment_.set_connected(place.endpoint, false);
  place.who = nullptr;
  who.port = -1;
}

bool Bus::offer(Participant& who, const image::CanFrame& frame) {
  const std::uint32_t key = image::arbitration_key(frame);
  for (const auto& place : places_)
    if (place->who != nullptr && place->who != &who && place->who->offers(key)) return false;
  if (!places_[static_cast<std::size_t>(who.port)]->bus().send(frame)) return false;
  who.offered(frame);
  return true;
}

void Bus::on_wire(const image::CanFrame& frame, int sender, Nanoseconds start, Nanoseconds end,
                  Outcome outcome) noexcept {
  if (outside_ != nullptr) outside_->on_wire(frame, sender, start, end, outcome);
  if (outcome == Outcome::error) return;
  for (const auto& place : places_)
    if (place->endpoint == sender && place->who != nullptr) place->who->delivered(frame);
}

}  // namespace servogate::usercan
