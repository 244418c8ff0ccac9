// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/identification/lost_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <vector>

namespace servogate::bench {
namespace {

/// The presses of one place in one direction: the load has not moved between them.
struct Face {
  double presses = 0.0, torque = 0.0, angle = 0.0;  ///< how many, and their means
};
/// By place; first towards minus.
using Places = std::map<int, std::array<Face, 2>>;

Places faces_of(std::span<const Press> presses) {
  Places places;
  for (const Press& p : presses) {
    Face& f = places[p.place][p.torque_nm > 0.0];
    f.presses += 1.0;
    f.torque += (p.torque_nm - f.torque) / f.presses;
    f.angle += (p.angle_rad - f.angle) / f.presses;
  }
  std::erase_if(places, [](const auto& p) { return p.second[0].presses < 2.0 || p.second[1].presses < 2.0; });
  return places;
}

struct Twist {
  double compliance = 0.0, compliance_deviation = 0.0;  ///< rad/N m
  double deviation_rad = 0.0;                           ///< of one angle about it
};

/// Within each face alone, so that it does not matter where the load stands.
std::optional<Twist> twist_of(std::span<const Press> presses, const Places& places) {
  double square = 0.0, product = 0.0, angles = 0.0, degrees = -1.0;
  for (const Press& p : presses) {
    const auto place = places.find(p.place);
    if (place == places.end()) continue;
    const Face& f = place->second[p.torque_nm > 0.0];
    const double torque = p.torque_nm - f.torque, angle = p.angle_rad - f.angle;
    square += torque * torque;
    product += torque * angle;
    angles += angle * angle;
    degrees += 1.0 - 1.0 / f.presses;
  }
  if (!(square > 0.0) || !(product > 0.0) || degrees < 1.0) return std::nullopt;
  const double left = std::max(0.0, angles - product * product / square);
  const double deviation = std::sqrt(left / degrees);
  return Twist{product / square, deviation / std::sqrt(square), deviation};
}

double median(std::vector<double> v) {
  const auto middle = v.begin() + std::ssize(v) / 2;
  std::nth_element(v.begin(), middle, v.end());
  if (v.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(v.begin(), middle));
}

/// Those near the median: where the load gave way to the motor the gap looks wider.
std::vector<double> without_outliers(const std::vector<double>& gaps, double least) {
  const double middle = median(gaps);
  std::vector<double> off;
  for (const double g : gaps) off.push_back(std::abs(g - middle));
  const double most = std::max(least, 3.0 * 1.4826 * median(off));
  std::vector<double> kept;
  std::copy_if(gaps.begin(), gaps.end(), std::back_inserter(kept),
               [&](double g) { return std::abs(g - middle) <= most; });
  return kept;
}

}  // namespace

std::optional<LostMotion> fit_lost_motion(std::span<const Press> presses) {
  const Places places = faces_of(presses);
  const auto twist = twist_of(presses, places);
  if (!twist) return std::nullopt;
  std::vector<double> gaps;
  double one = 0.0,
         torque = 0.0;  // standard deviation of one of them by that of the angles; between the faces
  for (const auto& [place, face] : places) {
    torque = face[1].torque - face[0].torque;
    gaps.push_back(face[1].angle - face[0].angle - twist->compliance * torque);
    one = twist->deviation_rad * std::sqrt(1.0 / face[0].presses + 1.0 / face[1].presses);
  }
  const std::vector<double> kept = without_outliers(gaps, 3.0 * one);
  const auto n = static_cast<double>(kept.size());
  LostMotion out;
  double mean = 0.0, squares = 0.0;
  for (const double g : kept) mean += g / n;
  for (const double g : kept) squares += (g - mean) * (g - mean);
  out.stiffness_nm_rad = 1.0 / twist->compliance;
  const double scatter = std::max(one, n > 1.0 ? std::sqrt(squares / (n - 1.0)) : 0.0);
  out.deviation_rad = std::hypot(scatter / std::sqrt(n), torque * twist->compliance_deviation);
  out.backlash_rad = mean > 4.0 * out.deviation_rad ? mean : 0.0;
  return out;
}

}  // namespace servogate::bench
