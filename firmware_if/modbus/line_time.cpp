// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/modbus/line_time.hpp"

namespace servogate::modbus {

using image::Nanoseconds;

namespace {
constexpr std::size_t kRtuOverhead = 3;  // station address and checksum
constexpr int kBitsPerCharacter = 11;
constexpr std::uint32_t kFast = 19'200;
constexpr Nanoseconds kFastSilence = 1'750'000;
}  // namespace

Nanoseconds LineTime::characters(std::size_t count) const noexcept {
  if (baud_ == 0) return 0;
  return static_cast<Nanoseconds>(count) * kBitsPerCharacter * image::kSecond / baud_;
}

Nanoseconds LineTime::silence() const noexcept {
  if (baud_ == 0) return 0;
  return baud_ > kFast ? kFastSilence : characters(7) / 2;
}

Nanoseconds LineTime::request(const Block& block) const noexcept {
  return characters(request_size(block.function, block.count) + kRtuOverhead);
}

Nanoseconds LineTime::transaction(const Block& block, Nanoseconds answer_delay) const noexcept {
  return request(block) + answer_delay +
         characters(response_size(block.function, block.count) + kRtuOverhead) + silence();
}

}  // namespace servogate::modbus
