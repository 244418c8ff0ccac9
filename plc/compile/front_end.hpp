// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "plc/compile/compile.hpp"
#include "plc/ir/ir.hpp"
#include "plc/syntax/report.hpp"

namespace servogate::plc {

/// Everything before code generation: the typed representation, for tools and the reference evaluator of the
/// tests. nullopt when the report has an error. Not real-time safe.
std::optional<ir::Program> analyze(const std::vector<SourceFile>& files,
                                   const std::vector<image::Symbol>& symbols, const Options& options,
                                   syntax::Report& report);

/// Names for a syntax::Report of these files, the standard library's last.
std::vector<std::string> file_names(const std::vector<SourceFile>& files);

}  // namespace servogate::plc
