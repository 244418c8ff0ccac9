// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/plc_orders/path_wheel.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/cycle/gate/gate.hpp"

namespace servogate::cycle {

using image::at;
using image::RequestKind;
using image::WheelNews;

namespace {

consteval image::Place of_process(std::string_view name) { return image::field(image::kProcessFields, name); }
consteval image::Place of_machine(std::string_view name) {
  return image::field(image::kMachineFields, name, image::kMachineBase);
}
constexpr image::Place kChosen = of_process("path_wheel"), kOn = of_process("path_wheel_on");
constexpr image::Place kLost = of_process("path_wheel_lost"), kRate = of_process("path_wheel_rate");
constexpr image::Place kRefusal = of_process("path_wheel_refusal");
constexpr image::Place kCounters[] = {of_machine("handwheel1"), of_machine("handwheel2")};
constexpr double kNoWay = 1e-6;  // mm or degrees

bool busy(image::ProcessState s) noexcept {
  return s == image::ProcessState::running || s == image::ProcessState::held ||
         s == image::ProcessState::waiting;
}

}  // namespace

void PathWheel::configure(const PathWheelConfig& config, int process) noexcept {
  config_ = config;
  process_ = process;
}

void PathWheel::take(const image::Request& request) noexcept {
  switch (static_cast<WheelNews>(request.index)) {
    case WheelNews::choose:
      asked_ = request.value != 0.0;
      break;
    case WheelNews::turned:
      pending_ += request.value;
      break;
    case WheelNews::here:
      here_ = request.value != 0.0;
      break;
  }
}

void PathWheel::forget() noexcept {
  parts_ = {};
  in_part_ = 0;
  turned_ = pending_ = 0.0;
  counter_known_ = false;
}

/// A counter that is looked at anew is taken as it is.
std::int32_t PathWheel::counts_of_plc(const image::ProcessImage& image) noexcept {
  const image::Place place = kCounters[config_.source - 1];
  const auto now = static_cast<std::uint32_t>(static_cast<std::int32_t>(image.packets.number(place)));
  const auto counts = static_cast<std::int32_t>(now - counter_);  // round the end of the counter, too
  counter_ = now;
  return std::exchange(counter_known_, true) ? counts : 0;
}

void PathWheel::measure(std::int32_t counts, image::Nanoseconds period) noexcept {
  parts_[static_cast<std::size_t>(part_)] += counts;
  in_part_ += period;
  if (in_part_ < kWindow / kParts) return;
  in_part_ = 0;
  const double sum = std::accumulate(parts_.begin(), parts_.end(), 0.0);
  turned_ = sum / (static_cast<double>(kWindow) * 1e-9 * config_.full);
  part_ = (part_ + 1) % kParts;
  parts_[static_cast<std::size_t>(part_)] = 0.0;
}

void PathWheel::read(const image::ProcessImage& image) noexcept {
  const bool by_plc = image.packets.bit(at(kChosen, image::process_base(process_)));
  if (!declared()) {
    refusal_ = static_cast<std::uint16_t>(by_plc ? Refusal::no_path_wheel : Refusal::none);
    return;
  }
  chosen_ = asked_ || by_plc;
  const bool of_pendant = config_.source == PathWheelConfig::kPendant;
  lost_ = of_pendant ? !here_ : config_.healthy && !image.packets.bit(*config_.healthy);
  if (!chosen_ || lost_) return forget();
  measure(of_pendant ? static_cast<std::int32_t>(std::exchange(pending_, 0.0)) : counts_of_plc(image),
          image.now.period_ns);
}

/// The process itself ends a way where the hand rests or turns round.
bool PathWheel::next(image::Request& request, const image::ProcessImage& image) noexcept {
  const image::ProcessStatus& p = image.processes[static_cast<std::size_t>(process_)];
  if (!chosen_ || !busy(p.state)) leads_ = false;
  if (!leads_ || turned_ >= 0.0) at_begin_ = went_back_ = false;
  if (!declared() || !chosen_ || turned_ == 0.0 || p.retracing) return false;
  request = {};
  request.asker = config_.source == PathWheelConfig::kPendant ? image::Asker::pendant : image::Asker::plc;
  request.process = static_cast<std::int8_t>(process_);
  if (turned_ > 0.0) {
    request.kind = p.retraced ? RequestKind::reposition : RequestKind::resume;
    return leads_;
  }
  if (went_back_ && p.retraced_mm <= went_from_ + kNoWay) at_begin_ = true;
  if (at_begin_ || !(leads_ || p.wheel.rests)) return false;
  request.kind = RequestKind::retrace;
  request.index = kBlocks;
  went_from_ = p.retraced_mm;
  return true;
}

void PathWheel::answer(const image::Request& request, const image::Answer& answer) noexcept {
  refusal_ = answer.refusal;
  if (answer.refusal != 0) return;
  leads_ = request.kind != RequestKind::resume;
  went_back_ = request.kind == RequestKind::retrace;
}

void PathWheel::write(image::ProcessImage& image) const noexcept {
  image::PathWheel& out = image.processes[static_cast<std::size_t>(process_)].wheel;
  out.chosen = chosen_;
  out.lost = chosen_ && lost_;
  out.leads = leads_;
  out.turned = turned_;
  const std::uint32_t base = image::process_base(process_);
  image.packets.set_bit(at(kOn, base), out.chosen);
  image.packets.set_bit(at(kLost, base), out.lost);
  image.packets.set_number(at(kRate, base), std::round(out.rate() * 100.0));
  image.packets.set_number(at(kRefusal, base), refusal_);
}

}  // namespace servogate::cycle
