// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/pendant/pendant_session.hpp"

#include <algorithm>
#include <utility>

#include "gateway/control/compose/setup/axis_setup.hpp"
#include "gateway/control/server/pendant/texts.hpp"
#include "kernel/axis/setpoint/ramp.hpp"
#include "kernel/cycle/plc_orders/handwheel.hpp"
#include "machine/loading/pendant_layout.hpp"

namespace servogate::gateway {

using drivers::PendantNews;
using image::Nanoseconds;
using pendant::Request;
using pendant::RequestKind;

namespace {

constexpr Nanoseconds kShow = 150 * image::kMillisecond;  ///< between two pictures of the display
constexpr Nanoseconds kTellAgain = 5 * image::kSecond;    ///< the same thing
constexpr Nanoseconds kStale =
    100 * image::kMillisecond;      ///< no newer image: nothing is known to be permitted
constexpr int kBehindAnAnswer = 2;  ///< pictures: the first one may have been taken before it

/// The braking way at this speed, and what a handwheel may lag behind.
double room(const axis::AxisConfig& axis, double speed) {
  axis::MotionLimits limits = axis.limits;
  limits.velocity = std::min(limits.velocity, speed);
  return axis::Ramp::stopping_distance({0.0, limits.velocity, 0.0}, limits) +
         limits.velocity * cycle::Handwheel::kLag;
}

bool runs(image::ProcessState state) {
  return state == image::ProcessState::running || state == image::ProcessState::waiting;
}

/// It goes on by the operator's start.
bool waits_for_start(const image::ProcessStatus& p) {
  const image::WaitReason why = p.wait.reason;
  return p.state == image::ProcessState::waiting &&
         (why == image::WaitReason::program_stop || why == image::WaitReason::optional_stop ||
          why == image::WaitReason::block_end);
}

bool ended_by_somebody(image::JogEnd end) {
  return end == image::JogEnd::asked || end == image::JogEnd::feed || end == image::JogEnd::alarm ||
         end == image::JogEnd::power;
}

}  // namespace

PendantSession::PendantSession(const machine::LoadResult& loaded, const machine::PendantConfig& config,
                               drivers::PendantPort& port, PendantAsks asks, Announce announce)
    : loaded_(loaded),
      config_(config),
      port_(port),
      asks_(std::move(asks)),
      announce_(std::move(announce)),
      layout_(machine::pendant_layout(*loaded.device(config.device), config)),
      rules_(machine::pendant_rules(loaded.machine, config, layout_)) {
  for (const pendant::AxisCode& a : layout_.axes) {
    Axis axis;
    axis.index = loaded.machine.axis_index(std::string(1, a.letter));
    if (axis.index >= 0) {
      const axis::AxisConfig motion =
          gateway::axis_config(loaded, loaded.machine.axes[static_cast<std::size_t>(axis.index)]);
      if (process_ < 0 && rules_.axes.find(a.letter) != std::string::npos)
        process_ = loaded.machine.axes[static_cast<std::size_t>(axis.index)].process - 1;
      axis.room = room(motion, motion.jog_velocity);
      axis.slow_room = room(motion, std::min(motion.slow_velocity, motion.jog_velocity));
    }
    axes_.push_back(axis);
  }
  process_ = std::max(process_, 0);
  for (const machine::PathWheelConfig& w : loaded.machine.path_wheels)
    if (w.source == config.name) path_process_ = w.process - 1;
  if (!config.dead_man_point.empty())
    if (const machine::PointConfig* point = loaded.machine.point(config.dead_man_point))
      dead_man_ = point->place;
}

void PendantSession::tell(const text::Entry& entry, std::vector<std::string> arguments) const {
  if (announce_) announce_(entry, arguments);
}

const machine::AxisConfig& PendantSession::axis_config(int axis) const {
  const int index = axes_[static_cast<std::size_t>(axis)].index;
  return loaded_.machine.axes[static_cast<std::size_t>(index)];
}

void PendantSession::take_report(const pendant::ReportWriter::Bytes& report, Nanoseconds now) {
  if (std::exchange(slept_, false)) return;
  if (const auto reading = reader_.read(report.view())) {
    if (!reading->asleep) return hands_.take(*reading);
    slept_ = true;
    reader_.restart();
    return hands_.lost();
  }
  // What it says is not known, so it says nothing, and what it jogs ends.
  reader_.restart();
  hands_.lost();
  if (garbage_++ == 0 || now - garbage_told_at_ >= kTellAgain) {
    garbage_told_at_ = now;
    tell(pendant_says::kGarbage, {config_.name, config_.device, std::to_string(garbage_)});
  }
}

void PendantSession::take_news(Nanoseconds now) {
  PendantNews news;
  while (port_.take(news)) {
    switch (news.kind) {
      case PendantNews::Kind::report:
        if (plugged_) take_report(news.report, now);
        break;
      case PendantNews::Kind::not_allowed:
        tell(pendant_says::kNotAllowed, {config_.name, news.words});
        break;
      case PendantNews::Kind::plugged:
      case PendantNews::Kind::unplugged:
        plugged_ = news.kind == PendantNews::Kind::plugged;
        slept_ = false;
        reader_.restart();
        hands_.lost();
        tell_of_wheel();
        if (plugged_)
          tell(pendant_says::kCame, {config_.name, news.words});
        else
          tell(pendant_says::kWent, {config_.name});
        break;
    }
  }
}

/// Whether counts of its wheel can come at all: the path of a program may wait for them.
void PendantSession::tell_of_wheel() {
  if (path_process_ < 0) return;
  using What = ask::PathWheel::What;
  const auto what = plugged_ ? What::here : What::lost;
  urgent_.push_back({asks_.question(ask::PathWheel{path_process_, what, 0.0}), {}});
}

void PendantSession::observe(const image::ProcessImage& image, Nanoseconds now) {
  if (image.now.number != seen_) {
    ++pictures_;
    seen_at_ = now;
  }
  seen_ = image.now.number;
  const image::ProcessStatus& process = image.processes[static_cast<std::size_t>(process_)];
  view_.running = runs(process.state) && !waits_for_start(process);
  view_.held = process.state == image::ProcessState::held;
  view_.by_path = path_process_ >= 0 && image.processes[static_cast<std::size_t>(path_process_)].wheel.chosen;
  feed_mm_s_ = view_.running ? process.feed_mm_s : 0.0;
  view_.override_percent = process.override_ratio * 100.0;
  view_.released = now - seen_at_ <= kStale && (!dead_man_ || image.packets.number(*dead_man_) != 0.0);
  view_.alarm = image.alarms_active > 0;
  view_.powered = false;
  view_.current = pictures_ >= kBehindAnAnswer;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    pendant::AxisView& view = view_.axes[a];
    view = {};
    if (axes_[a].index < 0) continue;
    const image::AxisImage& axis = image.axes[static_cast<std::size_t>(axes_[a].index)];
    const bool mine = axis.hand == asks_.hand;
    view_.powered = view_.powered || axis.enabled;
    view.jogs =
        axis.enabled && !image.homing && !runs(image.processes[static_cast<std::size_t>(axis.process)].state);
    view.moves = mine && axis.owner == image::AxisOwner::manual && axis.moving;
    view.stopped = mine && ended_by_somebody(axis.jog_end);
    view.to_go = axis.distance_to_go;
    view.room = axis.homed && !axis.limit_plus && !axis.limit_minus ? axes_[a].room : axes_[a].slow_room;
  }
  hands_.see(view_);
}

