// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/text/finding.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

/// Sentences of the command line itself.
using files::kCannotRead;
extern const text::Entry kCannotWrite;  ///< {0} path, {1} system's words
extern const text::Entry kOutputLost;   ///< {0} system's words
extern const text::Entry kStartNowForbidden;
extern const text::Entry kNoStartButton;
extern const text::Entry kLeavesTravel;  ///< {0} axis, {1} from, {2} to, {3} travel min, {4} travel max

/// The error that was said last: what a command with --json leaves on standard output when it failed before
/// it had anything else to say (end_output()).
struct LastError {
  std::string code, text;  ///< both empty: none
};
const LastError& last_error() noexcept;

/// Prints findings, one a line, on stderr; returns the number of errors.
int print_findings(const std::vector<text::Finding>& findings);
/// Prints one sentence as `servogate: text [code]` on stderr.
void complain(const text::Entry& entry, const std::vector<std::string>& arguments);

}  // namespace servogate::gateway
