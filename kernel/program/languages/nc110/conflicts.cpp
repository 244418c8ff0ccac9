// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bitset>
#include <initializer_list>

#include "kernel/program/languages/nc110/nc110.hpp"

namespace servogate::program::nc110 {
namespace {

using Numbers = std::initializer_list<int>;

/// One row of table 2.4: each of `rows` may not stand in a block with any of `columns`.
struct Row {
  Numbers rows;
  Numbers columns;
};

constexpr int kCycles[] = {81, 82, 83, 84, 85, 86, 89};
constexpr int kProbes[] = {72, 73, 74};
constexpr int kCycle = -8;  ///< stands for G81-G89 ...
constexpr int kProbe = -7;  ///< ... and G72-G74 in a column list, as in the printed table

const Row kTable[] = {
    {{0, 1}, {0, 1, 2, 3, 33, 80, 21, 20}},
    {{2, 3}, {0, 1, 2, 3, 33, kCycle, 80, kProbe, 21, 20}},
    {{4}, {33, kCycle, kProbe, 27, 28, 4, 9}},
    {{9}, {33, kCycle, kProbe, 4, 9}},
    {{6, 33, 34}, {0, 1, 2, 3, 33, kCycle, 80, kProbe, 21, 20, 41, 42, 40}},
    {{20}, {0, 1, 2, 3, 33, kCycle, 80, kProbe, 21, 20, 41, 42, 79}},
    {{21}, {0, 1, 2, 3, 33, kCycle, 80, kProbe, 21, 20, 79}},
    {{27}, {kCycle, kProbe, 27, 28, 29, 4}},
    {{28}, {33, kCycle, kProbe, 27, 28, 29, 4}},
    {{29}, {kCycle, kProbe, 27, 28, 29}},
    {{35}, {0, 33, kCycle, 80, kProbe, 20}},
    {{40}, {33, kCycle, 80, kProbe, 41, 42, 40, 79}},
    {{41, 42}, {33, kCycle, 80, kProbe, 20, 41, 42, 40, 79}},
    {{72, 73, 74}, {1, 2, 3, 33, kCycle, 80, kProbe, 21, 20, 41, 42, 40, 27, 28, 29, 79}},
    {{79}, {kCycle, 80, kProbe, 21, 20, 41, 42, 40, 90, 91, 79}},
    {{80}, {0, 1, 2, 3, 33, kCycle, 80, kProbe, 21, 20, 41, 42, 40, 79}},
    {{81, 82, 83, 84, 85, 86, 89}, {2, 3, 33, kCycle, 80, kProbe, 21, 20, 41, 42, 40, 27, 28, 29, 79}},
    {{90, 91}, {90, 91, 79}},
};

using Matrix = std::array<std::bitset<100>, 100>;

void mark(Matrix& matrix, int a, int b) {
  matrix[static_cast<std::size_t>(a)].set(static_cast<std::size_t>(b));
  matrix[static_cast<std::size_t>(b)].set(static_cast<std::size_t>(a));
}

Matrix build() {
  Matrix matrix;
  for (const Row& row : kTable)
    for (const int g : row.rows)
      for (const int column : row.columns) {
        if (column == kCycle)
          for (const int cycle : kCycles) mark(matrix, g, cycle);
        else if (column == kProbe)
          for (const int probe : kProbes) mark(matrix, g, probe);
        else
          mark(matrix, g, column);
      }
  for (int g = 0; g < 100; ++g)
    for (const int plane : {17, 18, 19}) mark(matrix, g, plane);
  for (const int g : {27, 28}) {  // printed rows of G27 and G28 allow G09, the row of G09 does not
    matrix[9].reset(static_cast<std::size_t>(g));
    matrix[static_cast<std::size_t>(g)].reset(9);
  }
  return matrix;
}

}  // namespace

bool conflict(int g1, int g2) {
  static const Matrix matrix = build();
  return g1 >= 0 && g1 < 100 && g2 >= 0 && g2 < 100 &&
         matrix[static_cast<std::size_t>(g1)].test(static_cast<std::size_t>(g2));
}

}  // namespace servogate::program::nc110
