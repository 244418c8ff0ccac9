// SPDX-License-Identifier: Apache-2.0
#include "report/work_places.hpp"

#include <algorithm>

namespace servogate::report {

WorkPlaces::WorkPlaces(const TraceLayout& layout)
    : frame_of_(layout.frame_of),
      count_(std::min<std::size_t>(layout.axes.size(), image::kMaxAxes)),
      processes_(std::clamp(layout.processes, 1, image::kMaxProcesses)) {}

bool WorkPlaces::follow(const TraceRow& row) {
  if (!frame_of_) return false;
  bool changed = false;
  for (int p = 0; p < processes_; ++p) {
    const auto i = static_cast<std::size_t>(p);
    const std::uint32_t run = p == 0 ? row.run : row.further[i - 1].run;
    const std::int64_t blocks = p == 0 ? row.blocks : row.further[i - 1].blocks;
    // What the first block has is known when it moves.
    if (run == 0 || blocks < 1 || (run == seen_[i].run && blocks == seen_[i].blocks)) continue;
    WorkFrame frame;
    if (!frame_of_(p, run, blocks, frame)) continue;
    seen_[i] = {run, blocks};
    frames_[i] = frame;
    changed = true;
  }
  for (std::size_t a = 0; a < count_; ++a) {
    const std::int8_t p = row.axes[a].process;
    if (p < 0 || p >= processes_ || seen_[static_cast<std::size_t>(p)].run == 0) continue;
    if (!changed && process_[a] == p && known_[a]) continue;
    const WorkAxis& now = frames_[static_cast<std::size_t>(p)][a];
    process_[a] = p;
    changed = changed || !known_[a] || !(axes_[a] == now);
    known_[a] = true;
    axes_[a] = now;
  }
  return changed;
}

double WorkPlaces::place(std::size_t axis, const TraceRow& row) const noexcept {
  const WorkAxis& map = axes_[axis];
  double value = map.offset;
  for (std::size_t a = 0; a < count_; ++a)
    if (map.share[a] != 0.0) value += map.share[a] * row.axes[a].command;
  return value;
}

}  // namespace servogate::report
