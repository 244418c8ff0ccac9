// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>

#include "gateway/cli/options.hpp"

namespace servogate::gateway {

namespace {

struct ClientCommand {
  const char* name;
  const char* meaning;
  const char* arguments;  ///< nullptr: takes none
  const char* example;
  bool waits = false;  ///< takes --wait
};

constexpr ClientCommand kClients[] = {
    {"status", "Shows modes, axes, program and alarms of the running control.", nullptr,
     "servogate status --json"},
    {"home", "References axes; without a name all of them, in the machine's order.", "AXIS...",
     "servogate home Z --wait", true},
    {"jog", "Moves one axis: a distance (+1mm, -0.5deg) or a direction (+ or -) until Enter or Ctrl-C.",
     "AXIS DISTANCE", "servogate jog X -1mm", true},
    {"zero", "Gives the present position of an axis a value in the active origin (0 if none is said).",
     "AXIS [VALUE]", "servogate zero X 0"},
    {"mdi", "Runs one block typed by hand.", "BLOCK", "servogate mdi \"G0 X10\" --wait", true},
    {"load", "Loads a part program.", "PROGRAM", "servogate load bracket.nc"},
    {"start", "Starts the loaded program.", nullptr, "servogate start --wait", true},
    {"step", "Runs one block.", nullptr, "servogate step", true},
    {"hold", "Feed hold: stops on the path.", nullptr, "servogate hold"},
    {"resume", "Goes on after a hold.", nullptr, "servogate resume"},
    {"reset", "Ends the program and clears alarms whose cause is gone.", nullptr, "servogate reset"},
    {"override", "Feed override in per cent, 0 to 150.", "PCT", "servogate override 80"},
    {"power", "Switches the drives on or off.", "on|off", "servogate power on --wait", true},
    {"input",
     "Plays an input of a mock machine: on, off, a number, or auto (a switch follows its axis again).",
     "POINT on|off|auto", "servogate input estop_chain_ok off"},
    {"alarms", "Lists the alarms with cause and remedy.", nullptr, "servogate alarms"},
    {"down", "Stops the axes in a controlled way, switches the drives off, ends the control.", nullptr,
     "servogate down"},
};

void add_clock(CLI::App& app, bool& is_virtual, std::string& realtime) {
  auto* v = app.add_flag("--virtual", is_virtual, "Virtual time (mock buses only)");
  auto* r =
      app.add_option("--realtime", realtime, "Real time; =best-effort goes on without the rights for it")
          ->expected(0, 1)
          ->default_str("strict")
          ->check(CLI::IsMember({"strict", "best-effort"}));
  v->excludes(r);
}

/// Put before `-`, `-1mm`, `-5`, so that the parser takes them for the arguments that they are.
constexpr char kShield = '\x01';

bool negative(std::string_view a) {
  return a == "-" || (a.size() > 1 && a[0] == '-' && (a[1] == '.' || (a[1] >= '0' && a[1] <= '9')));
}

/// The arguments as CLI11 wants them: last one first, without the program's name.
std::vector<std::string> shielded(int argc, char** argv) {
  const bool client =
      argc > 1 && std::any_of(std::begin(kClients), std::end(kClients),
                              [&](const ClientCommand& c) { return c.name == std::string_view(argv[1]); });
  std::vector<std::string> arguments;
  for (int i = argc; i-- > 1;)
    arguments.push_back(client && negative(argv[i]) ? kShield + std::string(argv[i]) : argv[i]);
  return arguments;
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, char** argv, int& exit_code) {
  CommandLine line;
  for (int i = 0; i < argc; ++i)
    line.text += (i == 0 ? "" : " ") + std::string(i == 0 ? "servogate" : argv[i]);

  CLI::App app{"servogate: a Linux computer becomes the control of a machine"};
  app.name("servogate");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 alarm, program error or failed check, 2 wrong use or bad file,\n"
      "3 stopped by the operator, 4 infrastructure (bus, rights).\n"
      "`servogate COMMAND --help` shows each command with an example.");

  bool is_virtual = false;
  std::string realtime;

  auto* version = app.add_subcommand("version", "Shows version and commit.");
  version->add_flag("--json", line.json, "As JSON");
  version->footer("Example: servogate version --json");

  RunOptions& run = line.run;
  auto* r = app.add_subcommand("run", "Runs a part program on a machine: up, load, start, down in one.");
  r->add_option("MACHINE", run.machine, "Machine file (TOML)")->required();
  r->add_option("PROGRAM", run.program,
                "Part program; without one the machine is only switched on and homed");
  add_clock(*r, is_virtual, realtime);
  r->add_option("--trace", run.trace, "Writes one row a cycle to this CSV file");
  r->add_option("--report", run.report, "Writes the report to this JSON file");
  r->add_option("--html", run.html, "Writes the report to this HTML file");
  r->add_option("--record", run.record, "Records inputs and requests for `servogate replay`");
  r->add_option("--dialect", run.dialect, "Language of the program instead of the machine's own");
  r->add_option("--override", run.override_percent, "Feed override in per cent")
      ->check(CLI::Range(0.0, 150.0));
  r->add_option("--state", run.state, "State directory; without one a virtual run leaves no state behind");
  r->add_flag("--start-now", run.start_now,
              "Start without the operator's start, where the machine file allows it");
  r->add_flag("--json", run.json, "Prints the report as JSON on standard output");
  r->add_flag("-q,--quiet", run.quiet, "No progress");
  r->footer(
      "Example: servogate run examples/mill/machine.toml examples/mill/bracket.nc --virtual --html out.html");

