// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/client/request.hpp"

#include <charconv>
#include <cmath>
#include <filesystem>

#include "firmware_if/text/decimal_comma.hpp"
#include "firmware_if/text/units.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/command/client/tables.hpp"
#include "gateway/command/client/texts.hpp"

namespace servogate::gateway::command {

using nlohmann::json;

namespace {

const text::Entry kArguments{"client.arguments", "`{0}` takes: {1}", "`{0}` принимает: {1}"};

/// A finite number at the front of `text`; `rest`: what is behind it.
bool parse_number(std::string_view text, double& value, std::string_view& rest) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  rest = text.substr(static_cast<std::size_t>(end - text.data()));
  return error == std::errc{} && std::isfinite(value) && !rest.starts_with(',');
}

}  // namespace

json request_of(const ClientOptions& options) {
  const std::vector<std::string>& a = options.arguments;
  const std::string& c = options.command;
  json r{{"cmd", c},
         {"asker", "command_line"},
         {"language", text::user_language() == text::Language::russian ? "ru" : "en"}};
  const auto comma = [](const std::string& what) {
    const std::string point = text::with_decimal_point(what);
    if (!point.empty()) complain(kComma, {what, point});
    return !point.empty();
  };
  const auto wrong = [&](const char* takes) {
    if (a.empty() || !comma(a.back())) complain(kArguments, {c, takes});
    return json();
  };
  const auto not_a = [&](const std::string& what, std::string_view english, std::string_view russian) {
    if (!comma(what)) complain(kBadNumber, {what, text::both(english, russian)});
    return json();
  };
  if (options.process > 0) r["process"] = options.process;
  std::string_view rest;
  double value = 0.0;
  if (is_table_command(options)) return table_request(options, std::move(r));
  if (c == "alarms" && options.history) {
    r["cmd"] = "history";
    r["count"] = options.last;
  } else if (c == "home") {
    r["axes"] = a;
  } else if (c == "jog") {
    r["axis"] = a[0];
    if (a[1] == "+" || a[1] == "-") {
      r["cmd"] = "jog_continuous";
      r["value"] = a[1] == "+" ? 1 : -1;
    } else {
      if (!parse_number(a[1], value, rest))
        return not_a(a[1], "a distance such as +1mm or -0.5deg", "перемещение вида +1mm или -0.5deg");
      r["value"] = value;
      if (!rest.empty()) r["unit"] = text::unit_symbol(rest);
    }
  } else if (c == "zero") {
    if (a.size() == 2 && !parse_number(a[1], value, rest)) return not_a(a[1], "a number", "число");
    r["axis"] = a[0];
    r["value"] = value;
    if (!rest.empty()) r["unit"] = text::unit_symbol(rest);
  } else if (c == "mdi") {
    std::string block = a[0];
    for (std::size_t i = 1; i < a.size(); ++i) block += " " + a[i];
    r["block"] = block;
  } else if (c == "load") {
    r["program"] = std::filesystem::absolute(a[0]).string();
  } else if (c == "start" && (!options.from.empty() || options.line > 0 || options.interrupted)) {
    r["cmd"] = "restart";
    if (options.feed) r["feed"] = *options.feed;
    r["confirm"] = options.by_hand;
    if (options.line > 0) r["line"] = options.line;
    if (!options.from.empty()) {
      std::string_view digits = options.from;
      if (digits.starts_with('N') || digits.starts_with('n')) digits.remove_prefix(1);
      if (!parse_number(digits, value, rest) || !rest.empty() || value < 0.0 || value != std::floor(value))
        return not_a(options.from, "a block, as N120", "кадр вида N120");
      r["number"] = static_cast<int>(value);
    }
  } else if (c == "return" && options.feed) {
    r["feed"] = *options.feed;
  } else if (c == "assign") {
    r["axis"] = a[0];
  } else if (c == "override") {
    if (!parse_number(a[0], value, rest) || (!rest.empty() && rest != "%")) return wrong("PCT (0 to 150)");
    r["value"] = value;
  } else if (c == "power") {
    if (a[0] != "on" && a[0] != "off") return wrong("on | off");
    r["value"] = a[0] == "on" ? 1 : 0;
  } else if (c == "input") {
    r["point"] = a[0];
    if (a[1] == "on" || a[1] == "off")
      r["value"] = a[1] == "on";
    else if (a[1] == "auto")
      r["value"] = "auto";
    else if (parse_number(a[1], value, rest) && rest.empty())
      r["value"] = value;
    else
      return wrong("POINT on | off | auto | NUMBER");
  }
  return r;
}

}  // namespace servogate::gateway::command
