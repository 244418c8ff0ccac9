// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/text/finding.hpp"
#include "plc/compile/compile.hpp"
#include "plc/testing/test_file.hpp"

namespace servogate::plc::testing {

/// How one test went: passed when there is no finding. It ends with the first line that is not fulfilled.
struct Outcome {
  std::string name;
  int line = 0;
  std::int64_t scans = 0;
  image::Nanoseconds time_ns = 0;  ///< virtual time of the last scan
  std::vector<text::Finding> findings;

  bool passed() const noexcept { return findings.empty(); }
};

/// Runs every test of a file on an engine of its own, from the initial values, in virtual time: scan n is
/// done at (n - 1) * cycle_ns, and packets are empty at first. A name is a variable of the program, or one of
/// `symbols` even when the program does not use it. Names and values that cannot be are findings of their
/// test. Not real-time safe.
std::vector<Outcome> run_tests(const TestFile& file, std::shared_ptr<const Image> image,
                               const std::vector<image::Symbol>& symbols, const Options& options);

}  // namespace servogate::plc::testing
