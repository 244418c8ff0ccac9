// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/pendant/hands.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/image/wheel_way.hpp"

namespace servogate::pendant {

namespace {

constexpr int kMostPending = 10'000;

std::size_t at(int index) { return static_cast<std::size_t>(index); }

bool moves(Action action) {
  return action == Action::start_hold || action == Action::home || action == Action::mdi ||
         action == Action::power;
}

bool begins_motion(const Request& r) {
  return r.kind == RequestKind::start || r.kind == RequestKind::resume || r.kind == RequestKind::home ||
         r.kind == RequestKind::mdi || r.kind == RequestKind::power;
}

/// These mean the same with `shift` held.
bool always(const Binding* b) {
  return b != nullptr &&
         (b->action == Action::shift || b->action == Action::stop || b->action == Action::hold);
}

}  // namespace

const Binding* Hands::binding_of(int button) const noexcept {
  const Binding* alone = nullptr;
  for (const Binding& b : layout_->bindings) {
    if (b.button != button) continue;
    if (b.with >= 0 && pressed(b.with)) return &b;
    if (b.with < 0) alone = &b;
  }
  return shifted() && !always(alone) ? nullptr : alone;
}

bool Hands::shifted() const noexcept {
  return std::any_of(layout_->bindings.begin(), layout_->bindings.end(), [this](const Binding& b) {
    // A dead-man that is held all the time cannot change what the others mean.
    return b.action == Action::shift && b.button != rules_->dead_man && pressed(b.button);
  });
}

bool Hands::held() const noexcept {
  return known_ && view_.released && (rules_->dead_man < 0 || pressed(rules_->dead_man));
}

bool Hands::permitted(int axis) const noexcept {
  if (axis < 0 || !held() || axis == blocked_) return false;
  return view_.axes[at(axis)].jogs && is_mine(axis);
}

bool Hands::is_mine(int axis) const noexcept {
  return axis >= 0 && rules_->axes.find(layout_->axes[at(axis)].letter) != std::string::npos;
}

double Hands::step_length() const noexcept {
  return step_ < 0 ? 0.0 : std::min(layout_->steps[at(step_)].length, rules_->max_step);
}

void Hands::drop_pending() noexcept {
  drop(pending_);
  pending_ = 0;
}

void Hands::begin_end(int axis) noexcept {
  if (axis >= 0) ends_ |= 1u << axis;
}

void Hands::queue(const Request& request) noexcept {
  if (queued_ < kQueue) queue_[at(queued_++)] = {request, pressed_now_};
}

/// What waits is not carried out behind it.
void Hands::stop(bool& which) noexcept {
  which = true;
  queued_ = 0;
}

void Hands::see(const View& view) noexcept {
  // A hand that still turns does not jog: the axis is to be selected anew.
  if (view_.by_path && !view.by_path) blocked_ = selected_;
  view_ = view;
  if (wheel_axis_ >= 0 && view.current && !under_way_) {
    const AxisView& axis = view.axes[at(wheel_axis_)];
    if (axis.stopped) blocked_ = wheel_axis_;
    if (!axis.moves) wheel_axis_ = -1;
  }
  if (wheel_axis_ >= 0 && !permitted(wheel_axis_)) {
    begin_end(wheel_axis_);
    wheel_axis_ = -1;
  }
  if (!permitted(selected_) || view.by_path) drop_pending();
  if (!view.by_path || !held()) drop(std::exchange(path_turned_, 0));
  ring();
}

/// Which axis wheel and ring mean now: that of the selector, of the button that is held, or of the last one
/// that was pressed.
void Hands::select() noexcept {
  int axis = layout_->axis >= 0 ? now_.axis : chosen_;
  for (const Binding& b : layout_->bindings)
    if (b.action == Action::hold_axis && pressed(b.button) && (b.with < 0 || pressed(b.with)))
      axis = layout_->axis_index(b.axis);
  if (axis == selected_) return;
  drop_pending();
  begin_end(wheel_axis_);
  wheel_axis_ = blocked_ = -1;
  ring_armed_ = false;
  selected_ = axis;
}

void Hands::press(const Binding& b) noexcept {
  if (moves(b.action) && !held() && !(b.action == Action::start_hold && view_.running) &&
      !(b.action == Action::power && view_.powered))
    return;
  switch (b.action) {
    case Action::nothing:
    case Action::shift:
    case Action::hold_axis:
      return;
    case Action::stop:
      return stop(stop_);
    case Action::hold:
      return stop(hold_);
    case Action::start_hold:
      if (view_.running) return stop(hold_);
      return queue({view_.held ? RequestKind::resume : RequestKind::start});
    case Action::reset:
      return queue({RequestKind::reset});
    case Action::power:
      if (view_.powered) return stop(power_off_);
      return queue({RequestKind::power, -1, 1.0});
    case Action::home:
      return queue({RequestKind::home});
    case Action::zero:
      if (is_mine(selected_)) queue({RequestKind::zero, selected_});
      return;
    case Action::override_by:
      return queue(
          {RequestKind::override_feed, -1, std::clamp(view_.override_percent + b.value, 0.0, 150.0)});
    case Action::next_step:
      step_ = layout_->steps.empty() ? -1 : (step_ + 1) % static_cast<int>(layout_->steps.size());
      return drop_pending();
    case Action::coordinates:
      machine_coordinates_ = !machine_coordinates_;
      return;
    case Action::select:
      chosen_ = layout_->axis_index(b.axis);
      return;
    case Action::mdi:
      return queue({RequestKind::mdi, -1, 0.0, &b.text});
    case Action::path_wheel:
      return queue({RequestKind::path_wheel, -1, view_.by_path ? 0.0 : 1.0});
  }
}

void Hands::take(const Reading& reading) noexcept {
  const bool first = !known_;
  stuck_ = first ? reading.buttons : stuck_ & reading.buttons;
  const std::uint32_t before = first ? 0 : now_.buttons;
  const int step = step_, selected = selected_;
  now_ = reading;
  now_.buttons &= ~stuck_;
  known_ = true;
  if (first && layout_->step < 0) step_ = layout_->steps.empty() ? -1 : 0;
  const std::uint32_t fresh = now_.buttons & ~before;
  for (int b = 0; b < static_cast<int>(layout_->buttons.size()); ++b)
    if ((fresh >> b & 1u) != 0) {
      pressed_now_ = b;
      if (const Binding* binding = binding_of(b)) press(*binding);
    }
  if (layout_->step >= 0) step_ = reading.step;
  select();
  if (!held()) blocked_ = -1;
  if (step_ != step) drop_pending();
  if (reading.counts != 0) turn(reading.counts, !first && step_ == step && selected_ == selected);
  see(view_);
}

/// `same`: the report has turned no selector.
void Hands::turn(int counts, bool same) noexcept {
  if (same && view_.by_path && held() && std::abs(path_turned_) < kMostPending)
    path_turned_ += counts;
  else if (same && !view_.by_path && permitted(selected_) && ring_axis_ < 0 && step_length() > 0.0 &&
           std::abs(pending_) < kMostPending)
    pending_ += counts;
  else
    drop(counts);
}

/// The ring jogs while it is held out of its rest.
void Hands::ring() noexcept {
  const int range = layout_->ring < 0 || std::abs(now_.ring) < layout_->ring_from ? 0 : now_.ring;
  const int sign = (range > 0) - (range < 0);
  if (ring_axis_ >= 0 && (sign != ring_sign_ || selected_ != ring_axis_ || !permitted(ring_axis_))) {
    begin_end(ring_axis_);
    ring_axis_ = -1;
    ring_armed_ = false;
  }
  if (sign == 0 && known_) ring_armed_ = true;
}

void Hands::lost() noexcept {
  known_ = false;
  now_ = {};
  begin_end(wheel_axis_);
  begin_end(ring_axis_);
  wheel_axis_ = ring_axis_ = selected_ = chosen_ = blocked_ = -1;
  ring_armed_ = false;
  drop_pending();
  drop(std::exchange(path_turned_, 0));
  queued_ = 0;
}

bool Hands::next_jog(Request& request) noexcept {
  if (ring_axis_ < 0 && ring_armed_ && permitted(selected_) && layout_->ring >= 0 &&
      std::abs(now_.ring) >= layout_->ring_from) {
    ring_axis_ = selected_;
    ring_sign_ = now_.ring > 0 ? 1 : -1;
    request = {RequestKind::jog_on, ring_axis_, static_cast<double>(ring_sign_)};
    return true;
  }
  if (pending_ == 0 || !view_.current || !permitted(selected_)) return false;
  const AxisView& axis = view_.axes[at(selected_)];
  const double step = step_length(), way = step * pending_;
  const double left = axis.moves ? std::copysign(1.0, way) * axis.to_go : 0.0;
  const double followed = image::wheel_way(way, step, axis.room, left);
  drop(static_cast<int>(std::lround(std::abs(way - followed) / step)));
  pending_ = 0;
  if (followed == 0.0) return false;
  wheel_axis_ = selected_;
  request = {RequestKind::jog, wheel_axis_, followed};
  return true;
}

bool Hands::next(Request& request, image::Nanoseconds now) noexcept {
  for (int a = 0; a < kMostAxes; ++a) {
    if ((ends_ >> a & 1u) == 0) continue;
    ends_ &= ~(1u << a);
    request = {RequestKind::jog_stop, a};
    return true;
  }
  if (std::exchange(stop_, false)) {
    request = {RequestKind::stop};
    return true;
  }
  if (std::exchange(hold_, false)) {
    request = {RequestKind::hold};
    return true;
  }
  if (std::exchange(power_off_, false)) {
    request = {RequestKind::power, -1, 0.0};
    return true;
  }
  if (under_way_) return false;
  while (queued_ > 0) {
    const Queued oldest = queue_[0];
    std::move(queue_.begin() + 1, queue_.begin() + queued_, queue_.begin());
    --queued_;
    // The hand has let go of it meanwhile: what was asked for then is not begun now.
    if (begins_motion(oldest.request) && (!held() || !pressed(oldest.button))) continue;
    request = oldest.request;
    under_way_ = true;
    return true;
  }
  if (ring_axis_ >= 0 && now - kept_alive_ >= kKeepAlive) {
    kept_alive_ = now;
    request = {RequestKind::keep_alive, ring_axis_};
    under_way_ = true;
    return true;
  }
  if (path_turned_ != 0) {
    request = {RequestKind::path_turned, -1, static_cast<double>(std::exchange(path_turned_, 0))};
    under_way_ = true;
    return true;
  }
  under_way_ = next_jog(request);
  if (under_way_ && request.kind == RequestKind::jog_on) kept_alive_ = now;
  return under_way_;
}

/// A ring whose jog was refused or has ended is to be let go before it jogs again.
void Hands::answered(const Request& request, bool accepted) noexcept {
  under_way_ = false;
  view_.current = false;
  if (accepted) {
    // Meanwhile the hand has let go: the end that was asked for may have come before the jog.
    if (request.kind == RequestKind::jog_on && ring_axis_ != request.axis) begin_end(request.axis);
    if (request.kind == RequestKind::jog && wheel_axis_ != request.axis) begin_end(request.axis);
    return;
  }
  if ((request.kind == RequestKind::jog_on || request.kind == RequestKind::keep_alive) &&
      ring_axis_ == request.axis) {
    ring_axis_ = -1;
    ring_armed_ = false;
  }
}

}  // namespace servogate::pendant
