// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plc/terms/options.hpp"

namespace servogate::plc {

/// A change of the PLC that is prepared outside the cycle and carried out by a request of kind
/// image::RequestKind::logic, whose index is `number`. Records keep both.
struct LogicChange {
  enum class Kind : std::uint8_t {
    load,         ///< `files` replace the program
    force,        ///< `name` is held at `value`
    release,      ///< `name` is let go
    release_all,  ///< of variables; packet places have requests of their own
  };
  Kind kind = Kind::load;
  std::uint32_t number = 0;
  bool online = false;  ///< load: every variable keeps its value, not the retained ones only
  std::vector<SourceFile> files;
  std::string name, value;
};

}  // namespace servogate::plc
