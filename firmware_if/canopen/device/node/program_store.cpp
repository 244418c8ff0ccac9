// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/program_store.hpp"

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint8_t kProgram = 1;  ///< sub-index of the one program
constexpr std::int64_t kStop = 0, kStart = 1, kReset = 2, kClear = 3;
constexpr std::int64_t kBusy = 1;

constexpr std::int64_t status_of(std::uint8_t error) noexcept { return error << 1; }

}  // namespace

std::uint32_t program_identification(std::span<const std::uint8_t> image) noexcept {
  std::uint32_t crc = 0xFFFF'FFFF;
  for (const std::uint8_t byte : image) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0xEDB8'8320 : crc >> 1;
  }
  return ~crc;
}

std::vector<ObjectSpec> program_objects(std::uint32_t identification) {
  using enum DataType;
  using enum Access;
  std::vector<ObjectSpec> rows;
  for (const std::uint16_t index :
       {object::kProgramData, object::kProgramControl, object::kProgramIdentification, object::kFlashStatus})
    rows.push_back({index, 0, unsigned8, constant, Mappable::no, 1});
  rows.push_back({object::kProgramData, kProgram, domain, wo});
  rows.push_back({object::kProgramControl, kProgram, unsigned8, rw, Mappable::no, kStart, 0, kClear});
  rows.push_back({object::kProgramIdentification, kProgram, unsigned32, ro, Mappable::no, identification});
  rows.push_back({object::kFlashStatus, kProgram, unsigned32, ro});
  return rows;
}

ProgramStore::ProgramStore(ObjectDictionary& dictionary, std::size_t capacity, const Times& times)
    : dictionary_(dictionary),
      control_(dictionary.variable(object::kProgramControl, kProgram)),
      identification_(dictionary.variable(object::kProgramIdentification, kProgram)),
      status_(dictionary.variable(object::kFlashStatus, kProgram)),
      times_(times),
      memory_(capacity) {}

AbortCode ProgramStore::check_control(std::int64_t value) const noexcept {
  if (busy_) return AbortCode::device_state;
  if (value == kClear && running_) return AbortCode::device_state;
  if ((value == kStart || value == kReset) && flash_ != Flash::valid) return AbortCode::device_state;
  return AbortCode::none;
}

bool ProgramStore::control(std::int64_t value, image::Nanoseconds now) noexcept {
  control_ = value == kReset ? kStart : value;
  switch (value) {
    case kStart:
    case kReset: {
      const bool begins = value == kReset || !running_;
      running_ = true;
      return begins;
    }
    case kStop:
      running_ = false;
      return false;
    default:
      control_ = kStop;
      flash_ = Flash::cleared;
      identification_ = 0;
      next_identification_ = 0;
      error_after_ = 0;
      work_until(now + times_.clear);
      return false;
  }
}

AbortCode ProgramStore::check_download() const noexcept {
  return running_ || busy_ || flash_ != Flash::cleared ? AbortCode::device_state : AbortCode::none;
}

std::span<std::uint8_t> ProgramStore::room() noexcept { return memory_; }

void ProgramStore::written(std::size_t size, image::Nanoseconds now) noexcept {
  next_identification_ = program_identification(std::span(memory_).first(size));
  error_after_ = spoil_;
  flash_ = spoil_ == 0 ? Flash::valid : Flash::invalid;
  spoil_ = 0;
  work_until(now + static_cast<image::Nanoseconds>(size / 1024 + 1) * times_.write_per_kbyte);
}

void ProgramStore::work_until(image::Nanoseconds t) noexcept {
  busy_ = true;
  status_ = kBusy;
  ready_at_ = t;
}

void ProgramStore::tick(image::Nanoseconds now) noexcept {
  if (!busy_ || now < ready_at_) return;
  busy_ = false;
  status_ = status_of(error_after_);
  // A reset of communication must not bring the old one back.
  dictionary_.set_default(object::kProgramIdentification, kProgram,
                          flash_ == Flash::valid ? next_identification_ : 0);
}

}  // namespace servogate::canopen
