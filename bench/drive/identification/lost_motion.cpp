// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/identification/lost_motion.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace servogate::bench {

std::optional<LostMotion> fit_lost_motion(std::span<const Press> presses) {
  const auto n = static_cast<Eigen::Index>(presses.size());
  if (n < 4) return std::nullopt;
  Eigen::MatrixXd a(n, 3);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Press& p = presses[static_cast<std::size_t>(i)];
    a.row(i) << 1.0, std::copysign(0.5, p.torque_nm), p.torque_nm;
    b(i) = p.angle_rad;
  }
  // Columns of very different size, so that the rank is seen.
  Eigen::Vector3d size = a.colwise().norm().transpose();
  if (size.minCoeff() <= 0.0) return std::nullopt;
  const Eigen::MatrixXd scaled = a * size.cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(scaled);
  qr.setThreshold(1e-6);
  if (qr.rank() < 3) return std::nullopt;
  const Eigen::Vector3d x = qr.solve(b).cwiseQuotient(size);
  if (!(x(2) > 0.0)) return std::nullopt;
  LostMotion out;
  out.stiffness_nm_rad = 1.0 / x(2);
  const double degrees = static_cast<double>(n - 3);
  const double variance = degrees > 0.0 ? (a * x - b).squaredNorm() / degrees : 0.0;
  const Eigen::Matrix3d normal = scaled.transpose() * scaled;
  out.deviation_rad =
      std::sqrt(std::max(0.0, variance * normal.ldlt().solve(Eigen::Vector3d::Unit(1))(1))) / size(1);
  out.backlash_rad = x(1) > 3.0 * out.deviation_rad ? x(1) : 0.0;
  return out;
}

}  // namespace servogate::bench
