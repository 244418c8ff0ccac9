// SPDX-License-Identifier: Apache-2.0
// The command line as its users meet it: exit codes, --json, what is written and what is said.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "tests/comes.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/machine_run/rig/programs.hpp"

namespace servogate::machine_run {
namespace {

using nlohmann::json;

json parsed(const std::string& text) {
  const json j = json::parse(text, nullptr, false);
  EXPECT_FALSE(j.is_discarded()) << text.substr(0, 300);
  return j;
}

TEST(Command, version_is_said_in_words_and_as_json) {
  const Ending words = servogate({"version"});
  EXPECT_EQ(words.code, 0);
  EXPECT_NE(words.out.find("servogate"), std::string::npos) << words.out;
  const Ending as_json = servogate({"version", "--json"});
  EXPECT_EQ(as_json.code, 0);
  const json j = parsed(as_json.out);
  EXPECT_TRUE(j.contains("version") && j.contains("commit") && j.contains("schema")) << as_json.out;
}

TEST(Command, help_of_every_command_ends_with_zero_and_shows_an_example) {
  EXPECT_EQ(servogate({"--help"}).code, 0);
  for (const char* command :
       {"version", "run", "up", "check", "canon", "replay", "status", "home", "jog", "mdi", "load", "start",
        "hold", "resume", "reset", "override", "alarms", "down"}) {
    const Ending e = servogate({command, "--help"});
    EXPECT_EQ(e.code, 0) << command;
    EXPECT_NE(e.out.find("Example: servogate "), std::string::npos) << command << e.out;
  }
  for (const char* command : {"run", "check"}) {
    const Ending e = servogate({"plc", command, "--help"});
    EXPECT_EQ(e.code, 0) << command;
    EXPECT_NE(e.out.find("Example: servogate "), std::string::npos) << command << e.out;
  }
}

TEST(Command, wrong_use_ends_with_two_and_a_sentence) {
  const std::string mill = mill_file(), bracket = source("examples/mill/bracket.nc");
  const std::vector<std::vector<std::string>> wrong{
      {},
      {"dance"},
      {"run"},
      {"run", mill, bracket, "--sideways"},
      {"run", mill, bracket, "--virtual", "--realtime"},
      {"run", mill, bracket, "--realtime=perhaps"},
      {"run", mill, bracket, "--override", "151"},
      {"run", mill, bracket, "--dialect", "klingon"},
      {"run", "/nonexistent/machine.toml"},
      {"run", mill, "/nonexistent/program.nc"},
      {"run", bracket},
      {"canon", mill},
      {"canon", mill, "/nonexistent/program.nc"},
      {"canon", mill, bracket, "--dialect", "klingon"},
      {"replay"},
      {"plc"},
      {"plc", "run", "/nonexistent/file.st"},
      {"plc", "run"},
  };
  for (const auto& arguments : wrong) {
    const Ending e = servogate(arguments);
    std::string line;
    for (const std::string& a : arguments) line += a + " ";
    EXPECT_EQ(e.code, 2) << line << e.out << e.err;
    EXPECT_NE(e.err + e.out, "") << line;
  }
}

TEST(Command, virtual_time_with_a_real_bus_is_wrong_use_and_names_the_bus) {
  const Scratch scratch;
  const std::string changed = changed_mill(scratch, "\"mock:can\"", "\"socketcan:vcan9\"");
  std::string text = read_all(changed);
  text = text.substr(0, text.find("[[simulation.drive]]"));
  text.insert(text.find("estop ="), "mock_inputs_guard_real_drives = true\n");
  const std::string machine = scratch.write("real.toml", text);
  const Ending e = servogate({"run", machine, source("examples/mill/bracket.nc"), "--virtual"});
  EXPECT_EQ(e.code, 2) << e.err;
  EXPECT_NE(e.err.find("socketcan:vcan9"), std::string::npos) << e.err;
}

TEST(Command, client_without_a_running_control_ends_with_four) {
  const Scratch scratch;
  for (const char* command : {"status", "hold", "alarms"}) {
    const Ending e = servogate({command, "--socket", scratch.path("none.sock")});
    EXPECT_EQ(e.code, 4) << command << e.err;
    EXPECT_NE(e.err, "") << command;
  }
}

TEST(Check, of_the_example_says_what_the_numbers_mean) {
  const Ending e = servogate({"check", mill_file(), source("examples/mill/bracket.nc")});
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_NE(e.out.find("26214.4 counts"), std::string::npos) << e.out;
  const Ending as_json = servogate({"check", mill_file(), source("examples/mill/bracket.nc"), "--json"});
  EXPECT_EQ(as_json.code, 0);
  EXPECT_TRUE(parsed(as_json.out).contains("findings"));
}

TEST(Check, that_fails_ends_with_one_and_names_file_line_and_column) {
  const Scratch scratch;
  const std::string outside =
      scratch.write("outside.nc", "N10 G90 G71 G94\nN20 G0 X10\nN30 G1 X400 F1000\nN40 M30\n");
  const Ending e = servogate({"check", mill_file(), outside});
  EXPECT_EQ(e.code, 1) << e.err << e.out;
  EXPECT_NE((e.err + e.out).find("outside.nc:3"), std::string::npos) << e.err << e.out;
  const std::string broken = changed_mill(scratch, "travel_min = \"-300 mm\"", "travel_min = \"-300 s\"");
  const Ending m = servogate({"check", broken});
  EXPECT_EQ(m.code, 1) << m.err;
  EXPECT_NE((m.err + m.out).find("machine.toml:"), std::string::npos) << m.err << m.out;
}

/// Seconds in which a run's set-point moved while a block of its program was under way.
double seconds_of_motion(const TraceFile& trace, const std::vector<std::string>& axes) {
  const std::size_t line = trace.column("line");
  double seconds = 0.0;
  for (std::size_t row = 1; row < trace.rows(); ++row) {
    bool moved = false;
    for (const std::string& axis : axes) {
      const std::size_t command = trace.column(axis + ".cmd");
      moved = moved || trace.at(row, command) != trace.at(row - 1, command);
    }
    if (moved && trace.at(row, line) > 0.0) seconds += 0.001;
  }
  return seconds;
}

TEST(Check, gives_the_warnings_about_the_machine_beside_those_about_its_logic) {
  const Scratch scratch;
  const std::string fast =
      changed_mill(scratch, "max_velocity = \"500 mm/s\"", "max_velocity = \"900 mm/s\"");
  const Ending e = servogate({"check", fast});
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_NE((e.err + e.out).find("[machine.motor_too_fast]"), std::string::npos) << e.err;
}

TEST(Check, names_what_reading_and_what_the_motion_finds_from_the_top_of_the_file) {
  const Scratch scratch;
  const std::string both = scratch.write("both.nc", "N10 G0 X2\nN20 G1 X400 F100\nN30 G1 X1 FOO\nN40 M30\n");
  const Ending e = servogate({"check", mill_file(), both});
  EXPECT_EQ(e.code, 1);
  const std::size_t motion = e.err.find("both.nc:2:8: error: X would go to 400");
  const std::size_t reading = e.err.find("both.nc:3:11: error: F needs a number");
  ASSERT_NE(reading, std::string::npos) << e.err;
  EXPECT_LT(motion, reading) << e.err;
}

TEST(Check, says_the_time_that_the_motion_of_a_run_takes_within_a_hundredth) {
  const struct {
    std::string machine, program;
    std::vector<std::string> axes;
  } examples[] = {{mill_file(), source("examples/mill/bracket.nc"), {"X", "Y", "Z"}},
                  {source("examples/lathe/machine.toml"), source("examples/lathe/bush.nc"), {"X", "Z"}}};
  for (const auto& example : examples) {
    const Scratch scratch;
    const Ending said = servogate({"check", example.machine, example.program, "--json"});
    ASSERT_EQ(said.code, 0) << said.err;
    const json report = parsed(said.out)["programs"][0];
    const Ending ran = servogate(
        {"run", example.machine, example.program, "--virtual", "--trace", scratch.path("t.csv"), "-q"});
    ASSERT_EQ(ran.code, 0) << ran.err;
    const double driven = seconds_of_motion(TraceFile(scratch.path("t.csv")), example.axes);
    EXPECT_GT(driven, 60.0);
    EXPECT_NEAR(report["motion_s"].get<double>(), driven, 0.01 * driven) << example.program;
    EXPECT_NEAR(report["time_s"].get<double>(),
                report["motion_s"].get<double>() + report["dwell_s"].get<double>(), 1e-9);
    EXPECT_GT(report["functions"], 15);
  }
}

TEST(Run, turns_a_shaft_in_the_language_of_a_Fenix_and_leaves_the_axes_where_it_ends) {
  const Scratch scratch;
  const Ending ran =
      servogate({"run", source("examples/fenix-shaft/machine.toml"), source("examples/fenix-shaft/shaft.nc"),
                 "--tables", source("examples/fenix-shaft/tables"), "--virtual", "--trace",
                 scratch.path("t.csv"), "-q"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_GT(seconds_of_motion(TraceFile(scratch.path("t.csv")), {"X", "Z"}), 300.0);
}

TEST(Run, mills_a_flange_in_the_ISO_dialect_of_a_SINUMERIK_and_leaves_the_axes_where_it_ends) {
  const Scratch scratch;
  const Ending ran =
      servogate({"run", source("examples/iso-flange/machine.toml"), source("examples/iso-flange/flange.nc"),
                 "--tables", source("examples/iso-flange/tables"), "--virtual", "--trace",
                 scratch.path("t.csv"), "-q"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_GT(seconds_of_motion(TraceFile(scratch.path("t.csv")), {"X", "Y", "Z"}), 120.0);
}

TEST(Canon, prints_one_object_a_line_with_command_and_line) {
  const Ending e = servogate({"canon", mill_file(), source("examples/mill/bracket.nc")});
  ASSERT_EQ(e.code, 0) << e.err;
  std::istringstream lines(e.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const json j = parsed(line);
    ASSERT_TRUE(j.contains("cmd") && j.contains("line")) << line;
    EXPECT_GE(j["line"].get<int>(), 1);
  }
  EXPECT_GT(count, 150);
}

TEST(Canon, of_a_wrong_program_prints_what_comes_before_the_error_and_ends_with_one) {
  const Scratch scratch;
  const Ending e = servogate(
      {"canon", mill_file(), scratch.write("w.nc", "N10 G0 X1\nN20 G1 X2 F100\nN30 X3 Q\nN40 M30\n")});
  EXPECT_EQ(e.code, 1);
  EXPECT_NE(e.out.find("\"rapid\""), std::string::npos) << e.out;
  EXPECT_NE(e.err.find("w.nc:3:"), std::string::npos) << e.err;
}

TEST(Plc, runs_and_checks_structured_text) {
  const Scratch scratch;
  const std::string good =
      scratch.write("good.st", "PROGRAM P\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM\n");
  EXPECT_EQ(servogate({"plc", "check", good}).code, 0);
  const Ending run = servogate({"plc", "run", good, "--cycles", "5", "--print", "P.n"});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_NE(run.out.find("5"), std::string::npos) << run.out;
  const std::string bad =
      scratch.write("bad.st", "PROGRAM P\nVAR n : INT; END_VAR\nn := TRUE;\nEND_PROGRAM\n");
  const Ending check = servogate({"plc", "check", bad});
  EXPECT_NE(check.code, 0);
  EXPECT_NE((check.err + check.out).find("bad.st:3:"), std::string::npos) << check.err << check.out;
}

TEST(Run, ends_with_zero_and_writes_trace_report_and_page) {
  const Scratch scratch;
  const std::string program = scratch.write("short.nc", kShortProgram);
  const Ending e =
      servogate({"run", mill_file(), program, "--virtual", "--trace", scratch.path("t.csv"), "--report",
                 scratch.path("r.json"), "--html", scratch.path("p.html"), "--json", "-q"});
  ASSERT_EQ(e.code, 0) << e.err;
  EXPECT_EQ(e.err, "") << "quiet means quiet";
  const json report = parsed(read_all(scratch.path("r.json")));
  EXPECT_EQ(parsed(e.out)["cycles"], report["cycles"]);
  EXPECT_TRUE(report["finished"].get<bool>());
  EXPECT_TRUE(report["alarms"].empty()) << report["alarms"].dump();
  EXPECT_EQ(report["starved"], 0);
  const TraceFile trace(scratch.path("t.csv"));
  EXPECT_EQ(trace.rows(), report["cycles"].get<std::size_t>());
  const std::vector<std::string> first{"t",     "feed",  "line",  "X.cmd", "X.act",
                                       "Y.cmd", "Y.act", "Z.cmd", "Z.act"};
  EXPECT_TRUE(std::equal(first.begin(), first.end(), trace.names().begin()));
  for (std::size_t i = 0; i < trace.rows(); ++i)
    ASSERT_NEAR(trace.at(i, 0), static_cast<double>(i) * 0.001, 1e-9);
  EXPECT_NE(read_all(scratch.path("p.html")).find("<html"), std::string::npos);
}

TEST(Run, without_a_program_switches_on_homes_and_ends) {
  const Scratch scratch;
  const Ending e =
      servogate({"run", mill_file(), "--virtual", "--trace", scratch.path("t.csv"), "-q", "--json"});
  ASSERT_EQ(e.code, 0) << e.err;
  const TraceFile trace(scratch.path("t.csv"));
  for (const char* axis : {"X.cmd", "Y.cmd", "Z.cmd"})
    EXPECT_NEAR(trace.at(trace.rows() - 1, trace.column(axis)), 0.0, 0.01) << axis;
}

TEST(Run, with_a_program_error_ends_with_one_and_writes_its_report_all_the_same) {
  const Scratch scratch;
  const std::string program =
      scratch.write("stops.nc", "N10 G90 G71 G94\nN20 G1 X20 F6000\nN30 E30=1\nN40 (BNC,NOWHERE)\nN50 M30\n");
  const Ending e =
      servogate({"run", mill_file(), program, "--virtual", "--report", scratch.path("r.json"), "-q"});
  EXPECT_EQ(e.code, 1) << e.err;
  EXPECT_NE(e.err.find("stops.nc:4"), std::string::npos) << e.err;
}

TEST(Run, of_a_program_that_is_proven_wrong_moves_nothing_and_names_the_place) {
  const Scratch scratch;
  const std::string program = scratch.write("far.nc", "N10 G90 G71 G94\nN20 G0 X5\nN30 G0 X301\nN40 M30\n");
  const Ending e = servogate({"run", mill_file(), program, "--virtual", "--report", scratch.path("r.json"),
                              "--trace", scratch.path("t.csv"), "-q"});
  EXPECT_EQ(e.code, 1);
  EXPECT_NE(e.err.find("far.nc:3:8: error: X would go to 301, the travel ends at 300 [P701]"),
            std::string::npos)
      << e.err;
  const json report = parsed(read_all(scratch.path("r.json")));
  EXPECT_FALSE(report["finished"].get<bool>());
  EXPECT_EQ(report["cycles"], 0);
  EXPECT_EQ(report["findings"][0]["code"], "P701");
  EXPECT_EQ(TraceFile(scratch.path("t.csv")).rows(), 0u);
}

TEST(Run, that_is_refused_or_never_gets_ready_says_why_in_its_report) {
  const Scratch scratch;
  const std::string report = scratch.path("r.json");
  const struct {
    const char *from, *to, *code, *words;
  } rows[] = {{"door_closed = 1", "door_closed = 0", "run.refused", "feed_enable"},
              {"operator_closes = [\"estop_chain_ok\"]", "operator_closes = []", "run.not-ready",
               "the emergency-stop chain is open"}};
  for (const auto& row : rows) {
    const Ending e =
        servogate({"run", changed_mill(scratch, row.from, row.to), "--virtual", "--report", report, "-q"});
    EXPECT_EQ(e.code, 1) << row.code;
    EXPECT_NE(e.err.find(std::string("[") + row.code + "]"), std::string::npos) << e.err;
    const json error = parsed(read_all(report))["error"];
    EXPECT_EQ(error["code"], row.code);
    EXPECT_NE(error["text"].get<std::string>().find(row.words), std::string::npos) << error;
  }
}

TEST(Run, goes_on_through_a_warning_during_homing_to_the_end_of_its_program) {
  const Scratch scratch;
  const std::string machine =
      changed_mill(scratch, "following_error_warn = \"0.5 mm\"", "following_error_warn = \"0.0005 mm\"");
  const std::string program = scratch.write("x.nc", "N10 G90 G71 G94\nN20 G1 X5 F1000\nN30 M30\n");
  const Ending e = servogate({"run", machine, program, "--virtual", "--json"});
  EXPECT_EQ(e.code, 0) << e.err;
  const json report = parsed(e.out);
  EXPECT_TRUE(report["finished"].get<bool>()) << e.err;
  bool warned = false;
  for (const json& alarm : report["alarms"]) warned = warned || alarm["number"] == 1017;
  EXPECT_TRUE(warned) << report["alarms"];
}

TEST(Run, whose_homing_fails_names_the_alarm_and_the_axes_without_a_zero) {
  const Scratch scratch;
  const std::string machine = changed_mill(scratch, "switch = \"x_home\"", "switch = \"x_limit_plus_2\"");
  std::string text = read_all(machine);
  const std::string point = "  { name = \"estop_chain_ok\"";
  ASSERT_NE(text.find(point), std::string::npos);
  text.insert(text.find(point), "  { name = \"x_limit_plus_2\", channel = \"di20\", place = \"SA30\" },\n");
  const Ending e = servogate({"run", scratch.write("dead.toml", text), "--virtual", "--json"});
  EXPECT_EQ(e.code, 1) << e.err;
  EXPECT_NE(e.err.find("[run.not-homed]"), std::string::npos) << e.err;
  const json report = parsed(e.out);
  EXPECT_EQ(report["error"]["code"], "run.not-homed");
  EXPECT_FALSE(report["alarms"].empty()) << "a switch that never works";
}

TEST(Run, shows_the_message_of_a_program_without_letting_it_command_the_terminal) {
  const Scratch scratch;
  const std::string program = scratch.write("dis.nc",
                                            "N10 (DIS,\"a\x1b]0;b\x07 \xC2\x9B"
                                            "c\")\nN20 G4 F1\nN30 M30\n");
  const Ending e = servogate({"run", mill_file(), program, "--virtual"});
  EXPECT_NE(e.err.find("a\\x1B]0;b\\x07 \\xC2\\x9B"
                       "c"),
            std::string::npos)
      << e.err;
  EXPECT_EQ(e.err.find('\x1b'), std::string::npos);
}

TEST(Run, goes_on_with_the_gains_of_the_machine_file_when_the_saved_ones_are_damaged) {
  const Scratch scratch;
  const std::string nc = scratch.write("end.nc", "N10 M30\n"), state = scratch.path("state");
  ASSERT_EQ(servogate({"run", mill_file(), nc, "--virtual", "--state", state, "-q"}).code, 0);
  scratch.write("state/gains.toml", "checksum = \"none\"\n\x1b[2J = 1\n");
  const Ending e = servogate({"run", mill_file(), nc, "--virtual", "--state", state, "--json"});
  EXPECT_EQ(e.code, 0) << e.err;
  EXPECT_NE(e.err.find("alarm 6006"), std::string::npos) << e.err;
  EXPECT_NE(e.err.find("gains.toml"), std::string::npos) << e.err;
  EXPECT_EQ(e.err.find('\x1b'), std::string::npos) << e.err;
  EXPECT_TRUE(parsed(e.out)["finished"].get<bool>());
}

TEST(Run, that_an_alarm_ends_is_one_with_the_alarm_in_report_and_words) {
  const Scratch scratch;
  // The PLC of the mill does not know M77.
  const std::string program =
      scratch.write("m77.nc", "N10 G90 G71 G94\nN20 G0 X5\nN30 M77\nN40 G0 X9\nN50 M30\n");
  const Ending e = servogate({"run", mill_file(), program, "--virtual", "--report", scratch.path("r.json"),
                              "--trace", scratch.path("t.csv"), "-q"});
  EXPECT_EQ(e.code, 1);
  EXPECT_NE(e.err.find("alarm 4002"), std::string::npos) << e.err;
  EXPECT_NE(e.err.find("M77"), std::string::npos) << e.err;
  const json report = parsed(read_all(scratch.path("r.json")));
  EXPECT_FALSE(report["finished"].get<bool>());
  ASSERT_FALSE(report["alarms"].empty());
  EXPECT_EQ(report["alarms"][0]["number"], 4002);
  const TraceFile trace(scratch.path("t.csv"));
  EXPECT_NEAR(trace.at(trace.rows() - 1, trace.column("X.cmd")), 5.0, 0.01);
}

TEST(Run, speaks_russian_to_a_russian) {
  const Scratch scratch;
  const Ending e =
      servogate({"run", mill_file(), scratch.write("m77.nc", "N10 M77\nN20 M30\n"), "--virtual", "-q"},
                {{"LANG", "ru_RU.UTF-8"}});
  EXPECT_EQ(e.code, 1);
  EXPECT_NE(e.err.find("M77"), std::string::npos) << e.err;
  EXPECT_NE(e.err.find("ПЛК не знает"), std::string::npos) << e.err;
}

TEST(Run, that_cannot_write_what_it_was_asked_for_ends_with_four) {
  const Scratch scratch;
  const std::string program = scratch.write("short.nc", "N10 G0 X1\nN20 M30\n");
  for (const char* option : {"--trace", "--report", "--html", "--record"}) {
    const Ending e =
        servogate({"run", mill_file(), program, "--virtual", option, "/nonexistent/folder/file", "-q"});
    EXPECT_EQ(e.code, 4) << option << e.err;
    EXPECT_NE(e.err.find("/nonexistent/folder/file"), std::string::npos) << option << e.err;
  }
}

// -- Ctrl-C

/// Starts a run that goes on for long and waits until it moves.
class LongRun {
 public:
  explicit LongRun(const Scratch& scratch)
      : trace_(scratch.path("t.csv")),
        program_({"run", mill_file(),
                  scratch.write("long.nc",
                                "N10 G90 G94 G71\n(RPT,99)\n(RPT,99)\nN20 G1 X200 Y100 F9000\nN30 X0 "
                                "Y0\n(ERP)\n(ERP)\nN40 M30\n"),
                  "--virtual", "--trace", trace_, "--report", scratch.path("r.json"), "-q"}) {
    // The trace grows by more than 250 and less than 500 bytes a cycle; homing is over after some 6000.
    EXPECT_TRUE(tests::comes([&] {
      std::error_code ignored;
      const auto size = std::filesystem::file_size(trace_, ignored);
      return !ignored && size > 500 * 8000;
    }));
  }
  Program& program() { return program_; }
  const std::string& trace() const { return trace_; }

 private:
  std::string trace_;
  Program program_;
};

TEST(Run, interrupted_once_stops_on_the_path_within_the_limits_and_writes_everything) {
  const Scratch scratch;
  LongRun run(scratch);
  run.program().signal(SIGINT);
  const Ending e = run.program().wait();
  EXPECT_EQ(e.code, 3) << e.err;
  const json report = parsed(read_all(scratch.path("r.json")));
  EXPECT_FALSE(report["finished"].get<bool>());
  EXPECT_TRUE(report["alarms"].empty()) << report["alarms"].dump();
  const TraceFile trace(run.trace());
  const std::size_t x = trace.column("X.cmd"), y = trace.column("Y.cmd"), feed = trace.column("feed");
  const std::size_t n = trace.rows();
  ASSERT_GT(n, 1000u);
  EXPECT_EQ(trace.at(n - 1, feed), 0.0);
  std::size_t stop = n - 1;
  while (stop > 4 && trace.at(stop, feed) == 0.0) --stop;
  EXPECT_GT(n - stop, 1u);
  // Where the power goes, the set-point becomes what the encoder measures, noise included.
  const std::size_t x_act = trace.column("X.act"), y_act = trace.column("Y.act");
  std::size_t off = stop + 1;
  // At a corner of the path one of them may be the same by chance.
  while (off < n && (trace.at(off, x) != trace.at(off, x_act) || trace.at(off, y) != trace.at(off, y_act)))
    ++off;
  EXPECT_GT(off - stop, 1u) << "the power goes when the set-point stands";
  for (std::size_t i = off; i < n; ++i) {
    ASSERT_NEAR(trace.at(i, x), trace.at(off - 1, x), 1e-3) << "row " << i;
    ASSERT_NEAR(trace.at(i, y), trace.at(off - 1, y), 1e-3) << "row " << i;
  }
  for (std::size_t i = std::max<std::size_t>(stop - 1000, 3); i < off; ++i) {
    const double beside =
        std::abs(trace.at(i, x) * 100.0 - trace.at(i, y) * 200.0) / std::hypot(200.0, 100.0);
    ASSERT_LT(beside, 1e-6) << "row " << i;
    for (const std::size_t c : {x, y}) {
      const double a = (trace.at(i, c) - 2 * trace.at(i - 1, c) + trace.at(i - 2, c)) * 1e6;
      const double j =
          (trace.at(i, c) - 3 * trace.at(i - 1, c) + 3 * trace.at(i - 2, c) - trace.at(i - 3, c)) * 1e9;
      // Twelve decimals of a millimetre are 1e-3 mm/s3.
      ASSERT_LE(std::abs(a), 1000.0 * 1.001) << "row " << i;
      ASSERT_LE(std::abs(j), 10000.0 * 1.001 + 0.01) << "row " << i;
    }
  }
}

TEST(Run, interrupted_twice_is_a_quick_stop) {
  const Scratch scratch;
  LongRun run(scratch);
  run.program().signal(SIGSTOP);  // so that a fast computer has not ended before the second one
  run.program().signal(SIGINT);
  run.program().signal(SIGTERM);  // both count; two equal ones may arrive as one
  run.program().signal(SIGCONT);
  const Ending e = run.program().wait();
  EXPECT_EQ(e.code, 3) << e.err;
  const json report = parsed(read_all(scratch.path("r.json")));
  EXPECT_NE(report["alarms"].dump().find("6003"), std::string::npos) << report["alarms"].dump();
}

}  // namespace
}  // namespace servogate::machine_run
