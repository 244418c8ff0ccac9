// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "plc/compile.hpp"
#include "plc/engine.hpp"
#include "plc/front_end.hpp"
#include "plc/lookup.hpp"
#include "plc/values.hpp"
#include "plc/vm/image.hpp"
#include "tests/plc/evaluator.hpp"
#include "tests/plc/random_program.hpp"

namespace servogate::plc {
namespace {

constexpr int kScans = 3;

/// Runs a program both ways; what differs, or empty. `outcomes` counts how the programs ended.
std::string difference(const std::string& source, std::map<Fault, int>& outcomes) {
  Options options;
  options.warnings = false;
  const std::vector<SourceFile> files = {{"random.st", source}};
  const CompileResult compiled = compile(files, {}, options);
  if (!compiled.ok())
    return compiled.findings.empty() ? "no image" : compiled.findings[0].str(text::Language::english);
  syntax::Report report(file_names(files), false);
  auto program = analyze(files, {}, options, report);
  if (!program) return "analysed differently";
  Evaluator reference(std::move(*program));
  Engine engine(compiled.image);
  image::Packets packets;
  for (int scan = 0; scan < kScans; ++scan) {
    const ScanResult r = engine.scan(packets, scan * image::kMillisecond);
    const Fault expected = reference.scan();
    if (r.fault != expected)
      return "fault " + std::to_string(static_cast<int>(r.fault)) + " instead of " +
             std::to_string(static_cast<int>(expected));
    if (r.fault != Fault::none || scan + 1 == kScans) ++outcomes[r.fault];
    if (r.fault != Fault::none) return {};
    for (const std::string& name : variable_names(*compiled.image)) {
      const Handle h = *engine.find(name);
      const std::string is = engine.read(h), should = to_json(*h.type, reference.memory.data() + h.address);
      if (is != should)
        return name + " is " + is + " instead of " + should + " after scan " + std::to_string(scan + 1);
    }
  }
  return {};
}

TEST(TwoPaths, machine_and_tree_walk_agree_on_random_programs) {
  const char* given = std::getenv("SERVOGATE_SEED");
  const std::uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 10) : 20'260'101;
  const int count = 400;
  std::printf("seeds %llu to %llu\n", static_cast<unsigned long long>(first),
              static_cast<unsigned long long>(first + count - 1));
  std::map<Fault, int> outcomes;
  for (int i = 0; i < count; ++i) {
    const std::string source = random_program(first + static_cast<std::uint64_t>(i));
    const std::string what = difference(source, outcomes);
    ASSERT_EQ(what, "") << "seed " << first + static_cast<std::uint64_t>(i) << "\n" << source;
  }
  EXPECT_GT(outcomes[Fault::none], count / 3) << "most programs must run through";
  EXPECT_GT(
      outcomes[Fault::division_by_zero] + outcomes[Fault::index_out_of_range] + outcomes[Fault::conversion],
      10);
}

}  // namespace
}  // namespace servogate::plc
