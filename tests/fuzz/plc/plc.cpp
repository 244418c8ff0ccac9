// SPDX-License-Identifier: Apache-2.0
// Any bytes as PLC source, or as the body of a prepared program in Instruction List or ladder: the compiler
// must answer with findings or a program, and a program must run a few scans within its budget, whatever it
// does.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "plc/compile/compile.hpp"
#include "plc/engine/engine.hpp"
#include "plc/variables/lookup.hpp"

namespace {

// The first byte chooses: 1 a body of Instruction List, 2 a ladder, 3 a body of an XML file, else a whole
// file.
std::string source_of(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (size == 0 || data[0] < 1 || data[0] > 3) return text;
  const std::string head =
      "PROGRAM Main\nVAR a, b, c : BOOL; n, m : INT; r : REAL; s : STRING; t : TON; k : CTU; f : SR;\n"
      "l : ARRAY[1..3] OF INT; END_VAR\n";
  if (data[0] == 1) return head + "LD a\n" + text.substr(1) + "\nEND_PROGRAM\n";
  if (data[0] == 2) return head + "LADDER\n" + text.substr(1) + "\nEND_LADDER\nEND_PROGRAM\n";
  return "<project><types><pous><pou name='Main' pouType='program'><interface><localVars><variable name='a'>"
         "<type><BOOL/></type></variable><variable name='n'><type><INT/></type></variable><variable name='t'>"
         "<type><derived name='TON'/></type></variable></localVars></interface><body>" +
         text.substr(1) + "</body></pou></pous></types></project>";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace servogate;
  plc::Options options;
  options.instruction_budget = 20'000;
  const auto symbols = image::interface_symbols(1, {"X"}, 1);
  const plc::CompileResult r = plc::compile({{"fuzz.st", source_of(data, size)}}, symbols, options);
  bool errors = false;
  for (const text::Finding& f : r.findings) {
    errors = errors || f.severity == text::Severity::error;
    if (f.str(text::Language::russian).empty()) std::abort();
    if (f.excerpt().size() > 2000) std::abort();
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
