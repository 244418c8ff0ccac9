// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/urgent_desk.hpp"

#include <algorithm>

#include "gateway/control/run/words/jog_words.hpp"
#include "gateway/control/server/protocol/refusal.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

using image::RequestKind;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSilence{100};    ///< of the wall clock, then a hand is dead
constexpr std::chrono::milliseconds kOften{5};        ///< more keep-alives than these say nothing new
constexpr std::chrono::milliseconds kPatience{2000};  ///< with a cycle that does not answer
constexpr std::chrono::seconds kCatchUp{1};  ///< with the image that shows it, however long cycles are

/// What is posted for a command, and said of it.
struct Row {
  RequestKind kind;
  const text::Entry* said;
};
std::optional<Row> row_of(const ask::Command& command) {
  if (ask::is_any<ask::Stop>(command)) return Row{RequestKind::stop, &says::kStopped};
  if (ask::is_any<ask::QuickStop>(command)) return Row{RequestKind::quick_stop, &says::kStopped};
  if (ask::is_any<ask::Hold>(command)) return Row{RequestKind::hold, nullptr};
  if (ask::is_any<ask::JogStop>(command)) return Row{RequestKind::jog_stop, nullptr};
  if (ask::is_any<ask::Power>(command)) return Row{RequestKind::power, &says::kPowerOff};
  return std::nullopt;
}

/// What a jog_stop of an axis meets, or of all where `axis` < 0.
const text::Entry& said_of_jog_stop(const image::ProcessImage& now, int axis) {
  bool jogged = false;
  for (int a = 0; a < now.axis_count; ++a)
    jogged = jogged || ((axis < 0 || a == axis) &&
                        now.axes[static_cast<std::size_t>(a)].owner == image::AxisOwner::manual);
  if (axis >= 0) return jogged ? says::kJogStopped : says::kNotJogged;
  return jogged ? says::kJogsStopped : says::kNothingJogged;
}

}  // namespace

UrgentDesk::UrgentDesk(Control& control, RequestDesk& requests, double speed)
    : control_(control),
      requests_(requests),
      speed_(speed),
      image_(std::make_unique<image::ProcessImage>()) {}

UrgentDesk::~UrgentDesk() = default;

const image::ProcessImage& UrgentDesk::image() {
  control_.cycle().read(*image_);
  return *image_;
}

/// How the jog of this client ended; nullopt: it goes on.
std::optional<image::JogEnd> UrgentDesk::end_of(const HeldJog& jog, const image::AxisImage& a) {
  if (jog.silent) return image::JogEnd::silent;
  if (!(a.hand == jog.hand)) return image::JogEnd::none;  // another hand has begun a jog meanwhile
  if (a.jog_end != image::JogEnd::none) return a.jog_end;
  return a.owner == image::AxisOwner::manual ? std::nullopt : std::optional(image::JogEnd::none);
}

std::optional<Reply> UrgentDesk::take(const Question& question, bool ending) {
  const Caller& caller = question.caller;
  if (const auto* wanted = std::get_if<ask::KeepAlive>(&question.command)) {
    if (ending) return refuse(says::kEnding, {}, kAlarm, caller.language);
    return keep_alive(*wanted, question);
  }
  const std::optional<Row> row = row_of(question.command);
  if (!row) return refuse(says::kUnknown, {}, kWrongUse, caller.language);
  image::Request r{.asker = caller.asker, .kind = row->kind, .process = -1, .client = caller.hand().client};
  if (row->kind == RequestKind::power) r.process = 0;
  if (const auto* hold = std::get_if<ask::Hold>(&question.command))
    r.process = static_cast<std::int8_t>(hold->process);
  if (const auto* jog = std::get_if<ask::JogStop>(&question.command)) {
    if (jog->axis) {
      FormProblem problem;
      const int axis = axis_of(control_.machine(), *jog->axis, problem);
      if (axis < 0) return refuse(*problem.entry, problem.arguments, kWrongUse, caller.language);
      r.axis = static_cast<std::int8_t>(axis);
    }
  }
  Pending pending;
  pending.ticket = question.ticket;
  pending.language = caller.language;
  const bool jogs = row->kind == RequestKind::jog_stop;
  pending.said = row->said != nullptr ? row->said
                 : jogs               ? &said_of_jog_stop(image(), r.axis)
                                      : &said_of_hold(r.process);
  if (const auto own = jogs_.find(question.ticket.client); jogs && own != jogs_.end())
    std::erase_if(own->second, [&](const HeldJog& j) { return r.axis < 0 || j.axis == r.axis; });
  pending.asked = Clock::now();
  pending.id = requests_.post(r);
  if (pending.id == 0) return refuse(says::kNoAnswer, {}, kInfrastructure, caller.language);
  pending_.push_back(std::move(pending));
  return std::nullopt;
}

/// What a hold is about to meet.
const text::Entry& UrgentDesk::said_of_hold(int process) const {
  control_.cycle().read(*image_);
  const image::ProcessImage& now = *image_;
  for (int p = 0; p < now.process_count; ++p) {
    if (process >= 0 && p != process) continue;
    const image::ProcessState state = now.processes[static_cast<std::size_t>(p)].state;
    if (state == image::ProcessState::running || state == image::ProcessState::held ||
        state == image::ProcessState::waiting)
      return says::kHeld;
  }
  const auto by_hand = [](const image::AxisImage& a) {
    return a.moving && (a.owner == image::AxisOwner::manual || a.owner == image::AxisOwner::homing);
  };
  const bool jogs = now.homing || std::any_of(now.axes.begin(), now.axes.begin() + now.axis_count, by_hand);
  return jogs ? says::kManualStopped : says::kNothingHeld;
}

