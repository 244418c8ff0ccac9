// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/cycles/threading.hpp"

#include <algorithm>
#include <cmath>

#include "kernel/program/execution/execution.hpp"

namespace servogate::program {
namespace {

constexpr int kMostPasses = 10'000;

}  // namespace

/// `shift`: the tool begins so much further along, into the flank.
void thread_pass(Execution& run, const Threading& thread, double across, double shift) {
  const auto along = static_cast<std::size_t>(thread.along), out = static_cast<std::size_t>(thread.across);
  const Position begin = run.state().frames.programmed;
  const double forward = thread.along_end < begin[along] ? -1.0 : 1.0;
  const double outward = begin[out] < across ? -1.0 : 1.0;
  Position to = begin;
  to[along] += forward * shift;
  to[out] = across + thread.taper;
  run.motion().go(to, true);
  const double way = std::abs(thread.along_end - to[along]);
  const double run_out = std::min(thread.run_out, way);
  const double share = way > 0.0 ? (way - run_out) / way : 1.0;
  to[along] = thread.along_end - forward * run_out;
  to[out] = across + thread.taper * (1.0 - share);
  run.motion().thread(to, thread.lead, thread.start_angle_deg);
  if (run_out > 0.0) {
    const double room = std::abs(begin[out] - to[out]);
    to[along] = thread.along_end;
    to[out] += outward * std::min(run_out, room);
    run.motion().thread(to, thread.lead, thread.start_angle_deg);
  }
  to[out] = begin[out];
  run.motion().go(to, true);
  run.motion().go(begin, true);
}

std::vector<double> thread_depths(const std::string& name, double depth, double first, double least) {
  std::vector<double> depths;
  double before = 0.0;
  for (int pass = 1; before < depth - 1e-9; ++pass) {
    if (pass > kMostPasses) fail(Fault::cycle_pecks, 0, {name, std::to_string(kMostPasses)});
    const double chip = first * std::sqrt(static_cast<double>(pass));
    before = std::min(depth, std::max(chip, before + least));
    depths.push_back(before);
  }
  return depths;
}

}  // namespace servogate::program
