// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/text/finding.hpp"
#include "report/recorded_run.hpp"
#include "report/report.hpp"

namespace servogate::report {

/// What the page shows beside report and run.
struct HtmlOptions {
  std::string title;         ///< machine and program as people call them
  std::string program_name;  ///< heading of the listing
  std::string program_text;  ///< UTF-8; bytes that are not are shown as U+FFFD; cut after 200 000 lines
  text::Language language = text::Language::english;  ///< to begin with; the page has a switch
};

/// One self-contained HTML page: no network (its policy forbids it to the browser), opens from a file, light
/// and dark, prints. Its data is embedded; nothing in machine names, alarm texts or the program can break out
/// of it. Not real-time safe.
std::string to_html(const Report& report, const RecordedRun& run, const HtmlOptions& options);

/// Writes text to a file by way of a neighbour and a rename, so that a reader never sees half of it; through
/// a link to the file that it leads to. What is no regular file (a device, a pipe) is written to as it is.
/// The empty string, or what went wrong.
std::string write_file(const std::string& path, const std::string& content);

}  // namespace servogate::report
