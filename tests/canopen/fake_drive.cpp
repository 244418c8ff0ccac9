// SPDX-License-Identifier: Apache-2.0
#include "tests/canopen/fake_drive.hpp"

#include <algorithm>

namespace servogate::canopen::testing {
namespace {

constexpr std::uint32_t kInvalid = 0x80000000u;
constexpr std::uint32_t kNoObject = 0x06020000u, kNoSubindex = 0x06090011u, kDeviceState = 0x08000022u;

std::uint32_t number(const image::CanFrame& f, std::size_t first, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value |= static_cast<std::uint32_t>(f.data[first + i]) << 8 * i;
  return value;
}

std::string hex(std::uint32_t value) {
  char text[12];
  std::snprintf(text, sizeof text, "%X", value);
  return text;
}

}  // namespace

FakeDrive::FakeDrive(std::uint8_t id) : node(id) {
  set(0x1000, 0, 4, 0x00020192);
  set(0x1005, 0, 4, 0x80);
  set(0x1016, 1, 4, 0);
  set(0x1017, 0, 2, 0);
  set(0x1018, 1, 4, 0x11);
  set(0x1018, 2, 4, 0x22);
  set(0x1018, 3, 4, 0x00010002);
  set(0x1018, 4, 4, 1000u + id);
  for (std::uint16_t n = 0; n < 4; ++n) {
    set(0x1400 + n, 1, 4, kInvalid | (0x200u + 0x100u * n + id));
    set(0x1800 + n, 1, 4, kInvalid | 0x40000000u | (0x180u + 0x100u * n + id));
    set(0x1400 + n, 2, 1, 255);
    set(0x1800 + n, 2, 1, 255);
    set(0x1800 + n, 3, 2, 0);
    set(0x1800 + n, 5, 2, 0);
    for (std::uint8_t sub = 0; sub <= 8; ++sub) {
      set(0x1600 + n, sub, sub ? 4 : 1, 0);
      set(0x1A00 + n, sub, sub ? 4 : 1, 0);
    }
  }
  set(0x6007, 0, 2, 0);
  set(0x603F, 0, 2, 0);
  set(0x6040, 0, 2, 0);
  set(0x6041, 0, 2, 0);
  set(0x6060, 0, 1, 0);
  set(0x6061, 0, 1, 0);
  set(0x6064, 0, 4, 0);
  set(0x606C, 0, 4, 0);
  set(0x6077, 0, 2, 0);
  set(0x607A, 0, 4, 0);
  set(0x60B8, 0, 2, 0);
  set(0x60B9, 0, 2, 0);
  set(0x60BA, 0, 4, 0);
  set(0x60C2, 1, 1, 1);
  set(0x60C2, 2, 1, 0xFD);
  set(0x60FD, 0, 4, 0);
  set(0x60FF, 0, 4, 0);
  set(0x6502, 0, 4, 0x3A5);
}

std::uint32_t FakeDrive::get(std::uint16_t index, std::uint8_t subindex) const {
  const auto it = objects_.find(key(index, subindex));
  return it == objects_.end() ? 0 : it->second.value;
}

void FakeDrive::set(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, std::uint32_t value) {
  objects_[key(index, subindex)] = {bytes, value};
}

void FakeDrive::erase(std::uint16_t index, std::uint8_t subindex) { objects_.erase(key(index, subindex)); }

void FakeDrive::power_on(std::vector<image::CanFrame>& out) {
  powered = true;
  nmt_state = 0x7F;
  machine = {};
  set(0x1017, 0, 2, 0);
  pending_rpdo_.clear();
  out.push_back(frame(0x700u + node, {0}));
}

void FakeDrive::raise_fault(std::uint16_t code, std::vector<image::CanFrame>& out) {
  machine.state = image::DriveState::fault_reaction_active;
  set(0x603F, 0, 2, code);
  out.push_back(frame(0x80u + node, {code & 0xFF, code >> 8, 0x20, 1, 2, 3, 4, 5}));
}

void FakeDrive::on_frame(const image::CanFrame& f, std::vector<image::CanFrame>& out) {
  if (!powered) return;
  if (f.id == 0) return on_nmt(f, out);
  if (f.id == 0x80) return on_sync(out);
  if (f.id == 0x600u + node && !silent_sdo) return on_sdo(f, out);
  for (int pdo = 0; pdo < 4; ++pdo)
    if (f.id == get(static_cast<std::uint16_t>(0x1400 + pdo), 1)) on_rpdo(pdo, f);
}

void FakeDrive::on_nmt(const image::CanFrame& f, std::vector<image::CanFrame>& out) {
  if (f.data[1] != 0 && f.data[1] != node) return;
  switch (f.data[0]) {
    case 0x01:
      nmt_state = 5;
      break;
    case 0x02:
      nmt_state = 4;
      break;
    case 0x80:
      nmt_state = 0x7F;
      break;
    default:
      nmt_state = 0x7F;
      set(0x1017, 0, 2, 0);
      out.push_back(frame(0x700u + node, {0}));
  }
}

void FakeDrive::on_sdo(const image::CanFrame& f, std::vector<image::CanFrame>& out) {
  if (f.data[0] == 0x80) return;
  const auto index = static_cast<std::uint16_t>(number(f, 1, 2));
  const std::uint8_t sub = f.data[3];
  const auto reply = [&](int command, std::uint32_t value) {
    auto answer = frame(0x580u + node, {command, f.data[1], f.data[2], sub, 0, 0, 0, 0});
    for (std::size_t i = 0; i < 4; ++i) answer.data[4 + i] = static_cast<std::uint8_t>(value >> 8 * i);
    out.push_back(answer);
  };
  const auto object = objects_.find(key(index, sub));
  if (object == objects_.end())
    return reply(0x80, objects_.contains(key(index, 1)) ? kNoSubindex : kNoObject);
  if (f.data[0] == 0x40) return reply(0x43 | (4 - object->second.bytes) << 2, object->second.value);
  const std::size_t bytes = 4u - (f.data[0] >> 2 & 3);
  const std::uint32_t value = number(f, 4, bytes);
  writes.push_back(hex(index) + ":" + hex(sub) + "=" + hex(value));
  if (const auto abort = aborts.find(key(index, sub)); abort != aborts.end())
    return reply(0x80, abort->second);
  // CiA 301, 7.5.2.36: the map may change only while the PDO is off and its count is zero.
  const bool is_map = (index & 0xFFFC) == 0x1600 || (index & 0xFFFC) == 0x1A00;
  const auto parameter = static_cast<std::uint16_t>(index - 0x200);
  if (is_map && (!(get(parameter, 1) & kInvalid) || (sub != 0 && get(index, 0) != 0)))
    return reply(0x80, kDeviceState);
  object->second.value = stuck.contains(key(index, sub)) ? stuck[key(index, sub)] : value;
  if (index == 0x6060) set(0x6061, 0, 1, value);
  reply(0x60, 0);
}

void FakeDrive::on_rpdo(int pdo, const image::CanFrame& f) {
  if (nmt_state == 5) pending_rpdo_[pdo] = f;
}

void FakeDrive::apply_rpdos() {
  for (const auto& [pdo, f] : pending_rpdo_) {
    std::size_t at = 0;
    const auto map = static_cast<std::uint16_t>(0x1600 + pdo);
    for (std::uint8_t i = 1; i <= get(map, 0); ++i) {
      const std::uint32_t word = get(map, i);
      const std::size_t bytes = (word & 0xFF) / 8;
      set(static_cast<std::uint16_t>(word >> 16), static_cast<std::uint8_t>(word >> 8),
          static_cast<std::uint8_t>(bytes), number(f, at, bytes));
      at += bytes;
    }
  }
  pending_rpdo_.clear();
}

void FakeDrive::watch_zero_mark(std::int64_t from, std::int64_t to) {
  const std::uint32_t function = get(0x60B8, 0);
  if (!(function & 1)) captured_ = false;
  if (zero_mark_every != 0 && (function & 0x15) == 0x15 && !captured_) {
    const std::int64_t mark = to / zero_mark_every * zero_mark_every;
    if (mark > from && mark <= to) {
      captured_ = true;
      set(0x60BA, 0, 4, static_cast<std::uint32_t>(mark));
    }
  }
  set(0x60B9, 0, 2, (function & 1) | (captured_ ? 2u : 0u));
}

void FakeDrive::on_sync(std::vector<image::CanFrame>& out) {
  if (nmt_state != 5) return;
  ++sync_count_;
  const std::int64_t before = position;
  apply_rpdos();
  machine.step(static_cast<std::uint16_t>(get(0x6040, 0)));
  if (machine.state == image::DriveState::operation_enabled && get(0x6061, 0) == 8) {
    position += static_cast<std::int32_t>(get(0x607A, 0) - static_cast<std::uint32_t>(position));
    applied.push_back(position);
  }
  watch_zero_mark(before, position);
  set(0x6064, 0, 4, static_cast<std::uint32_t>(position));
  set(0x6041, 0, 2, 0x0210u | encode(machine.state));
  set(0x6061, 0, 1, get(0x6060, 0));
  for (int pdo = 0; pdo < 4 && !silent_tpdo; ++pdo) {
    const auto parameter = static_cast<std::uint16_t>(0x1800 + pdo),
               map = static_cast<std::uint16_t>(0x1A00 + pdo);
    const std::uint32_t type = get(parameter, 2);
    if ((get(parameter, 1) & kInvalid) || type == 0 || type > 240 ||
        sync_count_ % static_cast<int>(type) != 0)
      continue;
    image::CanFrame f;
    f.id = get(parameter, 1) & 0x7FF;
    for (std::uint8_t i = 1; i <= get(map, 0); ++i) {
      const std::uint32_t word = get(map, i);
      const std::uint32_t value =
          get(static_cast<std::uint16_t>(word >> 16), static_cast<std::uint8_t>(word >> 8));
      for (std::size_t b = 0; b < (word & 0xFF) / 8; ++b)
        f.data[f.length++] = static_cast<std::uint8_t>(value >> 8 * b);
    }
    if (pdo == 0) f.length = static_cast<std::uint8_t>(f.length - short_tpdo);
    out.push_back(f);
  }
}

std::uint32_t FakeDrive::encode(image::DriveState state) {
  using S = image::DriveState;
  switch (state) {
    case S::switch_on_disabled:
      return 0x40;
    case S::ready_to_switch_on:
      return 0x21;
    case S::switched_on:
      return 0x23;
    case S::operation_enabled:
      return 0x27;
    case S::quick_stop_active:
      return 0x07;
    case S::fault_reaction_active:
      return 0x0F;
    case S::fault:
      return 0x08;
    default:
      return 0;
  }
}

void FakeDrive::advance_to(image::Nanoseconds now, std::vector<image::CanFrame>& out) {
  const std::uint32_t period_ms = get(0x1017, 0);
  now_ = now;
  if (!powered || silent_heartbeat || period_ms == 0 || now < heartbeat_ns_) return;
  out.push_back(frame(0x700u + node, {nmt_state}));
  heartbeat_ns_ = now + period_ms * image::kMillisecond;
}

FakeDrive& FakeNetwork::add(std::uint8_t node) {
  drives.push_back(std::make_unique<FakeDrive>(node));
  return *drives.back();
}

bool FakeNetwork::send(const image::CanFrame& f) noexcept {
  if (refuse_sending) return false;
  sent.push_back(f);
  return true;
}

bool FakeNetwork::receive(image::CanFrame& f) noexcept {
  if (waiting.empty()) return false;
  f = waiting.front();
  waiting.pop_front();
  return true;
}

void FakeNetwork::inject(const image::CanFrame& f) {
  std::vector<image::CanFrame> answers;
  for (auto& drive : drives) drive->on_frame(f, answers);
  waiting.push_back(f);
  waiting.insert(waiting.end(), answers.begin(), answers.end());
}

void FakeNetwork::flush_out() {
  waiting.insert(waiting.end(), waiting_out.begin(), waiting_out.end());
  waiting_out.clear();
}

void FakeNetwork::transfer(image::Nanoseconds now) {
  const auto times = [this](const image::CanFrame& f) { return fate ? fate(f) : 1; };
  std::vector<image::CanFrame> answers;
  last_sent = sent;
  sent.clear();
  for (const auto& f : last_sent)
    for (int n = times(f); n > 0; --n)
      for (auto& drive : drives) drive->on_frame(f, answers);
  for (auto& drive : drives) drive->advance_to(now, answers);
  for (const auto& f : answers)
    for (int n = times(f); n > 0; --n) waiting.push_back(f);
}

}  // namespace servogate::canopen::testing
