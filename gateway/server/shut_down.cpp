// SPDX-License-Identifier: Apache-2.0
#include "gateway/server/shut_down.hpp"

#include <algorithm>

#include "gateway/cli/messages.hpp"
#include "gateway/run/standstill.hpp"

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

}  // namespace

void ShutDown::enter(Stage stage) {
  stage_ = stage;
  entered_ = std::chrono::steady_clock::now();
}

double ShutDown::in_stage() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - entered_).count();
}

bool ShutDown::moving() {
  const image::ProcessImage& image = resident_.image();
  return std::any_of(image.axes.begin(), image.axes.begin() + image.axis_count,
                     [](const image::AxisImage& a) { return a.moving; });
}

bool ShutDown::look() {
  image::Answer answer;
  switch (stage_) {
    case Stage::begin:
      resident_.ask({.kind = image::RequestKind::stop}, answer);
      enter(Stage::motion);
      break;
    case Stage::motion:
      if (moving() && in_stage() < kAxesOffPatience_s) break;
      resident_.ask({.kind = image::RequestKind::power, .value = 0.0}, answer);
      enter(Stage::drives);
      break;
    case Stage::drives:
      if (!axes_off(resident_.image()) && in_stage() < kAxesOffPatience_s) break;
      if (!axes_off(resident_.image())) complain(kAxesOn, {text::number(kAxesOffPatience_s, 0)});
      enter(Stage::spindles);
      break;
    case Stage::spindles: {
      const bool rest = spindles_rest(resident_.image());
      if (!rest && !said_ && in_stage() > kSilentWait_s) complain(kSpindleRunsDown, {}), said_ = true;
      if (rest || in_stage() > kSpindlePatience_s) end();
      break;
    }
    case Stage::done:
      break;
  }
  return stage_ == Stage::done;
}

void ShutDown::end() {
  const image::ProcessImage& image = resident_.image();
  const bool rest = spindles_rest(image), known = spindles_answer(image, resident_.control().machine());
  if (!rest) complain(kSpindleTurns, {text::number(kSpindlePatience_s, 0)});
  if (!known) complain(kSpindleUnknown, {});
  rests_ = rest && known && axes_off(image);
  enter(Stage::done);
}

}  // namespace servogate::gateway
