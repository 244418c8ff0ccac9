// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/text/finding.hpp"

/// Ctrl-C, Ctrl-\, SIGTERM and the end of the terminal as wishes of the operator. One a process; the main
/// thread's. A terminal's end that the caller ignores (nohup) stays ignored.
namespace servogate::gateway::command {

/// First act of main(): from here on the first signal says that nothing has begun and ends the program at
/// once with exit code 3, until one of the functions below says otherwise.
/// `json`: the command was called with --json; what ends it then says the same as an object on standard
/// output, unless something stands there already.
void watch_signals(bool json);

/// As before, but what is said is this sentence.
void say_when_stopped(const text::Entry& entry);

/// From here on the command looks itself: signals are counted. `interrupting`: system calls that wait are
/// interrupted by them.
void count_signals(bool interrupting = false);
/// Ctrl-Z does not suspend this process: what drives an axis cannot be laid aside.
void refuse_suspension();
/// How many have come since count_signals().
int signals_seen() noexcept;

/// For commands that an operator has nothing to stop in: what the system does by itself.
void leave_signals_alone();

/// Ends a command that would otherwise run on: its loop asks ended(). Waiting system calls are interrupted.
class EndBySignal {
 public:
  EndBySignal() { count_signals(true); }
  bool ended() const noexcept { return signals_seen() > 0; }
};

}  // namespace servogate::gateway::command
