// SPDX-License-Identifier: Apache-2.0
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "drivers/candump/candump_line.hpp"
#include "drivers/usercan/server/bus_server.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/input_lines.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kServing{"can.serving", "{0}: {1} at {2} bit/s", "{0}: {1}, {2} бит/с"};
const text::Entry kBadAddress{"can.bad-address", "'{0}' is no address; expected HOST:PORT or unix:PATH",
                              "«{0}» — не адрес; нужен ХОСТ:ПОРТ или unix:ПУТЬ"};
const text::Entry kNoFaults{
    "can.no-faults",
    "{0}: the bus alone has no devices that could fail; give faults to `servogate drive`, `io`, `sim` or "
    "`up`",
    "{0}: у самой шины нет устройств, которые могли бы отказать; неисправности принимают `servogate drive`, "
    "`io`, `sim` и `up`"};
const text::Entry kUntilWithoutLockstep{"can.until-without-lockstep", "--until needs --lockstep",
                                        "--until требует --lockstep"};

void say(const drivers::Notice& notice) {
  tell("servogate: " + notice.str() + " [" + std::string(notice.entry->id) + "]");
}

/// Every frame of a bus as `candump -l` writes it.
class Log final : public mock::CanMonitor {
 public:
  Log(const std::string& file, std::string bus, image::Nanoseconds epoch)
      : file_(file), bus_(std::move(bus)), epoch_(epoch) {}
  void on_wire(const mock::CanFrame& f, int, image::Nanoseconds, image::Nanoseconds end,
               Outcome outcome) noexcept override {
    if (outcome != Outcome::error) file_ << candump::format(f, epoch_ + end, bus_) << '\n';
  }
  bool good() { return static_cast<bool>(file_.flush()); }

 private:
  std::ofstream file_;
  std::string bus_;
  image::Nanoseconds epoch_;
};

}  // namespace

int can_bus(const CanBusOptions& options) {
  const auto address = usercan::parse_address(options.listen);
  if (!address) {
    complain(kBadAddress, {options.listen});
    return kWrongUse;
  }
  if (options.until > 0.0 && options.lockstep == 0) {
    complain(kUntilWithoutLockstep, {});
    return kWrongUse;
  }
  usercan::BusServerConfig config;
  config.listen = *address;
  config.buses = options.names;
  config.bit_rate = static_cast<std::uint32_t>(options.bit_rate);
  config.lockstep = options.lockstep;
  config.until = std::llround(options.until * 1e9);
  drivers::Notice why;
  const EndBySignal signals;
  const auto report = [json = options.json](const drivers::Notice& notice) {
    say(notice);
    if (json)
      print_json_line({{"event", "notice"}, {"code", std::string(notice.entry->id)}, {"text", notice.str()}});
  };
  const auto server = usercan::BusServer::open(config, report, why);
  if (server == nullptr) {
    complain(*why.entry, why.arguments);
    return kInfrastructure;
  }
  std::unique_ptr<Log> log;
  if (!options.log.empty()) {
    log = std::make_unique<Log>(options.log, options.names.front(), server->epoch());
    if (!log->good()) {
      complain(kCannotWrite, {options.log, text::words_of(errno)});
      return kInfrastructure;
    }
    server->set_monitor(0, log.get());
  }
  std::string names;
  for (const std::string& name : options.names) names += (names.empty() ? "" : ", ") + name;
  tell(text::render(kServing,
                    std::vector<std::string>{server->address().str(), names, text::number(options.bit_rate)},
                    text::user_language()));
  if (options.json)
    print_json_line({{"event", "serving"},
                     {"address", server->address().str()},
                     {"buses", options.names},
                     {"bit_rate", options.bit_rate}});
  InputLines input(true);
  while (!signals.ended() && server->serve(100 * image::kMillisecond))
    while (const auto line = input.next()) complain(kNoFaults, {*line});
  if (log == nullptr || log->good()) return kDone;
  complain(kCannotWrite, {options.log, text::words_of(errno)});
  return kInfrastructure;
}

}  // namespace servogate::gateway::command