ask::Command PendantSession::command_of(const Request& request) const {
  switch (request.kind) {
    case RequestKind::jog: {
      // Programs write a diameter; the way of a wheel is the slide's.
      const machine::AxisConfig& axis = axis_config(request.axis);
      return ask::Jog{axis.letter, axis.diameter ? 2.0 * request.value : request.value, {}};
    }
    case RequestKind::jog_on:
      return ask::JogContinuous{axis_config(request.axis).letter, request.value};
    case RequestKind::keep_alive:
      return ask::KeepAlive{axis_config(request.axis).letter};
    case RequestKind::jog_stop:
      return ask::JogStop{axis_config(request.axis).letter};
    case RequestKind::stop:
      return ask::Stop{};
    case RequestKind::hold:
      return ask::Hold{};
    case RequestKind::start:
      return ask::Start{process_};
    case RequestKind::resume:
      return ask::Resume{process_};
    case RequestKind::reset:
      return ask::Reset{};
    case RequestKind::power:
      return ask::Power{request.value != 0.0};
    case RequestKind::home:
      return ask::Home{config_.axes};
    case RequestKind::zero:
      return ask::Zero{axis_config(request.axis).letter, 0.0, {}};
    case RequestKind::override_feed:
      return ask::Override{request.value, process_};
    case RequestKind::mdi:
      return ask::Mdi{*request.text, process_};
    case RequestKind::path_wheel:
    case RequestKind::path_turned: {
      using What = ask::PathWheel::What;
      const What what = request.kind == RequestKind::path_turned ? What::turned
                        : request.value != 0.0                   ? What::choose
                                                                 : What::leave;
      return ask::PathWheel{path_process_ < 0 ? process_ : path_process_, what, request.value};
    }
  }
  return ask::Stop{};
}

