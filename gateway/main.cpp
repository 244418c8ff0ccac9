// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>

#include "gateway/cli/options.hpp"
#include "gateway/command/commands.hpp"

int main(int argc, char** argv) {
  using namespace servogate::gateway;
  int exit_code = kDone;
  const auto line = parse_command_line(argc, argv, exit_code);
  if (!line) return exit_code;
  try {
    if (line->command == "version") return command::version(line->json);
    if (line->command == "run") return command::run(line->run, line->text);
    if (line->command == "check") return command::check(line->check);
    if (line->command == "canon") return command::canon(line->canon);
    if (line->command == "replay") return command::replay(line->replay);
    if (line->command == "plc run") return command::plc_run(line->plc_run);
    if (line->command == "plc check") return command::plc_check(line->plc_check);
    if (line->command == "up") return command::up(line->up, line->text);
    return command::client(line->client);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "servogate: %s\n", e.what());
    return kInfrastructure;
  }
}
