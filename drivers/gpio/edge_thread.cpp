// SPDX-License-Identifier: Apache-2.0
#include "drivers/gpio/edge_thread.hpp"

#include <poll.h>
#include <pthread.h>

namespace servogate::gpio {

EdgeThread::EdgeThread(InputLines& inputs, std::vector<bool> told, const std::vector<Encoder>& encoders)
    : inputs_(inputs), lines_(told.size()), encoders_(encoders.size()) {
  for (std::size_t n = 0; n < told.size(); ++n) lines_[n].told = told[n];
  std::uint64_t levels = 0;
  inputs_.read(levels);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    lines_[n].level = (levels >> n & 1u) != 0;
    lines_[n].ahead = true;
  }
  for (std::size_t e = 0; e < encoders.size(); ++e) {
    encoders_[e].lines = encoders[e];
    encoders_[e].decoder.seat(lines_[encoders[e].a].level, lines_[encoders[e].b].level);
    lines_[encoders[e].a].encoder = lines_[encoders[e].b].encoder = static_cast<int>(e);
    lines_[encoders[e].b].track_b = true;
  }
  thread_ = std::thread([this] { work(); });
}

EdgeThread::~EdgeThread() {
  waker_.end();
  thread_.join();
}

bool EdgeThread::take(LineEvent& event) noexcept {
  const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
  if (tail == head_.load(std::memory_order_acquire)) return false;
  event = queue_[tail % kRoom];
  tail_.store(tail + 1, std::memory_order_release);
  return true;
}

void EdgeThread::work() noexcept {
  pthread_setname_np(pthread_self(), "gpio-edges");
  std::array<LineEvent, 32> events;
  while (!waker_.ended()) {
    const int count = inputs_.take(events);
    if (count < 0) break;
    for (int n = 0; n < count; ++n) take_in(events[static_cast<std::size_t>(n)]);
    if (count > 0) continue;
    settle_doubt();
    pollfd waits[] = {{inputs_.descriptor(), POLLIN, 0}, {waker_.descriptor(), POLLIN, 0}};
    if (::poll(waits, 2, -1) > 0 && (waits[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) break;
  }
  ended_.store(true, std::memory_order_release);
}

void EdgeThread::take_in(const LineEvent& event) noexcept {
  if (event.line >= lines_.size()) return;
  Line& line = lines_[event.line];
  taken_.fetch_add(1, std::memory_order_acq_rel);
  if (!line.ahead || event.level != line.level || event.number != line.number + 1) count_in(line, event);
  line.number = event.number;
  line.level = event.level;
  line.ahead = false;
  if (line.told) keep(event);
}

/// Where the kernel misses no number, an interrupt may: its handler has found the same level twice.
void EdgeThread::count_in(Line& line, const LineEvent& event) noexcept {
  const std::uint32_t missing = event.number - line.number - 1;
  const std::uint32_t gone = missing > 0 ? missing : event.level == line.level ? 1 : 0;
  if (gone > 0) lose(gone);
  if (line.encoder < 0) return;
  Counter& counter = encoders_[static_cast<std::size_t>(line.encoder)];
  counter.doubt = counter.doubt || gone > 0;
  counter.decoder.edge(line.track_b, event.level, event.t_ns);
  show(counter);
}

void EdgeThread::keep(const LineEvent& event) noexcept {
  const std::uint32_t head = head_.load(std::memory_order_relaxed);
  if (head - tail_.load(std::memory_order_acquire) == kRoom) return lose(1);
  queue_[head % kRoom] = event;
  head_.store(head + 1, std::memory_order_release);
}

/// Where edges are missing the levels themselves are looked at, once no edge waits any more.
void EdgeThread::settle_doubt() noexcept {
  for (Counter& counter : encoders_) {
    if (!counter.doubt) continue;
    std::uint64_t levels = 0;
    if (!inputs_.read(levels)) return;
    for (const std::size_t n : {counter.lines.a, counter.lines.b}) {
      const bool level = (levels >> n & 1u) != 0;
      lines_[n].ahead = level != lines_[n].level;
      lines_[n].level = level;
    }
    counter.decoder.settle(lines_[counter.lines.a].level, lines_[counter.lines.b].level);
    counter.doubt = false;
    show(counter);
  }
}

void EdgeThread::show(Counter& counter) noexcept {
  counter.count.store(counter.decoder.count(), std::memory_order_release);
  std::uint32_t errors = 0;
  for (const Counter& c : encoders_) errors += c.decoder.errors();
  errors_.store(errors, std::memory_order_release);
}

}  // namespace servogate::gpio
