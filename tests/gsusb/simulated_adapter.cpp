// SPDX-License-Identifier: Apache-2.0
#include "tests/gsusb/simulated_adapter.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::gsusb {
namespace {

constexpr std::uint32_t kExtended = 0x80000000, kRemote = 0x40000000, kError = 0x20000000;
constexpr std::uint32_t kControllerClass = 0x04, kProtocolClass = 0x08, kBusOffClass = 0x40,
                        kCounters = 0x200;
constexpr std::uint32_t kListenOnly = 1, kStamps = 1 << 4, kIdentify = 1 << 5, kState = 1 << 13;
constexpr std::uint32_t kFromBus = 0xFFFFFFFF;

void append(SimulatedAdapter::Bytes& out, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::uint8_t>(word >> 8 * i));
}
std::uint32_t word_at(std::span<const std::uint8_t> in, std::size_t at) {
  return in[at] | in[at + 1] << 8 | in[at + 2] << 16 | static_cast<std::uint32_t>(in[at + 3]) << 24;
}

}  // namespace

double SimulatedAdapter::bit_rate() const {
  return config_.clock_hz / (static_cast<double>(timing_[4]) * (1 + timing_[0] + timing_[1] + timing_[2]));
}
double SimulatedAdapter::sample_point() const {
  return static_cast<double>(1 + timing_[0] + timing_[1]) / (1 + timing_[0] + timing_[1] + timing_[2]);
}
bool SimulatedAdapter::wrong_rate() const {
  return config_.bus_rate != 0 && std::abs(bit_rate() / config_.bus_rate - 1.0) > 0.01;
}

bool SimulatedAdapter::take_request(std::uint8_t request, std::uint16_t value,
                                    std::span<const std::uint8_t> data) {
  switch (request) {
    case 0:  // host format: little-endian is all this firmware speaks
      return data.size() == 4;
    case 1: {  // bit timing, for a controller at rest
      if (value >= config_.channels || data.size() != 20 || started_) return false;
      for (std::size_t i = 0; i < 5; ++i) timing_[i] = word_at(data, 4 * i);
      const std::uint32_t segment_1 = timing_[0] + timing_[1];
      return segment_1 >= 1 && segment_1 <= 16 && timing_[2] >= 1 && timing_[2] <= 8 && timing_[3] >= 1 &&
             timing_[3] <= 4 && timing_[4] >= 1 && timing_[4] <= 1024;
    }
    case 2:  // mode: 0 reset, 1 start
      if (value >= config_.channels || data.size() != 8 || word_at(data, 0) > 1) return false;
      started_ = word_at(data, 0) == 1;
      flags_ = started_ ? word_at(data, 4) : 0;
      state_ = started_ ? State::active : State::stopped;
      transmit_errors_ = receive_errors_ = 0;
      from_host_.clear();
      if (!started_) to_host_.clear();
      return true;
    case 7:  // identify: blinks
      return value < config_.channels && data.size() == 4;
    default:
      return false;
  }
}

std::optional<SimulatedAdapter::Bytes> SimulatedAdapter::answer_request(std::uint8_t request,
                                                                        std::uint16_t value,
                                                                        std::uint32_t now_us) {
  Bytes out;
  if (request != 5 && value >= config_.channels) return std::nullopt;
  switch (request) {
    case 4: {  // what can be set: features, clock, segments, jump width, prescaler
      append(out, kListenOnly | kIdentify | (config_.timestamps ? kStamps : 0) |
                      (config_.tells_state ? kState : 0));
      for (const std::uint32_t w : {config_.clock_hz, 1u, 16u, 1u, 8u, 4u, 1u, 1024u, 1u}) append(out, w);
      return out;
    }
    case 5:  // who it is; channels less one
      out = {0, 0, 0, static_cast<std::uint8_t>(config_.channels - 1)};
      append(out, 2);
      append(out, 1);
      return out;
    case 6:
      append(out, now_us);
      return out;
    case 14:
      if (!config_.tells_state) return std::nullopt;
      for (const std::uint32_t w : {static_cast<std::uint32_t>(state_), receive_errors_, transmit_errors_})
        append(out, w);
      return out;
    default:
      return std::nullopt;
  }
}

