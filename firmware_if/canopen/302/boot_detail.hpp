// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>

#include "firmware_if/canopen/302/boot_step.hpp"
#include "firmware_if/image/detail.hpp"

namespace servogate::canopen {

/// A start-up that failed as the detail of a notice. Of its texts the one that the device gave is kept.
struct BootDetail {
  static constexpr image::DetailKind kDetail = image::DetailKind::canopen_boot;
  std::uint32_t abort = 0, expected = 0, got = 0;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0, step = 0, problem = 0, writing = 0;
  std::array<char, 32> got_text{};
  std::uint16_t reserved = 0;
};

/// real-time safe.
inline BootDetail boot_detail(const BootReport& report) noexcept {
  return {static_cast<std::uint32_t>(report.abort),
          report.expected,
          report.got,
          report.index,
          report.subindex,
          static_cast<std::uint8_t>(report.step),
          static_cast<std::uint8_t>(report.problem),
          static_cast<std::uint8_t>(report.writing ? 1 : 0),
          report.got_text.bytes,
          0};
}

/// And back, whatever a file made of it. real-time safe.
inline BootReport boot_report(const BootDetail& detail) noexcept {
  BootReport report;
  report.step = std::min(static_cast<BootStep>(detail.step), BootStep::done);
  report.problem = std::min(static_cast<BootProblem>(detail.problem), BootProblem::flash_timeout);
  report.index = detail.index;
  report.subindex = detail.subindex;
  report.writing = detail.writing != 0;
  report.abort = static_cast<AbortCode>(detail.abort);
  report.expected = detail.expected;
  report.got = detail.got;
  report.got_text.bytes = detail.got_text;
  report.got_text.bytes.back() = 0;
  return report;
}

}  // namespace servogate::canopen
