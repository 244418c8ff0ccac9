// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/inspect/object_catalogue.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway::command {

/// One access of `servogate sdo`.
struct SdoRequest {
  bool write = false;
  canopen::ObjectAddress at;
  const canopen::ValueType* type = nullptr;  ///< nullptr: by what comes
  bool type_given = false;         ///< on the command line, else of the object by that number in a drive
  std::vector<std::uint8_t> data;  ///< of a write
  std::string name;
};

/// Takes the words of the command line apart: `read OBJECT [TYPE] OBJECT [TYPE] ... write OBJECT VALUE [TYPE]
/// ...`. False: they are wrong, which has been said. Not real-time safe.
bool read_sdo_requests(const SdoOptions& options, const canopen::ObjectCatalogue& catalogue,
                       std::vector<SdoRequest>& requests);

/// The object that a word of the command line names; nullopt: none, which has been said.
std::optional<canopen::ObjectAddress> object_of_word(const std::string& word,
                                                     const canopen::ObjectCatalogue& catalogue);

}  // namespace servogate::gateway::command
