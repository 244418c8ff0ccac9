// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/reading/block.hpp"

/// Geometric elements: o origins, p points, l lines, c circles. Source: specification A 21, A 22, B 1.
namespace servogate::program::nc110 {

inline constexpr int kMostNumber = 255;  ///< of an element

/// True where a block defines an element: o, p, l or c, its number and =.
bool defines_element(std::string_view line, std::size_t pos);
/// True for the name of an element: p3.
bool names_element(std::string_view text);
/// Reads a definition to the end of its block and stores the element; `run` null: reads only.
void define_element(Execution* run, const Dialect& dialect, const AxisLetters& axes, Block& block,
                    std::size_t& pos);

/// An element in use; throws ProgramError where none has the number.
const Point& point_of(const Execution& run, int number, int column);
const Directed& line_of(const Execution& run, int number, int column);
const Directed& circle_of(const Execution& run, int number, int column);
const PlaneFrame& origin_of(const Execution& run, int number, int column);

/// FEL, FEP, FEC: `function` L, P or C. Source: specification B 2.2.
double element_value(const Execution& run, char function, int number, int item, int column);
/// How DIS shows an element.
std::string shown_element(const Execution& run, std::string_view name, int column);

}  // namespace servogate::program::nc110
