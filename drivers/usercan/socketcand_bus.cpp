// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/socketcand_bus.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include "drivers/clock.hpp"

namespace servogate::usercan {
namespace {

const text::Entry kRefused{"usercan.refused", "the bus server at {0} refuses '{1}': {2}",
                           "сервер шины {0} отказывает на «{1}»: {2}"};
const text::Entry kNoAnswer{"usercan.no-answer", "the bus server at {0} does not answer '{1}'",
                            "сервер шины {0} не отвечает на «{1}»"};

constexpr int kPatienceMs = 5000;
/// Room for what is said besides frames, so that `done` is never refused.
constexpr std::size_t kReserve = 1024;

}  // namespace

std::unique_ptr<SocketcandBus> SocketcandBus::open(const SocketcandConfig& config, drivers::Notice& why) {
  const int s = connect_to(config.address, why);
  if (s < 0) return nullptr;
  std::unique_ptr<SocketcandBus> bus(new SocketcandBus(s, config));
  return bus->greet(why) ? std::move(bus) : nullptr;
}

SocketcandBus::SocketcandBus(int socket, SocketcandConfig config)
    : socket_(socket), config_(std::move(config)), in_(kInput), out_(kOutput) {
  realtime_ahead_ = drivers::realtime_ahead();
}

SocketcandBus::~SocketcandBus() {
  flush();
  // A socket that is closed with something unread takes back what it has sent: read on until the server,
  // which has heard everything then, closes its end.
  shutdown(socket_, SHUT_WR);
  const image::Nanoseconds deadline = drivers::clock_ns(CLOCK_MONOTONIC) + 2 * image::kSecond;
  in_begin_ = in_end_ = 0;
  while (config_.lockstep.empty() && connected_ && drivers::clock_ns(CLOCK_MONOTONIC) < deadline)
    if (wait_readable(100) && fill()) in_begin_ = in_end_;
  close(socket_);
}

bool SocketcandBus::greet(drivers::Notice& why) {
  if (!expect({}, "hi", why) || !expect("< open " + config_.bus + " >", "ok", why) ||
      !expect("< rawmode >", "ok", why))
    return false;
  // socketcand itself has no remote frames and says so: that is no reason to refuse it.
  drivers::Notice unknown;
  simulated_ = expect("< remotemode >", "ok", unknown);
  return config_.lockstep.empty() || expect("< lockstep " + config_.lockstep + " >", "ok", why);
}

bool SocketcandBus::expect(std::string_view said, std::string_view word, drivers::Notice& why) {
  if (!said.empty()) say(said);
  flush();
  const std::string what = said.empty() ? "connect" : std::string(said);
  const image::Nanoseconds deadline = drivers::clock_ns(CLOCK_MONOTONIC) + kPatienceMs * image::kMillisecond;
  while (connected_ && drivers::clock_ns(CLOCK_MONOTONIC) < deadline) {
    while (const auto element = next_element()) {
      Words words(*element);
      const std::string_view first = words.next();
      if (first == word) return true;
      if (first != "error") continue;
      why = {&kRefused,
             {config_.address.str(), what, std::string(element->substr(element->find("error") + 5))}};
      return false;
    }
    if (!fill()) wait_readable(100);
  }
  why = {&kNoAnswer, {config_.address.str(), what}};
  return false;
}

bool SocketcandBus::wait_readable(int milliseconds) const {
  pollfd p{socket_, POLLIN, 0};
  return poll(&p, 1, milliseconds) > 0;
}

void SocketcandBus::disconnect() noexcept {
  connected_ = false;
  // Whatever had not left is gone; the caller was told that it was taken.
  for (std::size_t i = 0; i < out_size_; ++i) lost_ += out_[i] == '<' ? 1 : 0;
  out_size_ = 0;
}

void SocketcandBus::say(std::string_view text) noexcept {
  if (text.size() > out_.size() - out_size_) return;
  std::memcpy(out_.data() + out_size_, text.data(), text.size());
  out_size_ += text.size();
}

void SocketcandBus::flush() noexcept {
  while (out_size_ > 0 && connected_) {
    const ssize_t sent = ::send(socket_, out_.data(), out_size_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno != EAGAIN) disconnect();
    if (sent < 0) return;
    out_size_ -= static_cast<std::size_t>(sent);
    std::memmove(out_.data(), out_.data() + sent, out_size_);
  }
}

bool SocketcandBus::send(const image::CanFrame& frame) noexcept {
  if (frame.fd || frame.error || frame.length > 8 || !connected_) return false;
  if (out_.size() - out_size_ < kReserve + kMaxElement) {
    flush();
    if (out_.size() - out_size_ < kReserve + kMaxElement) return false;
  }
  say(send_element(frame).view());
  if (config_.lockstep.empty()) flush();  // in lockstep with done(): nothing counts before
  return true;
}

/// Reads what has come. False: nothing.
bool SocketcandBus::fill() noexcept {
  if (!connected_) return false;
  if (in_begin_ > 0) {
    std::memmove(in_.data(), in_.data() + in_begin_, in_end_ - in_begin_);
    in_end_ -= in_begin_;
    grant_end_ -= std::min(grant_end_, in_begin_);
    in_begin_ = 0;
  }
  if (in_end_ == in_.size()) return false;
  const ssize_t got = recv(socket_, in_.data() + in_end_, in_.size() - in_end_, MSG_DONTWAIT);
  if (got == 0 || (got < 0 && errno != EAGAIN && errno != EINTR)) disconnect();
  if (got <= 0) return false;
  in_end_ += static_cast<std::size_t>(got);
  acknowledge_at_once(socket_);
  realtime_ahead_ = drivers::realtime_ahead();
  return true;
}

std::optional<std::string_view> SocketcandBus::next_element() noexcept {
  std::size_t taken = 0;
  const auto element = find_element({in_.data() + in_begin_, in_end_ - in_begin_}, taken);
  in_begin_ += taken;
  return element;
}

/// True: a frame; everything else is read over.
bool SocketcandBus::read_element(std::string_view element, image::CanFrame& frame) noexcept {
  Words words(element);
  const std::string_view first = words.next();
  if (first != "frame" && first != "remote") return false;
  if (!read_frame(words, first == "remote", frame)) return false;
  frame.timestamp_ns = config_.lockstep.empty() ? frame.timestamp_ns - realtime_ahead_ : granted_;
  return true;
}

bool SocketcandBus::receive(image::CanFrame& frame) noexcept {
  if (!config_.lockstep.empty()) {
    while (in_begin_ < grant_end_)
      if (const auto element = next_element(); element && read_element(*element, frame)) return true;
    return false;
  }
  if (out_size_ > 0) flush();
  do {
    while (const auto element = next_element())
      if (read_element(*element, frame)) return true;
  } while (fill());
  return false;
}

bool SocketcandBus::done(image::Nanoseconds wish, LockstepWake wake) noexcept {
  Element e;
  e.add("< done ");
  e.add_number(granted_);
  e.add(" ");
  e.add_number(wish);
  e.add(wake == LockstepWake::frames ? " frames >" : wake == LockstepWake::wish ? " wish >" : " >");
  say(e.view());
  flush();
  return connected_;
}

std::optional<image::Nanoseconds> SocketcandBus::wait_grant() {
  while (!ended_) {
    std::size_t taken = 0;
    for (std::size_t at = std::max(in_begin_, grant_end_);
         const auto element = find_element({in_.data() + at, in_end_ - at}, taken);) {
      at += taken;
      Words words(*element);
      const std::string_view word = words.next();
      ended_ = ended_ || word == "end";
      if (word != "grant") continue;
      granted_ = read_number(words.next()).value_or(granted_);
      grant_end_ = at;
      return granted_;
    }
    flush();
    if (!ended_ && !fill()) {
      if (!connected_) return std::nullopt;
      wait_readable(100);
    }
  }
  return std::nullopt;
}

}  // namespace servogate::usercan
