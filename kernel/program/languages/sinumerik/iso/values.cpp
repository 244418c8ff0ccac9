// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "kernel/program/reading/block.hpp"

/// Expressions in place of numbers: variables of macros (specification 16.2).
namespace servogate::program::sinumerik::iso {

bool value_of_macro(BlockText& text, Value& value) {
  if (text.line[text.pos] != '=' || value.negative) return false;
  ++text.pos;
  text.expression(value);
  value.fraction = true;  // as it stands, whatever notation is chosen
  return true;
}

bool no_value_of_macro(BlockText& text, Value&) {
  if (text.line[text.pos] != '=') return false;
  std::size_t start = text.pos;
  while (start > 0 && text.line[start - 1] == ' ') --start;
  fail(Wrong::macro_value, static_cast<int>(start), {std::string(text.line.substr(start - 1, 1)) + "="});
}

}  // namespace servogate::program::sinumerik::iso
