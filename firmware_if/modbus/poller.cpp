// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/poller.hpp"

#include <algorithm>

namespace servogate::modbus {

using image::Nanoseconds;

namespace {

/// An answer to a read tells its function and how much there is, not from where. Those to multiple writes
/// carry the address.
bool answers_alike(const Block& a, const Block& b) noexcept {
  if (a.coding == Coding::huanyang || b.coding == Coding::huanyang)
    return false;  // they say of what they are
  return a.unit == b.unit && a.function == b.function && !writes(a.function) &&
         response_size(a.function, a.count) == response_size(b.function, b.count);
}

}  // namespace

Poller::Poller(PollSettings settings, std::vector<Block> blocks)
    : settings_(settings), blocks_(std::move(blocks)), states_(blocks_.size()), health_(256) {
  for (std::size_t a = 0; a < blocks_.size(); ++a)
    for (std::size_t b = 0; b < blocks_.size(); ++b)
      if (a != b && answers_alike(blocks_[a], blocks_[b])) states_[a].alike.push_back(b);
}

void Poller::start_at(Nanoseconds t) noexcept {
  for (State& state : states_) state.due_ns = t;
}

Nanoseconds Poller::ready_ns(std::size_t block) const noexcept {
  const Health& health = health_[blocks_[block].unit];
  Nanoseconds ready = health.lost ? std::max(states_[block].due_ns, health.retry_ns) : states_[block].due_ns;
  if (states_[block].alike.empty()) return ready;
  for (const std::size_t other : states_[block].alike) ready = std::max(ready, states_[other].awaited_ns);
  return std::max(ready, states_[block].awaited_ns);
}

std::optional<Poller::Next> Poller::next(Nanoseconds idle_since) const noexcept {
  if (repeat_) return Next{repeat_->block, repeat_->attempt, idle_since};
  std::optional<Next> found;
  for (std::size_t i = 1; i <= blocks_.size(); ++i) {
    const std::size_t n = (last_block_ + i) % blocks_.size();  // who was served last comes last among equals
    if (writes(blocks_[n].function) && !states_[n].armed) continue;
    const Nanoseconds ready = std::max(ready_ns(n), idle_since);
    if (!found || ready < found->start_ns) found = Next{n, 0, ready};
  }
  return found;
}

const Request& Poller::begin(const Next& next) noexcept {
  const Block& block = blocks_[next.block];
  State& state = states_[next.block];
  now_ = next;
  repeat_.reset();
  request_.function = block.function;
  request_.address = block.address;
  request_.count = block.count;
  request_.coding = block.coding;
  if (writes(block.function)) request_.data = state.data;
  state.changed = false;
  if (next.attempt == 0) state.due_ns = std::max(state.due_ns + block.period_ns, next.start_ns);
  last_block_ = next.block;
  ++transactions_;
  return request_;
}

Outcome Poller::answered(const Response& response, Nanoseconds end) noexcept {
  if (response.exception != Exception::none) {
    health_of(now_.block).last_exception = response.exception;
    Outcome outcome = failed(end);
    outcome.exception = response.exception;
    return outcome;
  }
  State& state = states_[now_.block];
  // This may be the late answer to what was repeated.
  if (now_.attempt > 0) state.awaited_ns = end + settings_.late_ns;
  health_of(now_.block).lost = false;
  const bool written = writes(response.function);
  if (written && state.changed) state.due_ns = std::min(state.due_ns, end);
  Outcome outcome{now_.block, true, Exception::none, end, {}};
  if (!written || request_.coding == Coding::huanyang) outcome.data = response.data;
  return outcome;
}

Outcome Poller::unanswered(Nanoseconds end) noexcept {
  Health& health = health_of(now_.block);
  const Outcome outcome = failed(end);
  states_[now_.block].awaited_ns = end + settings_.late_ns;
  if (!health.lost && now_.attempt < settings_.retries) {
    repeat_ = Next{now_.block, now_.attempt + 1, end};
    return outcome;
  }
  health.lost = true;
  health.retry_ns = end + settings_.lost_retry_ns;
  return outcome;
}

Outcome Poller::failed(Nanoseconds end) noexcept {
  ++health_of(now_.block).errors;
  if (writes(blocks_[now_.block].function)) states_[now_.block].changed = true;
  return {now_.block, false, Exception::none, end, {}};
}

void Poller::write(std::size_t block, const Data& data, Nanoseconds t) noexcept {
  State& state = states_[block];
  state.data = data;
  state.armed = state.changed = true;
  state.due_ns = std::min(state.due_ns, t);
}

}  // namespace servogate::modbus
