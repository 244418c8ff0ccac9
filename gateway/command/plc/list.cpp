// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/plc/control_client.hpp"
#include "gateway/command/plc/sources.hpp"
#include "gateway/control/server/desk/plc/plc_view.hpp"
#include "gateway/control/server/protocol/reply_json.hpp"

namespace servogate::gateway::command {

namespace {

using nlohmann::json;

const text::Entry kWritten{"plc-list.written", "written {0}", "запись {0}"};
const text::Entry kRead{"plc-list.read", "read {0}", "чтение {0}"};
const text::Entry kForced{"plc-list.forced", "forced to {0}", "удерживается на {0}"};

std::string say(const text::Entry& entry, const std::string& argument) {
  return text::render(entry, std::vector<std::string>{argument}, text::user_language());
}

std::string joined(const json& list) {
  std::string out;
  for (const json& item : list) out += (out.empty() ? "" : ", ") + item.get<std::string>();
  return out;
}

void print_symbols(const json& answer) {
  for (const json& s : answer["symbols"]) {
    const std::string name = s.value("name", ""), place = s.value("place", "");
    print_formatted("%-28s %-14s %-12s%s\n", name.c_str(), s.value("type", "").c_str(), place.c_str(),
                    s.value("retain", false) ? " RETAIN" : "");
    if (s.contains("forced")) print_line("    " + say(kForced, s.value("forced", "")));
    if (!s["written"].empty()) print_line("    " + say(kWritten, joined(s["written"])));
    if (!s["read"].empty()) print_line("    " + say(kRead, joined(s["read"])));
  }
}

/// Without a control: the files are compiled.
int list_files(const PlcListOptions& options, json& answer) {
  PlcSurroundings surroundings;
  std::vector<plc::SourceFile> sources;
  if (!read_surroundings(options.machine, surroundings) || !read_sources(options.files, sources))
    return kWrongUse;
  const plc::CompileResult compiled =
      plc::compile(std::move(sources), surroundings.symbols, surroundings.options);
  print_findings(compiled.findings);
  if (!compiled.ok()) return kWrongUse;
  answer = json::parse(line_of(PlcSymbols{options.files, list_symbols(*compiled.image), {}}));
  return kDone;
}

}  // namespace

int plc_list(const PlcListOptions& options) {
  json answer;
  if (!options.files.empty()) {
    if (const int code = list_files(options, answer); code != kDone) return code;
    if (options.json) print_exact(answer.dump(-1, ' ', false, json::error_handler_t::replace));
  } else {
    ControlClient control;
    if (const int code = control.connect(options.socket); code != kDone) return code;
    answer = control.ask("plc_list");
    if (const int code = ControlClient::tell(answer, options.json); code != kDone) return code;
  }
  if (!options.json) print_symbols(answer);
  return kDone;
}

}  // namespace servogate::gateway::command
