// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "firmware_if/text/finding.hpp"
#include "machine/keys/key.hpp"

namespace servogate::machine {

/// JSON schema (draft 7) of a section, its nested tables inside. `title` names the document.
std::string schema_of(const Section& section, const std::string& title);
/// The reference of the machine file (docs/machine-file.md, docs/ru/machine-file.md) in one language.
std::string reference_markdown(text::Language language);

}  // namespace servogate::machine
