// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/board/simulated_board.hpp"

#include <algorithm>

namespace servogate::mock {

namespace {

constexpr std::uint16_t kFirmwareVersion = 1;
constexpr std::uint16_t kTenVolts = 10'000;
constexpr std::uint8_t kEverything =
    board::capability(board::Output::step) | board::capability(board::Output::analog) |
    board::capability(board::Output::pwm) | board::kHasEncoder | board::kHasIndex;

}  // namespace

SimulatedBoard::SimulatedBoard(const SimulatedBoardConfig& config)
    : config_(config), tick_ns_(image::kSecond / config.tick_hz) {
  for (std::size_t n = 0; n < board::kChannels; ++n)
    if (config.amplifiers[n]) amplifiers_[n].emplace(*config.amplifiers[n]);
  restart();
}

board::Description SimulatedBoard::description() const {
  board::Description d;
  d.firmware = kFirmwareVersion;
  d.inputs = config_.inputs;
  d.outputs = config_.outputs;
  d.analog_inputs = d.analog_outputs = board::kAnalog;
  d.full_scale_mv = kTenVolts;
  for (std::size_t n = 0; n < board::kChannels; ++n) d.capabilities[n] = amplifiers_[n] ? kEverything : 0;
  std::copy_n(config_.serial.begin(), std::min(config_.serial.size(), d.serial.size()), d.serial.begin());
  return d;
}

void SimulatedBoard::restart() {
  firmware_ =
      std::make_unique<board::Firmware>(static_cast<board::Hardware&>(*this), description(), config_.tick_hz);
}

void SimulatedBoard::advance_to(image::Nanoseconds t) {
  const double dt = static_cast<double>(tick_ns_) * 1e-9;
  while (t_ns_ + tick_ns_ <= t) {
    t_ns_ += tick_ns_;
    firmware_->tick();
    for (auto& a : amplifiers_)
      if (a) a->advance(dt);
  }
}

std::span<const std::uint8_t> SimulatedBoard::exchange(std::span<const std::uint8_t> message) noexcept {
  if (!plugged_) return {};
  return {answer_.data(), firmware_->receive(message, answer_)};
}

void SimulatedBoard::set_input(std::size_t number, bool level, image::Nanoseconds t) noexcept {
  if (input(number) == level) return;
  inputs_ ^= 1u << number;
  if (edges_lost_) return;
  firmware_->note_edge(static_cast<std::uint8_t>(number), level,
                       static_cast<std::uint32_t>(t / image::kMicrosecond));
}

Amplifier* SimulatedBoard::amplifier(std::size_t channel) noexcept {
  return channel < amplifiers_.size() && amplifiers_[channel] ? &*amplifiers_[channel] : nullptr;
}
const Amplifier* SimulatedBoard::amplifier(std::size_t channel) const noexcept {
  return channel < amplifiers_.size() && amplifiers_[channel] ? &*amplifiers_[channel] : nullptr;
}

bool SimulatedBoard::inject(const board::Injection& injection) noexcept {
  std::array<std::uint8_t, board::kMostBytes> message{}, answer{};
  const std::size_t size = board::put({board::Kind::inject, 0}, injection, message);
  const std::size_t answered = firmware_->receive({message.data(), size}, answer);
  board::Message m;
  return board::parse({answer.data(), answered}, m) && m.header.kind == board::Kind::injected;
}

bool SimulatedBoard::fault(std::size_t channel) noexcept {
  const Amplifier* a = amplifier(channel);
  return a != nullptr && a->fault;
}
void SimulatedBoard::set_enable(std::size_t channel, bool on) noexcept {
  if (Amplifier* a = amplifier(channel)) a->set_enable(on);
}
std::int32_t SimulatedBoard::counts(std::size_t channel) noexcept {
  const Amplifier* a = amplifier(channel);
  return a != nullptr ? a->counts() : 0;
}
void SimulatedBoard::arm_index(std::size_t channel, bool armed) noexcept {
  if (Amplifier* a = amplifier(channel)) a->arm_index(armed);
}
bool SimulatedBoard::take_index(std::size_t channel, std::int32_t& counts) noexcept {
  Amplifier* a = amplifier(channel);
  return a != nullptr && a->take_index(counts);
}
void SimulatedBoard::set_step(std::size_t channel, bool step, bool forward) noexcept {
  if (Amplifier* a = amplifier(channel)) a->set_step(step, forward, t_ns_);
}
void SimulatedBoard::set_value(std::size_t channel, std::int16_t value) noexcept {
  if (Amplifier* a = amplifier(channel)) a->set_value(static_cast<double>(value) / board::kFullScale);
}

std::size_t MockBoardPort::read(std::span<std::uint8_t> buffer) noexcept {
  if (count_ == 0) return 0;
  const Kept& kept = answers_[first_];
  first_ = (first_ + 1) % kKept;
  --count_;
  std::copy_n(kept.bytes.begin(), kept.size, buffer.begin());
  return kept.size;
}

bool MockBoardPort::write(std::span<const std::uint8_t> message) noexcept {
  const std::span<const std::uint8_t> answer = board_.exchange(message);
  if (answer.empty() || count_ == kKept) return false;
  Kept& kept = answers_[(first_ + count_++) % kKept];
  kept.size = answer.size();
  std::copy(answer.begin(), answer.end(), kept.bytes.begin());
  return true;
}

}  // namespace servogate::mock
