// SPDX-License-Identifier: Apache-2.0
// `servogate dump`: a bus as a log of can-utils.
#include <poll.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "drivers/candump/candump_line.hpp"
#include "drivers/clock.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/control/compose/can_transport.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kGone{"dump.gone", "the bus {0} has gone down: nothing more can be recorded",
                        "шина {0} отключилась: дальше записывать нечего"};
using drivers::clock_ns;

/// Opens what the command line names, saying what is wrong with it; `code` is the exit code then.
std::optional<CanTransport> open_named(const std::string& name, double bit_rate, int& code) {
  const auto named = named_bus(name, bit_rate);
  code = kWrongUse;
  if (!named) return std::nullopt;
  CanTransportOptions options;
  options.bit_rate = named->bit_rate;
  drivers::Notice why;
  auto opened = open_can(named->url, options, why);
  if (!opened) complain(*why.entry, why.arguments);
  code = kInfrastructure;
  return opened;
}

/// The name of the interface in a log: what stands behind the last colon or slash, as can-utils has no more
/// room.
std::string short_name(const std::string& named) {
  const std::size_t at = named.find_last_of(":/#");
  return at == std::string::npos || at + 1 == named.size() ? named : named.substr(at + 1);
}

/// A frame for programs: "id" hexadecimal with 3 digits or, of an extended one, 8; "t" s since 1970.
nlohmann::json object_of(const image::CanFrame& frame, image::Nanoseconds time, const std::string& bus) {
  const std::string text = candump::format(frame, time, bus);
  // "(T) BUS ID#DATA", "ID#R3", "ID##FDATA": identifier and data as can-utils writes them.
  const std::string word = text.substr(text.rfind(' ') + 1);
  const std::size_t hash = word.find('#');
  nlohmann::json out{{"schema", 1},
                     {"t", static_cast<double>(time) / 1e9},
                     {"bus", bus},
                     {"id", word.substr(0, hash)},
                     {"data", ""}};
  if (frame.remote)
    out["remote"] = true;
  else
    out["data"] = word.substr(hash + (frame.fd ? 3 : 1));
  if (frame.fd) out["fd"] = true;
  if (frame.error) out["error"] = true;
  return out;
}

void wait_readable(int descriptor, image::Nanoseconds at_most) {
  pollfd p{descriptor, POLLIN, 0};
  const timespec limit{at_most / image::kSecond, at_most % image::kSecond};
  ppoll(&p, 1, &limit, nullptr);
}

}  // namespace

int dump(const DumpOptions& options) {
  int code = kDone;
  const auto transport = open_named(options.bus, options.bit_rate, code);
  if (!transport) return code;
  const EndBySignal signals;
  const std::string name = short_name(options.bus);
  const image::Nanoseconds begin = clock_ns(CLOCK_MONOTONIC);
  const image::Nanoseconds until = options.seconds > 0.0 ? begin + std::llround(options.seconds * 1e9) : 0;
  std::int64_t count = 0;
  image::CanFrame frame;
  bool wanted = true, down = false;
  while (wanted && !down && !signals.ended() && (until == 0 || clock_ns(CLOCK_MONOTONIC) < until)) {
    while (wanted && transport->bus->receive(frame)) {
      const image::Nanoseconds time = frame.timestamp_ns + drivers::realtime_ahead();
      wanted = (options.json ? print_exact(object_of(frame, time, name).dump())
                             : print_line(candump::format(frame, time, name))) &&
               (options.count == 0 || ++count < options.count);
    }
    std::fflush(stdout);  // whoever reads along sees what has come
    down = transport->bus->state() == image::CanState::down;
    if (wanted && !down) wait_readable(transport->descriptor, 100 * image::kMillisecond);
  }
  if (wanted && down) {
    complain(kGone, {options.bus});
    code = kInfrastructure;
  } else {
    code = kDone;
  }
  return unless_frames_lost(code, options.bus, *transport->bus);
}

}  // namespace servogate::gateway::command