/// The answer waits for the next whole image, so that a status asked for behind it shows what it did.
std::optional<Reply> UrgentDesk::answer_of(Pending& p) {
  if (!p.answer) {
    p.answer = requests_.take(p.id);
    if (!p.answer && !passed(p.asked, kPatience)) return std::nullopt;
    if (!p.answer) {
      requests_.forget(p.id);
      return refuse(says::kLeftToCycle, {}, kInfrastructure, p.language);
    }
    p.answered_in = image().now.number;
    p.asked = Clock::now();
  }
  if (image().now.number == p.answered_in && !passed(p.asked, kCatchUp)) return std::nullopt;
  if (p.answer->refusal == 0) return accept(*p.said, {}, p.language);
  return refused_by_gate(*p.answer, control_.machine(), p.language);
}

std::vector<std::pair<Ticket, Reply>> UrgentDesk::look() {
  std::vector<std::pair<Ticket, Reply>> come;
  std::erase_if(pending_, [&](Pending& p) {
    std::optional<Reply> reply = answer_of(p);
    if (reply) come.emplace_back(p.ticket, std::move(*reply));
    return reply.has_value();
  });
  return come;
}

Reply UrgentDesk::ended(const HeldJog& jog, image::JogEnd end, bool others, text::Language language) const {
  const std::string letter = control_.machine().axes[static_cast<std::size_t>(jog.axis)].letter;
  Reply reply;
  reply.code = jog_end_code(end);
  reply.text = jog_end_words(end, letter, language);
  reply.content = JogState{others, letter, jog_end_name(end)};
  return reply;
}

/// Those of this client only: the dead-man of a jog is its own client's.
Reply UrgentDesk::keep_alive(const ask::KeepAlive& wanted, const Question& question) {
  const text::Language language = question.caller.language;
  int index = -1;
  if (wanted.axis) {
    FormProblem problem;
    index = axis_of(control_.machine(), *wanted.axis, problem);
    if (index < 0) return refuse(*problem.entry, problem.arguments, kWrongUse, language);
  }
  const auto meant = [index](const HeldJog& j) { return index < 0 || j.axis == index; };
  const auto own = jogs_.find(question.ticket.client);
  if (own == jogs_.end() || std::none_of(own->second.begin(), own->second.end(), meant))
    return refuse(says::kNoJog, {}, kWrongUse, language);
  std::vector<HeldJog>& jogs = own->second;
  const image::ProcessImage& now = image();
  // Of a keep-alive that lay somewhere nobody knows whether its hand still lives.
  const bool lives = !requests_.stale({.kind = RequestKind::keep_alive}, question.asked());
  std::optional<Reply> gone;
  for (std::size_t i = jogs.size(); i-- > 0;) {
    HeldJog& jog = jogs[i];
    if (!meant(jog)) continue;
    const auto end = end_of(jog, now.axes[static_cast<std::size_t>(jog.axis)]);
    if (end && !gone) {  // one an answer
      const HeldJog last = jog;
      jogs.erase(jogs.begin() + static_cast<std::ptrdiff_t>(i));
      gone = ended(last, *end, !jogs.empty(), language);
    }
    if (end || !lives) continue;
    jog.heard = Clock::now();
    if (speed_ > 0.0 && jog.heard - jog.told < kOften) continue;
    jog.told = jog.heard;
    requests_.tell({.asker = jog.hand.asker,
                    .kind = RequestKind::keep_alive,
                    .axis = static_cast<std::int8_t>(jog.axis),
                    .client = jog.hand.client});
  }
  if (gone) return *gone;
  Reply reply;
  reply.content = JogState{true, {}, {}};
  return reply;
}

void UrgentDesk::stop(int axis, const image::Hand& hand) {
  requests_.tell({.asker = hand.asker,
                  .kind = RequestKind::jog_stop,
                  .axis = static_cast<std::int8_t>(axis),
                  .client = hand.client,
                  .value = 1.0});
}

void UrgentDesk::begin(std::uint64_t client, const JogBegun& jog) {
  std::vector<HeldJog>& jogs = jogs_[client];
  std::erase_if(jogs, [&](const HeldJog& j) { return j.axis == jog.axis; });
  jogs.push_back({jog.axis, jog.hand, Clock::now(), {}, false});
}

void UrgentDesk::watch() {
  std::erase_if(jogs_, [](const auto& own) { return own.second.empty(); });
  if (speed_ == 1.0) return;
  for (auto& [client, jogs] : jogs_)
    for (HeldJog& jog : jogs) {
      if (jog.silent || Clock::now() - jog.heard < kSilence) continue;
      jog.silent = true;
      stop(jog.axis, jog.hand);
    }
}

void UrgentDesk::let_go(std::uint64_t client) {
  const auto own = jogs_.find(client);
  if (own == jogs_.end()) return;
  for (const HeldJog& jog : own->second) stop(jog.axis, jog.hand);
  jogs_.erase(own);
}

}  // namespace servogate::gateway
