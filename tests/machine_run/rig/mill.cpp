// SPDX-License-Identifier: Apache-2.0
#include "tests/machine_run/rig/mill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "gateway/control/compose/program/program_model.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {

using image::RequestKind;

LimitJudge::LimitJudge(const machine::MachineConfig& machine)
    : machine_(machine), axes_(machine.axes.size()) {}

void LimitJudge::add(const image::ProcessImage& image) {
  const double dt = image.now.period_s();
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const image::AxisImage& in = image.axes[i];
    Axis& a = axes_[i];
    // To the last cycle in which the drive goes where it is told, also while its power is being taken away.
    const image::DriveCommand& to = in.drive_command;
    const bool follows = in.drive.online && in.drive.state == image::DriveState::operation_enabled &&
                         to.power && !to.quick_stop && to.mode == image::DriveMode::csp;
    if (!follows || in.homed != a.homed) a.known = 0;
    a.homed = in.homed;
    if (!follows) continue;
    std::copy(a.x + 1, a.x + 4, a.x);
    a.x[3] = in.command;
    a.known = std::min(a.known + 1, 4);
    if (a.known < 4) continue;
    a.velocity = std::max(a.velocity, std::abs(a.x[3] - a.x[2]) / dt);
    a.acceleration = std::max(a.acceleration, std::abs(a.x[3] - 2 * a.x[2] + a.x[1]) / (dt * dt));
    a.jerk = std::max(a.jerk, std::abs(a.x[3] - 3 * a.x[2] + 3 * a.x[1] - a.x[0]) / (dt * dt * dt));
  }
}

std::string LimitJudge::verdict() const {
  std::string words;
  const auto check = [&](const std::string& what, double value, double limit) {
    if (value > limit * 1.001)
      words += what + " " + std::to_string(value) + " > " + std::to_string(limit) + "; ";
  };
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const machine::AxisConfig& c = machine_.axes[i];
    check(c.letter + " velocity", axes_[i].velocity, c.max_velocity);
    check(c.letter + " acceleration", axes_[i].acceleration, c.max_acceleration);
    check(c.letter + " jerk", axes_[i].jerk, c.max_jerk);
  }
  return words;
}

machine::LoadResult changed_mill(const std::function<void(std::string& text)>& change) {
  const std::string path = source("examples/mill/machine.toml");
  std::ifstream file(path);
  std::string text((std::istreambuf_iterator<char>(file)), {});
  change(text);
  return machine::parse(text, path);
}

void replace(std::string& text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
}

Mill::Mill(std::string_view program, cycle::InputSource* source)
    : Mill(machine::load(machine_run::source("examples/mill/machine.toml")), program, source) {}

Mill::Mill(const machine::LoadResult& loaded, std::string_view program, cycle::InputSource* source,
           gateway::RunSettings settings)
    : program_(program) {
  std::vector<text::Finding> findings;
  settings.source = source;
  machine_ = gateway::RunningMachine::compose(loaded, nullptr, settings, findings);
  if (machine_ == nullptr) {
    ADD_FAILURE() << "the mill is not composed";
    std::abort();
  }
  control_ = &machine_->control();
  judge_ = std::make_unique<LimitJudge>(control_->machine());
  model_ = gateway::program_model(control_->machine(), 0);
  if (!program_.empty())
    control_->process(0).load([this](const program::Position& start) {
      return program::Interpreter("nc110", model_, {}, "test.nc", program_, {}, start);
    });
}

void Mill::step() {
  if (step_cycle) {
    control_->advance_world();
    control_->read_ahead();
    step_cycle(control_->cycle());
  } else {
    machine_->step();
  }
  judge_->add(image());
  if (after_cycle) after_cycle();
}

void Mill::run(double seconds) {
  const auto cycles = std::llround(seconds * 1e9 / static_cast<double>(control_->cycle().period_ns()));
  for (long long n = 0; n < cycles; ++n) step();
}

