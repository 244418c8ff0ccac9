// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/io/io_profile.hpp"

#include <algorithm>
#include <limits>

#include "firmware_if/canopen/401/objects.hpp"

namespace servogate::canopen {
namespace {
std::uint8_t byte(std::int64_t value) noexcept { return static_cast<std::uint8_t>(value); }
}  // namespace

IoProfile::IoProfile(ObjectDictionary& dictionary, const IoTerminals& terminals, image::Nanoseconds filter_ns)
    : dictionary_(dictionary), terminals_(terminals), filter_ns_(filter_ns) {}

void IoProfile::set_digital(std::uint8_t line, bool level) noexcept { lines_[line].level = level; }
void IoProfile::set_analogue(std::uint8_t channel, std::int16_t value) noexcept {
  analogue_in_[channel] = value;
}
bool IoProfile::digital(std::uint8_t line) const noexcept { return digital_out_[line / 8] >> line % 8 & 1; }

void IoProfile::tick(image::Nanoseconds now) noexcept {
  for (std::size_t group = 0; group < groups(terminals_.digital_inputs); ++group) {
    const std::uint8_t filtered = byte(at(io::kFilterConstantInput8, group));
    std::uint8_t bits = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      Line& line = lines_[8 * group + i];
      if (line.level == line.seen) line.since = now;
      if ((filtered >> i & 1) == 0 || now - line.since >= filter_ns_) line.seen = line.level;
      bits = byte(bits | (line.seen ? 1u << i : 0u));
    }
    dictionary_.set(io::kReadInput8, byte(group + 1), bits ^ byte(at(io::kPolarityInput8, group)));
  }
  for (std::size_t i = 0; i < terminals_.analogue_inputs; ++i)
    dictionary_.set(io::kReadAnalogueInput16, byte(i + 1), analogue_in_[i]);
}

bool IoProfile::is_event(ObjectDictionary::Slot slot, std::int64_t sent, std::int64_t now) noexcept {
  const ObjectSpec& spec = dictionary_.spec(slot);
  if (spec.index == io::kReadInput8) return digital_event(spec.subindex, byte(sent), byte(now));
  if (spec.index == io::kReadAnalogueInput16) return analogue_event(spec.subindex, sent, now);
  return sent != now;
}

bool IoProfile::digital_event(std::uint8_t group, std::uint8_t sent, std::uint8_t now) const noexcept {
  if (dictionary_.get(io::kInterruptEnableDigital) == 0) return false;
  const std::uint8_t rose = byte(now & ~sent), fell = byte(sent & ~now);
  return ((rose | fell) & dictionary_.get(io::kInterruptAnyChange8, group)) != 0 ||
         (rose & dictionary_.get(io::kInterruptLowToHigh8, group)) != 0 ||
         (fell & dictionary_.get(io::kInterruptHighToLow8, group)) != 0;
}

/// Limits and deltas are 32 bits wide, the value stands in their upper half. Source: CiA 401-1, "Analogue
/// input interrupt".
bool IoProfile::analogue_event(std::uint8_t channel, std::int64_t sent, std::int64_t now) const noexcept {
  if (dictionary_.get(io::kInterruptEnableAnalogue) == 0 || now == sent) return false;
  const auto part = [&](std::uint16_t index) { return dictionary_.get(index, channel) >> 16; };
  const auto selected = dictionary_.get(io::kInterruptTriggerSelection, channel);
  const auto chosen = [&](std::uint8_t bit, bool happens) { return (selected & bit) != 0 && happens; };
  return chosen(io::kAboveUpper,
                part(io::kInterruptUpperLimit) != 0 && now >= part(io::kInterruptUpperLimit)) ||
         chosen(io::kBelowLower,
                part(io::kInterruptLowerLimit) != 0 && now < part(io::kInterruptLowerLimit)) ||
         chosen(io::kByDelta, std::abs(now - sent) >= std::max<std::int64_t>(1, part(io::kInterruptDelta))) ||
         chosen(io::kByNegativeDelta,
                sent - now >= std::max<std::int64_t>(1, part(io::kInterruptNegativeDelta))) ||
         chosen(io::kByPositiveDelta,
                now - sent >= std::max<std::int64_t>(1, part(io::kInterruptPositiveDelta)));
}

void IoProfile::put_group(std::size_t group, std::uint8_t bits, std::uint8_t mask) noexcept {
  digital_out_[group] = byte((digital_out_[group] & ~mask) | (bits & mask));
}

void IoProfile::after_write(ObjectDictionary::Slot slot) noexcept {
  const ObjectSpec& spec = dictionary_.spec(slot);
  const auto i = static_cast<std::size_t>(spec.subindex - 1);
  if (spec.subindex == 0) return;
  if (spec.index == io::kWriteOutput8 || spec.index == io::kPolarityOutput8)
    put_group(i, byte(at(io::kWriteOutput8, i) ^ at(io::kPolarityOutput8, i)),
              byte(at(io::kFilterMaskOutput8, i)));
  if (spec.index == io::kWriteAnalogueOutput16)
    analogue_out_[i] = static_cast<std::int16_t>(dictionary_.value(slot));
}

/// Until they are written again the outputs have their error values. Source: CiA 401-1, objects 6206h, 6207h,
/// 6443h, 6444h.
void IoProfile::on_abort_connection(std::uint16_t) noexcept {
  for (std::size_t i = 0; i < groups(terminals_.digital_outputs); ++i)
    put_group(i, byte(at(io::kErrorValueOutput8, i) ^ at(io::kPolarityOutput8, i)),
              byte(at(io::kErrorModeOutput8, i)));
  for (std::size_t i = 0; i < terminals_.analogue_outputs; ++i)
    if (at(io::kErrorModeAnalogueOutput, i) != 0)
      analogue_out_[i] = static_cast<std::int16_t>(at(io::kErrorValueAnalogueOutput, i) >> 16);
}

void IoProfile::on_reset() noexcept {
  for (std::size_t i = 0; i < groups(terminals_.digital_outputs); ++i)
    put_group(i, byte(at(io::kWriteOutput8, i) ^ at(io::kPolarityOutput8, i)), 0xFF);
  for (std::size_t i = 0; i < terminals_.analogue_outputs; ++i)
    analogue_out_[i] = static_cast<std::int16_t>(at(io::kWriteAnalogueOutput16, i));
}

}  // namespace servogate::canopen
