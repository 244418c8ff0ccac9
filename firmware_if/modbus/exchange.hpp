// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware_if/modbus/inverter_control.hpp"
#include "firmware_if/modbus/poller.hpp"

namespace servogate::modbus {

/// A unit of a line and its source in ProcessImage::sources.
struct Unit {
  std::uint8_t unit = 1;
  int source = -1;
};

/// The cycle's end of a line: what the poller read into packet A, outputs out of it, inverters as drives of
/// spindles, age and quality of each unit, whoever carries the poller. All but the constructor is real-time
/// safe.
class Exchange {
 public:
  /// Age from which the data of a block count as stale, in periods of the block; as bad after twice that.
  /// Throws std::invalid_argument when a block names a unit that is none.
  Exchange(Map map, const std::vector<Unit>& units, int stale_after_periods);

  /// What came of a transaction; before the receive() of the cycle that is to see it.
  void take(const Outcome& outcome) noexcept;
  /// Inputs and the health of the units into the image.
  void receive(image::ProcessImage& image) noexcept;
  /// Outputs that have changed, and all of them the first time.
  void send(const image::ProcessImage& image, WriteSink& sink) noexcept;

  /// What the outputs are left with when the control ends: their values of loss, but for those that hold.
  /// Nothing where nothing was sent.
  void leave(WriteSink& sink) noexcept;

  const Map& map() const noexcept { return map_; }

 private:
  /// A point of a block, and which one of its unit's stage it is.
  struct Carried {
    Point point;
    std::size_t in_stage = 0;
  };
  struct BlockState {
    std::size_t unit = 0;   ///< of stages_
    std::size_t group = 0;  ///< of that stage
    std::vector<Carried> points;
    Data data;  ///< written last
    bool armed = false;
    bool of_inverter = false;  ///< which says what is written
  };
  image::Quality quality(const Inverter& inverter, image::Nanoseconds t) const noexcept;

  Map map_;
  std::vector<image::PointStage> stages_;  ///< of each unit
  std::vector<BlockState> blocks_;
  std::vector<InverterControl> inverters_;
};

}  // namespace servogate::modbus