void PendantSession::told_refusal(const Reply& reply, Nanoseconds now) {
  if (reply.text == refusal_ && now - refusal_told_at_ < kTellAgain) return;
  refusal_ = reply.text;
  refusal_told_at_ = now;
  tell(pendant_says::kRefused, {config_.name, reply.text});
}

void PendantSession::take_answers(Nanoseconds now) {
  std::erase_if(urgent_, [this, now](const Question& q) {
    const auto reply = asks_.answer(q.number);
    if (reply && !reply->ok && q.request.kind != RequestKind::jog_stop) told_refusal(*reply, now);
    return reply.has_value();
  });
  if (question_) {
    if (const auto reply = asks_.answer(question_->number)) {
      const auto* const jog = std::get_if<JogState>(&reply->content);
      const bool goes_on = jog == nullptr || (jog->moving && jog->axis.empty());
      hands_.answered(question_->request, reply->ok && goes_on);
      if (!reply->ok && question_->request.kind != RequestKind::keep_alive) told_refusal(*reply, now);
      question_.reset();
      pictures_ = 0;
    }
  }
  if (!status_) return;
  if (const auto reply = asks_.answer(*status_)) {
    status_.reset();
    if (const auto* const status = std::get_if<StatusReport>(&reply->content)) show(*status);
  }
}

void PendantSession::step(const image::ProcessImage& image, Nanoseconds now) {
  take_answers(now);
  observe(image, now);
  take_news(now);
  Request request;
  while (hands_.next(request, now)) {
    const bool urgent = pendant::Hands::is_urgent(request);
    if (request.axis >= 0 && axes_[static_cast<std::size_t>(request.axis)].index < 0) {
      if (!urgent) hands_.answered(request, false);
      continue;
    }
    const Question asked{asks_.question(command_of(request)), request};
    if (urgent)
      urgent_.push_back(asked);
    else
      question_ = asked;
  }
  if (layout_.display_bytes == 0 || !plugged_ || status_ || now - shown_at_ < kShow) return;
  shown_at_ = now;
  status_ = asks_.question(ask::Status{});
}

void PendantSession::show(const StatusReport& status) {
  pendant::Shown shown;
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    const auto index = static_cast<std::size_t>(axes_[a].index);
    if (axes_[a].index < 0 || index >= status.axes.size()) continue;
    const AxisReport& axis = status.axes[index];
    shown.work[a] = axis.work;
    shown.machine[a] = axis.position;
  }
  shown.feed_mm_min = feed_mm_s_ * 60.0;
  if (!status.spindles.empty()) shown.spindle_rpm = status.spindles.front().spindle.actual_rpm;
  shown.feed_override = view_.override_percent;
  shown.selected = hands_.selected();
  shown.step = hands_.step();
  shown.machine_coordinates = hands_.machine_coordinates();
  shown.reset = view_.alarm;
  port_.show(pendant::show(layout_, shown));
}

}  // namespace servogate::gateway
