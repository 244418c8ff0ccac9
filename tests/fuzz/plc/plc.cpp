// SPDX-License-Identifier: Apache-2.0
// Any bytes as PLC source: the compiler must answer with findings or a program, and a program must run a few
// scans within its budget, whatever it does.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "plc/compile.hpp"
#include "plc/engine.hpp"
#include "plc/lookup.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace servogate;
  plc::Options options;
  options.instruction_budget = 20'000;
  const auto symbols = image::interface_symbols(1, {"X"}, 1);
  const plc::CompileResult r =
      plc::compile({{"fuzz.st", std::string(reinterpret_cast<const char*>(data), size)}}, symbols, options);
  bool errors = false;
  for (const text::Finding& f : r.findings) {
    errors = errors || f.severity == text::Severity::error;
    if (f.str(text::Language::russian).empty()) std::abort();
  }
  if (r.ok() == errors) std::abort();
  if (!r.ok()) return 0;
  plc::Engine engine(r.image);
  image::Packets packets;
  for (int scan = 0; scan < 3; ++scan) engine.scan(packets, scan * 10 * image::kMillisecond);
  std::size_t shown = 0;
  for (const std::string& name : plc::variable_names(*r.image))
    if (const auto h = engine.find(name)) shown += engine.read(*h).size();
  engine.restore(engine.retained());
  return shown > (std::size_t{1} << 40);
}
