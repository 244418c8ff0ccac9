// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/modbus_commands.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/quantities.hpp"

namespace servogate::gateway {

namespace {

void add_line(CLI::App& app, ModbusOptions& o) {
  app.add_option("LINE", o.line, "Url of the line, tcp:HOST:PORT or rtu:/dev/..., or MACHINE.toml#line")
      ->required();
  app.add_option("--baud", o.baud, "Rate of a serial line in bit/s, 1200 to 4000000")
      ->type_name("BIT/S")
      ->check(number_within({1'200.0, 4e6, text::both("bit/s", "бит/с"), true}));
  app.add_option("--parity", o.parity, "Parity of a serial line: none, even (the default) or odd")
      ->check(one_of({"none", "even", "odd"}));
  app.add_option("--stop-bits", o.stop_bits, "Stop bits of a serial line, 1 or 2")
      ->type_name("N")
      ->check(number_within({1.0, 2.0, "", true}));
  app.add_option("--timeout", o.timeout_ms, "Patience with an answer in ms, 1 to 60000")
      ->type_name("MS")
      ->check(number_within({1.0, 60'000.0, text::both("ms", "мс")}));
  app.add_flag("--json", o.json, "As JSON");
}

void add_place(CLI::App& app, ModbusOptions& o, std::vector<std::string> kinds, const char* meaning) {
  app.add_option("UNIT", o.unit, "Unit, 0 to 255")->required()->check(number_within({0.0, 255.0, "", true}));
  app.add_option("KIND", o.kind, meaning)->required()->check(one_of(std::move(kinds)));
  app.add_option("ADDRESS", o.address, "The first one, as on the wire, 0 to 65535")
      ->required()
      ->check(number_within({0.0, 65'535.0, "", true}));
}

}  // namespace

void add_modbus_commands(CLI::App& app, BusCommands& options) {
  CLI::App& modbus = *app.add_subcommand("modbus", "A Modbus line by hand, where no control uses it.");
  modbus.require_subcommand(1);

  ModbusOptions& r = options.modbus_read;
  CLI::App& read = *modbus.add_subcommand("read", "Reads inputs or registers of a unit.");
  add_line(read, r);
  add_place(read, r, {"coils", "inputs", "registers", "input-registers"},
            "coils, inputs, registers or input-registers");
  read.add_option("COUNT", r.count, "How many, 1 to 2000")->check(number_within({1.0, 2'000.0, "", true}));
  read.footer("Example: servogate modbus read tcp:10.0.0.5:502 1 input-registers 0 4");

  ModbusOptions& w = options.modbus_write;
  CLI::App& write = *modbus.add_subcommand("write", "Writes coils or registers of a unit.");
  add_line(write, w);
  add_place(write, w, {"coils", "registers"}, "coils or registers");
  write.add_option("VALUE", w.values, "Of coils: 0 or 1; of registers: 0 to 65535 or 0x0 to 0xFFFF")
      ->required();
  write.add_flag("--i-may-move", w.may_move, "What is connected may move");
  write.footer("Example: servogate modbus write rtu:/dev/ttyUSB0 1 coils 3 1 --i-may-move");

  ModbusOptions& s = options.modbus_scan;
  CLI::App& scan = *modbus.add_subcommand("scan", "Which units answer on a line.");
  add_line(scan, s);
  scan.add_option("--from", s.first, "First unit, 1 to 247")
      ->type_name("N")
      ->check(number_within({1.0, 247.0, "", true}));
  scan.add_option("--to", s.last, "Last unit, 1 to 247")
      ->type_name("N")
      ->check(number_within({1.0, 247.0, "", true}));
  scan.footer("Example: servogate modbus scan rtu:/dev/ttyUSB0 --parity none --timeout 100");
}

}  // namespace servogate::gateway
