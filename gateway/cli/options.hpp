// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gateway/cli/bus_options.hpp"
#include "gateway/cli/plc_options.hpp"
#include "gateway/cli/test_options.hpp"
#include "gateway/control/run/capture/capture_request.hpp"
#include "gateway/control/run/clock_kind.hpp"
#include "gateway/control/run/exit_code.hpp"

namespace servogate::gateway {

struct RunOptions {
  std::string machine, program, dialect;
  ClockKind clock = ClockKind::unset;
  std::string trace, report, html, record, can_log, state, tables;
  CaptureRequest capture;
  double override_percent = 100.0;
  std::optional<double> patience_s;  ///< machine time that a program may wait for somebody; 0: for ever
  std::vector<std::string> forces;   ///< NAME=VALUE
  std::vector<std::string> faults;   ///< as "kill node=2 at=30"
  std::string script;                ///< file with such lines
  bool quiet = false;
  bool start_now = false;
  bool json = false;
};

struct UpOptions {
  std::string machine, state, socket, record, can_log;
  CaptureRequest capture;
  ClockKind clock = ClockKind::unset;
  double speed = 1.0;
  bool json = false;
};

/// A client of a running control: `servogate status`, `home X Z`, `jog X +1mm` ...
struct ClientOptions {
  std::string command;
  std::vector<std::string> arguments;
  std::string socket;
  int process = 0;                   ///< from 1; 0: none was said
  std::string from;                  ///< of `start`: "N120"; empty: the first block
  int line = 0;                      ///< the same by its line
  bool interrupted = false;          ///< the same, where it was interrupted
  std::optional<double> feed;        ///< of the way there or back, mm/min
  std::optional<double> mm, blocks;  ///< of `retrace`
  bool yes = false;                  ///< without asking
  bool by_hand = false;              ///< each step of the way waits for start
  bool history = false;              ///< of `alarms`: what has happened instead
  int last = 100;                    ///< events of it
  bool watch = false;                ///< of `status`: again and again
  bool json = false;
  bool wait = false;     ///< until what was begun has ended
  bool no_wait = false;  ///< of `power`, `jog`, `return` and `retrace`, which wait of themselves
};

struct CheckOptions {
  std::string machine, dialect, tables;
  int process = 1;         ///< that runs the programs
  bool elsewhere = false;  ///< the machine is another computer: its devices are not looked for
  std::vector<std::string> programs;
  bool json = false;
};

struct CanonOptions {
  std::string machine, program, dialect, tables;
  int process = 1;   ///< that runs the program
  bool json = true;  ///< its output is JSON with and without the option
};

struct ReplayOptions {
  std::string record, trace, against;
  bool json = false;
};

struct CaptureOptions {
  std::string file, csv;
  bool json = false;
};

/// `servogate backup` and `restore`.
struct BackupOptions {
  std::string machine, file, state;
  bool force = false;
};

struct BenchCommands;

/// The parsed command line: the name of the command and its options.
struct CommandLine {
  std::string command;
  RunOptions run;
  UpOptions up;
  ClientOptions client;
  CheckOptions check;
  CanonOptions canon;
  ReplayOptions replay;
  CaptureOptions capture;
  BackupOptions backup;
  TestOptions test;
  PlcCommands plc;
  BusCommands bus;
  std::shared_ptr<BenchCommands> bench;  ///< made by parse_command_line()
  bool json = false;                     ///< of `version`
  std::vector<std::string> words;        ///< the whole line, for the report
};

/// Reads the command line. nullopt: help or an error was printed, `exit_code` tells which.
std::optional<CommandLine> parse_command_line(int argc, char** argv, int& exit_code);

}  // namespace servogate::gateway
