// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/drive/homing.hpp"

namespace servogate::canopen {
namespace {

using Method = HomingSequence::Method;
constexpr auto kNeg = DriveInput::negative_limit, kPos = DriveInput::positive_limit, kHome = DriveInput::home;

// Methods 1-14 as drawn in CiA 402-2; 17-30 are the same without the zero mark.
constexpr Method kMethods[] = {
    {1, kNeg, -1, +1, false, true, false},   {2, kPos, +1, -1, false, true, false},
    {3, kHome, +1, -1, false, true, false},  {4, kHome, +1, +1, true, true, false},
    {5, kHome, -1, +1, false, true, false},  {6, kHome, -1, -1, true, true, false},
    {7, kHome, +1, -1, false, true, false},  {8, kHome, +1, +1, true, true, false},
    {9, kHome, +1, -1, true, true, false},   {10, kHome, +1, +1, false, true, false},
    {11, kHome, -1, +1, false, true, false}, {12, kHome, -1, -1, true, true, false},
    {13, kHome, -1, +1, true, true, false},  {14, kHome, -1, -1, false, true, false},
    {33, kHome, -1, -1, false, true, true},  {34, kHome, +1, +1, false, true, true},
};

constexpr int kNumbers[] = {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 17, 18,
                            19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 33, 34, 35, 37};

const Method* find(int number) noexcept {
  for (const Method& m : kMethods)
    if (m.number == number) return &m;
  return nullptr;
}

}  // namespace

std::span<const int> supported_homing_methods() noexcept { return kNumbers; }

bool HomingSequence::start(int number, const DriveInputs& inputs, const ServoState& servo) noexcept {
  state_ = State::running;
  reversed_ = armed_ = false;
  if (number == 35 || number == 37) {
    found(servo.position);
    return true;
  }
  const bool with_index = number < 17 || number > 30;
  const Method* m = find(with_index ? number : number - 16);
  if (!m) {
    state_ = State::failed;
    return false;
  }
  method_ = *m;
  method_.index = with_index;
  direction_ = method_.search;
  if (method_.only_index) {
    stage_ = Stage::index;
  } else if (inputs.on(method_.signal)) {
    stage_ = method_.to_active ? Stage::back_out : Stage::cross;
  } else {
    stage_ = Stage::search;
  }
  return true;
}

double HomingSequence::tick(const DriveInputs& inputs, const ServoState& servo, double switch_speed,
                            double zero_speed, bool standstill) noexcept {
  if (state_ != State::running) return 0.0;
  switch (stage_) {
    case Stage::search:
      return search(inputs, switch_speed);
    case Stage::back_out:
      if (!inputs.on(method_.signal) && servo.velocity * method_.cross < 0.0) {
        stage_ = Stage::cross;
        return method_.cross * zero_speed;
      }
      if (against_limit(inputs, -method_.cross)) return fail();
      return -method_.cross * switch_speed;
    case Stage::cross:
      return cross(inputs, servo, zero_speed);
    case Stage::index:
      if (servo.zero_mark && servo.velocity * method_.cross > 0.0) return found(servo.zero_mark_position);
      if (against_limit(inputs, method_.cross)) return fail();
      return method_.cross * zero_speed;
    case Stage::settle:
      if (standstill) state_ = State::done;
      return 0.0;
  }
  return 0.0;
}

// Fast, until the signal is active; a limit switch on the way turns the search round once.
double HomingSequence::search(const DriveInputs& inputs, double speed) noexcept {
  if (inputs.on(method_.signal)) {
    stage_ = method_.to_active ? Stage::back_out : Stage::cross;
    return 0.0;
  }
  if (against_limit(inputs, direction_)) {
    if (reversed_) return fail();
    reversed_ = true;
    direction_ = -direction_;
  }
  return direction_ * speed;
}

// Slowly over the edge that counts. While the shaft still turns the wrong way nothing is taken for the edge.
double HomingSequence::cross(const DriveInputs& inputs, const ServoState& servo, double speed) noexcept {
  if (servo.velocity * method_.cross > 0.0) {
    const bool level = inputs.on(method_.signal);
    if (level != method_.to_active) {
      armed_ = true;
    } else if (armed_) {
      if (!method_.index) return found(inputs.edge(method_.signal));
      stage_ = Stage::index;
      return method_.cross * speed;
    }
  }
  if (against_limit(inputs, method_.cross)) return fail();
  return method_.cross * speed;
}

double HomingSequence::found(std::int64_t position) noexcept {
  home_ = position;
  stage_ = Stage::settle;
  return 0.0;
}

// A limit switch in the way that is not the signal itself.
bool HomingSequence::against_limit(const DriveInputs& inputs, int direction) const noexcept {
  const DriveInput limit = direction > 0 ? kPos : kNeg;
  return inputs.on(limit) && method_.signal != limit;
}

double HomingSequence::fail() noexcept {
  state_ = State::failed;
  return 0.0;
}

}  // namespace servogate::canopen