bool Mill::until(const std::function<bool()>& met, double patience_s) {
  const image::Nanoseconds end = image().now.t_ns + std::llround(patience_s * 1e9);
  while (!met()) {
    if (image().now.t_ns > end) return false;
    step();
  }
  return true;
}

void Mill::post(RequestKind kind, double value, int axis) {
  image::Request r;
  r.kind = kind;
  r.value = value;
  r.axis = static_cast<std::int8_t>(axis);
  post(r);
}

void Mill::post(image::Request request) {
  request.id = next_id_++;
  EXPECT_TRUE(control_->cycle().post(request));
}

cycle::Refusal Mill::ask(RequestKind kind, double value, int axis) {
  image::Answer answer;
  while (control_->cycle().take_answer(answer)) {
  }
  post(kind, value, axis);
  for (int i = 0; i < 10; ++i) {
    step();
    while (control_->cycle().take_answer(answer))
      if (answer.id == next_id_ - 1) {
        answer_ = answer;
        return static_cast<cycle::Refusal>(answer.refusal);
      }
  }
  ADD_FAILURE() << "no answer";
  return cycle::Refusal::unknown_request;
}

const image::AxisImage& Mill::axis(std::string_view letter) const {
  const int index = control_->machine().axis_index(std::string(letter));
  return image().axes[static_cast<std::size_t>(index)];
}

bool Mill::standing() const {
  return std::none_of(image().axes.begin(), image().axes.begin() + image().axis_count,
                      [](const image::AxisImage& a) { return a.moving; });
}

bool Mill::power_on() {
  const auto all = [this](auto&& good) {
    return std::all_of(image().axes.begin(), image().axes.begin() + image().axis_count, good);
  };
  const bool online =
      until([&] { return all([](const image::AxisImage& a) { return a.drive.online; }); }, 15.0);
  if (!online || ask(RequestKind::reset) != cycle::Refusal::none ||
      ask(RequestKind::power, 1.0) != cycle::Refusal::none)
    return false;
  const auto permitted = [this] {
    const auto axes = control_->cycle().axes();
    return std::all_of(axes.begin(), axes.end(), [](const axis::Axis& a) { return a.motion_permitted(); });
  };
  return until(permitted, 5.0);
}

bool Mill::make_ready() {
  if (!power_on()) return false;
  if (ask(RequestKind::mode, static_cast<double>(image::Mode::home)) != cycle::Refusal::none) return false;
  if (ask(RequestKind::home) != cycle::Refusal::none) return false;
  // Axes home one after the other: all of them have to stand for a while.
  int standing_cycles = 0;
  const auto homed = [&] {
    const bool all = std::all_of(
        image().axes.begin(), image().axes.begin() + image().axis_count, [](const image::AxisImage& a) {
          return a.homed && a.owner == image::AxisOwner::none && !a.moving && a.in_position;
        });
    standing_cycles = all ? standing_cycles + 1 : 0;
    return standing_cycles > 100;
  };
  return until(homed, 30.0) &&
         ask(RequestKind::mode, static_cast<double>(image::Mode::automatic)) == cycle::Refusal::none;
}

int Mill::alarms(image::AlarmNumber number) const {
  const auto history = control_->cycle().alarms().history();
  return static_cast<int>(std::count_if(history.begin(), history.end(),
                                        [&](const image::AlarmRecord& r) { return r.number == number; }));
}

std::string Mill::alarm_list() const {
  std::string list;
  for (const image::AlarmRecord& r : control_->cycle().alarms().history())
    list += std::to_string(r.number) + " at " + std::to_string(r.cycle) + "; ";
  return list;
}

void Mill::inject(std::string_view device, const fault::Fault& fault) {
  std::string why;
  ASSERT_TRUE(machine_->inject(device, fault, why)) << text::in_language(why, text::Language::english);
}

image::Place place_of(const gateway::Control& control, std::string_view symbol) {
  for (const image::Symbol& s : control.machine().symbol_table())
    if (s.name == symbol) return s.place;
  ADD_FAILURE() << symbol;
  return {};
}

}  // namespace servogate::machine_run
