// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/text/finding.hpp"
#include "gateway/cli/commands/bench_commands.hpp"
#include "gateway/cli/commands/bus_commands.hpp"
#include "gateway/cli/commands/canopen_commands.hpp"
#include "gateway/cli/commands/modbus_commands.hpp"
#include "gateway/cli/commands/pendant_commands.hpp"
#include "gateway/cli/commands/plc_commands.hpp"
#include "gateway/cli/help/completion.hpp"
#include "gateway/cli/help/manual_page.hpp"
#include "gateway/cli/help/russian.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/quantities.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/cli/wrong_use.hpp"

namespace servogate::gateway {

namespace {

struct ClientCommand {
  const char* name;
  const char* meaning;
  const char* arguments;  ///< in their order; [OPTIONAL], MANY...
  const char* example;
  bool waits = false;       ///< takes --wait
  bool of_process = false;  ///< takes --process
};

constexpr ClientCommand kClients[] = {
    {"status", "Shows modes, axes, program and alarms of the running control.", "",
     "servogate status --json"},
    {"home", "References axes; without a name all of them, in the machine's order.", "[AXIS...]",
     "servogate home Z --wait", true},
    {"jog",
     "Moves one axis, and waits until it stands: a distance (+1mm, -0.5deg), or a direction (+ or -) until "
     "Enter or Ctrl-C.",
     "AXIS DISTANCE", "servogate jog X -1mm", true},
    {"zero", "Gives the present position of an axis a value in the active origin (0 if none is said).",
     "AXIS [VALUE]", "servogate zero X 0"},
    {"origin",
     "Lists and changes the origins: list, set N X100, here N X0 (where the axis stands gets that value), "
     "clear N, "
     "undo, import FILE, export FILE.",
     "ACTION [WORD...]", "servogate origin here 1 X0 Z12.5"},
    {"tool",
     "Lists and changes the tools: list, set N length=85 radius=5, here N Z12.5 (touch-off), clear N, undo, "
     "import "
     "FILE, export FILE (.csv, .tbl of LinuxCNC).",
     "ACTION [WORD...]", "servogate tool set 3 length=85 radius=5"},
    {"touch",
     "Measures with the probe along one axis, by two touches: for a tool (tool N Z0), an origin (origin N "
     "X0), or "
     "alone (X); says before and after.",
     "WHAT WORD...", "servogate touch tool 3 Z0 by=-20 times=3"},
    {"mdi", "Runs one block typed by hand.", "BLOCK...", "servogate mdi \"G0 X10\" --wait", true, true},
    {"load", "Loads a part program.", "PROGRAM", "servogate load bracket.nc", false, true},
    {"start", "Starts the loaded program.", "", "servogate start --wait", true, true},
    {"step", "Runs one block.", "", "servogate step", true, true},
    {"hold", "Feed hold: stops on the path.", "", "servogate hold", false, true},
    {"resume", "Goes on after a hold.", "", "servogate resume", false, true},
    {"return",
     "Brings axes that were jogged away from a held program back by the way that they went, and waits until "
     "they stand.",
     "", "servogate return --feed 300", false, true},
    {"retrace",
     "Leads the axes of a held program back along its path, and waits until they stand; `servogate return` "
     "leads "
     "forward again.",
     "", "servogate retrace --mm 5", false, true},
    {"reset", "Ends the program and clears alarms whose cause is gone.", "", "servogate reset"},
    {"override", "Feed override in per cent, 0 to 150.", "PCT", "servogate override 80", false, true},
    {"assign", "Gives an axis that stands to a process: its programs move it from now on.", "AXIS",
     "servogate assign Z --process 2", false, true},
    {"power", "Switches the drives on or off, and waits until they are.", "on|off", "servogate power on",
     true},
    {"input",
     "Plays an input of a mock machine: on, off, a number, or auto (a switch follows its axis again).",
     "POINT on|off|auto|NUMBER", "servogate input estop_chain_ok off"},
    {"alarms", "Lists the alarms with cause and remedy.", "", "servogate alarms --history"},
    {"down", "Stops the axes in a controlled way, switches the drives off, ends the control.", "",
     "servogate down"},
};

/// Put before `-`, `-1mm`, `-5`, so that the parser takes them for the arguments that they are.
constexpr char kShield = '\x01';

bool negative(std::string_view a) {
  return a == "-" || (a.size() > 1 && a[0] == '-' && (a[1] == '.' || (a[1] >= '0' && a[1] <= '9')));
}

/// `--travel` takes the word behind it, negative or not.
bool option(std::string_view a) { return a.starts_with("--"); }

void unshield(std::string& word) {
  if (word.starts_with(kShield)) word.erase(0, 1);
}

/// The arguments as CLI11 wants them: last one first, without the program's name.
std::vector<std::string> shielded(int argc, char** argv) {
  // Numbers of these may be negative, and are no options.
  const bool bench = argc > 2 && std::string_view(argv[1]) == "bench" &&
                     (std::string_view(argv[2]) == "move" || std::string_view(argv[2]) == "jog");
  const bool numbers =
      argc > 1 && (bench || std::string_view(argv[1]) == "sdo" ||
                   std::any_of(std::begin(kClients), std::end(kClients),
                               [&](const ClientCommand& c) { return c.name == std::string_view(argv[1]); }));
  std::vector<std::string> arguments;
  for (int i = argc; i-- > 1;) {
    const std::string word = argv[i];
    // Its value may be missing, and what follows is then no value.
    if (word == "--realtime")
      arguments.push_back(word + "=strict");
    else
      arguments.push_back(numbers && negative(word) && !(bench && option(argv[i - 1])) ? kShield + word
                                                                                       : word);
  }
  return arguments;
}

/// All commands and their options, filling a CommandLine.
class Commands {
 public:
  explicit Commands(CommandLine& line) : line_(line) {
    app_.name("servogate");
    app_.require_subcommand(1);
    app_.footer(
        "Exit codes: 0 done, 1 alarm, program error or failed check, 2 wrong use or bad file,\n"
        "3 stopped by the operator, 4 infrastructure (bus, rights, lost frames, output that cannot be "
        "written).\n"
        "`servogate COMMAND --help` shows each command with an example.");
    version();
    run();
    up();
    for (const ClientCommand& c : kClients) client(c);
    check();
    canon();
    replay();
    capture();
    test();
    backup();
    restore();
    add_plc_commands(app_, line.plc);
    add_bus_commands(app_, line.bus);
    add_canopen_commands(app_, line.bus);
    add_modbus_commands(app_, line.bus);
    line.bench = std::make_shared<BenchCommands>();
    add_bench_commands(app_, *line.bench);
    add_pendant_commands(app_, line.bus);
    written_down();
    flags_take_no_value(app_);
  }

