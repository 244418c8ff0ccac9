// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/axes/transformation.hpp"

namespace servogate::path {
namespace {

class Identity final : public Transformation {
 public:
  void to_axes(PathPoint& /*place*/, int /*axes*/) const noexcept override {}
};

constinit const Identity kIdentity;

}  // namespace

const Transformation& identity() noexcept { return kIdentity; }

Vector to_axes(const Transformation& transformation, const Vector& position, int axes) noexcept {
  PathPoint place;
  place.x = position;
  transformation.to_axes(place, axes);
  return place.x;
}

Vector turned_to_axes(const Transformation& transformation, const Vector& direction, int axes) noexcept {
  PathPoint place;
  place.d1 = direction;
  transformation.to_axes(place, axes);
  return place.d1;
}

}  // namespace servogate::path
