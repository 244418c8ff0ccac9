// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

#include "gateway/cli/bench_options.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/latency/latency.hpp"
#include "gateway/command/plc/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/compose/plc/compile_beside.hpp"

namespace {

using namespace servogate::gateway;

const servogate::text::Entry kFailed{"cli.failed", "{0}", "{0}"};

/// They only read, and nothing goes on when they end.
constexpr std::array<std::string_view, 11> kNothingToStop = {"backup",    "capture",  "restore", "version",
                                                             "check",     "canon",    "replay",  "plc run",
                                                             "plc check", "plc test", "plc list"};

int carry_out(const CommandLine& line) {
  if (std::find(kNothingToStop.begin(), kNothingToStop.end(), line.command) != kNothingToStop.end())
    command::leave_signals_alone();
  if (line.command == "version") return command::version(line.json);
  if (line.command == "run") return command::run(line.run, line.words);
  if (line.command == "check") return command::check(line.check);
  if (line.command == "canon") return command::canon(line.canon);
  if (line.command == "backup") return command::backup(line.backup);
  if (line.command == "restore") return command::restore(line.backup);
  if (line.command == "replay") return command::replay(line.replay);
  if (line.command == "capture") return command::capture(line.capture);
  if (line.command == "test") return command::test(line.test);
  if (line.command == "plc run") return command::plc_run(line.plc.run);
  if (line.command == "plc check") return command::plc_check(line.plc.check);
  if (line.command == "plc test") return command::plc_test(line.plc.test);
  if (line.command == "plc list") return command::plc_list(line.plc.list);
  if (line.command == "plc watch") return command::plc_watch(line.plc.watch);
  if (line.command == "plc step") return command::plc_step(line.plc.step);
  if (line.command == "plc force") return command::plc_force(line.plc.force);
  if (line.command == "plc load") return command::plc_load(line.plc.load);
  if (line.command == "can bus") return command::can_bus(line.bus.can_bus);
  if (line.command == "can check") return command::can_check(line.bus.can_check);
  if (line.command == "can restart") return command::can_restart(line.bus.can_restart);
  if (line.command == "scan") return command::scan(line.bus.scan);
  if (line.command == "sdo") return command::sdo(line.bus.sdo);
  if (line.command == "od") return command::od(line.bus.od);
  if (line.command == "lss") return command::lss(line.bus.lss);
  if (line.command == "nmt") return command::nmt(line.bus.nmt);
  if (line.command == "modbus read") return command::modbus_read(line.bus.modbus_read);
  if (line.command == "modbus write") return command::modbus_write(line.bus.modbus_write);
  if (line.command == "modbus scan") return command::modbus_scan(line.bus.modbus_scan);
  if (line.command == "latency") return command::latency(line.bench->latency);
  if (line.command.starts_with("bench ")) return command::bench(line.command.substr(6), *line.bench);
  if (line.command == "pendant list") return command::pendant_list(line.bus.pendant_list);
  if (line.command == "pendant watch") return command::pendant_watch(line.bus.pendant_watch);
  if (line.command == "drive") return command::drive(line.bus.drive);
  if (line.command == "io") return command::io(line.bus.io);
  if (line.command == "sim") return command::sim(line.bus.sim);
  if (line.command == "dump") return command::dump(line.bus.dump);
  if (line.command == "play") return command::play(line.bus.play);
  if (line.command == "up") return command::up(line.up);
  return command::client(line.client);
}

}  // namespace

int main(int argc, char** argv) {
  // `test --json FILE` writes a file, and speaks to people.
  const bool json = (argc < 2 || std::string_view(argv[1]) != "test") &&
                    std::any_of(argv + std::min(argc, 1), argv + argc,
                                [](const char* word) { return std::string_view(word) == "--json"; });
  command::watch_signals(json);
  prepare_streams();
  int exit_code = kDone;
  try {
    const auto line = parse_command_line(argc, argv, exit_code);
    if (line) exit_code = carry_out(*line);
  } catch (const std::exception& e) {
    complain(kFailed, {e.what()});
    exit_code = kInfrastructure;
  }
  const int code = end_output(exit_code, json);
  if (compiles_on()) std::_Exit(code);  // it would meet a process that is being taken down
  return code;
}
