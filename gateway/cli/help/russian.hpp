// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace CLI {
class App;
}

/// What `--help` says, in Russian. Commands describe themselves in English where they are declared; this is
/// the catalogue of translations. Not real-time safe.
namespace servogate::gateway {

/// The Russian of a description; the English itself where the catalogue has none (a test looks for these).
std::string_view russian(std::string_view english);

/// Descriptions, headings and footers of an application and all its commands.
void speak_russian(CLI::App& app);

}  // namespace servogate::gateway
