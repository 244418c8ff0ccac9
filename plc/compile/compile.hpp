// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/text/finding.hpp"
#include "plc/terms/options.hpp"

namespace servogate::plc {

struct Image;

/// What came out. `findings` are in the order of file, line and column; `image` is null when any is an error.
struct CompileResult {
  std::vector<text::Finding> findings;
  std::shared_ptr<const Image> image;

  bool ok() const noexcept { return image != nullptr; }
};

/// Compiles Structured Text, Instruction List, ladders drawn in text and PLCopen XML (IEC 61131-3, third
/// edition) to the compact form that plc::Engine runs. A file that begins with '<' is XML. All files
/// see each other's declarations. Every symbol is a global variable of the type of its place (BL BOOL, BY
/// USINT, IN INT, LI DINT, RE REAL, LR LREAL, nCH STRING[n]), matched without case; writing one whose
/// declared writer is the NC or an input is an error. Not real-time safe.
CompileResult compile(std::vector<SourceFile> files, std::vector<image::Symbol> symbols,
                      const Options& options = {});

}  // namespace servogate::plc
