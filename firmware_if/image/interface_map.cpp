// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/interface_map.hpp"

namespace servogate::image {

namespace {

template <std::size_t N>
void add(std::vector<Symbol>& out, const std::string& prefix, const InterfaceField (&table)[N],
         std::uint32_t base) {
  for (const InterfaceField& f : table)
    out.push_back({prefix + "." + std::string(f.name), place(f, base), f.writer, std::string(f.comment)});
}

std::string numbered(const char* name, int index) {
  return index == 0 ? name : name + std::to_string(index + 1);
}

template <std::size_t N>
void table(std::string& out, const std::string& title, const std::string& prefix, const std::string& base,
           const InterfaceField (&fields)[N]) {
  constexpr const char* kFormats[] = {"BL", "BY", "IN", "LI", "RE", "LR", "CH"};
  out += "\n## " + title + "\n\n" + base +
         "\n\n| symbol | byte | bit | format | written by | guard | meaning |\n|---|---|---|---|---|---|---|\n";
  for (const InterfaceField& f : fields) {
    const std::string bit = f.format == Format::bl ? std::to_string(f.bit) : std::string();
    out += "| `" + prefix + std::string(f.name) + "` | +" + std::to_string(f.byte) + " | " + bit + " | " +
           kFormats[static_cast<int>(f.format)] + " | " + (f.writer == Writer::nc ? "NC" : "PLC") + " | " +
           (f.guards ? "yes" : "") + " | " + std::string(f.comment) + " |\n";
  }
}

}  // namespace

std::string interface_page() {
  std::string out =
      "# The interface between NC and PLC\n\n"
      "Made from the tables in `firmware_if/image/interface_map.hpp`. All places lie in packet K from byte " +
      std::to_string(kInterfaceBase) +
      " on; part programs and PLC use the bytes below as they like. Bytes count from the beginning of the "
      "block; words are "
      "little-endian. In Structured Text every symbol is a global variable, in a part program the same place "
      "is `SKn`.\n\nA place with `yes` in the column *guard* guards motion or energy: it permits or stops "
      "them, or tells the PLC whether something moves. `plc force` forces and releases such a place only at "
      "standstill, and warning 6005 is active as long as it is forced. `MC.estop_ok` is never forced.\n";
  const auto at_byte = [](std::uint32_t byte) { return std::to_string(byte); };
  table(out, "Processes", "NC.",
        "`NC.` is process 1, `NC2.` process 2 and so on. Process p begins at byte " +
            at_byte(kInterfaceBase) + " + " + at_byte(kProcessBlock) + " (p - 1).",
        kProcessFields);
  table(out, "Axes", "X.",
        "The prefix is the axis' letter. Axis n in the order of the machine file begins at byte " +
            at_byte(axis_base(0)) + " + " + at_byte(kAxisBlock) + " (n - 1).",
        kAxisFields);
  table(out, "Spindles", "S.",
        "`S.` is the first spindle, `S2.` the second. The first begins at byte " + at_byte(spindle_base(0)) +
            ", the second at " + at_byte(spindle_base(1)) + ".",
        kSpindleFields);
  table(out, "Machine", "MC.", "Begins at byte " + at_byte(kMachineBase) + ".", kMachineFields);
  table(out, "Auxiliary axes", "U.",
        "Only of axes with `auxiliary = true` in the machine file: what the `MC_` blocks ([plc.md](plc.md)) "
        "and "
        "the control say to one another; programs use the blocks. Axis n in the order of the machine file "
        "begins "
        "at byte " +
            at_byte(motion_base(0)) + " + " + at_byte(kMotionBlock) + " (n - 1).",
        kMotionFields);
  out +=
      "\n## Handshake of M, S, T and H\n\nThe NC puts the code into its place and raises the strobe. The PLC "
      "sets the "
      "acknowledgement when the function is carried out and keeps it until the strobe falls; then it takes "
      "the "
      "acknowledgement back, and the program goes on. An M code that the PLC does not know is acknowledged "
      "together with "
      "`m_unknown`. Without an acknowledgement in time the program stops with an alarm that names the "
      "word.\n";
  return out;
}

std::vector<Symbol> interface_symbols(int processes, const std::vector<std::string>& axis_letters,
                                      int spindles, std::uint32_t auxiliary) {
  std::vector<Symbol> out;
  for (int p = 0; p < processes; ++p) add(out, numbered("NC", p), kProcessFields, process_base(p));
  for (std::size_t a = 0; a < axis_letters.size(); ++a)
    add(out, axis_letters[a], kAxisFields, axis_base(static_cast<int>(a)));
  for (std::size_t a = 0; a < axis_letters.size(); ++a)
    if ((auxiliary >> a & 1u) != 0)
      add(out, axis_letters[a], kMotionFields, motion_base(static_cast<int>(a)));
  for (int s = 0; s < spindles; ++s) add(out, numbered("S", s), kSpindleFields, spindle_base(s));
  add(out, "MC", kMachineFields, kMachineBase);
  return out;
}

}  // namespace servogate::image
