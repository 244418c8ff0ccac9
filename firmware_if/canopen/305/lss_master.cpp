// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/305/lss_master.hpp"

#include <algorithm>

namespace servogate::canopen {
namespace {

constexpr std::uint8_t kScanReset = 0x80;
constexpr std::uint8_t kManufacturer = 255;

constexpr text::Entry kNodeRange{"lss-node-range", "the device does not take this node-ID",
                                 "устройство не принимает такой номер узла"};
constexpr text::Entry kBitRate{"lss-bit-rate", "the device does not have this bit rate",
                               "устройство не поддерживает эту скорость"};
constexpr text::Entry kNoStore{"lss-no-store", "the device cannot store its settings",
                               "устройство не умеет сохранять настройки"};
constexpr text::Entry kMemory{"lss-memory", "the device's memory failed", "сбой памяти устройства"};
constexpr text::Entry kSpecific{"lss-specific", "an error of the manufacturer, {0}",
                                "ошибка изготовителя, {0}"};
constexpr text::Entry kUnknown{"lss-unknown", "error {0}, not in CiA 305", "ошибка {0}, в CiA 305 её нет"};

}  // namespace

const text::Entry& lss_error_text(LssCommand command, std::uint8_t error) noexcept {
  if (error == kManufacturer) return kSpecific;
  if (error == 1 && command == LssCommand::configure_node) return kNodeRange;
  if (error == 1 && command == LssCommand::configure_bit_timing) return kBitRate;
  if (error == 1 && command == LssCommand::store) return kNoStore;
  return error == 2 && command == LssCommand::store ? kMemory : kUnknown;
}

bool LssMaster::start(LssCommand command, Answer answer, LssCommand expected) noexcept {
  if (busy()) return false;
  result_ = {};
  result_.status = LssStatus::busy;
  result_.command = command;
  patience_ = timeout_;
  answer_ = answer;
  expected_ = expected;
  count_ = sent_ = 0;
  scanning_ = heard_ = false;
  return true;
}

bool LssMaster::switch_global(LssMode mode) noexcept {
  if (!start(LssCommand::switch_global, Answer::none, LssCommand::switched)) return false;
  add(lss_bytes(LssCommand::switch_global, static_cast<std::uint32_t>(mode)));
  return true;
}

bool LssMaster::switch_selective(const LssIdentity& identity) noexcept {
  if (!start(LssCommand::switch_vendor, Answer::presence, LssCommand::switched)) return false;
  for (int i = 0; i < 4; ++i)
    add(lss_bytes(lss_nth(LssCommand::switch_vendor, i), identity.part[static_cast<std::size_t>(i)]));
  return true;
}

bool LssMaster::inquire(int part) noexcept {
  const LssCommand command = lss_nth(LssCommand::inquire_vendor, part);
  if (part < 0 || part > 3 || !start(command, Answer::value, command)) return false;
  add(lss_bytes(command));
  return true;
}

bool LssMaster::inquire_node() noexcept {
  if (!start(LssCommand::inquire_node, Answer::byte, LssCommand::inquire_node)) return false;
  add(lss_bytes(LssCommand::inquire_node));
  return true;
}

bool LssMaster::configure_node(NodeId node) noexcept {
  if (!start(LssCommand::configure_node, Answer::error_code, LssCommand::configure_node)) return false;
  add(lss_bytes(LssCommand::configure_node, node));
  return true;
}

bool LssMaster::configure_bit_rate(std::uint32_t bit_s) noexcept {
  const int index = lss_bit_rate_index(bit_s);
  if (index < 0 ||
      !start(LssCommand::configure_bit_timing, Answer::error_code, LssCommand::configure_bit_timing))
    return false;
  add(lss_bytes(LssCommand::configure_bit_timing, static_cast<std::uint32_t>(index) << 8));
  return true;
}

bool LssMaster::activate_bit_rate(std::uint16_t delay_ms) noexcept {
  if (!start(LssCommand::activate_bit_timing, Answer::none, LssCommand::switched)) return false;
  add(lss_bytes(LssCommand::activate_bit_timing, delay_ms));
  return true;
}

bool LssMaster::store() noexcept {
  if (!start(LssCommand::store, Answer::error_code, LssCommand::store)) return false;
  add(lss_bytes(LssCommand::store));
  return true;
}

bool LssMaster::identify(const LssIdentity& lowest, std::uint32_t highest_revision,
                         std::uint32_t highest_serial) noexcept {
  if (!start(LssCommand::identify_vendor, Answer::presence, LssCommand::identified)) return false;
  const std::uint32_t fields[] = {lowest.part[0],   lowest.part[1], lowest.part[2],
                                  highest_revision, lowest.part[3], highest_serial};
  for (int i = 0; i < 6; ++i) add(lss_bytes(lss_nth(LssCommand::identify_vendor, i), fields[i]));
  return true;
}

bool LssMaster::identify_unconfigured() noexcept {
  if (!start(LssCommand::identify_unconfigured, Answer::presence, LssCommand::unconfigured)) return false;
  add(lss_bytes(LssCommand::identify_unconfigured));
  return true;
}

bool LssMaster::fastscan() noexcept {
  if (!start(LssCommand::fastscan, Answer::presence, LssCommand::identified)) return false;
  later_scans_ = 0;
  begin_scan();
  return true;
}

void LssMaster::begin_scan() noexcept {
  scanning_ = true;
  scan_ = Scan::reset;
  part_ = 0;
  bit_ = 31;
  result_.identity = {};
  ask_scan(kScanReset, 0);
}

// The device that was asked last may have taken the question for the last one: it would be in configuration
// and take no part any more.
void LssMaster::scan_again() noexcept {
  if (later_scans_ == kLaterScans) return finish(LssStatus::no_answer);
  ++later_scans_;
  patience_ *= kLaterFactor;
  begin_scan();
  frames_[1] = frames_[0];
  frames_[0] = lss_bytes(LssCommand::switch_global, static_cast<std::uint32_t>(LssMode::waiting));
  count_ = 2;
}

void LssMaster::ask_scan(std::uint8_t bit, std::uint8_t next) noexcept {
  LssBytes bytes = lss_bytes(LssCommand::fastscan, bit == kScanReset ? 0 : result_.identity.part[part_]);
  bytes[5] = bit;
  bytes[6] = part_;
  bytes[7] = next;
  count_ = sent_ = 0;
  heard_ = false;
  add(bytes);
}

// Bit by bit from the highest, assuming 0: whoever has it answers. The whole part is then asked for once
// more, which moves the device on to the next one, and with the last into configuration state. An answer of
// the last bit that comes late would pass for one to that question.
void LssMaster::scanned(image::Nanoseconds now) noexcept {
  switch (scan_) {
    case Scan::reset:
      if (!heard_) return scan_again();
      scan_ = Scan::bit;
      return ask_scan(bit_, part_);
    case Scan::bit:
      if (!heard_) result_.identity.part[part_] |= 1u << bit_;
      if (bit_ > 0) return ask_scan(--bit_, part_);
      scan_ = Scan::quiet;
      heard_ = false;
      deadline_ = now + patience_;
      return;
    case Scan::quiet:
      if (heard_) return scan_again();
      scan_ = Scan::whole;
      return ask_scan(0, part_ == 3 ? std::uint8_t{0} : static_cast<std::uint8_t>(part_ + 1));
    case Scan::whole:
      if (!heard_) return scan_again();
      if (part_ == 3) return finish(LssStatus::done);
      ++part_;
      bit_ = 31;
      scan_ = Scan::bit;
      return ask_scan(bit_, part_);
  }
}

bool LssMaster::poll(image::Nanoseconds now, image::CanBus& bus) noexcept {
  if (!busy()) return false;
  if (sent_ < count_) {
    if (!bus.send(make_frame(cob::kLssMaster, frames_[static_cast<std::size_t>(sent_)]))) return false;
    ++sent_;
    deadline_ = now + patience_;
    return true;
  }
  // Several devices may answer a scan; the next question waits for all of them.
  if (now < deadline_) return false;
  if (scanning_)
    scanned(now);
  else
    finish(answer_ == Answer::none ? LssStatus::done : LssStatus::no_answer);
  return false;
}

bool LssMaster::on_frame(const image::CanFrame& frame) noexcept {
  if (frame.extended || frame.remote || frame.id != cob::kLssSlave || frame.length != 8) return false;
  if (!busy() || sent_ < count_ || frame.data[0] != static_cast<std::uint8_t>(expected_)) return false;
  LssBytes bytes{};
  std::copy_n(frame.data.begin(), bytes.size(), bytes.begin());
  heard_ = true;
  if (scanning_) return true;
  switch (answer_) {
    case Answer::none:
      return false;
    case Answer::error_code:
      result_.error = bytes[1];
      result_.specific = bytes[2];
      finish(bytes[1] == 0 ? LssStatus::done : LssStatus::refused);
      return true;
    case Answer::value:
      result_.value = lss_value(bytes);
      break;
    case Answer::byte:
      result_.value = bytes[1];
      break;
    case Answer::presence:
      break;
  }
  finish(LssStatus::done);
  return true;
}

}  // namespace servogate::canopen
