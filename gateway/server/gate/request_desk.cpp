// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/gate/request_desk.hpp"

#include <chrono>
#include <thread>

#include "gateway/history/request_words.hpp"

namespace servogate::gateway {

using image::RequestKind;

Stops RequestDesk::stops() const {
  const std::scoped_lock lock(mutex_);
  return stops_;
}

void RequestDesk::collect() {
  for (image::Answer answer; cycle_.take_answer(answer);) {
    if (const auto waiting = awaited_.find(answer.id); waiting != awaited_.end()) waiting->second = answer;
    if (const auto seen = witnessed_.find(answer.id); seen != witnessed_.end()) {
      witness_(seen->second, answer);
      witnessed_.erase(seen);
    }
  }
}

void RequestDesk::look_after() {
  const std::scoped_lock lock(mutex_);
  collect();
}

/// The queue keeps its order: a stop stands in front of all that is posted behind it.
std::uint64_t RequestDesk::post_locked(image::Request& request) {
  collect();
  request.id = next_id_++;
  if (!cycle_.post(request)) return 0;
  if (witness_ && history::kept(request.kind)) witnessed_.emplace(request.id, request);
  const bool off = request.kind == RequestKind::power && request.value == 0.0;
  if (off || request.kind == RequestKind::stop || request.kind == RequestKind::quick_stop ||
      request.kind == RequestKind::hold)
    ++stops_.all;
  if (request.kind == RequestKind::jog_stop && request.value != 1.0) ++stops_.jogs;  // a person's
  return request.id;
}

std::uint64_t RequestDesk::post(image::Request request) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t id = post_locked(request);
  if (id != 0) awaited_.emplace(id, std::nullopt);
  return id;
}

bool RequestDesk::tell(image::Request request) {
  const std::scoped_lock lock(mutex_);
  return post_locked(request) != 0;
}

std::optional<image::Answer> RequestDesk::take(std::uint64_t id) {
  const std::scoped_lock lock(mutex_);
  collect();
  const auto found = awaited_.find(id);
  if (found == awaited_.end() || !found->second) return std::nullopt;
  const image::Answer answer = *found->second;
  awaited_.erase(found);
  return answer;
}

void RequestDesk::forget(std::uint64_t id) {
  const std::scoped_lock lock(mutex_);
  awaited_.erase(id);
}

bool RequestDesk::overtaken(const image::Request& request, const Stops& asked_at) const {
  const bool ends_power = request.kind == RequestKind::power && request.value == 0.0;
  if (!cycle::moves(request.kind) || request.kind == RequestKind::keep_alive || ends_power) return false;
  const bool by_hand = request.kind == RequestKind::jog_increment ||
                       request.kind == RequestKind::jog_continuous || request.kind == RequestKind::home;
  return stops_.all != asked_at.all || (by_hand && stops_.jogs != asked_at.jogs);
}

RequestDesk::Outcome RequestDesk::ask(image::Request request, image::Answer& answer, const Stops& asked_at,
                                      int patience_ms) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(patience_ms);
  std::uint64_t id = 0;
  {
    const std::scoped_lock lock(mutex_);
    if (overtaken(request, asked_at)) return Outcome::overtaken;
    id = post_locked(request);
    if (id == 0) return Outcome::silent;
    awaited_.emplace(id, std::nullopt);
  }
  for (; Clock::now() < end; std::this_thread::sleep_for(std::chrono::microseconds(500)))
    if (const auto taken = take(id)) {
      answer = *taken;
      return Outcome::answered;
    }
  forget(id);
  return Outcome::silent;
}

}  // namespace servogate::gateway
