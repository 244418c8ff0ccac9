// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

#include "gateway/cli/messages.hpp"

namespace servogate::gateway {

/// Standard output of the commands. Every command prints through this and through nothing else, so that what
/// was lost is said, and a reader who has seen enough (`| head`) ends it quietly.

/// Before anything is opened: keeps the numbers 0 to 2 for the standard streams where the caller closed them,
/// and makes a closed pipe an error of the write instead of the end of a process that moves a machine.
void prepare_streams();

/// Appends to standard output as it is. False: the rest is in vain, nobody reads it or it cannot be written.
bool print(std::string_view text);
/// The same for people, with a line end: what would command a terminal as text::visible() shows it.
bool print_line(std::string_view line);
/// The same on standard error.
void tell(std::string_view words);
/// print_line() for programs, to the byte, with a line end: JSON.
bool print_exact(std::string_view json);

/// print_line() without the line end, formatted as by printf.
[[gnu::format(printf, 1, 2)]] bool print_formatted(const char* format, ...);

/// Writes what is buffered, so that what is said next on standard error stands behind it where both go to one
/// file.
void keep_order();

/// Something stands on standard output, or will. May be called by a signal handler.
bool has_printed() noexcept;

/// What a command with --json leaves when it failed before it had anything to print: one line without its
/// end.
std::string error_object(const LastError& error, int code);

/// At the end of a command: writes what is still buffered. With `json` a command that failed before it had
/// anything to print leaves one object with its error. Returns `code`, or kInfrastructure after saying what
/// could not be written. A closed pipe changes nothing.
int end_output(int code, bool json);

}  // namespace servogate::gateway
