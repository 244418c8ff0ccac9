// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/time.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::plc::testing {

/// A word of a test file and where it stands; columns count from 1.
struct Word {
  std::string text;
  int line = 0;
  int column = 0;
};

enum class Comparison : std::uint8_t { equal, not_equal, less, less_equal, greater, greater_equal };

/// `NAME = VALUE` of set and hold, or a condition: `NAME`, `NOT NAME`, `NAME >= VALUE`, `NAME = VALUE +- BY`.
struct Term {
  Word name, value, tolerance;  ///< value.text empty: a BOOL stands alone
  Comparison comparison = Comparison::equal;
  bool negated = false;
};

enum class StepKind : std::uint8_t { set, hold, release, run, expect, until, expect_fault };

/// One line of a test.
struct Step {
  StepKind kind = StepKind::run;
  Word word;                       ///< the line's first word
  std::vector<Term> terms;         ///< of all but run
  std::int64_t scans = 0;          ///< of run; 0: as long as `time_ns`
  image::Nanoseconds time_ns = 0;  ///< of run and until
};

struct Test {
  Word name;
  std::vector<Step> steps;
};

/// A file that has been read. `before` is done at the beginning of every test.
struct TestFile {
  std::string name;
  Word machine;               ///< path of the machine file whose symbols are known; empty text: none
  std::vector<Word> sources;  ///< paths of PLC sources
  image::Nanoseconds cycle_ns = image::kMillisecond;
  std::vector<Step> before;
  std::vector<Test> tests;
  std::vector<std::string> lines;
  std::vector<text::Finding> findings;  ///< all mistakes of the form, each with its line

  bool ok() const noexcept { return findings.empty(); }
};

/// Reads a test file; `name` appears in findings. Not real-time safe.
TestFile read_test_file(std::string name, std::string_view text);

/// A finding at a word of the file, with the line that it speaks of.
text::Finding finding_at(const TestFile& file, const Word& at, const text::Entry& entry,
                         std::vector<std::string> arguments);

}  // namespace servogate::plc::testing
