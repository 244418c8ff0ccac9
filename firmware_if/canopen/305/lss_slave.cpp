// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/305/lss_slave.hpp"

#include <algorithm>

namespace servogate::canopen {
namespace {

constexpr std::uint8_t kOk = 0, kRefused = 1, kMemory = 2;
constexpr std::uint8_t kScanReset = 0x80;

constexpr bool between(LssCommand command, LssCommand first, LssCommand last) noexcept {
  return command >= first && command <= last;
}
constexpr int distance(LssCommand command, LssCommand first) noexcept {
  return static_cast<int>(command) - static_cast<int>(first);
}

}  // namespace

bool LssSlave::on_frame(const image::CanFrame& frame, image::Nanoseconds now, LssBytes& answer) noexcept {
  if (frame.extended || frame.remote || frame.id != cob::kLssMaster || frame.length != 8) return false;
  LssBytes request{};
  std::copy_n(frame.data.begin(), request.size(), request.begin());
  const auto command = static_cast<LssCommand>(request[0]);
  if (command == LssCommand::switch_global) {
    if (request[1] == 1) mode_ = LssMode::configuration;
    if (request[1] == 0) leave_configuration();
    return false;
  }
  if (between(command, LssCommand::switch_vendor, LssCommand::switch_serial))
    return select(distance(command, LssCommand::switch_vendor), lss_value(request), answer);
  if (between(command, LssCommand::identify_vendor, LssCommand::identify_serial_high))
    return identify(distance(command, LssCommand::identify_vendor), lss_value(request), answer);
  if (command == LssCommand::identify_unconfigured) {
    answer = lss_bytes(LssCommand::unconfigured);
    return active_ == kUnconfiguredNode && pending_ == kUnconfiguredNode;
  }
  if (command == LssCommand::fastscan) return fastscan(request, answer);
  return mode_ == LssMode::configuration && configure(request, now, answer);
}

bool LssSlave::select(int part, std::uint32_t value, LssBytes& answer) noexcept {
  if (part == 0) selected_ = 0;
  if (part != selected_ || value != identity_.part[static_cast<std::size_t>(part)]) {
    selected_ = 0;
    return false;
  }
  if (++selected_ < 4) return false;
  selected_ = 0;
  mode_ = LssMode::configuration;
  answer = lss_bytes(LssCommand::switched);
  return true;
}

// Vendor and product are equal, revision and serial number within a range, in this order.
bool LssSlave::identify(int field, std::uint32_t value, LssBytes& answer) noexcept {
  if (field == 0) identified_ = 0;
  constexpr std::uint8_t kPart[] = {0, 1, 2, 2, 3, 3};
  const std::uint32_t own = identity_.part[kPart[field]];
  const bool lowest = field == 2 || field == 4, highest = field == 3 || field == 5;
  const bool fits = lowest ? own >= value : highest ? own <= value : own == value;
  if (field != identified_ || !fits) {
    identified_ = 0;
    return false;
  }
  if (++identified_ < 6) return false;
  identified_ = 0;
  answer = lss_bytes(LssCommand::identified);
  return true;
}

bool LssSlave::fastscan(const LssBytes& request, LssBytes& answer) noexcept {
  if (mode_ != LssMode::waiting || active_ != kUnconfiguredNode || pending_ != kUnconfiguredNode)
    return false;
  const std::uint8_t bit = request[5], part = request[6], next = request[7];
  answer = lss_bytes(LssCommand::identified);
  if (bit == kScanReset) {
    scan_position_ = 0;
    return true;
  }
  if (bit > 31 || part > 3 || next > 3 || part != scan_position_) return false;
  if ((identity_.part[part] ^ lss_value(request)) >> bit) return false;
  scan_position_ = next;
  if (bit == 0 && next < part) mode_ = LssMode::configuration;
  return true;
}

bool LssSlave::configure(const LssBytes& request, image::Nanoseconds now, LssBytes& answer) noexcept {
  const auto command = static_cast<LssCommand>(request[0]);
  answer = lss_bytes(command);
  if (between(command, LssCommand::inquire_vendor, LssCommand::inquire_serial)) {
    const auto part = static_cast<std::size_t>(distance(command, LssCommand::inquire_vendor));
    answer = lss_bytes(command, identity_.part[part]);
    return true;
  }
  switch (command) {
    case LssCommand::inquire_node:
      answer[1] = active_;
      return true;
    case LssCommand::configure_node: {
      const bool good = (request[1] >= 1 && request[1] <= kMaxNode) || request[1] == kUnconfiguredNode;
      if (good) pending_ = request[1];
      answer[1] = good ? kOk : kRefused;
      return true;
    }
    case LssCommand::configure_bit_timing: {
      const std::uint32_t bit_s =
          request[1] == 0 && request[2] < kLssBitRates.size() ? kLssBitRates[request[2]] : 0;
      const bool good = bit_s != 0 && device_.supports(bit_s);
      if (good) pending_bit_s_ = bit_s;
      answer[1] = good ? kOk : kRefused;
      return true;
    }
    case LssCommand::activate_bit_timing: {
      if (pending_bit_s_ == 0) return false;
      const auto delay = static_cast<image::Nanoseconds>(load_le(std::span(request).subspan(1, 2)));
      switch_at_ = now + delay * image::kMillisecond;
      speak_at_ = switch_at_ + delay * image::kMillisecond;
      change_ = Change::silent;
      device_.bit_rate_changed(0);
      return false;
    }
    case LssCommand::store:
      answer[1] = device_.store(pending_, pending_bit_s_) ? kOk : kMemory;
      return true;
    default:
      return false;
  }
}

void LssSlave::leave_configuration() noexcept {
  const bool was_configured = mode_ == LssMode::configuration;
  mode_ = LssMode::waiting;
  if (!was_configured || active_ != kUnconfiguredNode || pending_ == kUnconfiguredNode) return;
  device_.node_assigned();
}

// Both phases last the switch delay: first every device falls silent, then all have changed.
void LssSlave::tick(image::Nanoseconds now) noexcept {
  if (change_ == Change::silent && now >= switch_at_) change_ = Change::listening;
  if (change_ != Change::listening || now < speak_at_) return;
  change_ = Change::none;
  device_.bit_rate_changed(pending_bit_s_);
}

}  // namespace servogate::canopen
