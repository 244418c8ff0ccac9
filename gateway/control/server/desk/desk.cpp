// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/desk.hpp"

#include <utility>

#include "gateway/control/server/protocol/texts.hpp"
#include "gateway/control/server/resident/resident.hpp"

namespace servogate::gateway {

using std::chrono::milliseconds;

namespace {

// Between two looks of the watching thread; whatever is asked wakes it.
constexpr milliseconds kLookAtAnswers{1};
constexpr milliseconds kLookAtJogs{10};
constexpr milliseconds kLookAtShutDown{20};
constexpr milliseconds kLook{200};

}  // namespace

Desk::Desk(Resident& resident)
    : resident_(resident),
      urgent_(resident.control(), resident.requests(), resident.speed()),
      shut_down_(resident.control(), resident.requests(), resident.announce()),
      desk_(resident, [this](const Ticket& ticket, Reply reply) { give(ticket, std::move(reply)); }),
      subscriptions_(resident.control()) {}

void Desk::start() {
  desk_.start();
  subscriptions_.start();
  watching_ = std::thread([this] { watch(); });
}

void Desk::stop() {
  subscriptions_.stop();
  desk_.stop();
  if (!watching_.joinable()) return;
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
    wake_.notify_one();
  }
  watching_.join();
}

std::uint64_t Desk::open(Give give) {
  auto client = std::make_shared<Client>();
  client->give = std::move(give);
  const std::scoped_lock lock(mutex_);
  clients_.emplace(++last_client_, std::move(client));
  return last_client_;
}

void Desk::close(std::uint64_t client) {
  std::shared_ptr<Client> gone;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = clients_.find(client);
    if (found == clients_.end()) return;
    gone = std::move(found->second);
    *gone->gone = true;
    clients_.erase(found);
    urgent_.let_go(client);
  }
  desk_.gone(client);
  const std::scoped_lock giving(gone->giving);
  gone->give = nullptr;
}

void Desk::ask(std::uint64_t client, std::uint64_t question, ask::Command command, Caller caller) {
  caller.connection = client;
  caller.gone = gone_of(client);
  if (caller.left) *caller.gone = true;
  const text::Language language = caller.language;
  Question asked{{client, question}, std::move(command), std::move(caller), resident_.requests().stops()};
  if (!ask::is_urgent(asked.command)) return desk_.take(std::move(asked));
  if (ask::is_any<ask::Down>(asked.command)) {
    resident_.set_ending();  // nothing begins behind the answer
    give(asked.ticket, accept(says::kDown, {}, language));
    down_ = true;
    return;
  }
  std::optional<Reply> reply;
  {
    const std::scoped_lock lock(mutex_);
    reply = urgent_.take(asked, resident_.ending());
    asked_ = true;
    wake_.notify_one();
  }
  if (reply) give(asked.ticket, std::move(*reply));
}

/// Of a client that is gone already, too.
std::shared_ptr<std::atomic<bool>> Desk::gone_of(std::uint64_t client) {
  const std::scoped_lock lock(mutex_);
  const auto found = clients_.find(client);
  return found != clients_.end() ? found->second->gone : std::make_shared<std::atomic<bool>>(true);
}

void Desk::give(const Ticket& ticket, Reply reply) {
  std::shared_ptr<Client> client;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = clients_.find(ticket.client); found != clients_.end()) client = found->second;
    if (const auto* jog = std::get_if<JogBegun>(&reply.content)) {
      if (client != nullptr)
        urgent_.begin(ticket.client, *jog);
      else
        urgent_.end(*jog);
      asked_ = true;
      wake_.notify_one();
    }
  }
  if (client == nullptr) return;
  const std::scoped_lock giving(client->giving);
  if (client->give) client->give(ticket.question, std::move(reply));
}

void Desk::shut_down() noexcept {
  shuts_down_ = true;
  const std::scoped_lock lock(mutex_);
  asked_ = true;
  wake_.notify_one();
}

milliseconds Desk::pause() const {
  if (urgent_.waits()) return kLookAtAnswers;
  if (urgent_.jogs()) return kLookAtJogs;
  return shuts_down_ ? kLookAtShutDown : kLook;
}

void Desk::watch() {
  std::unique_lock lock(mutex_);
  while (!end_) {
    asked_ = false;
    auto come = urgent_.look();
    urgent_.watch();
    lock.unlock();
    for (auto& [ticket, reply] : come) give(ticket, std::move(reply));
    if (shuts_down_ && !at_rest_) {
      resident_.set_ending();
      desk_.cancel();
      at_rest_ = shut_down_.look();
    }
    lock.lock();
    wake_.wait_for(lock, pause(), [this] { return asked_ || end_; });
  }
}

}  // namespace servogate::gateway
