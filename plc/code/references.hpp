// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "plc/vm/image.hpp"

namespace servogate::plc::code {

/// Where every variable of the program's own files is read and written, in the order of files, lines and
/// columns.
std::vector<Image::Reference> references(const ir::Program& program);

}  // namespace servogate::plc::code
