// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"

namespace servogate::cycle {

/// The order of the PLC to an axis to follow its master by one of its electronic gears, or by none:
/// `<axis>.gear`. A number is asked for once: a gear that was refused, or that something disengaged, comes
/// again with another number only. From one gear to another the axis comes to rest. It is not asked for
/// while its master is awaited (ElectronicGear::master_awaited).
///
/// In each cycle, behind the requests, all real-time safe:
///     order.read(image, axis);
///     if (Request r; order.next(r, on, geared)) order.answer(r, handle(r));
class GearOrder {
 public:
  void read(const image::ProcessImage& image, int axis) noexcept;
  /// `on`: one of the gears is engaged; `geared`: the axis follows, or still comes to rest behind it.
  bool next(image::Request& request, bool on, bool geared) noexcept;
  /// The gate's decision, carried out already.
  void answer(const image::Request& request, const image::Answer& answer) noexcept;
  /// That the PLC wants, 0: none.
  std::uint8_t wished() const noexcept { return wish_; }
  /// In force or asked for last, 0: none.
  std::uint8_t number() const noexcept { return asked_; }
  /// Of that: how it was decided.
  const image::Answer& answer() const noexcept { return answer_; }

 private:
  int axis_ = 0;
  std::uint8_t wish_ = 0, asked_ = 0;
  image::Answer answer_;
};

}  // namespace servogate::cycle
