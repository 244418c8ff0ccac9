// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/resident/request_desk.hpp"

#include <chrono>
#include <cmath>
#include <thread>

#include "gateway/control/history/request_words.hpp"

namespace servogate::gateway {

using image::RequestKind;

namespace {
constexpr std::chrono::seconds kPatienceWithTaken{2};
}  // namespace

bool RequestDesk::pause() const {
  if (pause_ != nullptr) return pause_();
  std::this_thread::sleep_for(std::chrono::microseconds(500));
  return true;
}

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
RequestDesk::Post RequestDesk::post_locked(image::Request& request, const Asked* asked) {
  collect();
  request.id = next_id_++;
  const bool ages = asked != nullptr && longest_wait_ != kAnyTime;
  const auto lain = ages ? Clock::now() - asked->since : Clock::duration{};
  const cycle::Claim claim =
      cycle_.post_for(request, std::chrono::nanoseconds(lain).count(),
                      ages ? std::chrono::nanoseconds(longest_wait_).count() : cycle::Cycle::kForAnyTime);
  if (claim == 0) return {};
  if (witness_ && history::kept(request.kind)) witnessed_.emplace(request.id, request);
  const bool off = request.kind == RequestKind::power && request.value == 0.0;
  if (off || request.kind == RequestKind::stop || request.kind == RequestKind::quick_stop ||
      request.kind == RequestKind::hold)
    ++stops_.all;
  if (request.kind == RequestKind::jog_stop && request.value != 1.0) ++stops_.jogs;  // a person's
  return {request.id, claim};
}

std::uint64_t RequestDesk::post(image::Request request) {
  const std::scoped_lock lock(mutex_);
  const std::uint64_t id = post_locked(request).id;
  if (id != 0) awaited_.emplace(id, std::nullopt);
  return id;
}

bool RequestDesk::tell(image::Request request) {
  const std::scoped_lock lock(mutex_);
  return post_locked(request).id != 0;
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

std::optional<image::Answer> RequestDesk::stale(const image::Request& request, const Asked& asked) const {
  if (cycle::never_too_old(request)) return std::nullopt;
  image::Answer answer;
  answer.id = request.id;
  if (asked.gone != nullptr && *asked.gone) {
    answer.refusal = static_cast<std::uint16_t>(cycle::Refusal::client_gone);
    return answer;
  }
  const auto lain = Clock::now() - asked.since;
  if (longest_wait_ == kAnyTime || lain <= longest_wait_) return std::nullopt;
  answer.refusal = static_cast<std::uint16_t>(cycle::Refusal::too_old);
  answer.value = std::round(std::chrono::duration<double, std::milli>(lain).count());
  answer.limit = static_cast<double>(longest_wait_.count());
  return answer;
}

void RequestDesk::tell_witness(const image::Request& request, const image::Answer& answer) const {
  if (witness_ && history::kept(request.kind)) witness_(request, answer);
}

bool RequestDesk::withdraw(const Post& post) {
  const std::scoped_lock lock(mutex_);
  if (!cycle_.withdraw(post.claim)) return false;
  awaited_.erase(post.id);
  witnessed_.erase(post.id);
  return true;
}

RequestDesk::Outcome RequestDesk::ask(image::Request request, image::Answer& answer, const Asked& asked,
                                      int patience_ms) {
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(patience_ms);
  Post post;
  {
    const std::scoped_lock lock(mutex_);
    if (overtaken(request, asked.stops)) return Outcome::overtaken;
    if (const auto refused = stale(request, asked)) {
      answer = *refused;
      tell_witness(request, answer);
      return Outcome::answered;
    }
    post = post_locked(request, &asked);
    if (post.id == 0) return Outcome::silent;
    awaited_.emplace(post.id, std::nullopt);
  }
  return wait(post, request, answer, asked, end);
}

/// What a cycle has taken it answers at once, if ever; a stop is left to it for when it goes on.
RequestDesk::Outcome RequestDesk::wait(const Post& post, const image::Request& request, image::Answer& answer,
                                       const Asked& asked, Clock::time_point end) {
  const bool always = cycle::never_too_old(request);
  bool goes_on = true;
  for (bool open = !always;; goes_on = pause()) {
    if (const auto come = take(post.id)) {
      answer = *come;
      return Outcome::answered;
    }
    const bool gone = asked.gone != nullptr && *asked.gone;
    const bool over = !goes_on || (!stepped() && Clock::now() >= end);
    if (open && (gone || over)) {
      if (withdraw(post))
        return gone ? refused(request, cycle::Refusal::client_gone, answer) : Outcome::silent;
      open = false;
      if (!goes_on) return Outcome::taken;
      end = Clock::now() + kPatienceWithTaken;
    } else if (over) {
      forget(post.id);
      return Outcome::taken;
    }
  }
}

RequestDesk::Outcome RequestDesk::refused(const image::Request& request, cycle::Refusal why,
                                          image::Answer& answer) {
  const std::scoped_lock lock(mutex_);
  answer.refusal = static_cast<std::uint16_t>(why);
  tell_witness(request, answer);
  return Outcome::answered;
}

}  // namespace servogate::gateway
