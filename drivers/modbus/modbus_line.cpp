// SPDX-License-Identifier: Apache-2.0
#include "drivers/modbus/modbus_line.hpp"

#include <poll.h>
#include <pthread.h>

#include <algorithm>

#include "drivers/clock.hpp"
#include "firmware_if/modbus/line_time.hpp"

namespace servogate::modbus {

using image::Nanoseconds;

namespace {

constexpr Nanoseconds kLook = 10 * image::kMillisecond;  ///< at a cycle that does not come
/// A unit on a wire that has not answered for so long will not answer that request any more.
constexpr Nanoseconds kLatest = image::kSecond;
/// Failed transactions of a block that one cycle takes in.
constexpr std::uint32_t kMostFaults = 16;

Nanoseconds now_ns() noexcept { return drivers::clock_ns(CLOCK_MONOTONIC); }

PollSettings polling(const LineSettings& settings) {
  PollSettings poll = settings.poll;
  // A TCP connection is opened anew, which no late answer survives.
  if (std::holds_alternative<SerialPort>(settings.link.peer))
    poll.late_ns = std::max(kLatest, 2 * settings.link.answer_timeout_ns);
  return poll;
}

}  // namespace

ModbusLine::ModbusLine(const LineSettings& settings, const Map& map, const std::vector<Unit>& units)
    : exchange_(map, units, settings.stale_after_periods),
      boxes_(map.blocks.size()),
      link_(settings.link),
      poller_(polling(settings), map.blocks),
      silence_ns_(LineTime(link_.baud()).silence()) {}

std::unique_ptr<ModbusLine> ModbusLine::open(const LineSettings& settings, const Map& map,
                                             const std::vector<Unit>& units, drivers::Notice& why) {
  std::unique_ptr<ModbusLine> line(new ModbusLine(settings, map, units));
  if (line->link_.serial()) {
    if (!line->link_.open(why)) return nullptr;
    line->tally_.opened();
    line->linked_ = true;
  }
  line->thread_ = std::thread([l = line.get()] { l->work(); });
  return line;
}

ModbusLine::~ModbusLine() {
  if (!thread_.joinable()) return;
  exchange_.leave(letters_);
  waker_.end();
  thread_.join();
}

void ModbusLine::receive(image::ProcessImage& image, image::Notices&) noexcept {
  const Nanoseconds now = now_ns();
  last_cycle_ns_.store(now, std::memory_order_release);
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    Box& box = boxes_[b];
    const Arrived* arrived = box.arrived.take();
    if (arrived == nullptr) continue;
    const std::uint32_t faults = std::min(arrived->faults - box.faults_taken, kMostFaults);
    box.faults_taken = arrived->faults;
    for (std::uint32_t n = 0; n < faults; ++n) exchange_.take({b, false, Exception::none, 0, {}});
    if (arrived->outcome.end_ns == box.taken_ns) continue;
    box.taken_ns = arrived->outcome.end_ns;
    Outcome outcome = arrived->outcome;
    // The cycle's time is not the computer's, which goes on when cycles are late; ages are the same in both.
    outcome.end_ns = std::max<Nanoseconds>(0, image.now.t_ns - (now - arrived->outcome.end_ns));
    exchange_.take(outcome);
  }
  exchange_.receive(image);
}

void ModbusLine::send(image::ProcessImage& image) noexcept { exchange_.send(image, letters_); }

void ModbusLine::Letters::write(std::size_t block, const Data& data, Nanoseconds) noexcept {
  line_.boxes_[block].to_write.put(data);
  line_.waker_.wake();
}

void ModbusLine::work() noexcept {
  pthread_setname_np(pthread_self(), "modbus");
  while (!waker_.ended()) {
    const Nanoseconds now = now_ns();
    take_letters(now);
    if (!cycles_come(now)) {
      wait_until(now + kLook);
    } else if (!link_.is_open()) {
      open_link(now);
    } else if (const auto next = poller_.next(idle_since_ns_); !next || next->start_ns > now) {
      wait_until(std::min(next ? next->start_ns : now + kSilentCycle, now + kSilentCycle));
    } else {
      transact(*next);
    }
  }
  take_leave();
}

