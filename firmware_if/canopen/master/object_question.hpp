// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <span>

#include "firmware_if/canopen/301/sdo_client.hpp"

namespace servogate::canopen {

/// An object of a node that somebody outside the cycle wants to read: one question at a time. The cycle asks
/// the node by turns with the master's own accesses over SDO, which may come later by one short transfer.
/// Process data come first. Asked by one thread, answered by the cycle's. All members are real-time safe.
class ObjectQuestion {
 public:
  /// The asker: false, a question is under way.
  bool ask(NodeId node, std::uint16_t index, std::uint8_t subindex) noexcept {
    if (state_.load(std::memory_order_acquire) != State::idle) return false;
    node_ = node;
    index_ = index;
    subindex_ = subindex;
    state_.store(State::asked, std::memory_order_release);
    return true;
  }
  /// The asker: the answer has come. An object longer than SdoClient::kBuffer ends with
  /// AbortCode::out_of_memory.
  bool answered() const noexcept { return state_.load(std::memory_order_acquire) == State::answered; }
  SdoStatus status() const noexcept { return status_; }
  AbortCode abort() const noexcept { return abort_; }
  std::span<const std::uint8_t> data() const noexcept { return std::span(data_).first(size_); }
  /// The asker: has read the answer, or waits no longer. What the node is asked already is still waited for.
  void done() noexcept {
    State expected = State::asked;
    if (state_.compare_exchange_strong(expected, State::idle)) return;
    expected = State::running;
    if (state_.compare_exchange_strong(expected, State::abandoned)) return;
    state_.store(State::idle, std::memory_order_release);
  }

  /// The cycle: takes a question to this node and starts it. False: there is none.
  bool start(NodeId node, SdoClient& sdo) noexcept {
    if (state_.load(std::memory_order_acquire) != State::asked || node_ != node) return false;
    State expected = State::asked;
    return state_.compare_exchange_strong(expected, State::running) && sdo.upload(index_, subindex_);
  }
  /// The cycle: the transfer has ended.
  void finish(const SdoClient& sdo) noexcept {
    status_ = sdo.result().status;
    abort_ = sdo.result().abort;
    size_ = 0;
    if (status_ == SdoStatus::done)
      for (const std::uint8_t byte : sdo.data()) data_[size_++] = byte;
    settle();
  }
  /// The cycle: the node is gone.
  void give_up() noexcept {
    status_ = SdoStatus::no_answer;
    abort_ = AbortCode::timed_out;
    size_ = 0;
    settle();
  }

 private:
  enum class State : std::uint8_t { idle, asked, running, abandoned, answered };
  void settle() noexcept {
    State expected = State::running;
    if (!state_.compare_exchange_strong(expected, State::answered)) state_.store(State::idle);
  }

  std::atomic<State> state_{State::idle};
  NodeId node_ = 0;
  std::uint16_t index_ = 0;
  std::uint8_t subindex_ = 0;
  SdoStatus status_ = SdoStatus::idle;
  AbortCode abort_ = AbortCode::none;
  std::size_t size_ = 0;
  std::array<std::uint8_t, SdoClient::kBuffer> data_{};
};

}  // namespace servogate::canopen
