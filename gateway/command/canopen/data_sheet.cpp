// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/data_sheet.hpp"

#include "gateway/cli/messages.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kCannotRead{"eds.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};

}  // namespace

std::optional<canopen::Eds> read_data_sheet(const std::string& path) {
  std::string why;
  const auto bytes = files::read_file(path, files::kMostOfSource, why);
  if (!bytes) {
    complain(kCannotRead, {path, why});
    return std::nullopt;
  }
  canopen::EdsResult result = canopen::read_eds(*bytes, path);
  print_findings(result.findings);
  if (!result.ok()) return std::nullopt;
  return std::move(result.eds);
}

}  // namespace servogate::gateway::command
