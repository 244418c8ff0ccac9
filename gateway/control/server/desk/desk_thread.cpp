// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/desk_thread.hpp"

#include <chrono>

#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

constexpr std::chrono::milliseconds kLookAfter{200};  ///< what the machine has learned

}  // namespace

DeskThread::DeskThread(Resident& resident, Give give) : resident_(resident), give_(std::move(give)) {}

void DeskThread::start() {
  thread_ = std::thread([this] { run(); });
}

void DeskThread::take(Question question) {
  const std::scoped_lock lock(mutex_);
  queues_[question.ticket.client].questions.push_back(std::move(question));
  wake_.notify_one();
}

void DeskThread::gone(std::uint64_t client) {
  const std::scoped_lock lock(mutex_);
  queues_[client].gone = true;
  wake_.notify_one();
}

void DeskThread::stop() {
  if (!thread_.joinable()) return;
  thought_.cancel();
  {
    const std::scoped_lock lock(mutex_);
    end_ = true;
  }
  wake_.notify_one();
  thread_.join();
  thought_.close();
  files_.close();
  // Whoever still waits is told what came of it, or that the control ends.
  for (const Done& done : done_) {
    Outcome outcome = done.finish ? done.finish() : Outcome(Work{});
    Reply* const reply = std::get_if<Reply>(&outcome);
    if (done.question.ticket.client != 0)
      give_(done.question.ticket, reply != nullptr
                                      ? std::move(*reply)
                                      : refuse(says::kEnding, {}, kAlarm, done.question.caller.language));
  }
}

void DeskThread::run() {
  auto looked = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (!end_) {
    if (!turn(lock)) wake_.wait_for(lock, kLookAfter);
    const auto now = std::chrono::steady_clock::now();
    if (end_ || now - looked < kLookAfter) continue;
    looked = now;
    lock.unlock();
    for (Work& work : resident_.look_after()) order({}, std::move(work));
    plc_.look_after();
    lock.lock();
  }
}

/// One thing: what was worked for, else a question of the next client in turn. False: there is nothing.
bool DeskThread::turn(std::unique_lock<std::mutex>& lock) {
  if (!done_.empty()) {
    Done done = std::move(done_.front());
    done_.pop_front();
    lock.unlock();
    settle(done.question, done.finish
                              ? done.finish()
                              : Outcome(refuse(says::kEnding, {}, kAlarm, done.question.caller.language)));
    lock.lock();
    return true;
  }
  const auto waits = [](const Queue& q) { return !q.works && (q.gone || !q.questions.empty()); };
  auto next = queues_.upper_bound(served_);
  for (std::size_t n = 0; n <= queues_.size(); ++n, ++next) {
    if (next == queues_.end()) next = queues_.begin();
    if (next == queues_.end() || waits(next->second)) break;
  }
  if (next == queues_.end() || !waits(next->second)) return false;
  served_ = next->first;
  if (next->second.questions.empty()) {
    queues_.erase(next);
    lock.unlock();
    plc_.release_of(served_);
    lock.lock();
    return true;
  }
  const Question question = std::move(next->second.questions.front());
  next->second.questions.pop_front();
  next->second.works = true;
  lock.unlock();
  settle(question, dispatch(resident_, plc_, question));
  lock.lock();
  return true;
}

void DeskThread::settle(const Question& question, Outcome outcome) {
  if (Work* work = std::get_if<Work>(&outcome))
    order(question, std::move(*work));
  else
    answered(question, std::move(std::get<Reply>(outcome)));
}

void DeskThread::answered(const Question& question, Reply reply) {
  resident_.works().end(question.ticket);
  if (question.ticket.client == 0) return;
  give_(question.ticket, std::move(reply));
  const std::scoped_lock lock(mutex_);
  if (const auto queue = queues_.find(question.ticket.client); queue != queues_.end())
    queue->second.works = false;
}

void DeskThread::order(Question question, Work work) {
  resident_.works().begin(question.ticket, work.what, work.name);
  Workshop& shop = work.bench == Work::Bench::files ? files_ : thought_;
  shop.take(std::move(work), [this, question = std::move(question)](Finish finish) {
    const std::scoped_lock lock(mutex_);
    done_.push_back({question, std::move(finish)});
    wake_.notify_one();
  });
}

}  // namespace servogate::gateway
