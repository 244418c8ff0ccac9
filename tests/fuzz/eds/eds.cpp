// SPDX-License-Identifier: Apache-2.0
// EDS and DCF files from arbitrary bytes.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "firmware_if/canopen/306/eds.hpp"

using namespace servogate;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  canopen::EdsResult r = canopen::read_eds(text, "fuzz.eds");
  for (const text::Finding& f : r.findings)
    if (f.entry == nullptr || f.line < 1 || f.str(text::Language::russian).empty()) std::abort();
  (void)canopen::object_specs(r.eds, 1);
  if (!r.ok()) return 0;
  if (!r.eds.commissioning) r.eds.commissioning = canopen::EdsCommissioning{};
  if (canopen::read_eds(canopen::write_dcf(r.eds), "fuzz.dcf").eds != r.eds) std::abort();
  return 0;
}