  CLI::App& app() { return app_; }

  /// After the parse: the command's name, and what several options make together.
  void settle() {
    const CLI::App* chosen = app_.get_subcommands().front();
    line_.command = chosen->get_name();
    if (line_.command == "plc" || line_.command == "can" || line_.command == "modbus" ||
        line_.command == "bench" || line_.command == "pendant")
      line_.command += " " + chosen->get_subcommands().front()->get_name();
    line_.client.command = line_.command;
    for (std::string& argument : line_.client.arguments) unshield(argument);
    for (std::string& word : line_.bus.sdo.words) unshield(word);
    unshield(line_.bench->move.value);
    unshield(line_.bench->jog.value);
    line_.run.clock = line_.up.clock = line_.test.clock = virtual_time_           ? ClockKind::virtual_time
                                                          : realtime_ == "strict" ? ClockKind::realtime
                                                          : realtime_.empty()
                                                              ? ClockKind::unset
                                                              : ClockKind::realtime_best_effort;
  }

 private:
  static void flags_take_no_value(CLI::App& app) {
    for (CLI::Option* option : app.get_options())
      if (option->get_items_expected_max() == 0) option->disable_flag_override();
    for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; }))
      flags_take_no_value(*command);
  }

  CLI::App& command(const char* name, const char* meaning, const std::string& example) {
    CLI::App& app = *app_.add_subcommand(name, meaning);
    app.footer("Example: " + example);
    return app;
  }

  void clock(CLI::App& app) {
    CLI::Option* v = app.add_flag("--virtual", virtual_time_, "Virtual time (mock buses only)");
    CLI::Option* r =
        app.add_option("--realtime", realtime_, "Real time; =best-effort goes on without the rights for it")
            ->type_name("[=best-effort]")
            ->check(one_of({"strict", "best-effort"}));
    v->excludes(r);
  }

  void version() {
    CLI::App& app = command("version", "Shows version and commit.", "servogate version --json");
    app.add_flag("--json", line_.json, "As JSON");
  }

  void run() {
    RunOptions& o = line_.run;
    CLI::App& app = command(
        "run", "Runs a part program on a machine: up, load, start, down in one.",
        "servogate run examples/mill/machine.toml examples/mill/bracket.nc --virtual --html out.html");
    app.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
    app.add_option("PROGRAM", o.program,
                   "Part program; without one the machine is only switched on and homed");
    clock(app);
    app.add_option("--trace", o.trace, "Writes one row a cycle to this CSV file");
    app.add_option("--report", o.report, "Writes the report to this JSON file");
    app.add_option("--html", o.html, "Writes the report to this HTML file");
    app.add_option("--record", o.record, "Records inputs and requests for `servogate replay`");
    capture_options(app, o.capture);
    app.add_option("--can-log", o.can_log,
                   "Writes the frames of each simulated CAN bus to BUS.log in this folder")
        ->type_name("DIR");
    app.add_option("--dialect", o.dialect, "Language of the program instead of the machine's own");
    app.add_option("--override", o.override_percent, "Feed override in per cent, 0 to 150")
        ->type_name("PCT")
        ->check(number_within({0.0, 150.0, "%"}));
    app.add_option(
           "--patience", o.patience_s,
           "Machine time that a program may wait for somebody; 0: for ever. 60 s where nothing is real")
        ->type_name("SECONDS")
        ->check(number_within({0.0, 1e9, "s"}));
    app.add_option(
           "--fault", o.faults,
           "Fault of something simulated, as \"kill node=2 at=30\", in the words of `sim`; may be repeated")
        ->type_name("FAULT")
        ->allow_extra_args(false);
    app.add_option("--script", o.script, "File with such faults, each line beginning with its time in s");
    app.add_option("--force", o.forces,
                   "NAME=VALUE, holds a variable or place for the whole run, may be repeated")
        ->allow_extra_args(false);
    tables(app, o.tables);
    app.add_option("--state", o.state, "State directory; without one a virtual run leaves no state behind");
    app.add_flag("--start-now", o.start_now,
                 "Start without the operator's start, where the machine file allows it");
    app.add_flag("--json", o.json, "Prints the report as JSON on standard output");
    app.add_flag("-q,--quiet", o.quiet, "No progress");
  }

  void up() {
    UpOptions& o = line_.up;
    CLI::App& app = command("up", "Starts the resident control; the other commands are its clients.",
                            "servogate up examples/mill/machine.toml --virtual --speed 10");
    app.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
    clock(app);
    app.add_option("--speed", o.speed, "Virtual seconds per wall-clock second, 0.001 to 100000")
        ->type_name("TIMES")
        ->check(number_within({0.001, 100000.0, text::both("times real time", "× реального времени")}))
        ->excludes("--realtime");
    app.add_option("--state", o.state, "State directory instead of the machine file's");
    app.add_option("--socket", o.socket, "Control socket instead of the default");
    app.add_option("--record", o.record, "Records inputs, requests and programs for `servogate replay`");
    capture_options(app, o.capture);
    app.add_option("--can-log", o.can_log,
                   "Writes the frames of each simulated CAN bus to BUS.log in this folder")
        ->type_name("DIR");
    app.add_flag("--json", o.json, "What happens as JSON, one object a line");
  }

  void client(const ClientCommand& c) {
    ClientOptions& o = line_.client;
    CLI::App& app = command(c.name, c.meaning, c.example);
    std::string name;
    for (const char* at = c.arguments;; ++at) {
      if (*at != ' ' && *at != '\0') {
        name += *at;
        continue;
      }
      if (!name.empty()) positional(app, name);
      name.clear();
      if (*at == '\0') break;
    }
    app.add_option("--socket", o.socket, "Control socket instead of the default");
    app.add_flag("--json", o.json, "As JSON");
    if (std::string_view(c.name) == "status")
      app.add_flag("--watch", o.watch, "Again and again until Ctrl-C; with --json one object a line");
    if (std::string_view(c.name) == "alarms") {
      app.add_flag("--history", o.history, "What has happened and who did what, instead; the newest last");
      app.add_option("--last", o.last, "Events of the history, 1 to 1000; 100 without it")
          ->type_name("N")
          ->check(number_within({1.0, 1000.0, text::both("events", "событий"), true}));
    }
    if (std::string_view(c.name) == "start") from_the_middle(app, o);
    if (std::string_view(c.name) == "touch") app.add_flag("--yes", o.yes, "Goes there without asking");
    if (std::string_view(c.name) == "return") {
      app.add_option("--feed", o.feed, "Feed of the way back in mm/min, 1 to 5000; the jog speed without it")
          ->type_name("MM/MIN")
          ->check(number_within({1.0, 5000.0, "mm/min"}));
      app.add_flag("--no-wait", o.no_wait, "Returns as soon as the control has agreed");
    }
    if (std::string_view(c.name) == "retrace") {
      CLI::Option* mm = app.add_option("--mm", o.mm, "Back by so much path")
                            ->type_name("MM")
                            ->check(number_within({1e-3, 1e6, "mm"}));
      CLI::Option* blocks = app.add_option("--blocks", o.blocks,
                                           "Back to the begin of so many blocks, the present one included")
                                ->type_name("N")
                                ->check(number_within({1.0, 1e6, text::both("blocks", "кадров"), true}));
      mm->excludes(blocks);
      app.add_option("--feed", o.feed, "No faster than this in mm/min, 1 to 5000; as programmed without it")
          ->type_name("MM/MIN")
          ->check(number_within({1.0, 5000.0, "mm/min"}));
      app.add_flag("--no-wait", o.no_wait, "Returns as soon as the control has agreed");
    }
    if (c.of_process)
      process(app, o.process, "Process, from 1; without it the first one, and `hold` holds all");
    if (!c.waits) return;
    app.add_flag("--wait", o.wait, "Waits until it has ended; exit 1 after an alarm, 3 when it was stopped");
    if (std::string_view(c.name) == "power" || std::string_view(c.name) == "jog")
      app.add_flag("--no-wait", o.no_wait, "Returns as soon as the control has agreed");
  }

  static void from_the_middle(CLI::App& app, ClientOptions& o) {
    CLI::Option* from =
        app.add_option("--from", o.from, "Begins at block N of the program, as N120")->type_name("N");
    CLI::Option* line = app.add_option("--line", o.line, "Begins at this line of the program's file")
                            ->type_name("LINE")
                            ->check(number_within({1.0, 1e8, "", true}));
    CLI::Option* where =
        app.add_flag("--interrupted", o.interrupted, "Begins at the block where it was interrupted");
    from->excludes(line)->excludes(where);
    line->excludes(where);
    app.add_option("--feed", o.feed, "Feed of the way to that block in mm/min, 1 to 5000; 500 without it")
        ->type_name("MM/MIN")
        ->check(number_within({1.0, 5000.0, "mm/min"}));
    app.add_flag("--by-step", o.by_hand, "Each step of that way waits for `servogate start`");
    app.add_flag("--yes", o.yes, "Goes there without asking");
  }
  static void tables(CLI::App& app, std::string& folder) {
    app.add_option("--tables", folder,
                   "Directory with origins.toml and tools.toml instead of the machine's state directory")
        ->type_name("DIR");
  }
  static void process(CLI::App& app, int& number, const char* meaning) {
    app.add_option("--process", number, meaning)
        ->type_name("N")
        ->check(number_within({1.0, image::kMaxProcesses, "", true}));
  }

  /// NAME, [NAME], NAME... or [NAME...]; the words go into the client's arguments in their order.
  void positional(CLI::App& app, std::string name) {
    const bool optional = name.starts_with('[');
    if (optional) name = name.substr(1, name.size() - 2);
    const bool many = name.ends_with("...");
    if (many) name.resize(name.size() - 3);
    std::vector<std::string>& words = line_.client.arguments;
    CLI::Option* option = many
                              ? app.add_option_function<std::vector<std::string>>(
                                    name,
                                    [&words](const std::vector<std::string>& given) {
                                      words.insert(words.end(), given.begin(), given.end());
                                    },
                                    "")
                              : app.add_option_function<std::string>(
                                    name, [&words](const std::string& given) { words.push_back(given); }, "");
    option->required(!optional)->type_name("");
  }

  void check() {
    CheckOptions& o = line_.check;
    CLI::App& app = command("check", "Validates a machine file, and programs against it, without moving.",
                            "servogate check examples/mill/machine.toml examples/mill/bracket.nc");
    app.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
    app.add_option("PROGRAM", o.programs, "Part programs");
    app.add_option("--dialect", o.dialect, "Language of the programs instead of the machine's own");
    tables(app, o.tables);
    process(app, o.process, "Process that runs the programs, from 1; without it the first one");
    app.add_flag("--elsewhere", o.elsewhere,
                 "The machine is another computer: its buses and devices are not looked for here");
    app.add_flag("--json", o.json, "As JSON");
  }

  void canon() {
    CanonOptions& o = line_.canon;
    CLI::App& app = command("canon", "Prints the canonical commands of a program, one JSON object a line.",
                            "servogate canon examples/mill/machine.toml examples/mill/bracket.nc | head");
    app.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
    app.add_option("PROGRAM", o.program, "Part program")->required();
    app.add_option("--dialect", o.dialect, "Language of the program instead of the machine's own");
    tables(app, o.tables);
    process(app, o.process, "Process that runs the program, from 1; without it the first one");
    app.add_flag("--json", o.json, "As JSON, which it always is");
  }

  static void capture_options(CLI::App& app, CaptureRequest& o) {
    app.add_option("--capture", o.file, "Writes chosen values of each cycle to this file, *.csv or *.mcap")
        ->type_name("FILE");
    app.add_option("--channels", o.channels,
                   "What --capture holds: names and groups with commas between them")
        ->type_name("NAMES");
    app.add_option("--trigger", o.trigger,
                   "When --capture begins, as \"X.error > 0.05\" or alarm; without it at once")
        ->type_name("CONDITION");
    app.add_option("--before", o.before_s, "Time before the trigger that is in the capture")
        ->type_name("SECONDS")
        ->check(number_within({0.0, 3600.0, "s"}));
    app.add_option("--after", o.after_s, "Time behind the trigger that is in the capture")
        ->type_name("SECONDS")
        ->check(number_within({0.0, 3600.0, "s"}));
  }

  void capture() {
    CaptureOptions& o = line_.capture;
    CLI::App& app = command("capture", "Says what a capture (*.mcap) holds, and makes CSV of it.",
                            "servogate capture alarm.mcap --csv alarm.csv");
    app.add_option("FILE", o.file, "File written by --capture, or one of the black box")->required();
    app.add_option("--csv", o.csv, "Writes its values to this CSV file, its frames to a file beside it");
    app.add_flag("--json", o.json, "As JSON");
  }

  void replay() {
    ReplayOptions& o = line_.replay;
    CLI::App& app = command("replay", "Runs a record again in virtual time and compares the set-points.",
                            "servogate replay run.record --against run.csv");
    app.add_option("RECORD", o.record, "File written by --record")->required();
    app.add_option("--trace", o.trace, "Writes the trace of the replay to this CSV file");
    app.add_option("--against", o.against, "Compares with this trace, byte by byte");
    app.add_flag("--json", o.json, "As JSON");
  }

  void test() {
    TestOptions& o = line_.test;
    CLI::App& app = command("test", "Tests whole machines by scenario files (*.scenario.toml).",
                            "servogate test tests/scenarios --junit results.xml");
    CLI::Option* paths =
        app.add_option("PATH", o.paths, "Scenario files, and directories that are searched for them")
            ->type_name("");
    app.add_option("--session", o.session,
                   "Another program steps this machine by lines of JSON on standard input")
        ->type_name("MACHINE")
        ->excludes(paths);
    app.add_option("--jobs", o.jobs, "Scenarios that run side by side; one a core without it")
        ->type_name("N")
        ->check(number_within({1.0, 256.0, "", true}));
    app.add_option("--shard", o.shard, "Every N-th scenario, beginning with the I-th: for several runners")
        ->type_name("I/N");
    app.add_option("--tag", o.tags, "Only scenarios with this tag, may be repeated")->type_name("TAG");
    app.add_option("--name", o.name, "Only scenarios whose name contains this")->type_name("TEXT");
    app.add_flag("--list", o.list, "Names the scenarios and runs none");
    app.add_option("--junit", o.junit, "Writes the results to this file as JUnit XML");
    app.add_option("--json", o.json, "Writes the results to this file as JSON");
    app.add_flag("--tap", o.tap, "Prints the results as TAP 13");
    app.add_option("--trace-table", o.trace_table,
                   "Writes which scenarios verify which requirement to this file");
    app.add_option("--artifacts", o.artifacts,
                   "Writes trace and page of each scenario that fails to this folder")
        ->type_name("DIR");
    app.add_option("--seed", o.seed,
                   "Of what scenarios draw by chance; without it a new one, which is printed")
        ->type_name("S");
    app.add_flag("--shrink", o.shrink, "Looks for the smallest time line of a random scenario that fails");
    app.add_flag("--without-faults", o.without_faults,
                 "Leaves the `fault` steps out: what passes then would not have noticed them");
    app.add_flag("--real", o.real, "Allows machines with real buses and devices, whose axes then move");
    app.add_flag("--quiet", o.quiet, "No progress");
    clock(app);
  }

  void backup() {
    BackupOptions& o = line_.backup;
    CLI::App& app =
        command("backup",
                "Writes what the machine has learned into one file: origins, tools, references, PLC values.",
                "servogate backup machine.toml monday.backup");
    kept_state(app, o);
    app.add_option("FILE", o.file, "File that the backup is written to")->required();
    app.add_flag("--force", o.force, "Replaces a file that is there");
  }

  void restore() {
    BackupOptions& o = line_.backup;
    CLI::App& app = command(
        "restore", "Puts a backup in the place of what the machine has learned, while its control is down.",
        "servogate restore machine.toml monday.backup");
    kept_state(app, o);
    app.add_option("FILE", o.file, "File that `servogate backup` wrote")->required();
    app.add_flag("--force", o.force, "Also the backup of a machine with another name");
  }

  static void kept_state(CLI::App& app, BackupOptions& o) {
    app.add_option("MACHINE", o.machine, "Machine file (TOML)")->required();
    app.add_option("--state", o.state, "State directory instead of the machine file's");
  }

  void written_down() {
    command("man", "Prints the manual page of all commands.",
            "servogate man > servogate.1 && man ./servogate.1");
    CLI::App& app =
        command("completion", "Prints a script with which the shell completes commands and options.",
                "source <(servogate completion bash)");
    app.add_option("SHELL", shell_, "bash; zsh reads the same script after `bashcompinit`")
        ->required()
        ->check(one_of({"bash", "zsh"}));
  }

  CommandLine& line_;
  CLI::App app_{"servogate: a Linux computer becomes the control of a machine"};
  bool virtual_time_ = false;
  std::string realtime_;
  std::string shell_;
};

