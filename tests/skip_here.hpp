// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <string_view>

namespace servogate {

/// Skips the running test, or fails it inside the laboratory (LAB=1, set by tests/lab/lab).
inline void skip_or_fail(std::string_view what) {
  const char* lab = std::getenv("LAB");
  if (lab != nullptr && std::string_view(lab) == "1") FAIL() << what;
  GTEST_SKIP() << what;
}

}  // namespace servogate

/// Ends a test (or its SetUp) for want of something that the laboratory has, saying in one line what is
/// missing and how to run it. In the laboratory nothing may be missing: there the test fails.
#define SKIP_HERE(what)            \
  do {                             \
    servogate::skip_or_fail(what); \
    return;                        \
  } while (false)
