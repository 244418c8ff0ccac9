// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace servogate::program {
class Execution;
}  // namespace servogate::program

namespace servogate::program::nc110 {

constexpr int kMostTimer = 6;

/// The values that the language keeps for itself, as places of State::own.
enum class Own : std::size_t {
  tim = 0,                     ///< TIM1 to TIM6
  tot = tim + kMostTimer + 1,  ///< TOT0 to TOT6
  rms = tot + kMostTimer + 1,  ///< return of a tap, %; 0: 100
  rta,                         ///< offset of the probe's ball, mm
  rto,
  approach,  ///< DPT, mm, mm and mm/min
  safety,
  probe_feed,
  skew,   ///< UGF, degrees; 0: not told
  err,    ///< 1: the program goes on behind a fault of a record file
  iosta,  ///< number of that fault, 0: the last order to a record file was carried out
};
constexpr std::size_t at(Own own) { return static_cast<std::size_t>(own); }

/// Numbers for ValueSource::system: an own value, or what FEL, FEP and FEC ask for.
constexpr int kOfElement = 1'000'000;
constexpr int kOfTime = 10'000;  ///< TIM0
constexpr int kOfRest = 20'000;  ///< RMN: 100 times the process, and the axis among its own, from 1
double own_value(const Execution& run, int number, int column);

}  // namespace servogate::program::nc110
