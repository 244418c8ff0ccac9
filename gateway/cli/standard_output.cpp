// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/standard_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/options.hpp"

namespace servogate::gateway {

namespace {

/// errno of the first write that failed, 0: none.
int failure = 0;
std::atomic<bool> printed{false};  ///< asked by a signal handler, too

bool note(bool written) {
  if (!written && failure == 0) failure = errno != 0 ? errno : EIO;
  return written;
}

}  // namespace

void prepare_streams() {
  std::signal(SIGPIPE, SIG_IGN);
  // Opened the wrong way round, so that using it stays the error that it is. open() takes the lowest number.
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) != fd) return;
}

bool print(std::string_view text) {
  if (failure != 0) return false;
  printed = true;
  errno = 0;
  return note(std::fwrite(text.data(), 1, text.size(), stdout) == text.size());
}

bool print_line(std::string_view line) { return print(text::visible(line)) && print("\n"); }

bool print_exact(std::string_view json) { return print(json) && print("\n"); }

bool print_formatted(const char* format, ...) {
  if (failure != 0) return false;
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string words(static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, arguments))),
                    '\0');
  std::vsnprintf(words.data(), words.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return print(text::visible(words));
}

void keep_order() {
  errno = 0;
  if (failure == 0) note(std::fflush(stdout) == 0);
}

bool has_printed() noexcept { return printed; }

std::string error_object(const LastError& error, int code) {
  return nlohmann::json{
      {"schema", 1}, {"exit", code}, {"error", {{"code", error.code}, {"text", error.text}}}}
      .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

int end_output(int code, bool json) {
  if (json && !printed && code != kDone) print_exact(error_object(last_error(), code));
  keep_order();
  if (failure == 0 || failure == EPIPE) return code;
  complain(kOutputLost, {text::words_of(failure)});
  return kInfrastructure;
}

}  // namespace servogate::gateway
