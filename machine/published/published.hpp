// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "machine/keys/key.hpp"

namespace servogate::machine {

/// JSON schema (draft 7) of a section, its nested tables inside. `title` names the document.
std::string schema_of(const Section& section, const std::string& title);
/// Tables of a section and its nested tables in Markdown, English and Russian meanings side by side.
std::string markdown_of(const Section& section);

}  // namespace servogate::machine
