// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <stop_token>
#include <vector>

#include "plc/compile/compile.hpp"

namespace servogate::gateway {

/// A program that takes longer to compile is refused: what is meant to run in milliseconds is not so large.
inline constexpr std::chrono::seconds kCompilePatience{60};

/// plc::compile() with an end: by `stop` (no finding, no image) and by `patience` (an error). What was given
/// up is ended (plc::Options::stop) and touches nothing of anybody's until it is; so long nothing else is
/// compiled here. Any thread.
plc::CompileResult compile_beside(std::vector<plc::SourceFile> files, std::vector<image::Symbol> symbols,
                                  const plc::Options& options, const std::stop_token& stop,
                                  std::chrono::milliseconds patience = kCompilePatience);

/// Something that was given up still runs: the process ends without waiting for it (std::_Exit).
bool compiles_on() noexcept;

}  // namespace servogate::gateway
