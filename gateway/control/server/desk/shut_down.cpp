// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/desk/shut_down.hpp"

#include <algorithm>
#include <utility>

#include "gateway/control/run/standstill.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kSpindleRunsDown{"up.spindle-runs-down",
                                   "the spindle runs down; the control ends when it stands",
                                   "шпиндель останавливается; управление завершится, когда он встанет"};
const text::Entry kSpindleTurns{"up.spindle-turns",
                                "the spindle does not stand after {0} s: the control ends all the same",
                                "шпиндель не встал за {0} с: управление всё же завершается"};
const text::Entry kAxesOn{"up.axes-on", "drives are still on after {0} s: the control ends all the same",
                          "приводы не выключились за {0} с: управление всё же завершается"};
const text::Entry kSpindleUnknown{"up.spindle-unknown",
                                  "the drive of a spindle does not answer: whether it stands cannot be seen",
                                  "привод шпинделя не отвечает: стоит ли шпиндель, не видно"};
constexpr double kSilentWait_s = 0.5;
constexpr double kAnswerPatience_s = 2.0;

}  // namespace

void ShutDown::enter(Stage stage) {
  stage_ = stage;
  entered_ = std::chrono::steady_clock::now();
}

double ShutDown::in_stage() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - entered_).count();
}

const image::ProcessImage& ShutDown::image() {
  control_.cycle().read(*image_);
  return *image_;
}

bool ShutDown::moving() {
  const image::ProcessImage& now = image();
  return std::any_of(now.axes.begin(), now.axes.begin() + now.axis_count,
                     [](const image::AxisImage& a) { return a.moving; });
}

/// The cycle has answered, or does not any more. A value of 0 switches off.
bool ShutDown::asked(image::RequestKind kind) {
  if (request_ == 0)
    request_ = requests_.post(
        {.kind = kind, .process = static_cast<std::int8_t>(kind == image::RequestKind::stop ? -1 : 0)});
  if (!requests_.take(request_) && in_stage() < kAnswerPatience_s) return false;
  requests_.forget(std::exchange(request_, 0));
  return true;
}

bool ShutDown::look() {
  switch (stage_) {
    case Stage::begin:
      enter(Stage::stop);
      [[fallthrough]];
    case Stage::stop:
      if (asked(image::RequestKind::stop)) enter(Stage::motion);
      break;
    case Stage::motion:
      if (!moving() || in_stage() >= kAxesOffPatience_s) enter(Stage::power);
      break;
    case Stage::power:
      if (asked(image::RequestKind::power)) enter(Stage::drives);
      break;
    case Stage::drives:
      if (!axes_off(image()) && in_stage() < kAxesOffPatience_s) break;
      if (!axes_off(image())) announce(kAxesOn, {text::number(kAxesOffPatience_s, 0)});
      enter(Stage::spindles);
      break;
    case Stage::spindles: {
      const bool rest = spindles_rest(image());
      if (!rest && !said_ && in_stage() > kSilentWait_s) announce(kSpindleRunsDown, {}), said_ = true;
      if (rest || in_stage() > kSpindlePatience_s) end();
      break;
    }
    case Stage::done:
      break;
  }
  return stage_ == Stage::done;
}

void ShutDown::end() {
  const image::ProcessImage& now = image();
  const bool rest = spindles_rest(now), known = spindles_answer(now, control_.machine());
  if (!rest) announce(kSpindleTurns, {text::number(kSpindlePatience_s, 0)});
  if (!known) announce(kSpindleUnknown, {});
  rests_ = rest && known && axes_off(now);
  enter(Stage::done);
}

}  // namespace servogate::gateway
