// SPDX-License-Identifier: Apache-2.0
// The part of the bus server that grants time.
#include <algorithm>
#include <limits>

#include "drivers/clock.hpp"
#include "drivers/usercan/server/bus_server.hpp"

namespace servogate::usercan {
namespace {

using Turn = Participant::Turn;

const text::Entry kLeft{"usercan.left-lockstep", "participant {0} left at {1} s; the others go on without it",
                        "участник {0} вышел на {1} с; остальные продолжают без него"};
const text::Entry kStalled{"usercan.stalled",
                           "time stands still at {0} s: participant {1} does not say that it is done",
                           "время стоит на {0} с: участник {1} не сообщает о готовности"};
const text::Entry kNobodyWantsTime{
    "usercan.nobody-wants-time", "time ends at {0} s: the bus is idle and no participant wants to go on",
    "время кончилось на {0} с: шина свободна и ни один участник не хочет продолжать"};

const text::Entry kNoLaterTime{"usercan.no-later-time",
                               "participant {0} has asked {1} times in a row for no later time than {2} s, "
                               "which it has: time creeps on by "
                               "nanoseconds",
                               "участник {0} {1} раз подряд просит не более позднее время, чем {2} с, "
                               "которое у него уже есть: время ползёт "
                               "по наносекундам"};

constexpr Nanoseconds kNever = std::numeric_limits<Nanoseconds>::max();
constexpr Nanoseconds kPatience = 5 * image::kSecond;
/// A participant may look at an instant again; so many times in a row it does not know what it does.
constexpr int kWishesOfNow = 1000;

std::string seconds(Nanoseconds t) { return text::number(static_cast<double>(t) * 1e-9, 9); }

}  // namespace

void BusServer::join_lockstep(Participant& who, std::string_view name) {
  const auto taken = [&](const auto& p) { return p->turn != Turn::none && p->name() == name; };
  if (config_.lockstep == 0) return refuse(who, "this bus runs in real time");
  if (begun_) return refuse(who, "time has begun without you");
  if (name.empty() || std::any_of(participants_.begin(), participants_.end(), taken))
    return refuse(who, "lockstep needs a name of your own");
  who.set_name(name);
  who.release();
  who.say("< ok >");
  who.turn = Turn::waiting;
}

/// Everybody for whom time waits has said that it is done.
bool BusServer::all_done() const {
  int joined = 0;
  const Participant* late = nullptr;
  for (const auto& p : participants_) {
    joined += p->turn != Turn::none ? 1 : 0;
    if (p->turn == Turn::working && !p->closed) late = p.get();
  }
  return begun_ ? late == nullptr : joined >= config_.lockstep;
}

/// The earliest instant at which somebody wants time or a frame ends; frames that begin before it have begun.
Nanoseconds BusServer::next_time() {
  for (;;) {
    Nanoseconds next = kNever;
    for (const auto& p : participants_)
      if (p->turn != Turn::none && !p->closed) next = std::min(next, p->wish);
    bool begins = false;
    for (const auto& bus : buses_) {
      const Nanoseconds event = bus->segment().next_event_ns();
      if (event >= next) continue;
      next = event;
      begins = !bus->segment().busy();
    }
    if (next == kNever) return kNever;
    if (!begins) return std::max(next, now_ + 1);
    advance(next + 1);
  }
}

/// Whether a participant gets time now: always, but where it has asked to be left alone.
bool BusServer::wakes(const Participant& who) const noexcept {
  return who.wake == LockstepWake::any || who.wish <= now_ || (who.wake == LockstepWake::frames && who.heard);
}

void BusServer::watch_wish(Participant& who) {
  who.wishes_of_now = who.wish > now_ ? 0 : std::min(who.wishes_of_now + 1, kWishesOfNow + 1);
  if (who.wishes_of_now == kWishesOfNow)
    report_({&kNoLaterTime, {who.name(), std::to_string(kWishesOfNow), seconds(now_)}});
}

/// Order is by name, so that a run repeats: whoever came first is not served first.
void BusServer::begin_lockstep() {
  std::stable_sort(participants_.begin(), participants_.end(), [](const auto& a, const auto& b) {
    const bool first = a->turn != Turn::none, second = b->turn != Turn::none;
    return first != second ? first : first && a->name() < b->name();
  });
  for (const auto& p : participants_)
    if (p->bus >= 0 && !buses_[static_cast<std::size_t>(p->bus)]->join(*p)) {
      refuse(*p, "all places are taken");
      p->closed = true;
    }
  begun_ = true;
}

/// To the next instant. False: time has ended.
bool BusServer::go_on() {
  for (const auto& p : participants_)
    if (p->closed && p->turn != Turn::none) {
      report_({&kLeft, {p->name(), seconds(now_)}});
      p->turn = Turn::none;
    }
  const auto here = [](const auto& p) { return p->turn != Turn::none; };
  if (std::none_of(participants_.begin(), participants_.end(), here)) return false;
  for (const auto& p : participants_)
    while (!p->said.empty() && buses_[static_cast<std::size_t>(p->bus)]->offer(*p, p->said.front()))
      p->said.pop_front();
  advance(now_ + 1);  // what was sent at this instant has begun
  const Nanoseconds next = next_time();
  if (next == kNever) report_({&kNobodyWantsTime, {seconds(now_)}});
  if (next == kNever || (config_.until > 0 && next > config_.until)) return false;
  advance(next);
  return true;
}

void BusServer::grant() {
  const auto woken = [this](const auto& p) { return p->turn != Turn::none && wakes(*p); };
  if (!begun_) {
    begin_lockstep();
  } else {
    // An instant at which nobody wakes, the end of a frame that can wait, is passed over.
    do {
      if (!go_on()) return end_lockstep();
    } while (std::none_of(participants_.begin(), participants_.end(), woken));
  }
  const std::string element = " < grant " + std::to_string(now_) + " >";
  for (const auto& p : participants_)
    if (woken(p)) {
      p->say(element);
      p->turn = Turn::working;
      p->heard = false;
    }
  stalled_since_ = drivers::clock_ns(CLOCK_MONOTONIC);
  stall_said_ = false;
}

void BusServer::end_lockstep() {
  for (const auto& p : participants_)
    if (p->turn != Turn::none && !p->closed) p->say(" < end >");
  ended_ = true;
}

void BusServer::watch_for_stall() {
  if (!begun_ || stall_said_ || drivers::clock_ns(CLOCK_MONOTONIC) - stalled_since_ < kPatience) return;
  for (const auto& p : participants_)
    if (p->turn == Turn::working) report_({&kStalled, {seconds(now_), p->name()}});
  stall_said_ = true;
}

}  // namespace servogate::usercan
