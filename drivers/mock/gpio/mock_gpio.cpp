// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/gpio/mock_gpio.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::mock {

namespace {

template <typename T>
int find(const std::vector<T>& lines, std::string_view name) noexcept {
  for (std::size_t n = 0; n < lines.size(); ++n)
    if (lines[n].name == name) return static_cast<int>(n);
  return -1;
}

constexpr std::uint64_t kFlipsPerBounce = 24;
/// A chip that has never been there is missed after this time.
constexpr image::Nanoseconds kNeverPlugged = 100 * image::kMillisecond;

std::vector<image::PointRule> rules_of(const std::vector<GpioInput>& inputs,
                                       const std::vector<GpioOutput>& outputs) {
  std::vector<image::PointRule> rules;
  for (const GpioInput& input : inputs) rules.push_back(input.rule);
  for (const GpioOutput& output : outputs) {
    rules.push_back(output.rule);
    rules.back().input = false;
  }
  return rules;
}

}  // namespace

MockGpio::MockGpio(std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs, AxisPosition position,
                   int source)
    : inputs_(std::move(inputs)),
      outputs_(std::move(outputs)),
      position_(std::move(position)),
      stage_(rules_of(inputs_, outputs_), source, {{0, kNeverPlugged}}) {
  lines_.resize(inputs_.size());
  for (const GpioInput& input : inputs_) random_.emplace_back(input.bounce.seed);
  for (const GpioOutput& output : outputs_) driven_.push_back(output.rule.inverted);
  output_edges_.resize(outputs_.size());
}

double MockGpio::place_of_axis(const GpioInput& input) const {
  if (!position_) return std::nan("");
  if (const auto* limit = std::get_if<LimitSwitch>(&input.source)) return position_(limit->axis);
  if (const auto* home = std::get_if<HomeSwitch>(&input.source)) return position_(home->axis);
  return 0.0;
}

bool MockGpio::contact(const GpioInput& input, double at) {
  if (const auto* set = std::get_if<SetInput>(&input.source)) return set->on;
  if (std::isnan(at)) return false;
  if (const auto* limit = std::get_if<LimitSwitch>(&input.source))
    return (limit->positive ? at >= limit->mm : at <= limit->mm) != input.rule.inverted;
  const auto* home = std::get_if<HomeSwitch>(&input.source);
  return home != nullptr && (at >= home->mm && at <= home->mm + home->width_mm) != input.rule.inverted;
}

/// When the axis of a switch, on a straight way from where it was, has come to the place that works it.
image::Nanoseconds MockGpio::crossing(std::size_t n, double at, image::Nanoseconds t) const {
  const GpioInput& input = inputs_[n];
  const double from = lines_[n].at;
  if (!std::isfinite(from) || !std::isfinite(at) || from == at) return t;
  double place = at;
  if (const auto* limit = std::get_if<LimitSwitch>(&input.source)) place = limit->mm;
  if (const auto* home = std::get_if<HomeSwitch>(&input.source)) {
    const double end = home->mm + home->width_mm;
    place = (from < home->mm) != (at < home->mm) ? home->mm : end;
  }
  const double share = std::clamp((place - from) / (at - from), 0.0, 1.0);
  return t_ns_ + static_cast<image::Nanoseconds>(share * static_cast<double>(t - t_ns_));
}

void MockGpio::flip(std::size_t n, bool level, image::Nanoseconds t) {
  lines_[n].level = level;
  lines_[n].changed_ns = t;
  ++lines_[n].edges;
  if (plugged_ && !edges_lost_) stage_.edge(n, level, t);
}

void MockGpio::move(std::size_t n, bool wanted, image::Nanoseconds t) {
  Line& line = lines_[n];
  if (!line.started) {
    line.started = true;
    line.contact = line.level = wanted;
    return;
  }
  const auto bounce = static_cast<std::uint64_t>(std::max<image::Nanoseconds>(inputs_[n].bounce.time_ns, 0));
  std::mt19937_64& random = random_[n];
  if (wanted != line.contact) {
    line.contact = wanted;
    line.settle_ns = t + static_cast<image::Nanoseconds>(
                             bounce == 0 ? 0 : bounce / 2 + random() % (bounce - bounce / 2) + 1);
    line.next_flip_ns = t;
  }
  while (line.next_flip_ns < line.settle_ns && line.next_flip_ns <= t) {
    flip(n, !line.level, line.next_flip_ns);
    const std::uint64_t step = bounce / kFlipsPerBounce + 1;
    line.next_flip_ns += static_cast<image::Nanoseconds>(step + random() % step);
  }
  if (t >= line.settle_ns && line.level != line.contact)
    flip(n, line.contact, std::min(t, std::max(line.settle_ns, line.next_flip_ns)));
}

void MockGpio::advance_to(image::Nanoseconds t) {
  t = std::max(t_ns_, t);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    Line& line = lines_[n];
    const double at = place_of_axis(inputs_[n]);
    const bool wanted = line.forced ? line.forced_level : contact(inputs_[n], at);
    if (line.started && !line.forced && wanted != line.contact) move(n, wanted, crossing(n, at, t));
    if (!line.settled(wanted)) move(n, wanted, t);
    line.at = at;
  }
  t_ns_ = t;
}

void MockGpio::receive(image::ProcessImage& image, image::Notices&) noexcept {
  if (plugged_) {
    for (std::size_t n = 0; n < lines_.size(); ++n) {
      const auto* encoder = std::get_if<SetCounts>(&inputs_[n].source);
      stage_.take(n, encoder != nullptr ? encoder->counts : lines_[n].level ? 1.0 : 0.0);
    }
    stage_.fresh(0, t_ns_);
  } else {
    stage_.lost(0);
  }
  stage_.settle(image);
}

void MockGpio::send(image::ProcessImage& image) noexcept {
  if (!plugged_) return;
  for (std::size_t n = 0; n < outputs_.size(); ++n) {
    const bool level = stage_.level(inputs_.size() + n, image.packets);
    if (level == driven_[n]) continue;
    driven_[n] = level;
    ++output_edges_[n];
  }
}

int MockGpio::input_index(std::string_view name) const noexcept { return find(inputs_, name); }
int MockGpio::output_index(std::string_view name) const noexcept { return find(outputs_, name); }

void MockGpio::set_counts(std::size_t n, std::int32_t counts) {
  if (auto* encoder = std::get_if<SetCounts>(&inputs_[n].source)) encoder->counts = counts;
}

bool MockGpio::set_input(std::size_t n, bool on) {
  auto* set = n < inputs_.size() ? std::get_if<SetInput>(&inputs_[n].source) : nullptr;
  if (set != nullptr) set->on = on;
  return set != nullptr;
}

void MockGpio::force_input(std::size_t n, bool on) {
  lines_[n].forced = true;
  lines_[n].forced_level = on;
}

void MockGpio::release_input(std::size_t n) { lines_[n].forced = false; }
void MockGpio::set_bounce(std::size_t n, const Bounce& bounce) {
  inputs_[n].bounce = bounce;
  random_[n].seed(bounce.seed);
}

}  // namespace servogate::mock
