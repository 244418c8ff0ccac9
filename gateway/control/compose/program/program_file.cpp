// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_file.hpp"

#include <algorithm>

#include "kernel/program/languages/languages.hpp"
#include "machine/files/encoding.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway {

namespace {

const text::Entry kNotUtf8{
    "program.not-utf8",
    "the text is not UTF-8: words in it cannot be shown. Convert it from what the old control wrote: "
    "iconv -f CP1251 -t UTF-8 (or CP866, KOI8-R)",
    "текст не в UTF-8: слова в нём не показать. Преобразуйте из кодировки старой системы: "
    "iconv -f CP1251 -t UTF-8 (или CP866, KOI8-R)"};
const text::Entry kLikelyEncoding{
    "program.not-utf8",
    "the text is not UTF-8 but looks like {0}: words in it cannot be shown. Convert it: iconv -f {0} -t "
    "UTF-8",
    "текст не в UTF-8, похоже на {0}: слова в нём не показать. Преобразуйте: iconv -f {0} -t UTF-8"};

}  // namespace

const text::Entry kUnknownDialect{"cli.unknown-dialect", "dialect '{0}' is not known; known: {1}",
                                  "диалект «{0}» неизвестен; известны: {1}"};

bool known_dialect(const std::string& dialect) {
  const std::vector<std::string> known = program::dialects();
  return std::find(known.begin(), known.end(), dialect) != known.end();
}

std::string dialect_names() {
  std::string list;
  for (const std::string& name : program::dialects()) list += (list.empty() ? "" : ", ") + name;
  return list;
}

bool open_program(const machine::MachineConfig& machine, const std::string& path, const std::string& dialect,
                  ProgramFile& out, std::vector<text::Finding>& findings) {
  const auto error = [&](const text::Entry& entry, std::vector<std::string> arguments) {
    findings.push_back({text::Severity::error, path, 1, 1, &entry, std::move(arguments)});
    return false;
  };
  out.dialect = dialect.empty() ? machine.control.dialect : dialect;
  if (!known_dialect(out.dialect)) return error(kUnknownDialect, {out.dialect, dialect_names()});
  std::string reason;
  auto content = files::read_file(path, files::kMostOfProgram, reason);
  if (!content) return error(files::kCannotRead, {reason});
  if (const int line = files::first_line_not_utf8(*content); line > 0) {
    const std::string likely(files::likely_russian_encoding(*content));
    findings.push_back(
        {text::Severity::warning, path, line, 1, likely.empty() ? &kNotUtf8 : &kLikelyEncoding, {likely}});
  }
  out.path = path;
  out.text = std::move(*content);
  out.model = program_model(machine, out.process);
  out.loader = program_loader(path);
  return true;
}

}  // namespace servogate::gateway
