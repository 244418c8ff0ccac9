// SPDX-License-Identifier: Apache-2.0
#include "report/record/column.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <new>

namespace servogate::report {

namespace {

constexpr double kMostMultiples = 281'474'976'710'656.0;  // 2^48

void append(std::string& out, std::int64_t value) {
  // The sign goes into the lowest bit, so that small values of either sign stay short.
  auto bits = static_cast<std::uint64_t>(value) << 1;
  if (value < 0) bits = ~bits;
  for (; bits >= 0x80; bits >>= 7) out += static_cast<char>(bits | 0x80);
  out += static_cast<char>(bits);
}

double finite(double v) noexcept { return std::isfinite(v) ? v : 0.0; }

}  // namespace

std::string deflated(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  std::string in(bytes);
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);  // one call is enough: the room is deflateBound()'s
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

Column pack(std::span<const double> values, double quantum, int order) {
  Column column{values.size(), quantum, std::clamp(order, 0, 3), {}};
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::fabs(finite(v)));
  while (most / column.quantum > kMostMultiples) column.quantum *= 2;
  std::string bytes;
  bytes.reserve(2 * values.size());
  std::array<std::int64_t, 3> last{};
  for (const double v : values) {
    std::int64_t difference = std::llround(finite(v) / column.quantum);
    for (int k = 0; k < column.order; ++k) {
      const std::int64_t now = difference;
      difference -= last[static_cast<std::size_t>(k)];
      last[static_cast<std::size_t>(k)] = now;
    }
    append(bytes, difference);
  }
  column.bytes = deflated(bytes);
  return column;
}

}  // namespace servogate::report
