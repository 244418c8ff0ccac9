// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/encoder/encoder_profile.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/406/objects.hpp"

namespace servogate::canopen {
namespace {

using enum DataType;
using enum Access;

constexpr std::uint8_t kWithSync = 1, kOnEvent = 254;
constexpr std::uint16_t kEventMs = 100;

void add_position_pdo(std::vector<ObjectSpec>& rows, NodeId node, int number, std::uint8_t type,
                      std::uint16_t event_ms) {
  const auto parameter = static_cast<std::uint16_t>(object::kTpdoParameter + number - 1);
  const auto mapping = static_cast<std::uint16_t>(object::kTpdoMapping + number - 1);
  rows.push_back({parameter, 1, unsigned32, rw, Mappable::no, cob::kNoRemote | cob::tpdo(number, node)});
  rows.push_back({parameter, 2, unsigned8, rw, Mappable::no, type});
  rows.push_back({parameter, 5, unsigned16, rw, Mappable::no, event_ms});
  rows.push_back({mapping, 0, unsigned8, rw, Mappable::no, 1});
  rows.push_back(
      {mapping, 1, unsigned32, rw, Mappable::no, MappingEntry{encoder::kPositionValue, 0, 32}.word()});
}

std::int64_t modulo(std::int64_t value, std::int64_t modulus) noexcept {
  const std::int64_t rest = value % modulus;
  return rest < 0 ? rest + modulus : rest;
}

}  // namespace

std::vector<ObjectSpec> encoder_objects(NodeId node, const EncoderResolution& r) {
  const std::int64_t all = std::int64_t{r.counts_per_rev} * r.revolutions;
  std::vector<ObjectSpec> rows = {
      {encoder::kOperatingParameters, 0, unsigned16, rw, Mappable::no, 0, 0,
       encoder::kClockwiseFalls | encoder::kScaling},
      {encoder::kUnitsPerRevolution, 0, unsigned32, rw, Mappable::no, r.counts_per_rev, 1, r.counts_per_rev},
      {encoder::kTotalRange, 0, unsigned32, rw, Mappable::no, all, 1, all},
      {encoder::kPresetValue, 0, unsigned32, rw, Mappable::no, 0},
      {encoder::kPositionValue, 0, unsigned32, ro, Mappable::tpdo, 0},
      {encoder::kSpeedValue, 0, unsigned8, constant, Mappable::no, 1},
      {encoder::kSpeedValue, 1, integer16, ro, Mappable::tpdo, 0},
      {encoder::kOperatingStatus, 0, unsigned16, ro, Mappable::tpdo, 0},
      {encoder::kSingleTurnResolution, 0, unsigned32, ro, Mappable::no, r.counts_per_rev},
      {encoder::kRevolutions, 0, unsigned16, ro, Mappable::no, r.revolutions},
      {encoder::kAlarms, 0, unsigned16, ro, Mappable::tpdo, 0},
      {encoder::kSupportedAlarms, 0, unsigned16, ro, Mappable::no, encoder::kPositionError},
      {encoder::kWarnings, 0, unsigned16, ro, Mappable::tpdo, 0},
      {encoder::kSupportedWarnings, 0, unsigned16, ro, Mappable::no, 0},
  };
  add_position_pdo(rows, node, 1, kOnEvent, kEventMs);
  add_position_pdo(rows, node, 2, kWithSync, 0);
  // What communication_objects() maps into RPDO 1 an encoder does not have.
  rows.push_back(
      {object::kRpdoParameter, 1, unsigned32, rw, Mappable::no, cob::kInvalid | cob::rpdo(1, node)});
  rows.push_back({object::kRpdoMapping, 0, unsigned8, rw, Mappable::no, 0});
  return rows;
}

EncoderProfile::EncoderProfile(ObjectDictionary& dictionary, const EncoderResolution& resolution)
    : dictionary_(dictionary), resolution_(resolution) {}

std::int64_t EncoderProfile::range() const noexcept {
  const bool scaling = (dictionary_.get(encoder::kOperatingParameters) & encoder::kScaling) != 0;
  const std::int64_t all = std::int64_t{resolution_.counts_per_rev} * resolution_.revolutions;
  return scaling ? std::max<std::int64_t>(1, dictionary_.get(encoder::kTotalRange)) : all;
}

/// Counts of the disc by code sequence and scaling, before preset and range.
std::int64_t EncoderProfile::scaled() const noexcept {
  const std::int64_t parameters = dictionary_.get(encoder::kOperatingParameters);
  const std::int64_t counts = (parameters & encoder::kClockwiseFalls) != 0 ? -shown_counts_ : shown_counts_;
  if ((parameters & encoder::kScaling) == 0) return counts;
  // Turns and the part of a turn apart, so that nothing overflows.
  const std::int64_t disc = resolution_.counts_per_rev, units = dictionary_.get(encoder::kUnitsPerRevolution);
  const std::int64_t rest = modulo(counts, disc);
  return (counts - rest) / disc * units + rest * units / disc;
}

void EncoderProfile::show() noexcept {
  dictionary_.set(encoder::kPositionValue, 0, modulo(scaled() + offset_, range()));
}

void EncoderProfile::tick(image::Nanoseconds now) noexcept {
  if (!unreadable_) shown_counts_ = counts_;
  dictionary_.set(encoder::kOperatingStatus, 0, dictionary_.get(encoder::kOperatingParameters));
  dictionary_.set(encoder::kAlarms, 0, unreadable_ ? encoder::kPositionError : 0);
  show();
  const std::int64_t here = scaled();
  if (last_ns_ >= 0 && now > last_ns_) {
    const double speed = static_cast<double>(here - last_) * 1e9 / static_cast<double>(now - last_ns_);
    dictionary_.set(encoder::kSpeedValue, 1, static_cast<std::int64_t>(std::clamp(speed, -32768.0, 32767.0)));
  }
  last_ = here;
  last_ns_ = now;
}

AbortCode EncoderProfile::before_write(ObjectDictionary::Slot slot, std::int64_t value) noexcept {
  if (dictionary_.spec(slot).index == encoder::kPresetValue && value >= range())
    return AbortCode::value_too_high;
  return AbortCode::none;
}

/// The present position has the preset's value from now on.
void EncoderProfile::after_write(ObjectDictionary::Slot slot) noexcept {
  if (dictionary_.spec(slot).index == encoder::kPresetValue) offset_ = dictionary_.value(slot) - scaled();
  show();
}

}  // namespace servogate::canopen
