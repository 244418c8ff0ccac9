// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "plc/vm/image.hpp"

namespace servogate::plc::code {

/// Where every variable of the program's own files is read and written, in the order of files, lines and
/// columns. `image` has its places, programs and units already.
std::vector<Image::Reference> references(const ir::Program& program, const Image& image);

}  // namespace servogate::plc::code
