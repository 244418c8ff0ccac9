// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace servogate::report {

/// What happens on a stretch of the path. Jump: coordinates change by homing or while drives are off; no
/// motion.
enum class StretchKind : std::uint8_t { feed, rapid, jump };

/// One point of a recorded path.
struct PathVertex {
  float x = 0, y = 0, z = 0, t = 0, speed = 0;
  std::int32_t line = 0;
  StretchKind kind = StretchKind::feed;  ///< of the stretch that ends here
  float deviation = 0;                   ///< largest on that stretch
  std::int32_t tool = 0;
};

/// How far a thinned polyline may be from the points that were left out.
struct PathThinning {
  double distance = 0.001;  ///< mm
  double speed = 1.0;       ///< mm/s, against linear interpolation over time
  bool keep_lines = true;   ///< keep each point at which the program line changes
};

/// Leaves out the points from index `from` on that the rest describes within the tolerances (Douglas and
/// Peucker, "The reduction of the number of points required to represent a digitized line", 1973). First and
/// last point and changes of kind or tool stay; a deviation goes on to the next point that stays. O(n log n)
/// usually. Not real-time safe.
void thin(std::vector<PathVertex>& path, std::size_t from, const PathThinning& tolerance);

/// A path in bounded memory: thinned while it grows; its tolerance doubles whenever it grows too long.
class BoundedPath {
 public:
  BoundedPath(std::size_t max_vertices, double tolerance);
  /// Points nearer to the one before than a quarter of the tolerance are left out unless line or kind
  /// change.
  void add(const PathVertex& v);
  /// Thins what is left; then vertices() is final.
  void finish();
  const std::vector<PathVertex>& vertices() const noexcept { return path_; }
  /// No point that was given is farther from the polyline than this, mm.
  double tolerance() const noexcept { return tolerance_; }

 private:
  void compact(std::size_t most);
  void keep_last();
  PathThinning thinning() const noexcept;

  std::size_t max_vertices_;
  double first_tolerance_, tolerance_;
  float fastest_ = 0;
  std::size_t thinned_ = 0;  ///< points before this index are thinned at the present tolerance
  std::vector<PathVertex> path_;
  PathVertex last_;
  bool pending_ = false;  ///< last_ is not in path_
  float left_out_ = 0;    ///< largest deviation of points behind path_.back() that were left out
};

}  // namespace servogate::report
