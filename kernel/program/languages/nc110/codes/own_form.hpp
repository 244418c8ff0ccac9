// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "kernel/program/reading/dialect.hpp"

namespace servogate::program::nc110 {

/// Blocks of assignments and of codes in brackets (assignments.cpp), and what reading alone says against
/// them.
void own_form(Execution& run);
bool own_form_waits(const Block& block);
LineMark mark(std::string_view line, std::size_t pos);
void judge(const Judgement& reading, const Block& block);

}  // namespace servogate::program::nc110
