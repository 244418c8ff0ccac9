// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/jog.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <string>

#include "firmware_if/text/finding.hpp"
#include "firmware_if/text/units.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/command/client/wait.hpp"
#include "gateway/command/signals.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

const text::Entry kStands{"client.stands", "{0} stands at {1} {2} (machine coordinates)",
                          "{0} стоит на {1} {2} (в координатах станка)"};
const text::Entry kStandsDiameter{"client.stands-diameter",
                                  "{0} stands at {1} {2} in diameter (machine coordinates)",
                                  "{0} стоит на {1} {2} по диаметру (в координатах станка)"};

const text::Entry kLastSeen{"client.last-seen", "{0} was last seen at {1} {2}: its drive does not answer",
                            "{0}: последнее известное место {1} {2}, привод не отвечает"};

/// Keeps a continuous jog alive until the operator ends it or it ends by itself (`by_itself`); its last
/// answer.
json hold(SocketClient& client, const json& request, const json& begun, bool& by_itself) {
  const int pause_ms = std::max(1, static_cast<int>(begun.value("keep_alive_ms", 30.0)));
  while (signals_seen() == 0) {
    pollfd in{STDIN_FILENO, POLLIN, 0};
    if (poll(&in, 1, pause_ms) > 0) break;
    json reply = ask(client, {{"cmd", "keep_alive"}, {"language", request["language"]}});
    by_itself = !reply.value("moving", false);
    if (by_itself) return reply;
  }
  return ask(client, {{"cmd", "jog_stop"}, {"axis", request["axis"]}, {"language", request["language"]}});
}

json axis_of(const json& status, const std::string& letter) {
  for (const json& a : status.value("axes", json::array()))
    if (a.value("letter", "") == letter) return a;
  return json::object();
}

}  // namespace

int follow_jog(SocketClient& client, const json& request, json& reply) {
  const bool continuous = request["cmd"] == "jog_continuous";
  bool by_itself = false;
  json ended;
  if (continuous) {
    ended = hold(client, request, reply, by_itself);
    if (ended.is_null()) {
      reply = nullptr;
      return kInfrastructure;
    }
  }
  json status = continuous ? json::object() : reply;
  const int waited = wait_for_end(client, request, status);
  if (status.is_null()) {
    reply = nullptr;
    return kInfrastructure;
  }
  const json axis = axis_of(status, request["axis"].get<std::string>());
  const json end = ended.contains("moving") ? ended : axis.value("jog_end", json());
  const std::string reason = end.is_object() ? end.value("reason", "") : "";
  const bool own_stop = continuous && !by_itself;
  const int code = waited == kInfrastructure                                ? kInfrastructure
                   : reason == "arrived" || (reason == "asked" && own_stop) ? kDone
                   : reason == "asked"                                      ? kStopped
                                                                            : kAlarm;
  const std::string stands = text::render(
      axis.value("drive", "") == "offline" ? kLastSeen
      : axis.value("diameter", false)      ? kStandsDiameter
                                           : kStands,
      std::vector<std::string>{axis.value("letter", ""), text::number(axis.value("position", 0.0), 3),
                               text::unit_words(axis.value("unit", ""))},
      text::user_language());
  reply = {{"ok", code == kDone},
           {"exit", code},
           {"text", code == kDone || !end.is_object() ? stands : end.value("text", "") + "; " + stands},
           {"reason", reason},
           {"axis", axis.value("letter", "")},
           {"position", axis.value("position", 0.0)},
           {"unit", axis.value("unit", "")},
           {"status", status}};
  if (code != kDone) reply["code"] = end.is_object() ? end.value("code", "") : "client.no-cycle";
  return code;
}

}  // namespace servogate::gateway::command
