// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/messages.hpp"

#include <unistd.h>
#include <mutex>

#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway {

const text::Entry kCannotWrite{"cli.cannot-write", "cannot write {0}: {1}", "не удаётся записать {0}: {1}"};
const text::Entry kOutputLost{"cli.output-lost", "cannot write to standard output: {0}",
                              "не удаётся записать в стандартный вывод: {0}"};
const text::Entry kStartNowForbidden{
    "cli.start-now-forbidden",
    "--start-now is not allowed by this machine file ([run] allow_start_now = true allows it)",
    "--start-now не разрешён файлом станка (разрешает [run] allow_start_now = true)"};
const text::Entry kNoStartButton{"cli.no-start-button",
                                 "the buses are real and the machine file names no start button ([run] "
                                 "start_point), so nothing would ever start: "
                                 "name one, or use `servogate up`, `home` and `start`",
                                 "шины настоящие, а кнопка пуска в файле станка не названа ([run] "
                                 "start_point), поэтому ничего не начнётся: "
                                 "назовите её или используйте `servogate up`, `home` и `start`"};
const text::Entry kLeavesTravel{"cli.leaves-travel", "{0} moves from {1} to {2}; its travel is {3} to {4}",
                                "{0} движется от {1} до {2}; ход оси от {3} до {4}"};

namespace {
LastError last;
std::mutex last_lock;  ///< clients of a running control complain from threads of their own

/// Standard error is a terminal that shows colours, and nobody has asked for none (no-color.org).
bool coloured() {
  const char* none = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  const bool wanted = none == nullptr || *none == '\0';
  return wanted && terminal != nullptr && std::strcmp(terminal, "dumb") != 0 && ::isatty(STDERR_FILENO) != 0;
}

/// The place in bold, "error" in red, "warning" in yellow.
std::string in_colour(const text::Finding& f) {
  const std::string words = f.str();
  const bool error = f.severity == text::Severity::error;
  const std::string mark = error ? ": error: " : ": warning: ";
  const std::size_t at = words.find(mark);
  if (at == std::string::npos || !coloured()) return words;
  return "\x1b[1m" + words.substr(0, at + 2) + (error ? "\x1b[31m" : "\x1b[33m") +
         mark.substr(2, mark.size() - 3) + "\x1b[0m" + words.substr(at + mark.size() - 1);
}
}  // namespace

const LastError& last_error() noexcept { return last; }

void tell(std::string_view words) { std::fprintf(stderr, "%s\n", text::visible(words).c_str()); }

int print_findings(const std::vector<text::Finding>& findings) {
  int errors = 0;
  keep_order();
  for (const text::Finding& f : findings) {
    std::fprintf(stderr, "%s\n%s", in_colour(f).c_str(), f.excerpt().c_str());
    if (f.severity != text::Severity::error) continue;
    if (errors++ == 0) last = {f.entry == nullptr ? "" : std::string(f.entry->id), f.str()};
  }
  return errors;
}

void complain(const text::Entry& entry, const std::vector<std::string>& arguments) {
  const LastError error{std::string(entry.id), text::render(entry, arguments, text::user_language())};
  const std::scoped_lock lock(last_lock);
  last = error;
  keep_order();
  tell("servogate: " + error.text + " [" + error.code + "]");
}

}  // namespace servogate::gateway
