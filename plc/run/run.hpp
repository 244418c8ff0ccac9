// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/time.hpp"
#include "plc/compile/compile.hpp"

namespace servogate::plc {

/// `--set NAME=VALUE[@CYCLE]`: acts before the scan of its cycle (1 is the first) and stays until logic or
/// another set overwrites it.
struct RunSet {
  std::string name;
  std::string value;
  std::int64_t cycle = 1;
};

/// What `servogate plc run` does, without the command line.
struct RunRequest {
  std::vector<SourceFile> files;
  std::vector<image::Symbol> symbols;  ///< of a machine file, may be empty
  Options options;
  std::int64_t cycles = 1;
  image::Nanoseconds cycle_ns = 10 * image::kMillisecond;
  std::vector<RunSet> sets;
  std::vector<std::string> prints;  ///< names as requested; empty: every variable of every program
};

/// `findings`: of the compiler; then a name, value or cycle that cannot be (wrong use); or the fault that
/// ended the run.
struct RunResult {
  enum class End { done, bad_source, wrong_use, fault };
  End end = End::done;
  std::vector<text::Finding> findings;
  std::int64_t cycles = 0;  ///< scans done
};

/// Runs programs in virtual time without a machine: cycle n is scanned at time (n - 1) * cycle_ns. `line`
/// gets one JSON object a cycle, `{"cycle":3,"values":{"Main.out":true}}`, values after the scan, in the
/// order and spelling of `prints`; returning false ends the run early (End::done). Not real-time safe.
RunResult run(const RunRequest& request, const std::function<bool(std::string_view)>& line);

/// `NAME=VALUE[@CYCLE]` taken apart; false when it has not that form. The last `@` followed by digits only is
/// the cycle.
bool parse_set(std::string_view text, RunSet& out);

/// `NAME,NAME,...` taken apart; a comma between the subscripts of one name belongs to it.
std::vector<std::string> parse_prints(std::string_view text);

/// What `servogate plc check` prints: every finding, warnings included. True when there is no error. Not
/// real-time safe.
bool check(const std::vector<SourceFile>& files, const std::vector<image::Symbol>& symbols,
           const Options& options, std::vector<text::Finding>& findings);

}  // namespace servogate::plc
