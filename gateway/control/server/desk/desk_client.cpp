// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/desk_client.hpp"

#include <utility>

namespace servogate::gateway {

DeskClient::DeskClient(Desk& desk, image::Asker asker, std::string user, text::Language language)
    : desk_(desk),
      caller_{.asker = asker, .user = std::move(user), .language = language, .gone = nullptr},
      number_(desk.open([this](std::uint64_t question, Reply reply) {
        const std::scoped_lock lock(mutex_);
        answers_.emplace(question, std::move(reply));
        came_.notify_all();
      })) {}

DeskClient::~DeskClient() {
  if (subscription_) desk_.subscriptions().unsubscribe(*subscription_);
  desk_.close(number_);
}

void DeskClient::subscribe(std::chrono::milliseconds period, Subscriptions::Seen seen) {
  if (subscription_) desk_.subscriptions().unsubscribe(*subscription_);
  subscription_ = desk_.subscriptions().subscribe(period, std::move(seen));
}

std::uint64_t DeskClient::ask(ask::Command command) {
  std::uint64_t question = 0;
  {
    const std::scoped_lock lock(mutex_);
    question = ++asked_;
  }
  Caller caller = caller_;
  caller.since = std::chrono::steady_clock::now();
  desk_.ask(number_, question, std::move(command), std::move(caller));
  return question;
}

std::optional<Reply> DeskClient::take(std::uint64_t question) {
  const std::scoped_lock lock(mutex_);
  const auto found = answers_.extract(question);
  return found.empty() ? std::nullopt : std::optional(std::move(found.mapped()));
}

std::optional<Reply> DeskClient::ask(ask::Command command, std::chrono::milliseconds patience) {
  const std::uint64_t question = ask(std::move(command));
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, patience, [&] { return answers_.contains(question); });
  lock.unlock();
  return take(question);
}

}  // namespace servogate::gateway
