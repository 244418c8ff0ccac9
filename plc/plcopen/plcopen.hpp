// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "plc/syntax/ast.hpp"
#include "plc/syntax/report.hpp"

/// PLCopen XML (TC6, version 2.0), as OpenPLC Editor, Beremiz and CODESYS export it.
namespace servogate::plc::plcopen {

/// The text looks like XML, so it is no Structured Text.
bool is_xml(std::string_view text);

/// Reads one file and adds what it declares to `source`: data types, POUs with bodies in ST, IL, LD and FBD,
/// global variables, configurations with resources and tasks. Bodies in SFC are reported. Findings name the
/// line and column of the XML file; inside a text with entities (&lt;) the column is that of the decoded
/// text.
void parse(std::string_view text, int file, syntax::Source& source, syntax::Report& report);

}  // namespace servogate::plc::plcopen
