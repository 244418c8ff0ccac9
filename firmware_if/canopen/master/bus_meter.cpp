// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/bus_meter.hpp"

#include <algorithm>

namespace servogate::canopen {

void BusMeter::close_cycle(image::Nanoseconds period_ns, std::uint32_t bit_rate) noexcept {
  const std::uint64_t bits = cycle_bits_;
  cycle_bits_ = 0;
  if (bit_rate == 0 || period_ns <= 0) return;
  const auto share = [bit_rate](std::uint64_t amount, image::Nanoseconds time) {
    return static_cast<double>(amount) * 1e9 / (static_cast<double>(bit_rate) * static_cast<double>(time));
  };
  worst_ = std::max(worst_, share(bits, period_ns));
  if (buckets_[bucket_].time_ns >= kBucketNs) {
    bucket_ = (bucket_ + 1) % kBuckets;
    sum_.bits -= buckets_[bucket_].bits;
    sum_.time_ns -= buckets_[bucket_].time_ns;
    buckets_[bucket_] = {};
  }
  for (Bucket* bucket : {&buckets_[bucket_], &sum_}) {
    bucket->bits += bits;
    bucket->time_ns += period_ns;
  }
  load_ = share(sum_.bits, sum_.time_ns);
}

}  // namespace servogate::canopen
