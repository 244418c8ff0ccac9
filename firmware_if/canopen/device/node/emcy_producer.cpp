// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/emcy_producer.hpp"

#include <algorithm>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {

EmcyProducer::EmcyProducer(ObjectDictionary& dictionary)
    : dictionary_(dictionary),
      register_(dictionary.variable(object::kErrorRegister)),
      cob_id_(dictionary.variable(object::kCobIdEmcy)),
      inhibit_(dictionary.variable(object::kInhibitTimeEmcy)) {}

bool EmcyProducer::present(std::uint16_t error_code) const noexcept {
  return std::any_of(active_.begin(), active_.begin() + static_cast<std::ptrdiff_t>(active_count_),
                     [error_code](const Active& a) { return a.code == error_code; });
}

void EmcyProducer::raise(std::uint16_t error_code, std::uint8_t register_bits,
                         std::uint32_t detail) noexcept {
  if (present(error_code) || active_count_ == kActive) return;
  active_[active_count_++] = {error_code, register_bits};
  update_register();
  notify(error_code, detail);
}

void EmcyProducer::notify(std::uint16_t error_code, std::uint32_t detail) noexcept {
  remember(error_code, detail);
  queue(error_code, detail);
}

void EmcyProducer::clear(std::uint16_t error_code) noexcept {
  const auto end = active_.begin() + static_cast<std::ptrdiff_t>(active_count_);
  const auto kept =
      std::remove_if(active_.begin(), end, [=](const Active& a) { return a.code == error_code; });
  if (kept == end) return;
  active_count_ = static_cast<std::size_t>(kept - active_.begin());
  update_register();
  queue(0, error_code);
}

void EmcyProducer::clear_all() noexcept {
  if (active_count_ == 0) return;
  active_count_ = 0;
  update_register();
  queue(0, 0);
}

void EmcyProducer::reset() noexcept {
  active_count_ = 0;
  waiting_count_ = 0;
  not_before_ = now_;
  update_register();
}

void EmcyProducer::update_register() noexcept {
  std::uint8_t bits = 0;
  for (std::size_t i = 0; i < active_count_; ++i)
    bits = static_cast<std::uint8_t>(bits | active_[i].bits | error_register::kGeneric);
  register_ = bits;
}

void EmcyProducer::remember(std::uint16_t error_code, std::uint32_t detail) noexcept {
  const auto count = static_cast<std::uint8_t>(dictionary_.get(object::kPredefinedErrorField));
  for (std::uint8_t i = std::min<std::uint8_t>(count, kHistory - 1); i >= 1; --i)
    dictionary_.set(object::kPredefinedErrorField, static_cast<std::uint8_t>(i + 1),
                    dictionary_.get(object::kPredefinedErrorField, i));
  dictionary_.set(object::kPredefinedErrorField, 1,
                  error_code | static_cast<std::int64_t>(detail & 0xFFFF) << 16);
  dictionary_.set(object::kPredefinedErrorField, 0, std::min<int>(count + 1, kHistory));
}

void EmcyProducer::clear_history() noexcept {
  for (std::uint8_t i = 0; i <= kHistory; ++i) dictionary_.set(object::kPredefinedErrorField, i, 0);
}

void EmcyProducer::queue(std::uint16_t error_code, std::uint32_t detail) noexcept {
  if (waiting_count_ == kQueue) return;
  Emcy& emcy = waiting_[waiting_count_++];
  emcy.error_code = error_code;
  emcy.error_register = static_cast<std::uint8_t>(register_);
  store_le(detail, emcy.manufacturer);
  flush();
}

void EmcyProducer::tick(image::Nanoseconds now) noexcept {
  now_ = now;
  if (waiting_count_ > 0) flush();
}

void EmcyProducer::flush() noexcept {
  if (static_cast<std::uint32_t>(cob_id_) & cob::kInvalid) {
    waiting_count_ = 0;
    return;
  }
  while (waiting_count_ > 0 && allowed_ && bus_ && now_ >= not_before_) {
    image::CanFrame frame = emcy_frame(1, waiting_[0]);
    frame.id = static_cast<std::uint32_t>(cob_id_) & 0x7FF;
    if (!bus_->send(frame)) return;
    std::move(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(waiting_count_),
              waiting_.begin());
    --waiting_count_;
    not_before_ = now_ + inhibit_ * 100 * image::kMicrosecond;
  }
}

}  // namespace servogate::canopen
