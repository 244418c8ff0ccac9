// SPDX-License-Identifier: Apache-2.0
// Where tests find what they read and write. One source knows the paths of this checkout, so that the objects
// of all others are the same in every folder, and a compiler cache serves them.
#pragma once
#include <string>

namespace servogate::tests {

/// The root of the source tree, absolute, without a slash at its end.
const std::string& source_dir();

/// The root of the build tree, absolute, without a slash at its end.
const std::string& binary_dir();

/// The program servogate of this build. A test that starts it depends on it in CMake: add_dependencies(...
/// servogate).
const std::string& program();

/// The cmake that configured this build.
const std::string& cmake();

}  // namespace servogate::tests
