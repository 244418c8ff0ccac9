// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace servogate::gateway {

/// The manual page servogate(1) in the macros of man(7), in the user's language, made from the declarations.
/// Not real-time safe.
std::string manual_page(CLI::App& app);

}  // namespace servogate::gateway
