// SPDX-License-Identifier: Apache-2.0
#include "report/touches.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

namespace servogate::report {

namespace {

constexpr double kSamePlace = 0.1, kSameFeed = 1e-6;

bool same_place(const Touch& a, const Touch& b) {
  if (a.axis != b.axis || a.direction != b.direction || std::abs(a.feed_mm_min - b.feed_mm_min) > kSameFeed ||
      std::abs(a.at - b.at) > kSamePlace)
    return false;
  return std::equal(a.beside.begin(), a.beside.end(), b.beside.begin(),
                    [](double x, double y) { return std::abs(x - y) <= kSamePlace; });
}

}  // namespace

Repeatability repeatability(std::span<const double> places) {
  if (places.empty()) return {};
  const auto count = static_cast<double>(places.size());
  const double mean = std::accumulate(places.begin(), places.end(), 0.0) / count;
  const auto [least, most] = std::minmax_element(places.begin(), places.end());
  double squares = 0.0;
  for (const double place : places) squares += (place - mean) * (place - mean);
  return {mean, *most - *least, places.size() > 1 ? std::sqrt(squares / (count - 1.0)) : 0.0};
}

std::vector<TouchGroup> grouped(std::span<const Touch> touches) {
  std::vector<TouchGroup> groups;
  std::vector<Touch> firsts;
  for (const Touch& t : touches) {
    const auto first =
        std::find_if(firsts.begin(), firsts.end(), [&t](const Touch& f) { return same_place(f, t); });
    const auto n = static_cast<std::size_t>(first - firsts.begin());
    if (first == firsts.end()) {
      firsts.push_back(t);
      groups.push_back({t.axis, {}, "mm", false, t.direction, t.feed_mm_min});
    }
    groups[n].places.push_back(t.at);
  }
  return groups;
}

}  // namespace servogate::report