/// What the declarations themselves answer; empty: a command to be carried out.
std::string written_down(CLI::App& app, const std::string& command) {
  if (command == "man") return manual_page(app);
  return command == "completion" ? bash_completion(app) : std::string();
}

const CLI::App* subcommand(const CLI::App& app, std::string_view name) {
  const auto found = app.get_subcommands([&](const CLI::App* c) { return c->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

/// True when the word in a command's place is none of `app`'s commands; it has been said then.
bool unknown_command(const CLI::App& app, const std::string& prefix, const char* word) {
  const std::string_view name = word == nullptr ? "" : word;
  if (name.empty() || name == "-h" || name == "--help" || subcommand(app, name) != nullptr) return false;
  complain_of_command(prefix, word, app);
  return true;
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, char** argv, int& exit_code) {
  CommandLine line;
  line.words.emplace_back("servogate");
  line.words.insert(line.words.end(), argv + std::min(argc, 1), argv + argc);
  Commands commands(line);
  CLI::App& app = commands.app();
  exit_code = kWrongUse;
  static char version[] = "version", help[] = "--help";
  if (argc == 2 && std::string_view(argv[1]) == "--version") argv[1] = version;
  if (argc >= 2 && std::string_view(argv[1]) == "help") {  // `help plc run` as `plc run --help`
    std::rotate(argv + 1, argv + 2, argv + argc);
    argv[argc - 1] = help;
  }
  const char* first = argc > 1 ? argv[1] : nullptr;
  if (unknown_command(app, "", first)) return std::nullopt;
  for (const char* group : {"plc", "can", "pendant"})
    if (first != nullptr && std::string_view(first) == group &&
        unknown_command(*subcommand(app, group), group + std::string(" "), argc > 2 ? argv[2] : nullptr))
      return std::nullopt;
  try {
    app.parse(shielded(argc, argv));
  } catch (const CLI::Success&) {
    if (text::user_language() == text::Language::russian) speak_russian(app);
    print(app.help());
    exit_code = kDone;
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    std::vector<std::string> unread = app.remaining(true);
    for (std::string& word : unread) unshield(word);
    complain_of_use(error, app, unread);
    return std::nullopt;
  }
  if (complain_of_empty(app)) return std::nullopt;
  commands.settle();
  if (const std::string page = written_down(app, line.command); !page.empty()) {
    print(page);
    exit_code = kDone;
    return std::nullopt;
  }
  return line;
}

}  // namespace servogate::gateway
