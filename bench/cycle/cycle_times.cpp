// SPDX-License-Identifier: Apache-2.0
#include "bench/cycle/cycle_times.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

namespace servogate::bench {

namespace {

using image::RequestKind;

constexpr int kPatience = 120'000;  ///< cycles that each stage of getting ready may take

void ask(Machine& m, RequestKind kind, double value = 0.0) {
  image::Request r;
  r.asker = image::Asker::command_line;  // runs a program like an operator
  r.kind = kind;
  r.value = value;
  m.post(r);
}

template <typename Good>
bool all_axes(const Machine& m, Good&& good) {
  for (int a = 0; a < m.image().axis_count; ++a)
    if (!good(m.image().axes[static_cast<std::size_t>(a)])) return false;
  return true;
}

/// Repeats a request every 100 ms until the axes are as wished.
template <typename Good>
bool insist(Machine& m, RequestKind kind, double value, Good&& good) {
  for (int i = 0; i < kPatience; ++i) {
    if (all_axes(m, good)) return true;
    if (i % 100 == 0) ask(m, kind, value);
    m.step();
  }
  return false;
}

bool get_ready(Machine& m) {
  for (int i = 0; i < kPatience && !all_axes(m, [](const image::AxisImage& a) { return a.drive.online; });
       ++i)
    m.step();
  if (!insist(m, RequestKind::power, 1.0, [](const image::AxisImage& a) { return a.enabled; })) return false;
  for (int i = 0; i < 1000; ++i) m.step();
  ask(m, RequestKind::mode, static_cast<double>(image::Mode::home));
  const bool homed = insist(m, RequestKind::home, 0.0, [](const image::AxisImage& a) {
    return a.homed && !a.moving && a.owner != image::AxisOwner::homing;
  });
  for (int i = 0; i < 100; ++i) m.step();
  return homed;
}

double quantile(std::vector<image::Nanoseconds>& sorted, double q) {
  if (sorted.empty()) return 0.0;
  const auto at = static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1));
  return static_cast<double>(sorted[at]) * 1e-3;
}

}  // namespace

CycleCost measure(Machine& m) {
  CycleCost cost;
  if (!get_ready(m)) return cost;
  ask(m, RequestKind::mode, static_cast<double>(image::Mode::automatic));
  ask(m, RequestKind::start);
  std::vector<image::Nanoseconds> durations;
  durations.reserve(1'000'000);
  long cycles = 0;
  const auto begin = std::chrono::steady_clock::now();
  const image::Nanoseconds from = m.image().now.t_ns;
  do {
    m.step();
    if (const image::Nanoseconds ns = m.cycle_duration_ns(); ns >= 0) durations.push_back(ns);
  } while (++cycles < 10 || m.image().processes[0].state == image::ProcessState::running ||
           m.image().processes[0].state == image::ProcessState::waiting);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  cost.finished = m.image().processes[0].state == image::ProcessState::ended;
  cost.seconds = static_cast<double>(m.image().now.t_ns - from) * 1e-9;
  cost.virtual_speed = cost.seconds / wall;
  std::sort(durations.begin(), durations.end());
  cost.p50_us = quantile(durations, 0.50);
  cost.p99_us = quantile(durations, 0.99);
  cost.p999_us = quantile(durations, 0.999);
  return cost;
}

CycleCost median_of(int runs, const std::function<std::unique_ptr<Machine>()>& fresh) {
  std::vector<CycleCost> costs;
  for (int i = 0; i < runs; ++i) {
    const std::unique_ptr<Machine> machine = fresh();
    costs.push_back(measure(*machine));
  }
  CycleCost result = costs.front();
  const auto median = [&](double CycleCost::*figure) {
    std::sort(costs.begin(), costs.end(),
              [&](const CycleCost& a, const CycleCost& b) { return a.*figure < b.*figure; });
    return costs[costs.size() / 2].*figure;
  };
  for (double CycleCost::*figure :
       {&CycleCost::p50_us, &CycleCost::p99_us, &CycleCost::p999_us, &CycleCost::virtual_speed})
    result.*figure = median(figure);
  return result;
}

}  // namespace servogate::bench
