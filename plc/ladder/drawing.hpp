// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

namespace servogate::plc::ladder {

/// Reads the drawing of `unit` (what stood between LADDER and END_LADDER; the form is described in
/// docs/plc.md) and makes its body.
void read_drawing(syntax::Unit& unit, syntax::Report& report);

}  // namespace servogate::plc::ladder
