// SPDX-License-Identifier: Apache-2.0
// The words that a fuzzer of machine, device and state files has to know: made from the table of keys, so
// that it knows a new key too.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "machine/device.hpp"
#include "machine/keys/key.hpp"
#include "machine/keys/sections.hpp"
#include "machine/state/state_text.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

constexpr std::string_view kForms[] = {
    "[",       "[[",        "]\n",   "]]\n",    " = ",    "\"\"",     "{ ",       " }",
    ", ",      "true",      "false", "1 mm",    "\"\"\"", "'''",      "1e9",      "0x1F",
    "inf",     "nan",       "-1",    "\\u0416", "# \n",   "\xD0\x96", "\xC4\xBE", "checksum = \"none\"\n",
    "part = ", "1979-05-27"};

void add_section(const Section& section, const std::string& path, std::set<std::string>& words) {
  for (const Key& key : section.keys) {
    const std::string name(key.name);
    words.insert(name + " = ");
    for (const std::string_view choice : key.choices) words.insert("\"" + std::string(choice) + "\"");
    if (key.child == nullptr) continue;
    const std::string inner = path.empty() ? name : path + "." + name;
    words.insert(key.kind == KeyKind::tables ? "\n[[" + inner + "]]\n" : "\n[" + inner + "]\n");
    add_section(key.child(), inner, words);
  }
}

/// One entry of a libFuzzer dictionary.
std::string entry(std::string_view word) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : word) {
    const auto u = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (u < 0x20 || u >= 0x7F)
      out += std::string("\\x") + kHex[u >> 4] + kHex[u & 15];
    else
      out += c;
  }
  return out + "\"\n";
}

std::string dictionary() {
  std::set<std::string> words(std::begin(kForms), std::end(kForms));
  add_section(section_of<MachineConfig>(), {}, words);
  add_section(section_of<DeviceConfig>(), {}, words);
  for (const StatePart part : {StatePart::origins, StatePart::tools, StatePart::homing, StatePart::counters,
                               StatePart::gains, StatePart::records, StatePart::retained})
    words.insert("\"" + std::string(part_name(part)) + "\"");
  std::string out = "# Made from the table of keys; SERVOGATE_UPDATE=1 test_machine writes it anew.\n";
  for (const std::string& word : words) out += entry(word);
  return out;
}

TEST(FuzzDictionary, holds_every_key_of_the_files) {
  const std::string path = test::source("tests/fuzz/machine/machine.dict");
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) test::write_text(path, dictionary());
  EXPECT_EQ(test::read_text(path), dictionary()) << "SERVOGATE_UPDATE=1 test_machine writes it";
}

}  // namespace
}  // namespace servogate::machine
