// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <string>

#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "report/report.hpp"

namespace servogate::gateway::command {

int version(bool json) {
  const report::BuildIdentity id = report::build_identity();
  const std::string v(id.version), c(id.commit);
  if (json)
    print_exact(nlohmann::ordered_json{{"schema", 1}, {"version", v}, {"commit", c}}.dump());
  else
    print_line("servogate " + v + (c.empty() ? "" : " (" + c + ")"));
  return kDone;
}

}  // namespace servogate::gateway::command
