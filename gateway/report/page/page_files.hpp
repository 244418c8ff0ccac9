// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::report {

/// The page's own files from page/, made part of the program by page/embed.cmake.
extern const char* const kPageStyle;
extern const char* const kPageScript;

}  // namespace servogate::report
