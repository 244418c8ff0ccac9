// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/signals.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstring>
#include <string>

#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kNothingBegun{"cli.stopped", "stopped by the operator before anything had begun",
                                "остановлено оператором: ещё ничего не началось"};

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

/// What a handler may use: plain bytes that are whole before the handler is there.
struct Line {
  std::array<char, 768> bytes{};
  std::size_t size = 0;

  void hold(const std::string& line) {
    size = std::min(line.size(), bytes.size());
    std::memcpy(bytes.data(), line.data(), size);
  }
  void tell(int descriptor) const {
    [[maybe_unused]] const ssize_t ignored = write(descriptor, bytes.data(), size);
  }
};
struct Words {
  Line sentence;
  Line object;  ///< the same for --json
};
Words words[2];
std::atomic<int> words_in_force{0};
std::atomic<bool> counting{false};
std::atomic<bool> as_json{false};
std::atomic<int> seen{0};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

extern "C" void on_signal(int) {
  if (counting.load()) {
    seen.fetch_add(1);
    return;
  }
  const Words& w = words[words_in_force.load()];
  w.sentence.tell(STDERR_FILENO);
  if (as_json.load() && !has_printed()) w.object.tell(STDOUT_FILENO);
  _exit(kStopped);
}

void handle(void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  for (const int signal : kSignals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal != SIGHUP || before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

}  // namespace

void watch_signals(bool json) {
  as_json.store(json);
  say_when_stopped(kNothingBegun);
  handle(on_signal, SA_RESTART);
}

void say_when_stopped(const text::Entry& entry) {
  const int next = 1 - words_in_force.load();
  const LastError said{std::string(entry.id), text::render(entry, {}, text::user_language())};
  words[next].sentence.hold("servogate: " + said.text + " [" + said.code + "]\n");
  words[next].object.hold(error_object(said, kStopped) + "\n");
  words_in_force.store(next);
}

void count_signals(bool interrupting) {
  counting.store(true);
  handle(on_signal, interrupting ? 0 : SA_RESTART);
}

int signals_seen() noexcept { return seen.load(); }

void refuse_suspension() { std::signal(SIGTSTP, SIG_IGN); }

void leave_signals_alone() { handle(SIG_DFL, 0); }

}  // namespace servogate::gateway::command
