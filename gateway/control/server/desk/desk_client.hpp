// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "gateway/control/server/desk/desk.hpp"

namespace servogate::gateway {

/// A client of the desk inside this process: a pendant, a page, a Modbus server, a scenario. What it holds
/// ends with it. Any thread.
class DeskClient {
 public:
  /// `user`: name that others are told.
  DeskClient(Desk& desk, image::Asker asker, std::string user, text::Language language);
  ~DeskClient();
  DeskClient(const DeskClient&) = delete;

  /// Whose jogs are this client's.
  image::Hand hand() const noexcept { return {caller_.asker, static_cast<std::uint32_t>(number_)}; }
  /// Asks and goes on; the number of the question.
  std::uint64_t ask(ask::Command command);
  /// The answer to a question, once; nullopt: it has not come yet.
  std::optional<Reply> take(std::uint64_t question);
  /// Asks and waits; nullopt: no answer within `patience`.
  std::optional<Reply> ask(ask::Command command, std::chrono::milliseconds patience);
  /// Snapshots of the machine from now on, instead of those asked for before (Subscriptions). They end with
  /// the client. Not from `seen`.
  void subscribe(std::chrono::milliseconds period, Subscriptions::Seen seen);

 private:
  Desk& desk_;
  Caller caller_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::uint64_t asked_ = 0;
  std::map<std::uint64_t, Reply> answers_;
  std::uint64_t number_;
  std::optional<std::uint64_t> subscription_;
};

}  // namespace servogate::gateway
