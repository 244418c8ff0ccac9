// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/plc_commands.hpp"

#include <CLI/CLI.hpp>

#include "firmware_if/text/finding.hpp"
#include "gateway/cli/quantities.hpp"

namespace servogate::gateway {

namespace {

CLI::App& command(CLI::App& plc, const char* name, const char* meaning, const std::string& example) {
  CLI::App& app = *plc.add_subcommand(name, meaning);
  app.footer("Example: " + example);
  return app;
}

void run(CLI::App& plc, PlcRunOptions& o) {
  CLI::App& app = command(plc, "run", "Runs Structured Text in virtual time, one JSON object a cycle.",
                          "servogate plc run blink.st --cycles 100 --set start=TRUE@5 --print lamp,timer.ET");
  app.add_option("FILE", o.files, "Source files")->required();
  app.add_option("--cycles", o.cycles, "Number of cycles, 1 to 1000000000")
      ->type_name("N")
      ->check(number_within({1.0, 1e9, text::both("cycles", "циклов"), true}));
  app.add_option("--cycle-ms", o.cycle_ms, "Length of a cycle in ms, 0.001 to 60000")
      ->type_name("MS")
      ->check(number_within({0.001, 60000.0, text::both("ms", "мс")}));
  app.add_option("--set", o.sets, "NAME=VALUE[@CYCLE], may be repeated")->allow_extra_args(false);
  app.add_option("--print", o.prints, "NAME,... to print")->delimiter(',')->allow_extra_args(false);
}

void check(CLI::App& plc, PlcCheckOptions& o) {
  CLI::App& app = command(plc, "check", "Compiles Structured Text and prints what is wrong.",
                          "servogate plc check mill.st --machine machine.toml");
  app.add_option("FILE", o.files, "Source files")->required();
  app.add_option("--machine", o.machine, "Machine file whose symbols the program uses");
}

void test(CLI::App& plc, PlcTestOptions& o) {
  CLI::App& app = command(plc, "test", "Runs the tests of PLC programs in virtual time.",
                          "servogate plc test examples/mill/plc/mill.test");
  app.add_option("FILE", o.files, "Test files (.test), and sources that they need beside their own")
      ->required();
  app.add_option("--machine", o.machine, "Machine file instead of the one that a test names");
  app.add_flag("--json", o.json, "As JSON");
}

}  // namespace

void add_plc_commands(CLI::App& app, PlcCommands& options) {
  CLI::App& plc = *app.add_subcommand("plc", "PLC programs: without a machine, and in the running control.");
  plc.require_subcommand(1);
  run(plc, options.run);
  check(plc, options.check);
  test(plc, options.test);
}

}  // namespace servogate::gateway
