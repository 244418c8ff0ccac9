// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/program/program_file.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "kernel/program/languages/languages.hpp"
#include "machine/files/encoding.hpp"
#include "machine/files/read_file.hpp"
#include "machine/files/spooled_file.hpp"

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

namespace {

constexpr std::int64_t kSmall = std::int64_t{4} << 20;  ///< bytes of a program that is read into memory

/// A large program stays in a file that nobody else sees.
class SpooledText final : public program::ProgramText::Store {
 public:
  std::string_view content() const noexcept override { return file.content(); }
  void leave(std::size_t from, std::size_t to) const noexcept override { file.leave(from, to); }
  std::shared_ptr<const Store> hold(const std::function<std::string()>& next) const override {
    auto other = std::make_shared<SpooledText>();
    return other->file.hold(next, files::kMostOfProgram).empty() ? other : nullptr;
  }
  files::SpooledFile file;
};

std::optional<program::ProgramText> read_program(const std::string& path, std::string& reason) {
  const std::int64_t size = files::size_of(path);
  if (size <= kSmall) {
    auto content = files::read_file(path, files::kMostOfProgram, reason);
    if (!content) return std::nullopt;
    return program::ProgramText(std::move(*content));
  }
  auto spooled = std::make_shared<SpooledText>();
  reason = spooled->file.open(path, files::kMostOfProgram);
  if (!reason.empty()) return std::nullopt;
  return program::ProgramText(std::move(spooled));
}

struct NotUtf8 {
  int line = 0;  ///< 0: all of it is UTF-8
  std::string likely;
};

/// Piece by piece, cut behind a line end.
NotUtf8 find_other_encoding(const program::ProgramText& text) {
  const std::string_view all = text.view();
  int lines = 0;
  for (std::size_t from = 0; from < all.size();) {
    std::size_t to = all.size();
    if (to - from > static_cast<std::size_t>(kSmall))
      to = all.rfind('\n', from + static_cast<std::size_t>(kSmall));
    to = to == std::string_view::npos || to < from ? all.size() : std::min(to + 1, all.size());
    const std::string_view part = all.substr(from, to - from);
    if (const int line = files::first_line_not_utf8(part); line > 0)
      return {lines + line, std::string(files::likely_russian_encoding(part))};
    lines += static_cast<int>(std::count(part.begin(), part.end(), '\n'));
    text.leave(from, to);
    from = to;
  }
  return {};
}

}  // namespace

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
  const std::optional<program::ProgramText> text = read_program(path, reason);
  if (!text) return error(files::kCannotRead, {reason});
  if (const NotUtf8 other = find_other_encoding(*text); other.line > 0)
    findings.push_back({text::Severity::warning,
                        path,
                        other.line,
                        1,
                        other.likely.empty() ? &kNotUtf8 : &kLikelyEncoding,
                        {other.likely}});
  out.path = path;
  out.text = *text;
  out.model = program_model(machine, out.process);
  out.loader = program_loader(path);
  return true;
}

}  // namespace servogate::gateway
