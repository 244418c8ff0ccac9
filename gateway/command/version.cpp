// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <string>

#include "gateway/command/commands.hpp"
#include "gateway/report/report.hpp"

namespace servogate::gateway::command {

int version(bool json) {
  const report::BuildIdentity id = report::build_identity();
  const std::string v(id.version), c(id.commit);
  if (json)
    std::printf("{\"schema\":1,\"version\":\"%s\",\"commit\":\"%s\"}\n", v.c_str(), c.c_str());
  else
    std::printf("servogate %s%s%s%s\n", v.c_str(), c.empty() ? "" : " (", c.c_str(), c.empty() ? "" : ")");
  return kDone;
}

}  // namespace servogate::gateway::command
