// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "kernel/axis/axis.hpp"

namespace servogate::cycle {

/// An axis that follows a handwheel: what its counter changes by while the axis has it selected becomes jogs
/// by an increment, asked of the gate. Counts that cannot be followed are lost, never made up for: those that
/// the gate refuses, and those that would leave the axis more than its braking way and `kLag` behind.
///
/// In each cycle, after the axis has read and before it is commanded, all real-time safe:
///     wheel.read(image, index);
///     if (Request r; wheel.next(r, axis)) wheel.answer(r, handle(r));
///     wheel.write(image);
class Handwheel {
 public:
  /// So long, in seconds at jogging speed, the axis may go on for counts that were not yet followed.
  static constexpr double kLag = 0.05;

  /// What the PLC has written in this scan. A selection that is new takes the counter as it is.
  void read(const image::ProcessImage& image, int axis) noexcept;
  /// The next thing to ask for: a jog by what was turned, or its end when the selection has gone.
  bool next(image::Request& request, const axis::Axis& axis) noexcept;
  /// The gate's decision, carried out already.
  void answer(const image::Request& request, const image::Answer& answer) noexcept;
  /// Writes <axis>.handwheel_refusal.
  void write(image::ProcessImage& image) const noexcept;

  /// Somebody has stopped the axis: it follows again when the handwheel is selected anew.
  void stop() noexcept { stopped_ = selected_ != 0; }
  /// The axis moves by the handwheel.
  bool moves() const noexcept { return moves_; }

 private:
  double followed(const axis::Axis& axis) const noexcept;

  int axis_ = 0;
  int selected_ = 0;  ///< number of the handwheel, 0: none
  bool changed_ = false;
  bool moves_ = false;
  bool stopped_ = false;
  std::uint32_t counter_ = 0;
  std::int32_t counts_ = 0;  ///< of this cycle
  double step_ = 0.0;
  std::uint16_t refusal_ = 0;
};

}  // namespace servogate::cycle
