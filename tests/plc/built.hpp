// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"
#include "plc/vm/image.hpp"

namespace servogate::plc {

/// A program without mistakes; warnings are allowed.
inline std::shared_ptr<const Image> build(const std::string& text, std::vector<image::Symbol> symbols = {},
                                          Options options = {}) {
  const CompileResult r = compile({{"t.st", text}}, std::move(symbols), options);
  for (const text::Finding& f : r.findings)
    EXPECT_EQ(f.severity, text::Severity::warning) << f.str(text::Language::english);
  return r.image;
}

/// Places of every format, and who writes them.
inline const std::vector<image::Symbol> kSymbols = {
    {"bit_in", {image::Packet::a, image::Format::bl, 3, 1}, image::Writer::input, ""},
    {"Panel.byte", {image::Packet::k, image::Format::by, 100, 1}, image::Writer::program, ""},
    {"word", {image::Packet::k, image::Format::in, 60, 1}, image::Writer::plc, ""},
    {"long", {image::Packet::k, image::Format::li, 40, 1}, image::Writer::plc, ""},
    {"real", {image::Packet::k, image::Format::re, 50, 1}, image::Writer::plc, ""},
    {"wide", {image::Packet::k, image::Format::lr, 30, 1}, image::Writer::plc, ""},
    {"text", {image::Packet::k, image::Format::ch, 300, 6}, image::Writer::plc, ""},
    {"bit_out", {image::Packet::a, image::Format::bl, 64, 1}, image::Writer::plc, ""},
    {"never_written", {image::Packet::a, image::Format::bl, 65, 1}, image::Writer::plc, ""},
};

}  // namespace servogate::plc
