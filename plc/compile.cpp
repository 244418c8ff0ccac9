// SPDX-License-Identifier: Apache-2.0
#include "plc/compile.hpp"

#include "plc/code/generator.hpp"
#include "plc/front_end.hpp"
#include "plc/library/standard_blocks.hpp"
#include "plc/sema/analyzer.hpp"
#include "plc/syntax/parser.hpp"

namespace servogate::plc {

std::optional<ir::Program> analyze(const std::vector<SourceFile>& files,
                                   const std::vector<image::Symbol>& symbols, const Options& options,
                                   syntax::Report& report) {
  syntax::Source source;
  for (std::size_t i = 0; i < files.size(); ++i)
    syntax::parse_st(files[i].text, static_cast<int>(i), source, report);
  // A tree with holes gives follow-up findings; what stands before the hole is worth checking only when
  // whole.
  if (report.failed()) return std::nullopt;
  const auto library = static_cast<int>(files.size());
  report.hide(library);
  syntax::parse_st(library::standard_blocks(), library, source, report);
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

CompileResult compile(std::vector<SourceFile> files, std::vector<image::Symbol> symbols,
                      const Options& options) {
  syntax::Report report(file_names(files), options.warnings);
  CompileResult out;
  if (auto program = analyze(files, symbols, options, report))
    out.image = code::Generator(std::move(*program), options, report).run();
  if (report.failed()) out.image = nullptr;
  out.findings = report.take();
  return out;
}

}  // namespace servogate::plc
