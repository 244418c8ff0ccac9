// SPDX-License-Identifier: Apache-2.0
#include "plc/compile.hpp"

#include <algorithm>

#include "plc/code/generator.hpp"
#include "plc/front_end.hpp"
#include "plc/ladder/drawing.hpp"
#include "plc/library/motion_blocks.hpp"
#include "plc/library/standard_blocks.hpp"
#include "plc/plcopen/plcopen.hpp"
#include "plc/sema/analyzer.hpp"
#include "plc/syntax/parser.hpp"

namespace servogate::plc {

std::optional<ir::Program> analyze(const std::vector<SourceFile>& files,
                                   const std::vector<image::Symbol>& symbols, const Options& options,
                                   syntax::Report& report) {
  syntax::Source source;
  for (std::size_t i = 0; i < files.size(); ++i)
    if (plcopen::is_xml(files[i].text))
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
// Each finding gets the line that it speaks of.
void show_sources(const std::vector<SourceFile>& files, std::vector<text::Finding>& findings) {
  for (text::Finding& f : findings) {
    const auto file =
        std::find_if(files.begin(), files.end(), [&](const SourceFile& s) { return s.name == f.file; });
    if (file == files.end()) continue;
    std::size_t begin = 0;
    for (int line = 1; line < f.line && begin != std::string::npos; ++line) {
      begin = file->text.find('\n', begin);
      if (begin != std::string::npos) ++begin;
    }
    if (begin == std::string::npos) continue;
    f.source = file->text.substr(begin, file->text.find('\n', begin) - begin);
    while (!f.source.empty() && f.source.back() == '\r') f.source.pop_back();
  }
}
}  // namespace

CompileResult compile(std::vector<SourceFile> files, std::vector<image::Symbol> symbols,
                      const Options& options) {
  syntax::Report report(file_names(files), options.warnings);
  CompileResult out;
  if (auto program = analyze(files, symbols, options, report))
    out.image = code::Generator(std::move(*program), options, report).run();
  if (report.failed()) out.image = nullptr;
  out.findings = report.take();
  show_sources(files, out.findings);
  return out;
}

}  // namespace servogate::plc
