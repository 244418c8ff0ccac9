// SPDX-License-Identifier: Apache-2.0
#include "tests/plc/two_paths/two_paths.hpp"

#include "plc/compile/compile.hpp"
#include "plc/compile/front_end.hpp"
#include "plc/variables/lookup.hpp"
#include "plc/variables/values.hpp"
#include "plc/vm/image.hpp"
#include "tests/plc/two_paths/evaluator.hpp"

namespace servogate::plc {

namespace {

constexpr int kScans = 3;

std::string unequal_variable(const Engine& engine, const Evaluator& reference) {
  for (const std::string& name : variable_names(engine.image())) {
    const Handle h = *engine.find(name);
    const std::string is = engine.read(h), should = to_json(*h.type, reference.memory.data() + h.address);
    if (is != should) return name + " is " + is + " instead of " + should;
  }
  return {};
}

}  // namespace

Comparison run_both_ways(const std::string& source) {
  Options options;
  options.warnings = false;
  options.instruction_budget = 100'000'000;  // the evaluator counts in other steps
  const std::vector<SourceFile> files = {{"random.st", source}};
  const CompileResult compiled = compile(files, {}, options);
  if (!compiled.ok())
    return {compiled.findings.empty() ? "no image" : compiled.findings[0].str(text::Language::english)};
  syntax::Report report(file_names(files), false);
  auto program = analyze(files, {}, options, report);
  if (!program) return {"analysed differently"};
  Evaluator reference(std::move(*program));
  Engine engine(compiled.image);
  image::Packets packets;
  for (int scan = 1; scan <= kScans; ++scan) {
    const Fault is = engine.scan(packets, scan * image::kMillisecond).fault, should = reference.scan();
    if (is != should)
      return {"fault " + std::to_string(static_cast<int>(is)) + " instead of " +
              std::to_string(static_cast<int>(should)) + " in scan " + std::to_string(scan)};
    if (is != Fault::none) return {{}, is};
    if (const std::string what = unequal_variable(engine, reference); !what.empty())
      return {what + " after scan " + std::to_string(scan)};
  }
  return {};
}

}  // namespace servogate::plc
