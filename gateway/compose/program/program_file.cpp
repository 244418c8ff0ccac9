// SPDX-License-Identifier: Apache-2.0
#include "gateway/compose/program/program_file.hpp"

#include <algorithm>

#include "gateway/files/read_file.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNotUtf8{
    "program.not-utf8",
    "the text is not UTF-8: words in it cannot be shown. Convert it from what the old control wrote: "
    "iconv -f CP1251 -t UTF-8 (or CP866)",
    "текст не в UTF-8: слова в нём не показать. Преобразуйте из кодировки старой системы: "
    "iconv -f CP1251 -t UTF-8 (или CP866)"};

/// 0: all of it is UTF-8.
int first_line_not_utf8(std::string_view text) {
  int line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80                   ? 1
                               : lead >= 0xC2 && lead < 0xE0 ? 2
                               : lead >= 0xE0 && lead < 0xF0 ? 3
                               : lead >= 0xF0 && lead < 0xF5 ? 4
                                                             : 0;
    if (length == 0 || i + length > text.size()) return line;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0) != 0x80) return line;
    if (lead == '\n') ++line;
    i += length;
  }
  return 0;
}

}  // namespace

namespace {

std::string list_of(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

bool is_known(const std::string& dialect, const std::vector<std::string>& known) {
  return std::find(known.begin(), known.end(), dialect) != known.end();
}

}  // namespace

bool known_dialect(const std::string& dialect) {
  const std::vector<std::string> known = program::dialects();
  if (is_known(dialect, known)) return true;
  complain(kUnknownDialect, {dialect, list_of(known)});
  return false;
}

bool open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                  ProgramFile& out, std::vector<text::Finding>& findings) {
  const auto error = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    findings.push_back({text::Severity::error, path, 1, 1, &entry, std::move(arguments)});
    return false;
  };
  out.dialect = dialect.empty() ? machine.control.dialect : dialect;
  const std::vector<std::string> known = program::dialects();
  if (!is_known(out.dialect, known)) return error(kUnknownDialect, {out.dialect, list_of(known)});
  std::string reason;
  auto content = files::read_file(path, files::kMostOfProgram, reason);
  if (!content) return error(kCannotRead, {reason});
  if (const int line = first_line_not_utf8(*content); line > 0)
    findings.push_back({text::Severity::warning, path, line, 1, &kNotUtf8, {path}});
  out.path = path;
  out.text = std::move(*content);
  out.model = program_model(machine);
  out.loader = program_loader(path);
  return true;
}

int open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                 ProgramFile& out) {
  std::vector<text::Finding> findings;
  const bool opened = open_program(machine, path, dialect, out, findings);
  print_findings(findings);
  return opened ? kDone : kWrongUse;
}

}  // namespace servogate::gateway