void SimulatedAdapter::take_bulk(std::span<const std::uint8_t> bytes) {
  if (!started_ || bytes.size() < 20 || bytes[9] >= config_.channels) return;
  from_host_.emplace_back(bytes.begin(), bytes.begin() + 20);
}

void SimulatedAdapter::step(std::uint32_t now_us) {
  image::CanFrame f;
  while (bus_.receive(f)) {
    if (!started_ || state_ == State::bus_off || f.error || f.fd) continue;
    if (wrong_rate()) {
      count(receive_errors_, 1, now_us);
      continue;
    }
    queue(kFromBus, f.id | (f.extended ? kExtended : 0) | (f.remote ? kRemote : 0), f.length, f.data.data(),
          now_us);
  }
  while (started_ && state_ != State::bus_off && !listens_only() && !from_host_.empty()) {
    if (wrong_rate()) {
      count(transmit_errors_, 8, now_us);  // and the controller tries again
      continue;
    }
    const Bytes& bytes = from_host_.front();
    const std::uint32_t id = word_at(bytes, 4);
    f = {};
    f.extended = (id & kExtended) != 0;
    f.remote = (id & kRemote) != 0;
    f.id = id & (f.extended ? 0x1FFFFFFF : 0x7FF);
    f.length = std::min<std::uint8_t>(bytes[8], 8);
    std::copy_n(bytes.begin() + 12, 8, f.data.begin());
    if (!bus_.send(f)) return;
    queue(word_at(bytes, 0), id, f.length, nullptr, now_us);
    from_host_.pop_front();
  }
}

/// An error counter grows; the computer hears of the error and of the state. Source: ISO 11898-1, 12.1.4.2.
void SimulatedAdapter::count(std::uint32_t& errors, std::uint32_t by, std::uint32_t now_us) {
  if (!listens_only()) errors += by;
  receive_errors_ = std::min(receive_errors_, 255u);
  const std::uint32_t most = std::max(transmit_errors_, receive_errors_);
  state_ = transmit_errors_ > 255 ? State::bus_off
           : most > 127           ? State::passive
           : most > 95            ? State::warning
                                  : State::active;
  error_frame(now_us);
}

void SimulatedAdapter::error_frame(std::uint32_t now_us) {
  std::uint8_t data[8] = {};
  std::uint32_t id = kError | kProtocolClass | kControllerClass | kCounters;
  data[2] = 0x04;  // bit stuffing
  const bool transmit = transmit_errors_ >= receive_errors_;
  if (state_ == State::warning) data[1] = transmit ? 0x08 : 0x04;
  if (state_ == State::passive) data[1] = transmit ? 0x20 : 0x10;
  if (state_ == State::active) data[1] = 0x40;
  if (state_ == State::bus_off) {
    id = kError | kBusOffClass;
    from_host_.clear();
  }
  data[6] = static_cast<std::uint8_t>(std::min(transmit_errors_, 255u));
  data[7] = static_cast<std::uint8_t>(receive_errors_);
  queue(kFromBus, id, 8, data, now_us);
}

void SimulatedAdapter::go_bus_off(std::uint32_t now_us) {
  transmit_errors_ = 256;
  count(transmit_errors_, 0, now_us);
}

void SimulatedAdapter::queue(std::uint32_t echo, std::uint32_t id, std::uint8_t length,
                             const std::uint8_t* data, std::uint32_t now_us) {
  if (to_host_.size() >= config_.frames_to_host) {
    lost_ = true;
    return;
  }
  Bytes out;
  append(out, echo);
  append(out, id);
  out.insert(out.end(), {length, 0, static_cast<std::uint8_t>(lost_ ? 1 : 0), 0});
  for (std::size_t i = 0; i < 8; ++i) out.push_back(data != nullptr && i < length ? data[i] : 0);
  if ((flags_ & kStamps) != 0) append(out, now_us);
  to_host_.push_back(std::move(out));
  lost_ = false;
}

std::optional<SimulatedAdapter::Bytes> SimulatedAdapter::give_bulk() {
  if (to_host_.empty()) return std::nullopt;
  Bytes out = std::move(to_host_.front());
  to_host_.pop_front();
  return out;
}

}  // namespace servogate::gsusb
