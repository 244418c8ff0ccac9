// SPDX-License-Identifier: Apache-2.0
// `servogate bench`: which of its commands.
#include "gateway/command/bench/bench.hpp"

#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

int bench(const std::string& name, const BenchCommands& options) {
  if (name == "move") return bench_move(options.move);
  if (name == "jog") return bench_jog(options.jog);
  if (name == "response") return bench_response(options.response);
  if (name == "identify") return bench_identify(options.identify);
  if (name == "tune") return bench_tune(options.tune);
  if (name == "positioning") return bench_positioning(options.positioning);
  if (name == "circle") return bench_circle(options.circle);
  if (name == "compare") return bench_compare(options.compare);
  if (name == "record") return bench_record(options.record);
  return bench_run(options.run);
}

}  // namespace servogate::gateway::command
