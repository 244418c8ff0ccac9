// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::nc110 {

/// The language of the controls NC-110, NC-200, NC-201, NC-202, NC-210, NC-220, NC-230, NC-301, NC-302,
/// NC-310 as a table (docs/dialects/nc110.md). Source: programmer's manual, version 2.1.
const Dialect& dialect();

/// May not stand in one block (table 2.4 of the manual, incompatible when either direction says so).
bool conflict(int g1, int g2);

}  // namespace servogate::program::nc110
