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

Vector to_axes(const Config& config, const Vector& position) noexcept {
  PathPoint place;
  place.x = position;
  config.transformation->to_axes(place, config.axis_count);
  return place.x;
}

}  // namespace servogate::path
