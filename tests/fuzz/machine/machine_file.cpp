// SPDX-License-Identifier: Apache-2.0
// Machine files, device files and state files from arbitrary bytes. The first byte chooses the reader.
// Seeds: examples/*/machine.toml and tests/machine/broken*/ with a byte before them.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "machine/consequences.hpp"
#include "machine/load.hpp"
#include "machine/state/state.hpp"

using namespace servogate;

namespace {

/// Every finding has words, and every error of a text a place in it.
void check(const std::vector<text::Finding>& findings) {
  for (const text::Finding& f : findings)
    if (f.entry == nullptr || f.line < 1 || f.column < 0 || f.str(text::Language::russian).empty())
      std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0] % 3) {
    case 0: {
      const machine::LoadResult r = machine::parse(text, "machine.toml");
      check(r.findings);
      (void)machine::to_json(r, machine::consequences(r));
      break;
    }
    case 1: {
      const machine::DeviceResult r = machine::parse_device(text, "device.toml");
      check(r.findings);
      if (r.ok()) (void)machine::drive_profile(r.device, {}, 1);
      break;
    }
    default: {
      machine::MachineState state;
      const auto part = static_cast<machine::StatePart>(data[0] / 3 % 6);
      check(machine::read_part(text, "state.toml", part, state));
    }
  }
  return 0;
}
