// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace servogate::report {

/// The page's own files from page/, made part of the program by page/embed.cmake.
extern const char* const kPageStyle;
extern const char* const kPageBody;
extern const char* const kPageScript;
/// Scripts of others (page/vendor) and their licences, as they have to be passed on.
extern const char* const kPageLibraries;
extern const char* const kPageNotices;

}  // namespace servogate::report
