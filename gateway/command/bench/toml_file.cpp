// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/toml_file.hpp"

#include "gateway/cli/messages.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {
namespace {

const text::Entry kWrong{"bench.file", "{0}:{1}: {2}", "{0}:{1}: {2}"};
const text::Entry kSyntax{"bench.file-syntax", "not TOML: {0}", "не TOML: {0}"};

}  // namespace

std::nullopt_t wrong_line(const std::string& path, int line, const text::Entry& entry,
                          const std::vector<std::string>& arguments) {
  complain(kWrong, {path, std::to_string(line), text::render(entry, arguments, text::user_language())});
  return std::nullopt;
}

std::optional<machine::Document> read_toml(const std::string& path) {
  std::string why;
  const auto bytes = files::read_file(path, files::kMostOfSettings, why);
  if (!bytes) {
    complain(kCannotRead, {path, why});
    return std::nullopt;
  }
  machine::Document document = machine::read_document(*bytes);
  if (!document.ok()) return wrong_line(path, document.error_at.line, kSyntax, {document.error});
  return document;
}

}  // namespace servogate::gateway::command
