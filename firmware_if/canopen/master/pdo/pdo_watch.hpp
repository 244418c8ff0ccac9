// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/canopen/master/pdo/process_data.hpp"

namespace servogate::canopen {

/// Cycles between two TPDOs of this kind; 0: they come when they like. real-time safe.
constexpr std::int64_t cycles_between(const PdoWanted& pdo, image::Nanoseconds cycle_ns) noexcept {
  if (pdo.cyclic()) return pdo.transmission_type;
  return pdo.event_ms * image::kMillisecond / cycle_ns;
}

/// Those TPDOs of a node that have to come again and again, each watched by itself: with every n-th SYNC, or
/// by an event timer. Others say nothing by their silence. Real-time safe.
class PdoWatch {
 public:
  /// `max_missed`: that many of one TPDO in a row, and the node is lost; 0: never.
  PdoWatch(const std::array<PdoWanted, 4>& tpdos, image::Nanoseconds cycle_ns,
           std::int64_t max_missed) noexcept;

  /// None has come yet: each is due in this cycle.
  void restart() noexcept;
  /// One cycle, before ProcessData::end_of_cycle(). True: none is overdue.
  bool step(const ProcessData& data) noexcept;
  /// The overdue TPDO that is nearest to its limit or furthest beyond it.
  static constexpr int kSdo = 255;
  struct Overdue {
    int number = 0;           ///< 1-4; 0: none is overdue; kSdo: it is the answer to an SDO request
    std::int64_t missed = 0;  ///< how many have not come
    std::int64_t cycles = 0;  ///< since it came last
    std::int64_t limit = 0;   ///< cycles after which the node is lost; 0: never
    bool lost() const noexcept { return limit > 0 && cycles >= limit; }
  };
  const Overdue& overdue() const noexcept { return overdue_; }

 private:
  struct Watch {
    std::int64_t every = 0;   ///< cycles; 0: it is not watched
    std::int64_t cycles = 0;  ///< since it came
  };
  std::array<Watch, 4> watches_{};
  std::int64_t max_missed_;
  Overdue overdue_;
};

}  // namespace servogate::canopen
