// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "report/trace.hpp"

namespace servogate::report {

/// Places of a run in the coordinates of its programs, row by row. For the recorder's thread.
class WorkPlaces {
 public:
  explicit WorkPlaces(const TraceLayout& layout);
  /// The row to speak of. True: another frame than before is in force in one of the processes.
  bool follow(const TraceRow& row);
  /// A program has given this axis coordinates so far.
  bool known(std::size_t axis) const noexcept { return known_[axis]; }
  /// Coordinate of the axis as its program writes it; meaningful while known().
  double place(std::size_t axis, const TraceRow& row) const noexcept;
  /// The map of an axis; meaningful while known().
  const WorkAxis& axis(std::size_t axis) const noexcept { return axes_[axis]; }

 private:
  const FrameOf& frame_of_;
  std::size_t count_;
  int processes_;
  struct Seen {
    std::uint32_t run = 0;
    std::int64_t blocks = -1;
  };
  std::array<Seen, image::kMaxProcesses> seen_{};
  std::array<WorkFrame, image::kMaxProcesses> frames_{};
  std::array<std::int8_t, image::kMaxAxes> process_{};
  std::array<WorkAxis, image::kMaxAxes> axes_{};
  std::array<bool, image::kMaxAxes> known_{};
};

}  // namespace servogate::report
