// SPDX-License-Identifier: Apache-2.0
// `dump` and `play`: a bus to a log of can-utils, and back.
#include <poll.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "drivers/candump/candump_line.hpp"
#include "drivers/clock.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/named_bus.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/compose/can_transport.hpp"
#include "gateway/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kCannotPlay{"play.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};
const text::Entry kBadLine{"play.bad-line", "{0}:{1}: no line of a candump log",
                           "{0}:{1}: не строка журнала candump"};
const text::Entry kMayMove{
    "play.may-move", "{0} may be a real bus, and what is played can move its drives: --i-may-move",
    "{0} может быть настоящей шиной, воспроизведение может двинуть приводы: --i-may-move"};
const text::Entry kDown{"play.down", "the bus {0} takes no more frames",
                        "шина {0} больше не принимает кадры"};
const text::Entry kGone{"dump.gone", "the bus {0} has gone down: nothing more can be recorded",
                        "шина {0} отключилась: дальше записывать нечего"};
const text::Entry kLost{"dump.lost", "{0} frames were lost on this computer",
                        "на этом компьютере потеряно кадров: {0}"};

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
      wanted =
          print_line(candump::format(frame, time, name)) && (options.count == 0 || ++count < options.count);
    }
    down = transport->bus->state() == image::CanState::down;
    if (wanted && !down) wait_readable(transport->descriptor, 100 * image::kMillisecond);
  }
  if (const std::uint64_t lost = transport->bus->lost(); lost > 0) {
    complain(kLost, {std::to_string(lost)});
    return kInfrastructure;
  }
  if (!wanted || !down) return kDone;
  complain(kGone, {options.bus});
  return kInfrastructure;
}

int play(const PlayOptions& options) {
  if (const std::string why = files::why_unreadable(options.file); !why.empty()) {
    complain(kCannotPlay, {options.file, why});
    return kWrongUse;
  }
  std::ifstream file(options.file);
  std::vector<candump::Line> lines;
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (text.empty()) continue;
    auto line = candump::parse(text);
    if (!line) {
      complain(kBadLine, {options.file, std::to_string(number)});
      return kWrongUse;
    }
    if (!line->frame.error) lines.push_back(std::move(*line));
  }
  int code = kDone;
  const auto transport = open_named(options.bus, options.bit_rate, code);
  if (!transport) return code;
  if (!transport->nothing_real && !options.may_move) {
    complain(kMayMove, {options.bus});
    return kWrongUse;
  }
  const EndBySignal signals;
  const image::Nanoseconds begin = clock_ns(CLOCK_MONOTONIC);
  image::CanFrame heard;
  for (const candump::Line& line : lines) {
    const auto after = static_cast<double>(line.time - lines.front().time) / options.speed;
    const image::Nanoseconds due = begin + static_cast<image::Nanoseconds>(after);
    for (bool sent = false; !sent;) {
      while (transport->bus->receive(heard)) {
      }
      if (signals.ended()) return kStopped;
      const image::Nanoseconds early = due - clock_ns(CLOCK_MONOTONIC);
      if (early > 0) {
        wait_readable(transport->descriptor, std::min(early, 100 * image::kMillisecond));
        continue;
      }
      sent = transport->bus->send(line.frame);
      if (!sent && transport->bus->state() == image::CanState::down) {
        complain(kDown, {options.bus});
        return kInfrastructure;
      }
      if (!sent) wait_readable(transport->descriptor, image::kMillisecond);
    }
  }
  return kDone;
}

}  // namespace servogate::gateway::command
