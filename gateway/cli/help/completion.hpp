// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace CLI {
class App;
}

namespace servogate::gateway {

/// A script for bash that completes the commands of `app`, their options and the words that options allow;
/// everything else is a file name. Made from the declarations, so that it knows what the program knows.
/// zsh reads it through its bashcompinit. Not real-time safe.
std::string bash_completion(const CLI::App& app);

}  // namespace servogate::gateway
