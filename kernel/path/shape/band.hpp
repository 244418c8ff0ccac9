// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace servogate::path {

/// A symmetric positive definite matrix with `Width` diagonals on and below the main one, kept by columns:
/// entry d of column i stands in row i + d. Solves in place by Cholesky's method, each column at once
/// subtracting its outer product from those behind it, so that all loops have a fixed length. A pivot that
/// rounding took away is lifted to a share of its diagonal. Not real-time safe.
template <int Width>
class Band {
 public:
  using Column = std::array<double, Width>;

  /// All entries zero, for `rows` unknowns.
  void reset(std::size_t rows) { columns_.assign(rows + Width, Column{}); }
  Column& operator[](std::size_t column) { return columns_[column]; }

  /// Solves for rows `first` to `end` - 1, all others being zero. `x` holds the right side, then the
  /// solution; it has Width entries more than there are rows. The matrix is used up.
  void solve(std::size_t first, std::size_t end, std::vector<double>& x) {
    for (std::size_t i = end > first + Width ? end - Width : first; i < end; ++i)
      for (std::size_t d = end - i; d < Width; ++d) columns_[i][d] = 0.0;
    for (std::size_t i = end; i < end + Width; ++i) {
      columns_[i] = {};
      x[i] = 0.0;
    }
    for (std::size_t i = first; i < end; ++i) eliminate(i, x);
    for (std::size_t i = end; i-- > first;) {
      const Column& a = columns_[i];
      double even = x[i], odd = 0.0;
      for (std::size_t d = 1; d < Width; ++d) (d % 2 == 0 ? even : odd) -= a[d] * x[i + d];
      x[i] = (even + odd) * a[0];
    }
  }

 private:
  static constexpr double kLeastPivot = 1e-12;

  void eliminate(std::size_t i, std::vector<double>& x) {
    Column a = columns_[i];
    const double pivot = 1.0 / std::sqrt(std::max(a[0], 1e-300));
    const double y = x[i] * pivot;
    a[0] = pivot;
    x[i] = y;
    for (std::size_t d = 1; d < Width; ++d) a[d] *= pivot;
    columns_[i] = a;
    for (std::size_t d = 1; d < Width; ++d) x[i + d] -= a[d] * y;
    subtract(a, &columns_[i], std::make_index_sequence<Width - 1>());
  }

  template <std::size_t... Before>
  static void subtract(const Column& a, Column* from, std::index_sequence<Before...> /*columns*/) {
    (subtract<Before + 1>(a, from[Before + 1]), ...);
  }
  template <std::size_t D>
  static void subtract(const Column& a, Column& behind) {
    const double factor = a[D], least = kLeastPivot * behind[0];
    for (std::size_t e = 0; e < Width - D; ++e) behind[e] -= factor * a[D + e];
    behind[0] = std::max(behind[0], least);
  }

  std::vector<Column> columns_;
};

}  // namespace servogate::path
