// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/commands/plc_commands.hpp"

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
  app.add_option("--print", o.prints, "NAME,... to print")->allow_extra_args(false);
}

void check(CLI::App& plc, PlcCheckOptions& o) {
  CLI::App& app = command(plc, "check", "Compiles Structured Text and prints what is wrong.",
                          "servogate plc check mill.st --machine machine.toml");
  app.add_option("FILE", o.files, "Source files")->required();
  app.add_option("--machine", o.machine, "Machine file whose symbols the program uses");
  app.add_flag("--json", o.json, "As JSON");
}

void test(CLI::App& plc, PlcTestOptions& o) {
  CLI::App& app = command(plc, "test", "Runs the tests of PLC programs in virtual time.",
                          "servogate plc test examples/mill/plc/mill.test");
  app.add_option("FILE", o.files, "Test files (.test), and sources that they need beside their own")
      ->required();
  app.add_option("--machine", o.machine, "Machine file instead of the one that a test names");
  app.add_option("--junit", o.junit, "Writes the results to this file as JUnit XML");
  app.add_flag("--json", o.json, "As JSON");
}

/// What all clients of the running control take.
void client(CLI::App& app, std::string& socket, bool& json) {
  app.add_option("--socket", socket, "Control socket instead of the default");
  app.add_flag("--json", json, "As JSON");
}

void list(CLI::App& plc, PlcListOptions& o) {
  CLI::App& app = command(plc, "list", "Lists symbols with type, place, and where they are read and written.",
                          "servogate plc list mill.st --machine machine.toml");
  app.add_option("FILE", o.files, "Source files; without one the program of the running control");
  app.add_option("--machine", o.machine, "Machine file whose symbols the program uses");
  client(app, o.socket, o.json);
}

/// What `watch` and `step` show.
void shown(CLI::App& app, std::vector<std::string>& names, std::string& body) {
  app.add_option("NAME", names, "Variables and places; without one the lines of the first program");
  app.add_option("--source", body, "Lines of this program or instance, as Mill or Mill.change")
      ->type_name("BODY");
}

void watch(CLI::App& plc, PlcWatchOptions& o) {
  CLI::App& app =
      command(plc, "watch", "Shows values of the running PLC, beside its source lines or by name.",
              "servogate plc watch NC.m_code Mill.change.step");
  shown(app, o.names, o.body);
  app.add_flag("--times", o.times, "How long tasks and blocks take");
  app.add_option("--every", o.every_ms, "Time between samples in ms, 1 to 60000")
      ->type_name("MS")
      ->check(number_within({1.0, 60000.0, text::both("ms", "мс")}));
  app.add_option("--samples", o.samples, "Number of samples, 1 to 1000000000; without it until Ctrl-C")
      ->type_name("N")
      ->check(number_within({1.0, 1e9, text::both("samples", "раз"), true}));
  client(app, o.socket, o.json);
}

void step(CLI::App& plc, PlcStepOptions& o) {
  CLI::App& app =
      command(plc, "step", "Holds the PLC of a control whose drives are off, and runs single scans.",
              "servogate plc step Mill.change.step lamp");
  shown(app, o.names, o.body);
  app.add_option(
         "--scans", o.scans,
         "Number of scans, 1 to 100000; without it one for each Enter, or as many as the number typed")
      ->type_name("N")
      ->check(number_within({1.0, 1e5, text::both("scans", "сканов"), true}));
  client(app, o.socket, o.json);
}

void force(CLI::App& plc, PlcForceOptions& o) {
  CLI::App& app = command(plc, "force", "Holds variables and places at values until Enter or Ctrl-C.",
                          "servogate plc force door_closed=TRUE");
  app.add_option("NAME=VALUE", o.settings,
                 "What is forced; with --release the names to let go, all without one");
  app.add_flag("--stay", o.stay,
               "Returns at once; it stays forced until --release or the end of the control");
  app.add_flag("--release", o.release, "Lets go what is forced");
  client(app, o.socket, o.json);
}

void load(CLI::App& plc, PlcLoadOptions& o) {
  CLI::App& app = command(plc, "load", "Gives the running control another PLC program, between two scans.",
                          "servogate plc load --online");
  app.add_option("FILE", o.files, "Source files; without one those of the machine file, read again");
  app.add_flag("--online", o.online,
               "Online change: every variable keeps its value, not the retained ones only");
  app.add_flag("--while-running", o.while_running, "Even while a program runs or an axis moves")
      ->needs("--online");
  client(app, o.socket, o.json);
}

}  // namespace

void add_plc_commands(CLI::App& app, PlcCommands& options) {
  CLI::App& plc = *app.add_subcommand("plc", "PLC programs: without a machine, and in the running control.");
  plc.require_subcommand(1);
  run(plc, options.run);
  check(plc, options.check);
  test(plc, options.test);
  list(plc, options.list);
  watch(plc, options.watch);
  step(plc, options.step);
  force(plc, options.force);
  load(plc, options.load);
}

}  // namespace servogate::gateway
