// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/request.hpp"

#include <cmath>

#include "gateway/cli/messages.hpp"
#include "gateway/command/client/tables.hpp"
#include "gateway/control/server/protocol/request_words.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

/// `start` in the middle of a program; null: wrong use, which has been said.
json restart(const ClientOptions& options, json r) {
  r["cmd"] = "restart";
  if (options.feed) r["feed"] = *options.feed;
  r["confirm"] = options.by_hand;
  if (options.line > 0) r["line"] = options.line;
  if (options.from.empty()) return r;
  std::string_view digits = options.from, rest;
  if (digits.starts_with('N') || digits.starts_with('n')) digits.remove_prefix(1);
  double value = 0.0;
  if (!parse_number(digits, value, rest) || !rest.empty() || value < 0.0 || value != std::floor(value)) {
    complain(kBadNumber, {options.from, text::both("a block, as N120", "кадр вида N120")});
    return {};
  }
  r["number"] = static_cast<int>(value);
  return r;
}

}  // namespace

json request_of(const ClientOptions& options) {
  const std::string& c = options.command;
  json r{{"cmd", c},
         {"asker", "command_line"},
         {"language", text::user_language() == text::Language::russian ? "ru" : "en"}};
  if (options.process > 0) r["process"] = options.process;
  if (is_table_command(options)) return table_request(options, std::move(r));
  if (c == "alarms" && options.history) {
    r["cmd"] = "history";
    r["count"] = options.last;
    return r;
  }
  if (c == "start" && (!options.from.empty() || options.line > 0 || options.interrupted))
    return restart(options, std::move(r));
  if ((c == "return" || c == "retrace") && options.feed) r["feed"] = *options.feed;
  if (options.mm) r["mm"] = *options.mm;
  if (options.blocks) r["blocks"] = *options.blocks;
  FormProblem problem;
  if (add_words(r, options.arguments, problem)) return r;
  complain(*problem.entry, problem.arguments);
  return {};
}

}  // namespace servogate::gateway::command
