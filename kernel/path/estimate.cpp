// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "kernel/path/axes/transformation.hpp"
#include "kernel/path/follower.hpp"
#include "kernel/path/planner.hpp"

namespace servogate::path {

Estimate estimate(const Config& config, const Vector& start, std::span<const Element> elements,
                  double override_ratio) {
  constexpr std::int64_t kLongest = 1'000'000'000;  // cycles
  Track track(config);
  Planner planner(config, track);
  Follower follower(config, track);
  follower.set_position(to_axes(config, start));
  follower.set_override(std::max(override_ratio, 1e-3));
  planner.restart(start);

  Estimate out;
  out.lowest = out.highest = to_axes(config, start);
  std::size_t next = 0;
  bool finished = false;
  for (; out.cycles < kLongest; ++out.cycles) {
    while (!finished && planner.wants_more()) {
      if (next == elements.size() || out.flawed != 0) {
        planner.finish();
        finished = true;
      } else {
        Element element = elements[next++];
        element.lock = {};  // no spindle turns here: at the speed that its lead is planned for
        if (!planner.add(element)) {
          out.flawed = next;
          out.flaw = planner.last_flaw();
        }
      }
      planner.work();
    }
    planner.work();
    const Sample sample = follower.step(track.visible());
    for (int i = 0; i < config.axis_count; ++i) {
      out.lowest[i] = std::min(out.lowest[i], sample.position[i]);
      out.highest[i] = std::max(out.highest[i], sample.position[i]);
    }
    follower.release_stop();
    if (finished && sample.state == FollowerState::idle) break;
  }
  out.seconds = static_cast<double>(out.cycles) * config.period_s;
  return out;
}

}  // namespace servogate::path
