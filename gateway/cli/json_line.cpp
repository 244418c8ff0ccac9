// SPDX-License-Identifier: Apache-2.0
#include "gateway/cli/json_line.hpp"

#include <nlohmann/json.hpp>

#include "gateway/cli/standard_output.hpp"

namespace servogate::gateway {

void print_json_line(nlohmann::json object) {
  object["schema"] = 1;
  print_exact(object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  keep_order();
}

}  // namespace servogate::gateway
