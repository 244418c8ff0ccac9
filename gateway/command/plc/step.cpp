// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <optional>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"
#include "gateway/command/plc/sample_print.hpp"
#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

constexpr int kMostScans = 100'000;

const text::Entry kWaits{"plc-step.waits", "Enter runs a scan, a number so many, Ctrl-D or Ctrl-C lets go",
                         "Enter выполняет скан, число — столько сканов, Ctrl-D или Ctrl-C отпускает"};
const text::Entry kNoNumber{"plc-step.number", "'{0}' is no number of scans from 1 to {1}",
                            "«{0}» не число сканов от 1 до {1}"};

/// One hold, from the first scan to the last.
class Stepping {
 public:
  Stepping(ControlClient& control, const PlcStepOptions& options) : control_(control), options_(options) {}

  /// Has so many scans run, at most, and shows what stands after them.
  int scan(int count) {
    const json answer = control_.ask("plc_step", {{"scans", count}});
    if (const int code = answer.is_null() ? kInfrastructure : answer.value("exit", 0); code != kDone)
      return ControlClient::tell(answer, options_.json);
    return show();
  }
  int show() {
    json request{{"names", options_.names}};
    if (options_.names.empty()) request["body"] = options_.body;
    const json answer = control_.ask("plc_watch", request);
    const int code = ControlClient::tell(answer, options_.json);
    if (code == kDone && !options_.json) print_sample(answer);
    return code;
  }
  /// Scans as they are typed, until the end of the input or a signal.
  int by_hand() {
    tell(text::render(kWaits, {}, text::user_language()));
    while (const std::optional<std::string> line = next_line()) {
      int count = line->empty() ? 1 : 0;
      std::from_chars(line->data(), line->data() + line->size(), count);
      if (count < 1 || count > kMostScans) {
        complain(kNoNumber, {*line, std::to_string(kMostScans)});
        continue;
      }
      if (const int code = scan(count); code != kDone) return code;
    }
    return kDone;
  }

 private:
  std::optional<std::string> next_line() {
    while (signals_seen() == 0) {
      if (const std::size_t end = typed_.find('\n'); end != std::string::npos) {
        std::string line = typed_.substr(0, end);
        typed_.erase(0, end + 1);
        return line;
      }
      pollfd in{STDIN_FILENO, POLLIN, 0};
      if (poll(&in, 1, 200) <= 0) continue;
      std::array<char, 256> bytes{};
      const ssize_t n = read(STDIN_FILENO, bytes.data(), bytes.size());
      if (n <= 0) return std::nullopt;
      typed_.append(bytes.data(), static_cast<std::size_t>(n));
    }
    return std::nullopt;
  }

  ControlClient& control_;
  const PlcStepOptions& options_;
  std::string typed_;
};

}  // namespace

int plc_step(const PlcStepOptions& options) {
  ControlClient control;
  if (const int code = control.connect(options.socket); code != kDone) return code;
  count_signals();
  const json held = control.ask("plc_hold");
  if (held.is_null() || !held.value("ok", false)) return ControlClient::tell(held, options.json);
  if (!options.json) print_line(held.value("text", ""));
  Stepping stepping(control, options);
  int code = stepping.show();
  for (int n = 0; code == kDone && n < options.scans && signals_seen() == 0; ++n) code = stepping.scan(1);
  if (code == kDone && options.scans == 0) code = stepping.by_hand();
  // Whatever happens to this request: the control lets go with the connection.
  const json goes = control.ask("plc_go");
  if (goes.is_null()) return kInfrastructure;
  if (!options.json) print_line(goes.value("text", ""));
  return code;
}

}  // namespace servogate::gateway::command
