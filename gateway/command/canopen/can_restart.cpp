// SPDX-License-Identifier: Apache-2.0
// `servogate can restart`: a controller that has taken itself off the bus takes part again.
#include <cerrno>
#include <nlohmann/json.hpp>

#include "drivers/socketcan/link.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/commands.hpp"

namespace servogate::gateway::command {

namespace {

using text::Entry;

constexpr std::string_view kScheme = "socketcan:";

const Entry kNotByHand{"restart.not-by-hand",
                       "{0}: only an interface of Linux is restarted by hand; a gsusb: adapter does it by "
                       "itself, and a bus between "
                       "processes never goes off",
                       "{0}: вручную перезапускается только интерфейс Linux; адаптер gsusb: делает это сам, "
                       "а шина между процессами не "
                       "отключается"};
const Entry kNoInterface{"restart.no-interface", "there is no CAN interface {0}", "нет интерфейса CAN {0}"};
const Entry kDown{"restart.down", "{0} is down, not bus-off; bring it up with: sudo {1}",
                  "{0} выключен, а не bus-off; включить: sudo {1}"};
const Entry kNotOff{"restart.not-off", "{0} is not bus-off: there is nothing to restart",
                    "{0} не в состоянии bus-off: перезапускать нечего"};
const Entry kRefused{"restart.refused", "{0} is not restarted: {1}", "{0} не перезапущен: {1}"};
const Entry kRights{"restart.rights",
                    "{0} is not restarted: that needs the right to administer the network (sudo)",
                    "{0} не перезапущен: нужно право управлять сетью (sudo)"};
const Entry kRestarted{
    "restart.done",
    "{0} takes part in the bus again; look for the cause, and see `servogate can check` for its "
    "error counters",
    "{0} снова участвует в обмене; найдите причину, счётчики ошибок покажет `servogate can check`"};

/// What became of it, where nothing failed.
int tell(const CanRestartOptions& options, const std::string& name, bool restarted) {
  if (options.json)
    print_json_line({{"interface", name}, {"restarted", restarted}});
  else
    print_line(text::render(restarted ? kRestarted : kNotOff, std::vector<std::string>{name},
                            text::user_language()));
  return kDone;
}

}  // namespace

int can_restart(const CanRestartOptions& options) {
  const auto named = named_bus(options.bus, 0.0);
  if (!named) return kWrongUse;
  if (!named->url.starts_with(kScheme)) {
    complain(kNotByHand, {named->url});
    return kWrongUse;
  }
  const std::string name = named->url.substr(kScheme.size());
  const auto link = socketcan::read_link(name);
  if (!link || !link->is_can) {
    complain(kNoInterface, {name});
    return kInfrastructure;
  }
  if (!link->up) {
    const std::uint32_t rate = named->bit_rate > 0 ? named->bit_rate : link->bit_rate;
    complain(kDown, {name, rate > 0 ? socketcan::command_up(*link, rate) : "ip link set " + name + " up"});
    return kInfrastructure;
  }
  if (link->state != image::CanState::bus_off) return tell(options, name, false);
  if (const int error = socketcan::restart_link(link->index); error != 0) {
    if (error == EPERM)
      complain(kRights, {name});
    else
      complain(kRefused, {name, text::words_of(error)});
    return kInfrastructure;
  }
  return tell(options, name, true);
}

}  // namespace servogate::gateway::command