/// Whether there is a control to work for. After a pause everything is due at once.
bool ModbusLine::cycles_come(Nanoseconds now) noexcept {
  const Nanoseconds last = last_cycle_ns_.load(std::memory_order_acquire);
  const bool come = last >= 0 && now - last < kSilentCycle;
  if (come && !polling_) poller_.start_at(now);
  polling_ = come;
  return come;
}

void ModbusLine::open_link(Nanoseconds now) {
  if (now < open_at_ns_) return wait_until(open_at_ns_);
  drivers::Notice why;
  if (link_.open(why)) {
    tally_.opened();
    linked_ = true;
    idle_since_ns_ = now_ns();
  } else {
    tally_.not_opened();
    linked_ = false;
    pause_ns_ = std::max(pause_ns_, kFirstPause);
    pause();
  }
}

void ModbusLine::transact(const Poller::Next& next) {
  const Request& request = poller_.begin(next);
  Response response;
  tally_.asked(next.attempt > 0);
  const Heard heard = link_.exchange(poller_.blocks()[next.block].unit, request, response, &waker_);
  const Nanoseconds end = now_ns();
  idle_since_ns_ = end + silence_ns_;
  tally_.heard(heard, heard == Heard::answer && response.exception != Exception::none);
  if (heard == Heard::given_up) return link_.close();  // its answer may still come
  const Outcome outcome =
      heard == Heard::answer ? poller_.answered(response, end) : poller_.unanswered(idle_since_ns_);
  Box& box = boxes_[next.block];
  if (outcome.good)
    box.known.outcome = outcome;
  else
    ++box.known.faults;
  box.arrived.put(box.known);
  if (heard == Heard::answer)
    pause_ns_ = 0;
  else
    drop_link(heard == Heard::broken);
}

/// A connection that ends is opened again at once, and ever later when it does so again before any answer. A
/// unit without an answer is no reason to let its neighbours wait.
void ModbusLine::drop_link(bool broken) noexcept {
  link_.close();
  linked_ = !broken;
  open_at_ns_ = now_ns();
  if (broken) pause();
}

void ModbusLine::pause() noexcept {
  open_at_ns_ = now_ns() + pause_ns_;
  pause_ns_ = std::clamp(2 * pause_ns_, kFirstPause, kLastPause);
}

void ModbusLine::take_letters(Nanoseconds now) noexcept {
  for (std::size_t b = 0; b < boxes_.size(); ++b)
    if (const Data* data = boxes_[b].to_write.take(); data != nullptr) {
      boxes_[b].wanted = *data;
      poller_.write(b, *data, now);
    }
}

/// Writes the newest of every block once more: the poller may hold it, and may not have come to it. Units
/// that are lost are not waited for; others are asked twice.
void ModbusLine::take_leave() {
  waker_.clear();
  take_letters(now_ns());
  if (!linked_) return;
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    const std::optional<Data>& data = boxes_[b].wanted;
    if (!data || poller_.lost(poller_.blocks()[b].unit)) continue;
    if (!write_now(b, *data)) write_now(b, *data);
  }
}

bool ModbusLine::write_now(std::size_t block, const Data& data) {
  drivers::Notice why;
  if (!link_.is_open() && !link_.open(why)) return false;
  const Block& b = poller_.blocks()[block];
  const Request request{b.function, b.address, b.count, data, b.coding};
  Response response;
  wait_until(idle_since_ns_);
  const Heard heard = link_.exchange(b.unit, request, response, nullptr);
  idle_since_ns_ = now_ns() + silence_ns_;
  tally_.heard(heard);
  if (heard != Heard::answer) link_.close();
  return heard == Heard::answer;
}

void ModbusLine::wait_until(Nanoseconds t) noexcept {
  pollfd woken{waker_.descriptor(), POLLIN, 0};
  const Nanoseconds left = std::max<Nanoseconds>(0, t - now_ns());
  const timespec patience{static_cast<time_t>(left / image::kSecond),
                          static_cast<long>(left % image::kSecond)};
  if (ppoll(&woken, 1, &patience, nullptr) > 0) waker_.clear();
}

}  // namespace servogate::modbus
