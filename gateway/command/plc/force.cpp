// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <cstdio>

#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/force_setting.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"
#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kWaits{"plc-force.waits", "Enter or Ctrl-C lets go", "Enter или Ctrl-C освобождает"};
const text::Entry kNothing{"plc-force.nothing", "nothing is forced", "ничего не удерживается"};
const text::Entry kRow{"plc-force.row", "{0} = {1} (by {2})", "{0} = {1} ({2})"};

int release(ControlClient& control, const PlcForceOptions& options) {
  std::vector<std::string> names = options.settings;
  if (names.empty()) names.emplace_back();
  int worst = kDone;
  for (const std::string& name : names) {
    const json answer = control.ask("plc_release", {{"name", name}});
    const int code = ControlClient::tell(answer, options.json);
    if (code == kDone && !options.json) print_line(answer.value("text", ""));
    worst = std::max(worst, code);
  }
  return worst;
}

/// Without settings: what is forced now.
int show(ControlClient& control, const PlcForceOptions& options) {
  const json status = control.ask("status");
  if (status.is_null()) return kInfrastructure;
  const json forced = status.value("forced", json::array());
  if (options.json) {
    print_exact(json{{"schema", 1}, {"forced", forced}}.dump(-1, ' ', false, json::error_handler_t::replace));
    return kDone;
  }
  if (forced.empty()) print_line(text::render(kNothing, {}, text::user_language()));
  for (const json& f : forced)
    print_line(text::render(
        kRow, std::vector<std::string>{f.value("name", ""), f.value("value", ""), f.value("user", "")},
        text::user_language()));
  return kDone;
}

}  // namespace

int plc_force(const PlcForceOptions& options) {
  const auto settings = force_settings(options.release ? std::vector<std::string>() : options.settings);
  if (!settings) return kWrongUse;
  ControlClient control;
  if (const int code = control.connect(options.socket); code != kDone) return code;
  if (options.release) return release(control, options);
  if (settings->empty()) return show(control, options);
  if (!options.stay) count_signals();
  for (const auto& [name, value] : *settings) {
    const json answer = control.ask("plc_force", {{"name", name}, {"value", value}, {"stay", options.stay}});
    const int code = ControlClient::tell(answer, options.json);
    if (code != kDone) return code;
    if (!options.json) print_line(answer.value("text", ""));
  }
  if (options.stay) return kDone;
  // The control lets go when this connection ends, however it ends; asking now and then shows when it is
  // gone.
  tell(text::render(kWaits, {}, text::user_language()));
  while (signals_seen() == 0) {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    if (poll(&in, 1, 200) > 0) break;
    if (control.ask("status").is_null()) return kInfrastructure;
  }
  return kDone;
}

}  // namespace servogate::gateway::command
