// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/alarm/alarm_table.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "kernel/cycle/alarm/rows/axis_rows.hpp"
#include "kernel/cycle/alarm/rows/bus_rows.hpp"
#include "kernel/cycle/alarm/rows/plc_rows.hpp"
#include "kernel/cycle/alarm/rows/point_rows.hpp"
#include "kernel/cycle/alarm/rows/program_rows.hpp"
#include "kernel/cycle/alarm/rows/system_rows.hpp"

namespace servogate::cycle {

namespace {

template <std::size_t... kSizes>
constexpr auto joined(const AlarmRow (&... rows)[kSizes]) {
  std::array<AlarmRow, (kSizes + ...)> all;
  auto* to = all.data();
  ((to = std::copy(std::begin(rows), std::end(rows), to)), ...);
  return all;
}

constexpr auto kTable = joined(kAxisRows, kBusRows, kPointRows, kProgramRows, kPlcRows, kSystemRows);

static_assert(std::is_sorted(std::begin(kTable), std::end(kTable),
                             [](const AlarmRow& a, const AlarmRow& b) { return a.number < b.number; }));

}  // namespace

std::span<const AlarmRow> alarm_table() noexcept { return kTable; }

const AlarmRow* find_alarm(image::AlarmNumber number) noexcept {
  const AlarmRow* row =
      std::lower_bound(std::begin(kTable), std::end(kTable), number,
                       [](const AlarmRow& r, image::AlarmNumber n) { return r.number < n; });
  return row != std::end(kTable) && row->number == number ? row : nullptr;
}

bool is_of_part(image::AlarmNumber number) noexcept {
  constexpr image::AlarmNumber kOfParts[] = {alarm::kNodeLost, alarm::kNodeRestarted,
                                             alarm::kNodeLeft, alarm::kBusOff,
                                             alarm::kBusDown,  axis::alarm::kPdoMissing};
  return std::find(std::begin(kOfParts), std::end(kOfParts), number) != std::end(kOfParts);
}

}  // namespace servogate::cycle
