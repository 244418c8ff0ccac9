// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/server/bus_server.hpp"
#include "drivers/clock.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <limits>

namespace servogate::usercan {
namespace {

const text::Entry kDoesNotRead{"usercan.does-not-read",
                               "participant {0} was thrown out: {1} bytes wait for it and it does not read",
                               "участник {0} отключён: {1} байт ждут его, а он не читает"};

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
/// What is said after the answer to `rawmode` waits so long, unless the participant speaks first.
constexpr Nanoseconds kHold = 30 * image::kMillisecond;

std::string display(const Participant& who) {
  return who.name().empty() ? "#" + std::to_string(who.number()) : who.name();
}

}  // namespace

std::unique_ptr<BusServer> BusServer::open(BusServerConfig config, Report report, drivers::Notice& why) {
  const int s = listen_on(config.listen, why);
  if (s < 0) return nullptr;
  return std::unique_ptr<BusServer>(new BusServer(std::move(config), s, std::move(report)));
}

BusServer::BusServer(BusServerConfig config, int socket, Report report)
    : config_(std::move(config)), socket_(socket), report_(std::move(report)) {
  for (const std::string& name : config_.buses)
    buses_.push_back(std::make_unique<Bus>(name, config_.bit_rate));
  start_ = drivers::clock_ns(CLOCK_MONOTONIC);
  if (config_.lockstep == 0) epoch_ = drivers::clock_ns(CLOCK_REALTIME);
}

BusServer::~BusServer() {
  close(socket_);
  if (config_.listen.host.empty()) unlink(config_.listen.path.c_str());
}

bool BusServer::serve(Nanoseconds at_most) {
  if (ended_) return false;
  wait(at_most);
  if (config_.lockstep == 0) advance(drivers::clock_ns(CLOCK_MONOTONIC) - start_);
  accept_new();
  for (const auto& p : participants_)
    if (!p->closed && !p->read_socket()) p->closed = true;
  carry_out();
  if (config_.lockstep > 0 && all_done()) grant();
  if (config_.lockstep > 0) watch_for_stall();
  flush();
  bury();
  return !ended_;
}

void BusServer::wait(Nanoseconds at_most) {
  const Nanoseconds wall = drivers::clock_ns(CLOCK_MONOTONIC);
  Nanoseconds wake = at_most;
  if (config_.lockstep == 0)
    for (const auto& bus : buses_)
      if (const Nanoseconds next = bus->segment().next_event_ns(); next != kNever)
        wake = std::min(wake, start_ + next - wall);
  std::vector<pollfd> fds{{socket_, POLLIN, 0}};
  for (const auto& p : participants_) {
    const short read = p->closed || p->full() ? 0 : POLLIN;
    fds.push_back({p->socket(), static_cast<short>(read | (p->wants_to_write(wall) ? POLLOUT : 0)), 0});
    if (p->held_until() > 0) wake = std::min(wake, p->held_until() - wall);
    if (p->closed) fds.back().fd = -1;
  }
  wake = std::max<Nanoseconds>(wake, 0);
  const timespec limit{wake / image::kSecond, wake % image::kSecond};
  ppoll(fds.data(), fds.size(), &limit, nullptr);
}

void BusServer::accept_new() {
  for (;;) {
    const int s = accept4(socket_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (s < 0) return;
    const int on = 1;
    if (!config_.listen.host.empty()) setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    participants_.push_back(std::make_unique<Participant>(s, next_number_++));
    participants_.back()->epoch = epoch_;
  }
}

void BusServer::advance(Nanoseconds t) {
  now_ = std::max(now_, t);
  for (const auto& bus : buses_) bus->segment().advance_to(now_);
}

void BusServer::carry_out() {
  // Whoever waits for its turn in lockstep has said everything that counts for this instant; by name.
  for (bool more = true; more;) {
    more = false;
    for (const auto& p : participants_) more = carry_out_next(*p) || more;
  }
  // What was sent now may begin now: one nanosecond later nobody can join this arbitration.
  if (config_.lockstep == 0) advance(now_ + 1);
}

/// One element. False: there is none that can be carried out now.
bool BusServer::carry_out_next(Participant& who) {
  if (who.turn == Participant::Turn::waiting && begun_) {
    // Between its `done` and the next grant a participant says nothing.
    return false;
  }
  std::size_t taken = 0;
  const auto element = who.peek(taken);
  if (!element) {
    if (who.full()) {
      refuse(who, "element too long");
      who.closed = true;
      who.take_all();
    }
    return false;
  }
  Words words(*element);
  const std::string_view word = words.next();
  if (who.mode == Participant::Mode::raw && (word == "send" || word == "remote")) {
    if (!send_frame(who, element->substr(element->find(word) + word.size()), word == "remote")) return false;
  } else {
    hear_word(who, *element);
  }
  who.take(taken);
  return true;
}

bool BusServer::send_frame(Participant& who, std::string_view words, bool remote) {
  image::CanFrame frame;
  if (!read_send(Words(words), remote, frame)) {
    refuse(who, "syntax error in send command");
    return true;
  }
  who.release();
  if (who.turn != Participant::Turn::none) {
    who.said.push_back(frame);  // goes out when everybody is done, in the order of names
    return true;
  }
  return who.port >= 0 && buses_[static_cast<std::size_t>(who.bus)]->offer(who, frame);
}

void BusServer::hear_word(Participant& who, std::string_view element) {
  using Mode = Participant::Mode;
  Words words(element);
  const std::string_view word = words.next();
  if (word == "echo") {
    who.say("< echo >");
  } else if (word == "open" && who.mode == Mode::greeted) {
    open_bus(who, words.next());
  } else if (word == "rawmode" && who.mode != Mode::greeted) {
    who.mode = Mode::raw;
    who.say("< ok >");
    who.hold(drivers::clock_ns(CLOCK_MONOTONIC) + kHold);
  } else if (word == "remotemode" && who.mode == Mode::raw) {
    who.wants_remote = true;
    who.release();
    who.say("< ok >");
  } else if (word == "lockstep" && who.mode == Mode::raw) {
    join_lockstep(who, words.next());
  } else if (word == "done" && who.turn == Participant::Turn::working) {
    const auto at = read_number(words.next());
    const auto wish = read_number(words.next());
    if (!at || *at != now_) return refuse(who, "done with another time than the one granted");
    who.turn = Participant::Turn::waiting;
    who.wish = wish ? *wish : kNever;
    who.wake = lockstep_wake(words.next());
    watch_wish(who);
  } else if (!element.empty()) {
    refuse(who, who.mode == Mode::greeted ? "open a bus first" : "unknown command");
  }
}

void BusServer::open_bus(Participant& who, std::string_view name) {
  for (std::size_t b = 0; b < buses_.size(); ++b) {
    if (buses_[b]->name() != name) continue;
    // In lockstep places are given when time begins, in the order of names.
    if ((config_.lockstep == 0 || begun_) && !buses_[b]->join(who))
      return refuse(who, "could not open bus: all places are taken");
    who.bus = static_cast<int>(b);
    who.mode = Participant::Mode::opened;
    return who.say("< ok >");
  }
  refuse(who, "could not open bus");
}

void BusServer::refuse(Participant& who, std::string_view text) {
  who.say("< error ");
  who.say(text);
  who.say(" >");
}

void BusServer::flush() {
  const Nanoseconds wall = drivers::clock_ns(CLOCK_MONOTONIC);
  for (const auto& p : participants_) {
    if (!p->write_socket(wall)) {
      p->closed = true;
      p->take_all();
    }
    if (p->backlog() <= config_.backlog) continue;
    report_({&kDoesNotRead, {display(*p), std::to_string(p->backlog())}});
    p->closed = true;
    p->take_all();
  }
}

void BusServer::bury() {
  std::erase_if(participants_, [this](const auto& p) {
    std::size_t taken = 0;
    if (!p->closed || p->peek(taken) || !p->idle()) return false;
    if (p->port >= 0) buses_[static_cast<std::size_t>(p->bus)]->leave(*p);
    return true;
  });
}

}  // namespace servogate::usercan