  UpOptions& up = line.up;
  auto* u = app.add_subcommand("up", "Starts the resident control; the other commands are its clients.");
  u->add_option("MACHINE", up.machine, "Machine file (TOML)")->required();
  add_clock(*u, is_virtual, realtime);
  u->add_option("--speed", up.speed, "Virtual seconds per wall-clock second")->check(CLI::PositiveNumber);
  u->add_option("--state", up.state, "State directory instead of the machine file's");
  u->add_option("--socket", up.socket, "Control socket instead of the default");
  u->footer("Example: servogate up examples/mill/machine.toml --virtual --speed 10");

  for (const ClientCommand& c : kClients) {
    auto* s = app.add_subcommand(c.name, c.meaning);
    if (c.arguments != nullptr) s->add_option(c.arguments, line.client.arguments, "");
    s->add_option("--socket", line.client.socket, "Control socket instead of the default");
    s->add_flag("--json", line.client.json, "As JSON");
    if (c.waits)
      s->add_flag("--wait", line.client.wait,
                  "Waits until it has ended; exit 1 after an alarm, 3 when it was stopped");
    s->footer(std::string("Example: ") + c.example);
  }

  CheckOptions& check = line.check;
  auto* k = app.add_subcommand("check", "Validates a machine file, and programs against it, without moving.");
  k->add_option("MACHINE", check.machine, "Machine file (TOML)")->required();
  k->add_option("PROGRAM", check.programs, "Part programs");
  k->add_option("--dialect", check.dialect, "Language of the programs instead of the machine's own");
  k->add_flag("--json", check.json, "As JSON");
  k->footer("Example: servogate check examples/mill/machine.toml examples/mill/bracket.nc");

  CanonOptions& canon = line.canon;
  auto* c =
      app.add_subcommand("canon", "Prints the canonical commands of a program, one JSON object a line.");
  c->add_option("MACHINE", canon.machine, "Machine file (TOML)")->required();
  c->add_option("PROGRAM", canon.program, "Part program")->required();
  c->add_option("--dialect", canon.dialect, "Language of the program instead of the machine's own");
  c->footer("Example: servogate canon examples/mill/machine.toml examples/mill/bracket.nc | head");

  ReplayOptions& replay = line.replay;
  auto* p = app.add_subcommand("replay", "Runs a record again in virtual time and compares the set-points.");
  p->add_option("RECORD", replay.record, "File written by --record")->required();
  p->add_option("--trace", replay.trace, "Writes the trace of the replay to this CSV file");
  p->add_option("--against", replay.against, "Compares with this trace, byte by byte");
  p->add_flag("--json", replay.json, "As JSON");
  p->footer("Example: servogate replay run.record --against run.csv");

  auto* plc = app.add_subcommand("plc", "PLC programs without a machine.");
  plc->require_subcommand(1);
  auto* pr = plc->add_subcommand("run", "Runs Structured Text in virtual time, one JSON object a cycle.");
  pr->add_option("FILE", line.plc_run.files, "Source files")->required();
  pr->add_option("--cycles", line.plc_run.cycles, "Number of cycles")->check(CLI::PositiveNumber);
  pr->add_option("--cycle-ms", line.plc_run.cycle_ms, "Length of a cycle in ms")->check(CLI::PositiveNumber);
  pr->add_option("--set", line.plc_run.sets, "NAME=VALUE[@CYCLE], may be repeated")->allow_extra_args(false);
  pr->add_option("--print", line.plc_run.prints, "NAME,... to print")
      ->delimiter(',')
      ->allow_extra_args(false);
  pr->footer("Example: servogate plc run blink.st --cycles 100 --set start=TRUE@5 --print lamp,timer.ET");
  auto* pc = plc->add_subcommand("check", "Compiles Structured Text and prints what is wrong.");
  pc->add_option("FILE", line.plc_check.files, "Source files")->required();
  pc->add_option("--machine", line.plc_check.machine, "Machine file whose symbols the program uses");
  pc->footer("Example: servogate plc check mill.st --machine machine.toml");

  try {
    app.parse(shielded(argc, argv));
  } catch (const CLI::ParseError& e) {
    exit_code = app.exit(e) == 0 ? kDone : kWrongUse;
    return std::nullopt;
  }
  const ClockKind clock = is_virtual                  ? ClockKind::virtual_time
                          : realtime == "best-effort" ? ClockKind::realtime_best_effort
                          : r->count("--realtime") + u->count("--realtime") > 0 ? ClockKind::realtime
                                                                                : ClockKind::unset;
  line.run.clock = line.up.clock = clock;
  const CLI::App* chosen = app.get_subcommands().front();
  line.command = chosen->get_name();
  if (line.command == "plc") line.command += " " + chosen->get_subcommands().front()->get_name();
  line.client.command = line.command;
  for (std::string& argument : line.client.arguments)
    if (argument.starts_with(kShield)) argument.erase(0, 1);
  return line;
}

}  // namespace servogate::gateway
