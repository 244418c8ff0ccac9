// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/scenario/desk_operator.hpp"

#include <algorithm>
#include <utility>

#include "firmware_if/text/in_both.hpp"
#include "gateway/control/run/operator_script.hpp"
#include "gateway/control/run/standstill.hpp"
#include "gateway/control/server/desk/dispatch/dispatch.hpp"
#include "gateway/control/server/protocol/texts.hpp"

namespace servogate::gateway {

namespace {

using image::Nanoseconds;
using scenario::Said;

constexpr Nanoseconds kKeepAlive = 30 * image::kMillisecond;
constexpr Nanoseconds kLookAfter = 200 * image::kMillisecond;  ///< what the machine has learned
constexpr Nanoseconds kSettling = 20 * image::kMillisecond;    ///< until the image shows what was begun
constexpr Nanoseconds kBoot = 30 * image::kSecond;             ///< of drives, at most
constexpr std::uint64_t kClient = 1;

const text::Entry kByAlarm{"scenario.ended_by_alarm", "alarm {0}", "авария {0}"};
const text::Entry kEarly{"scenario.ended_early", "the program ended before its end ({0})",
                         "программа закончилась раньше конца ({0})"};
const text::Entry kNotHomed{"scenario.not_homed", "{0} is not homed", "ось {0} не выведена в ноль"};
const text::Entry kOffline{"scenario.offline", "drives that do not answer: {0}", "приводы не отвечают: {0}"};

}  // namespace

DeskOperator::DeskOperator(RunningMachine& machine)
    : machine_(machine),
      resident_(machine.control(), machine.learned(), {}, 0.0),
      urgent_(machine.control(), resident_.requests(), 0.0),
      variables_(machine.control()),
      pendants_(machine.control()) {
  resident_.requests().set_pause([this] { return step_ != nullptr && (*step_)(); });
  resident_.keep_blocks(machine.journal());
  // What clients see is the newest published image.
  machine.control().cycle().publish_every(1);
}

DeskOperator::~DeskOperator() = default;

std::string DeskOperator::problem(const scenario::Do& what) {
  std::string why;
  const auto deeds = read_sentence(what, why);
  if (!deeds) return why;
  for (const Deed& deed : *deeds) {
    const auto* const command = std::get_if<ask::Command>(&deed);
    FormProblem problem;
    std::string axis;
    if (command == nullptr) continue;
    if (const auto* jog = std::get_if<ask::Jog>(command)) axis = jog->axis;
    if (const auto* jog = std::get_if<ask::JogContinuous>(command)) axis = jog->axis;
    if (const auto* zero = std::get_if<ask::Zero>(command)) axis = zero->axis;
    if (!axis.empty() && axis_of(machine_.machine(), axis, problem) < 0)
      return text::in_both(*problem.entry, problem.arguments);
  }
  return {};
}

/// `step` moves the machine while an answer is waited for.
Reply DeskOperator::carry(Question question, const std::function<bool()>& step) {
  const std::function<bool()>* const outer = std::exchange(step_, &step);
  question.asked_at = resident_.requests().stops();
  const text::Language language = question.caller.language;
  Reply reply;
  if (ask::is_any<ask::Down>(question.command)) {
    reply = refuse(says::kUnknown, {"down"}, kWrongUse, language);
  } else if (ask::is_urgent(question.command)) {
    std::optional<Reply> given = urgent_.take(question, false);
    while (!given && step()) {
      for (auto& one : urgent_.look()) come_.push_back(std::move(one));
      std::erase_if(come_, [&](auto& one) {
        const bool own =
            one.first.client == question.ticket.client && one.first.question == question.ticket.question;
        if (own) given = std::move(one.second);
        return own;
      });
    }
    reply = given ? std::move(*given) : refuse(says::kNoAnswer, {}, kInfrastructure, language);
  } else {
    gateway::Outcome outcome = dispatch(resident_, plc_, question);
    while (auto* const work = std::get_if<Work>(&outcome)) outcome = work->run(std::stop_token{})();
    reply = std::move(std::get<Reply>(outcome));
  }
  step_ = outer;
  return reply;
}

Reply DeskOperator::ask(const ask::Command& command, text::Language language,
                        const std::function<bool()>& step) {
  Question question;
  question.ticket = {kClient, 1};
  question.command = command;
  question.caller.asker = image::Asker::scenario;
  question.caller.connection = kClient;
  question.caller.user = "scenario";
  question.caller.language = language;
  Reply reply = carry(std::move(question), step);
  if (const auto* jog = std::get_if<JogBegun>(&reply.content)) {
    std::erase_if(jogs_, [&](const JogBegun& j) { return j.axis == jog->axis; });
    jogs_.push_back(*jog);
  }
  if (const auto* stop = std::get_if<ask::JogStop>(&command))
    std::erase_if(jogs_, [&](const JogBegun& j) {
      return !stop->axis || machine_.machine().axis_index(*stop->axis) == j.axis;
    });
  return reply;
}

/// A pendant of the machine asks; its jogs live by its own keep-alives.
Reply DeskOperator::ask_for_pendant(const ask::Command& command, const image::Hand& hand,
                                    const std::function<bool()>& step) {
  Question question;
  question.ticket = {hand.client, 1};
  question.command = command;
  question.caller.asker = hand.asker;
  question.caller.connection = hand.client;
  question.caller.user = "pendant";
  Reply reply = carry(std::move(question), step);
  if (const auto* jog = std::get_if<JogBegun>(&reply.content)) urgent_.begin(hand.client, *jog);
  return reply;
}

Said DeskOperator::done(const Reply& reply) const { return {reply.ok, reply.code, reply.text}; }

/// In both languages: the message of a failure is shown in either.
Said DeskOperator::ask(const ask::Command& command) {
  return done(ask(command, text::user_language(), *step_));
}

Said DeskOperator::play(const std::string& point, std::optional<double> value) {
  Said said{true, {}, {}};
  said.accepted = machine_.play(point, value, said.text);
  if (!said.accepted) said.code = "scenario.not_played";
  return said;
}

DeskOperator::Begun DeskOperator::begun_by(const ask::Command& command) {
  if (const auto* power = std::get_if<ask::Power>(&command))
    return power->on ? Begun::power_on : Begun::power_off;
  if (ask::is_any<ask::Home>(command)) return Begun::home;
  if (ask::is_any<ask::Jog, ask::Return, ask::Retrace>(command)) return Begun::jog;
  if (ask::is_any<ask::Start, ask::Step, ask::Mdi, ask::Restart, ask::Resume>(command)) return Begun::program;
  return Begun::nothing;
}

bool DeskOperator::all_online() const {
  const image::ProcessImage& image = machine_.image();
  for (int a = 0; a < image.axis_count; ++a)
    if (!image.axes[static_cast<std::size_t>(a)].drive.online) return false;
  return image.axis_count > 0;
}

/// Drives that boot are waited for: nobody switches on what does not answer yet.
Said DeskOperator::ready() {
  const Nanoseconds end = now() + kBoot;
  while (!all_online()) {
    if (now() > end) {
      std::string names;
      for (std::size_t a = 0; a < machine_.machine().axes.size(); ++a)
        if (!machine_.image().axes[a].drive.online)
          names += (names.empty() ? "" : ", ") + machine_.machine().axes[a].letter;
      return {false, "scenario.offline", text::in_both(kOffline, {names})};
    }
    if (!(*step_)()) return {false, "scenario.ended", {}};
  }
  const auto through = [&](const ask::Command& command) {
    Said said = carry_out(Deed(command));
    while (said.accepted && under_way() && (*step_)()) {
    }
    if (said.accepted && !failure_.empty()) said = {false, "scenario.not_ready", failure_};
    return said;
  };
  ask(ask::Command(ask::Reset{}));
  Said said = through(ask::Power{true});
  const auto& axes = machine_.machine().axes;
  const bool homing = std::any_of(axes.begin(), axes.end(), [](const machine::AxisConfig& a) {
    return a.home.method != machine::HomingMethod::none;
  });
  if (said.accepted && homing) said = through(ask::Home{});
  begun_ = Begun::nothing;
  return said;
}

Said DeskOperator::carry_out(const Deed& deed) {
  if (std::holds_alternative<sentence::Ready>(deed)) return ready();
  if (std::holds_alternative<sentence::FallSilent>(deed)) {
    jogs_.clear();
    return {true, {}, {}};
  }
  if (const auto* wait = std::get_if<sentence::Wait>(&deed)) {
    const Nanoseconds end = now() + wait->time;
    while (now() < end && (*step_)()) {
    }
    return {true, {}, {}};
  }
  if (const auto* press = std::get_if<sentence::Press>(&deed)) {
    const Said said = play(press->point, 1.0);
    if (said.accepted) pressed_.push_back({press->point, now() + press->time});
    return said;
  }
  if (const auto* wheel = std::get_if<sentence::Handwheel>(&deed)) {
    double& counts = counts_[wheel->point];
    counts += wheel->counts;
    return play(wheel->point, counts);
  }
  const ask::Command& command = std::get<ask::Command>(deed);
  run_ = machine_.image().processes[0].run;
  axes_.clear();
  if (const auto* jog = std::get_if<ask::Jog>(&command)) axes_ = {machine_.machine().axis_index(jog->axis)};
  if (const auto* home = std::get_if<ask::Home>(&command))
    for (const std::string& letter : home->axes) axes_.push_back(machine_.machine().axis_index(letter));
  if (axes_.empty())
    for (std::size_t a = 0; a < machine_.machine().axes.size(); ++a) axes_.push_back(static_cast<int>(a));
  const Said said = ask(command);
  begun_ = said.accepted ? begun_by(command) : Begun::nothing;
  begun_at_ = now();
  settled_at_ = -1;
  failure_.clear();
  return said;
}

Said DeskOperator::carry_out(const scenario::Do& what, const std::function<bool()>& step) {
  const std::function<bool()>* const outer = std::exchange(step_, &step);
  std::string why;
  Said said{false, "scenario.words", {}};
  begun_ = Begun::nothing;
  if (const auto deeds = read_sentence(what, why)) {
    for (const Deed& deed : *deeds) {
      said = carry_out(deed);
      if (!said.accepted) break;
    }
  } else {
    said.text = why;
  }
  step_ = outer;
  return said;
}

/// What was begun has come to its end, good or bad.
bool DeskOperator::settled() {
  const image::ProcessImage& image = machine_.image();
  const auto axis = [&](int a) -> const image::AxisImage& { return image.axes[static_cast<std::size_t>(a)]; };
  const auto every = [&](auto&& good) {
    return std::all_of(axes_.begin(), axes_.end(), [&](int a) { return good(axis(a)); });
  };
  switch (begun_) {
    case Begun::nothing:
      return true;
    case Begun::power_on:
      return every([](const image::AxisImage& a) { return a.enabled; });
    case Begun::power_off:
      return axes_off(image);
    case Begun::home:
      return !image.homing && every([](const image::AxisImage& a) {
        return a.owner != image::AxisOwner::homing && !a.moving;
      });
    case Begun::jog:
      for (const image::ProcessStatus& p : image.processes)
        if (p.retracing) return false;
      return every(
          [](const image::AxisImage& a) { return a.owner != image::AxisOwner::manual && !a.moving; });
    case Begun::program: {
      using State = image::ProcessState;
      const image::ProcessStatus& p = image.processes[0];
      if (p.state == State::running ||
          (p.state == State::waiting && p.wait.reason != image::WaitReason::block_end &&
           p.wait.reason != image::WaitReason::program_stop))
        return false;
      return every([](const image::AxisImage& a) { return !a.moving; });
    }
  }
  return true;
}

bool DeskOperator::under_way() {
  if (begun_ == Begun::nothing) return false;
  const image::ProcessImage& image = machine_.image();
  if (now() - begun_at_ < kSettling) return true;
  const bool fault = image.alarms_active > 0 && fault_stands(machine_.alarms());
  const bool over = settled() || (fault && begun_ == Begun::power_on);
  if (!over) settled_at_ = -1;
  if (over && settled_at_ < 0) settled_at_ = now();
  // A drive may leave the state that it has just reached.
  if (!over || now() - settled_at_ < kSettling) return true;
  if (fault) {
    const cycle::AlarmSnapshot& alarms = machine_.alarms();
    std::string numbers;
    for (int n = 0; n < alarms.count; ++n)
      if (alarms.records[static_cast<std::size_t>(n)].active)
        numbers += (numbers.empty() ? "" : ", ") +
                   std::to_string(alarms.records[static_cast<std::size_t>(n)].number);
    failure_ = text::in_both(kByAlarm, {numbers});
  } else if (begun_ == Begun::home) {
    for (const int a : axes_)
      if (!image.axes[static_cast<std::size_t>(a)].homed &&
          machine_.machine().axes[static_cast<std::size_t>(a)].home.method != machine::HomingMethod::none)
        failure_ = text::in_both(kNotHomed, {machine_.machine().axes[static_cast<std::size_t>(a)].letter});
  } else if (begun_ == Begun::program && image.processes[0].state == image::ProcessState::stopped) {
    failure_ = text::in_both(kEarly, {"stopped"});
  }
  begun_ = Begun::nothing;
  return false;
}

void DeskOperator::poll(const std::function<bool()>& step) {
  variables_.poll();
  pendants_.poll(machine_.image(), [&](const ask::Command& command, const image::Hand& hand) {
    return ask_for_pendant(command, hand, step);
  });
  const Nanoseconds t = now();
  std::erase_if(pressed_, [&](const Pressed& p) {
    if (t < p.until) return false;
    play(p.point, 0.0);
    return true;
  });
  if (!jogs_.empty() && t - kept_alive_ >= kKeepAlive) {
    kept_alive_ = t;
    for (const JogBegun& jog : jogs_)
      resident_.requests().tell({.asker = jog.hand.asker,
                                 .kind = image::RequestKind::keep_alive,
                                 .axis = static_cast<std::int8_t>(jog.axis),
                                 .client = jog.hand.client});
  }
  if (t - looked_ < kLookAfter) return;
  looked_ = t;
  for (Work& work : resident_.look_after()) {
    gateway::Outcome outcome = work.run(std::stop_token{})();
    while (auto* const more = std::get_if<Work>(&outcome)) outcome = more->run(std::stop_token{})();
  }
}

}  // namespace servogate::gateway
