// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <thread>

#include "gateway/cli/options.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"
#include "gateway/command/plc/sample_print.hpp"
#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

int plc_watch(const PlcWatchOptions& options) {
  ControlClient control;
  if (const int code = control.connect(options.socket); code != kDone) return code;
  count_signals();
  json request{{"names", options.names}, {"times", options.times}};
  if (options.names.empty() && !options.times) request["body"] = options.body;
  for (int n = 0; (options.samples == 0 || n < options.samples) && signals_seen() == 0; ++n) {
    if (n > 0) std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(options.every_ms));
    if (signals_seen() > 0) break;
    const json answer = control.ask("plc_watch", request);
    const int code = ControlClient::tell(answer, options.json);
    if (code != kDone) return code;
    if (!options.json) print_sample(answer);
  }
  return kDone;
}

}  // namespace servogate::gateway::command
