// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check/canon.hpp"

#include <memory>

#include "kernel/program/faults/texts.hpp"

namespace servogate::program {
namespace {

void take_effect(image::Packets& packets, const WritePlace& write) {
  if (write.place.format == image::Format::ch)
    packets.set_characters(write.place, write.characters);
  else
    packets.set_number(write.place, write.value);
}

text::Finding too_long(const Interpreter& interpreter, int file, int line, long long limit) {
  return {text::Severity::error,      interpreter.path(file), line, interpreter.column(file, line, -1),
          &entry(Fault::block_limit), {std::to_string(limit)}};
}

}  // namespace

std::optional<text::Finding> run_dry(Interpreter& interpreter,
                                     const std::function<bool(const Command&)>& on_command,
                                     long long block_limit,
                                     const std::function<bool(const text::Finding&)>& on_error) {
  const auto packets = std::make_unique<image::Packets>();
  packets->resize(interpreter.machine().k_bytes, interpreter.machine().syvar_bytes);
  int file = 0, line = 0;
  for (;;) {
    const Step step = interpreter.next(*packets, true);
    if (const auto* error = std::get_if<Error>(&step)) {
      const text::Finding finding = error->finding;
      if (!on_error || !on_error(finding) || !interpreter.pass_over_error()) return finding;
    }
    if (const auto* wait = std::get_if<NeedsSync>(&step)) line = wait->line;
    if (const auto* command = std::get_if<Command>(&step)) {
      file = command->file;
      line = command->line;
      if (const auto* write = std::get_if<WritePlace>(&command->what)) take_effect(*packets, *write);
      if (!on_command(*command) || std::holds_alternative<End>(command->what)) return std::nullopt;
    }
    if (interpreter.executed() > block_limit) return too_long(interpreter, file, line, block_limit);
  }
}

std::optional<text::Finding> write_canon(Interpreter& interpreter, const MachineModel& machine,
                                         const std::function<bool(std::string_view)>& line) {
  std::vector<std::string> letters;
  for (const auto& axis : machine.axes) letters.push_back(axis.letter);
  std::string text;
  const auto on_command = [&](const Command& command) {
    text.clear();
    append_json(text, command, letters, interpreter.files());
    return line(text);
  };
  return run_dry(interpreter, on_command, kDryRunBlocks);
}

}  // namespace servogate::program
