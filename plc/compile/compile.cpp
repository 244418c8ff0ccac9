// SPDX-License-Identifier: Apache-2.0
#include "plc/compile/compile.hpp"

#include <algorithm>
#include <map>
#include <string_view>

#include "plc/code/generator.hpp"
#include "plc/compile/front_end.hpp"
#include "plc/ladder/drawing.hpp"
#include "plc/library/motion_blocks.hpp"
#include "plc/library/standard_blocks.hpp"
#include "plc/plcopen/plcopen.hpp"
#include "plc/sema/analyzer.hpp"
#include "plc/syntax/parser.hpp"
#include "plc/terms/texts.hpp"

namespace servogate::plc {

namespace {
// By its mark, or because every other byte of its first characters is 0.
bool is_utf16(std::string_view text) {
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
         (text.size() >= 2 && (text[0] == '\0') != (text[1] == '\0'));
}
// Lines of old systems end with CR alone.
void end_lines(std::string& text) {
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
}
}  // namespace

std::optional<ir::Program> analyze(const std::vector<SourceFile>& files,
                                   const std::vector<image::Symbol>& symbols, const Options& options,
                                   syntax::Report& report) {
  syntax::Source source;
  for (std::size_t i = 0; i < files.size(); ++i)
    if (is_utf16(files[i].text))
      report.error({static_cast<std::int16_t>(i), 1, 1}, texts::kUtf16);
    else if (plcopen::is_xml(files[i].text))
      plcopen::parse(files[i].text, static_cast<int>(i), source, report);
    else
      syntax::parse_st(files[i].text, static_cast<int>(i), source, report);
  for (syntax::Unit& u : source.units) {
    if (u.ladder.empty()) continue;
    const std::size_t errors = report.errors();
    ladder::read_drawing(u, report);
    source.body_errors += report.errors() - errors;
  }
  // Declarations with holes give follow-up findings. Bodies are whole statements, each by itself.
  if (report.errors() > source.body_errors) return std::nullopt;
  if (report.failed()) report.no_warnings();
  const auto library = static_cast<int>(files.size());
  report.hide(library);
  syntax::parse_st(library::standard_blocks() + library::motion_blocks(), library, source, report);
  ir::Program program = sema::Analyzer(source, symbols, options, library, report).run();
  if (report.failed()) return std::nullopt;
  return program;
}

std::vector<std::string> file_names(const std::vector<SourceFile>& files) {
  std::vector<std::string> names;
  for (const SourceFile& f : files) names.push_back(f.name);
  names.emplace_back(library::kFileName);
  return names;
}

namespace {
/// Where the lines of a text begin.
std::vector<std::size_t> line_starts(std::string_view text) {
  std::vector<std::size_t> out = {0};
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
    out.push_back(at + 1);
  return out;
}

// Each finding gets the line that it speaks of.
void show_sources(const std::vector<SourceFile>& files, std::vector<text::Finding>& findings) {
  std::map<std::string_view, std::vector<std::size_t>> starts;
  for (text::Finding& f : findings) {
    const auto file =
        std::find_if(files.begin(), files.end(), [&](const SourceFile& s) { return s.name == f.file; });
    if (file == files.end()) continue;
    auto& lines = starts[file->name];
    if (lines.empty()) lines = line_starts(file->text);
    if (f.line > std::ssize(lines)) continue;
    const std::size_t begin = lines[static_cast<std::size_t>(std::max(f.line, 1)) - 1];
    f.source = file->text.substr(begin, file->text.find('\n', begin) - begin);
    while (!f.source.empty() && f.source.back() == '\r') f.source.pop_back();
  }
}
}  // namespace

CompileResult compile(std::vector<SourceFile> files, std::vector<image::Symbol> symbols,
                      const Options& options) {
  for (SourceFile& f : files) end_lines(f.text);
  syntax::Report report(file_names(files), options.warnings, options.stop);
  CompileResult out;
  try {
    if (auto program = analyze(files, symbols, options, report))
      out.image = code::Generator(std::move(*program), options, report).run();
  } catch (const syntax::Cancelled&) {
    if (!report.failed()) report.error({}, texts::kCancelled);
  }
  if (report.failed()) out.image = nullptr;
  out.findings = report.take();
  show_sources(files, out.findings);
  return out;
}

}  // namespace servogate::plc
