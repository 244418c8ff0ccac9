// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "kernel/program/reading/block.hpp"
#include "kernel/program/reading/dialect.hpp"

/// What stands in a profile of geometric elements (G21 ... G20) and between two elements of a contour.
/// Source: specification A 14.3, A 21.3, B 1.5 to 1.7.
namespace servogate::program::nc110 {

/// p3, l3, -l3, c3 and s2 behind it.
void read_element(BlockText& text, Word& word);
/// An element of a profile, or a point in the place of coordinates.
void element(Execution& run, const BlockWords& words);
/// r5, r0, b5
void read_corner(BlockText& text, Word& word);
void corner(Execution& run, const BlockWords& words);
/// Axes across the plane inside of a profile.
void across(Execution& run, const BlockWords& words);
/// A line, from its first character that is no space, holds r or b.
bool corner_word(std::string_view line, std::size_t first);

}  // namespace servogate::program::nc110
