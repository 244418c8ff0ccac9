// SPDX-License-Identifier: Apache-2.0
#include "drivers/slcan/slcan_bus.hpp"

#include <poll.h>
#include <termios.h>

#include <algorithm>

#include "drivers/bus_thread.hpp"
#include "drivers/clock.hpp"

namespace servogate::slcan {
namespace {

using image::CanState;
using image::kMillisecond;

const text::Entry kNoBitRate{"slcan.no-bit-rate",
                             "the bit rate of {0} has to be said (--bit-rate 500000, or the bus of a machine "
                             "file): an adapter at a wrong rate disturbs the bus",
                             "для {0} нужно указать скорость (--bit-rate 500000 или шина файла машины): "
                             "адаптер с неверной скоростью мешает шине"};
const text::Entry kNoRate{
    "slcan.no-rate",
    "an adapter on a serial port has no {1} bit/s: 10, 20, 50, 100, 125, 250, 500, 800 kbit/s or 1 Mbit/s "
    "({0})",
    "у адаптера на последовательном порту нет {1} бит/с: 10, 20, 50, 100, 125, 250, 500, 800 кбит/с или 1 "
    "Мбит/с ({0})"};
const text::Entry kNoAnswer{
    "slcan.no-answer",
    "no CAN adapter answers on the serial port {0}: see whether it is this port, its firmware speaks slcan, "
    "and, "
    "where it is no USB device itself, whether {1} baud are right (slcan:{0}@BAUD)",
    "на последовательном порту {0} не отвечает адаптер CAN: проверьте порт, прошивку (slcan) и, если адаптер "
    "сам не устройство USB, скорость {1} бод (slcan:{0}@БОД)"};
const text::Entry kRefuses{"slcan.refuses", "the adapter on {0} refuses {1}",
                           "адаптер на {0} отказывается: {1}"};

image::Nanoseconds now_ns() noexcept { return drivers::clock_ns(CLOCK_MONOTONIC); }

int milliseconds_until(image::Nanoseconds due) noexcept {
  return static_cast<int>(
      std::max<image::Nanoseconds>(0, (due - now_ns() + kMillisecond - 1) / kMillisecond));
}

}  // namespace

std::unique_ptr<SlcanBus> SlcanBus::open(const SlcanConfig& config, drivers::Notice& why) {
  if (config.bit_rate == 0) {
    why = {&kNoBitRate, {config.place.path}};
    return nullptr;
  }
  if (!rate_digit(config.bit_rate)) {
    why = {&kNoRate, {config.place.path, std::to_string(config.bit_rate)}};
    return nullptr;
  }
  auto port = SerialPort::open(config.place, why);
  if (!port) return nullptr;
  std::unique_ptr<SlcanBus> bus(new SlcanBus(std::move(*port), config));
  if (!bus->start(why)) return nullptr;
  bus->thread_ = std::thread([b = bus.get()] { b->work(); });
  return bus;
}

SlcanBus::SlcanBus(SerialPort port, SlcanConfig config)
    : port_(std::move(port)), config_(std::move(config)) {}

SlcanBus::~SlcanBus() {
  if (!thread_.joinable()) return;
  wake_.end();
  thread_.join();
  if (state() != CanState::down && put("C\r")) tcdrain(port_.descriptor());
}

/// A channel that is open already, and the half of a command that somebody left there, are ended first.
/// Answers to that may be many or none; the version comes behind them.
bool SlcanBus::somebody_answers() {
  if (!put("\r\r\rC\rV\r")) return false;
  bool any = false;
  while (const auto answer = hear()) {
    any = true;
    if (answer->kind == Answer::Kind::other) break;
  }
  return any;
}

bool SlcanBus::start(drivers::Notice& why) {
  const std::string& path = config_.place.path;
  if (!somebody_answers()) {
    why = {&kNoAnswer, {path, std::to_string(config_.place.baud)}};
    return false;
  }
  const auto refused = [&](std::string command, const std::string& what) {
    command += kEnd;
    if (!put(command)) {
      why = {&kNoAnswer, {path, std::to_string(config_.place.baud)}};
      return true;
    }
    const auto answer = hear();  // there are some that do not answer to these
    if (!answer || answer->kind != Answer::Kind::refused) return false;
    why = {&kRefuses, {path, what}};
    return true;
  };
  if (refused(std::string("S") + *rate_digit(config_.bit_rate),
              std::to_string(config_.bit_rate) + " bit/s") ||
      refused(config_.listen_only ? "L" : "O", config_.listen_only ? "listen-only" : "open"))
    return false;
  const auto flags = put("F\r") ? hear() : std::nullopt;
  has_flags_ = flags && flags->kind == Answer::Kind::flags;
  if (has_flags_) set_flags(flags->flags);
  flags_due_ns_ = now_ns() + kFlagsEvery;
  return true;
}

/// Before the thread begins and behind its end. False: the port takes nothing.
bool SlcanBus::put(std::string_view command) {
  const image::Nanoseconds end = now_ns() + config_.answer_within;
  for (;;) {
    const int n = port_.write(command);
    if (n > 0) command.remove_prefix(static_cast<std::size_t>(n));
    if (command.empty()) return true;
    if (n < 0 || now_ns() > end) return false;
    pollfd ready{port_.descriptor(), POLLOUT, 0};
    ::poll(&ready, 1, milliseconds_until(end));
  }
}

/// The next answer; frames that come meanwhile are delivered. nullopt: none in time.
std::optional<Answer> SlcanBus::hear() {
  const image::Nanoseconds end = now_ns() + config_.answer_within;
  while (now_ns() < end) {
    char c = 0;
    int n = 0;
    while ((n = port_.read(&c, 1)) > 0) {
      const auto answer = reader_.put(c);
      if (answer && answer->kind != Answer::Kind::frame) return answer;
      if (answer) take(*answer, now_ns());
    }
    if (n < 0) return std::nullopt;
    pollfd ready{port_.descriptor(), POLLIN, 0};
    ::poll(&ready, 1, milliseconds_until(end));
  }
  return std::nullopt;
}

bool SlcanBus::send(const image::CanFrame& frame) noexcept {
  if (frame.error || frame.fd || frame.length > 8 || config_.listen_only) return false;
  if (state() == CanState::down || !outgoing_.try_enqueue(frame)) return false;
  wake_.wake();
  return true;
}

bool SlcanBus::receive(image::CanFrame& frame) noexcept {
  if (incoming_.try_dequeue(frame)) return true;
  told_.clear();
  return incoming_.try_dequeue(frame);
}

void SlcanBus::work() noexcept {
  drivers::begin_bus_thread("slcan");
  while (!wake_.ended()) {
    image::CanFrame frame;
    while (queue_.size() < drivers::SendQueue::kCapacity && outgoing_.try_dequeue(frame)) queue_.push(frame);
    const image::Nanoseconds now = now_ns();
    if (has_flags_ && now >= flags_due_ns_) {
      asks_flags_ = true;
      flags_due_ns_ = now + kFlagsEvery;
    }
    const bool writes = may_write() && has_room(now);
    pollfd ready[] = {{port_.descriptor(), static_cast<short>(POLLIN | (writes ? POLLOUT : 0)), 0},
                      {wake_.descriptor(), POLLIN, 0}};
    ::poll(ready, 2, 20);
    if ((ready[1].revents & POLLIN) != 0) wake_.clear();
    const bool gone = (ready[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    if (!read() || gone || ((ready[0].revents & POLLOUT) != 0 && !write())) return go_down();
  }
}

bool SlcanBus::read() noexcept {
  std::array<char, 512> bytes;
  const int n = port_.read(bytes.data(), bytes.size());
  const image::Nanoseconds now = now_ns();
  for (int i = 0; i < n; ++i)
    if (const auto answer = reader_.put(bytes[static_cast<std::size_t>(i)])) take(*answer, now);
  return n >= 0;
}

/// A command that has begun is ended before anything else.
bool SlcanBus::has_room(image::Nanoseconds now) noexcept {
  if (rest_ > 0) return true;
  if (in_adapter_ > 0 && now - last_sent_ns_ > kPatience) in_adapter_ = 0;
  return !acknowledges_ || in_adapter_ < kInAdapter || asks_flags_;
}

void SlcanBus::next_command(image::Nanoseconds now) noexcept {
  begun_ = 0;
  const bool room = !acknowledges_ || in_adapter_ < kInAdapter;
  if (!queue_.empty() && room) {
    rest_ = encode(queue_.first(), command_);
    queue_.pop();
    ++in_adapter_;
    last_sent_ns_ = now;
  } else if (asks_flags_) {
    command_[0] = 'F';
    command_[1] = kEnd;
    rest_ = 2;
    asks_flags_ = false;
  }
}

bool SlcanBus::write() noexcept {
  if (rest_ == 0) next_command(now_ns());
  if (rest_ == 0) return true;
  const int n = port_.write({command_.data() + begun_, rest_});
  if (n < 0) return false;
  begun_ += static_cast<std::size_t>(n);
  rest_ -= static_cast<std::size_t>(n);
  return true;
}

void SlcanBus::acknowledge(bool good) noexcept {
  if (!good) lost_.fetch_add(1, std::memory_order_relaxed);
  if (in_adapter_ == 0) return;
  acknowledges_ = true;
  --in_adapter_;
}

void SlcanBus::take(const Answer& answer, image::Nanoseconds now) noexcept {
  switch (answer.kind) {
    case Answer::Kind::done:
    case Answer::Kind::sent:
      return acknowledge(true);
    case Answer::Kind::refused:
      return acknowledge(in_adapter_ == 0);
    case Answer::Kind::flags:
      return set_flags(answer.flags);
    case Answer::Kind::frame: {
      image::CanFrame frame = answer.frame;
      frame.timestamp_ns = now;
      return deliver(frame);
    }
    case Answer::Kind::other:
      return;
  }
}

void SlcanBus::set_flags(std::uint8_t flags) noexcept {
  const CanState now = (flags & flag::kPassive) != 0   ? CanState::error_passive
                       : (flags & flag::kWarning) != 0 ? CanState::error_warning
                                                       : CanState::error_active;
  if ((flags & (flag::kReceiveFull | flag::kOverrun)) != 0) lost_.fetch_add(1, std::memory_order_relaxed);
  if (state_.exchange(now, std::memory_order_acq_rel) != now) told_.wake();
}

void SlcanBus::go_down() noexcept {
  state_.store(CanState::down, std::memory_order_release);
  std::uint64_t thrown = queue_.clear();
  image::CanFrame frame;
  while (outgoing_.try_dequeue(frame)) ++thrown;
  lost_.fetch_add(thrown, std::memory_order_relaxed);
  told_.wake();
}

void SlcanBus::deliver(const image::CanFrame& frame) noexcept {
  if (!incoming_.try_enqueue(frame)) lost_.fetch_add(1, std::memory_order_relaxed);
  told_.wake();
}

}  // namespace servogate::slcan
