// SPDX-License-Identifier: Apache-2.0
#include "kernel/path/shape/band.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace servogate::path {
namespace {

constexpr int kWidth = 4;
using Dense = std::vector<std::vector<double>>;

/// Diagonally heavy, so positive definite.
Dense random_matrix(std::size_t n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> entry(-1.0, 1.0);
  Dense m(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < kWidth && i + d < n; ++d)
      m[i][i + d] = m[i + d][i] = d == 0 ? 8.0 : entry(random);
  return m;
}

TEST(Band, solves_what_a_dense_matrix_times_the_solution_gives_back) {
  std::mt19937_64 random(1);
  const std::size_t n = 40;
  const Dense m = random_matrix(n, random);
  Band<kWidth> band;
  band.reset(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < kWidth && i + d < n; ++d) band[i][d] = m[i + d][i];
  std::vector<double> x(n + kWidth, 0.0);
  for (std::size_t i = 0; i < n; ++i) x[i] = std::sin(static_cast<double>(i));
  band.solve(0, n, x);
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < n; ++k) sum += m[i][k] * x[k];
    EXPECT_NEAR(sum, std::sin(static_cast<double>(i)), 1e-13) << i;
  }
}

TEST(Band, leaves_out_the_unknowns_before_and_behind) {
  std::mt19937_64 random(2);
  const std::size_t n = 30, first = 5, end = 23;
  const Dense m = random_matrix(n, random);
  Band<kWidth> band;
  band.reset(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t d = 0; d < kWidth && i + d < n; ++d) band[i][d] = m[i + d][i];
  std::vector<double> x(n + kWidth, 0.0);
  for (std::size_t i = first; i < end; ++i) x[i] = 1.0;
  band.solve(first, end, x);
  for (std::size_t i = 0; i < n; ++i) {
    if (i < first || i >= end) {
      EXPECT_EQ(x[i], 0.0) << i;
      continue;
    }
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) sum += m[i][k] * x[k];
    EXPECT_NEAR(sum, 1.0, 1e-13) << i;
  }
}

}  // namespace
}  // namespace servogate::path
