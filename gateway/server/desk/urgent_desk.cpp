// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/desk/urgent_desk.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "gateway/cli/options.hpp"
#include "gateway/run/words/jog_words.hpp"
#include "gateway/server/desk/refusal.hpp"
#include "gateway/server/words/texts.hpp"

namespace servogate::gateway {

namespace {

using image::RequestKind;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSilence{100};    ///< of the wall clock, then a hand is dead
constexpr std::chrono::milliseconds kOften{5};        ///< more keep-alives than these say nothing new
constexpr std::chrono::milliseconds kPatience{2000};  ///< with a cycle that does not answer
constexpr std::chrono::seconds kCatchUp{1};  ///< with the image that shows it, however long cycles are

struct Row {
  std::string_view command;
  RequestKind kind;
  const text::Entry* said;
};
constexpr Row kRows[] = {{"stop", RequestKind::stop, &says::kStopped},
                         {"quick_stop", RequestKind::quick_stop, &says::kStopped},
                         {"hold", RequestKind::hold, nullptr},
                         {"jog_stop", RequestKind::jog_stop, &says::kStopped},
                         {"power", RequestKind::power, &says::kPowerOff}};

/// How the jog of this client ended; nullopt: it goes on.
std::optional<image::JogEnd> end_of(const HeldJog& jog, const image::AxisImage& a) {
  if (jog.silent) return image::JogEnd::silent;
  if (!(a.hand == jog.hand)) return image::JogEnd::none;  // another hand has begun a jog meanwhile
  if (a.jog_end != image::JogEnd::none) return a.jog_end;
  return a.owner == image::AxisOwner::manual ? std::nullopt : std::optional(image::JogEnd::none);
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

std::optional<Reply> UrgentDesk::take(const json& request, const Caller& caller, Connection& connection,
                                      const Ticket& ticket, bool ending) {
  const std::string command = request.value("cmd", "");
  if (command == "keep_alive") {
    if (ending) return refuse(says::kEnding, {}, kAlarm, caller.language);
    return keep_alive(request, caller, connection);
  }
  const auto row =
      std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.command == command; });
  if (row == std::end(kRows)) return refuse(says::kUnknown, {command}, kWrongUse, caller.language);
  image::Request r{.asker = caller.asker, .kind = row->kind, .process = -1, .client = caller.hand().client};
  if (row->kind == RequestKind::power) r.process = 0;
  if (row->kind == RequestKind::jog_stop && request.contains("axis")) {
    FormProblem problem;
    const int axis = axis_of(control_.machine(), request["axis"], problem);
    if (axis < 0) return refuse(*problem.entry, problem.arguments, kWrongUse, caller.language);
    r.axis = static_cast<std::int8_t>(axis);
  }
  if (row->kind == RequestKind::jog_stop)
    std::erase_if(connection.jogs, [&](const HeldJog& j) { return r.axis < 0 || j.axis == r.axis; });
  Pending pending;
  pending.ticket = ticket;
  pending.caller = caller;
  pending.said = row->said != nullptr ? row->said : &said_of_hold();
  pending.asked = Clock::now();
  pending.id = requests_.post(r);
  if (pending.id == 0) return refuse(says::kNoAnswer, {}, kInfrastructure, caller.language);
  pending_.push_back(std::move(pending));
  connection.urgent_line = ticket.line;
  return std::nullopt;
}

/// What a hold is about to meet.
const text::Entry& UrgentDesk::said_of_hold() const {
  control_.cycle().read(*image_);
  const image::ProcessImage& now = *image_;
  for (int p = 0; p < now.process_count; ++p) {
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
    if (!p.answer && Clock::now() - p.asked < kPatience) return std::nullopt;
    if (!p.answer) {
      requests_.forget(p.id);
      return refuse(says::kNoAnswer, {}, kInfrastructure, p.caller.language);
    }
    p.answered_in = image().now.number;
    p.asked = Clock::now();
  }
  if (image().now.number == p.answered_in && Clock::now() - p.asked < kCatchUp) return std::nullopt;
  if (p.answer->refusal == 0) return accept(*p.said, {}, p.caller.language, json::object());
  return Reply{text_of(refusal_json(*p.answer, control_.machine(), p.caller.language))};
}

void UrgentDesk::look(const Give& give) {
  std::erase_if(pending_, [&](Pending& p) {
    std::optional<Reply> reply = answer_of(p);
    if (reply) give(p.ticket, std::move(*reply));
    return reply.has_value();
  });
}

Reply UrgentDesk::ended(const HeldJog& jog, image::JogEnd end, bool others, text::Language language) const {
  const std::string letter = control_.machine().axes[static_cast<std::size_t>(jog.axis)].letter;
  return {text_of({{"ok", true},
                   {"exit", kDone},
                   {"moving", others},
                   {"axis", letter},
                   {"reason", jog_end_name(end)},
                   {"code", jog_end_code(end)},
                   {"text", jog_end_words(end, letter, language)}})};
}

/// Those of this connection only: the dead-man of a jog is its own client's.
Reply UrgentDesk::keep_alive(const json& request, const Caller& caller, Connection& connection) {
  int index = -1;
  if (request.contains("axis")) {
    FormProblem problem;
    index = axis_of(control_.machine(), request["axis"], problem);
    if (index < 0) return refuse(*problem.entry, problem.arguments, kWrongUse, caller.language);
  }
  const auto meant = [index](const HeldJog& j) { return index < 0 || j.axis == index; };
  std::vector<HeldJog>& jogs = connection.jogs;
  if (std::none_of(jogs.begin(), jogs.end(), meant))
    return refuse(says::kNoJog, {}, kWrongUse, caller.language);
  const image::ProcessImage& now = image();
  std::optional<Reply> gone;
  for (std::size_t i = jogs.size(); i-- > 0;) {
    HeldJog& jog = jogs[i];
    if (!meant(jog)) continue;
    const auto end = end_of(jog, now.axes[static_cast<std::size_t>(jog.axis)]);
    if (end && !gone) {  // one an answer
      const HeldJog last = jog;
      jogs.erase(jogs.begin() + static_cast<std::ptrdiff_t>(i));
      gone = ended(last, *end, !jogs.empty(), caller.language);
    }
    if (end) continue;
    jog.heard = Clock::now();
    if (jog.heard - jog.told < kOften) continue;
    jog.told = jog.heard;
    requests_.tell({.asker = jog.hand.asker,
                    .kind = RequestKind::keep_alive,
                    .axis = static_cast<std::int8_t>(jog.axis),
                    .client = jog.hand.client});
  }
  return gone ? *gone : Reply{text_of({{"ok", true}, {"exit", kDone}, {"moving", true}})};
}

void UrgentDesk::stop(const HeldJog& jog) {
  requests_.tell({.asker = jog.hand.asker,
                  .kind = RequestKind::jog_stop,
                  .axis = static_cast<std::int8_t>(jog.axis),
                  .client = jog.hand.client,
                  .value = 1.0});
}

void UrgentDesk::begin(const HeldJog& jog, Connection* connection) {
  if (connection == nullptr) return stop(jog);
  std::erase_if(connection->jogs, [&](const HeldJog& j) { return j.axis == jog.axis; });
  connection->jogs.push_back(jog);
}

void UrgentDesk::watch(Connection& connection) {
  if (speed_ == 1.0) return;
  for (HeldJog& jog : connection.jogs) {
    if (jog.silent || Clock::now() - jog.heard < kSilence) continue;
    jog.silent = true;
    stop(jog);
  }
}

void UrgentDesk::let_go(Connection& connection) {
  for (const HeldJog& jog : connection.jogs) stop(jog);
  connection.jogs.clear();
}

}  // namespace servogate::gateway
