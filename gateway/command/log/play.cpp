// SPDX-License-Identifier: Apache-2.0
// `servogate play`: a log of can-utils back onto a bus.
#include <poll.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "drivers/candump/candump_line.hpp"
#include "drivers/clock.hpp"
#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/canopen/bus/foreign_master.hpp"
#include "gateway/command/canopen/bus/held_bus.hpp"
#include "gateway/command/canopen/bus/tool_bus.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/log/frame_filter.hpp"
#include "machine/files/read_file.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kCannotRead{"play.cannot-read", "cannot read {0}: {1}", "не читается {0}: {1}"};
const text::Entry kBadLine{"play.bad-line", "{0}:{1}: no line of a candump log",
                           "{0}:{1}: не строка журнала candump"};
const text::Entry kMayMove{
    "play.may-move", "{0} may be a real bus, and what is played can move its drives: --i-may-move",
    "{0} может быть настоящей шиной, воспроизведение может двинуть приводы: --i-may-move"};
const text::Entry kNoFd{
    "play.no-fd", "{0}:{1}: a CAN FD frame, and {2} carries classic frames only; nothing was played",
    "{0}:{1}: кадр CAN FD, а {2} переносит только классические кадры; ничего не воспроизведено"};
const text::Entry kPlayed{"play.played", "{0} of {1} frames were played",
                          "воспроизведено кадров: {0} из {1}"};
const text::Entry kLeftOut{"play.left-out", "left out: {0}", "пропущено: {0}"};
const text::Entry kErrors{"play.errors", "{0} error frames of the log were not played: nobody can send one",
                          "кадры ошибок из журнала не воспроизведены ({0}): послать такой кадр нельзя"};
const text::Entry kTwoSenders{
    "play.two-senders",
    "{0} came from the bus as well while the log was played: two senders of one identifier disturb each "
    "other. "
    "`--from master` leaves out what devices sent, `--node` and `--id` choose what is played",
    "{0}: эти кадры во время воспроизведения приходили и с шины, два отправителя одного идентификатора "
    "мешают "
    "друг другу. `--from master` пропускает то, что послали устройства; `--node` и `--id` выбирают кадры"};
using drivers::clock_ns;
struct Played {
  candump::Line line;
  int number;  ///< of the line in its file
};
using Log = std::vector<Played>;

constexpr const char* kWhat = "`play`";

/// What of the file is played, and what is not.
struct Sorted {
  Log log;
  FrameCount left_out;
  std::int64_t errors = 0;  ///< error frames, which nobody can send
};

/// kDone, or the exit code after saying what is wrong with the file.
int read_log(const std::string& name, const FrameFilter& filter, Sorted& sorted) {
  if (const std::string why = files::why_unreadable(name); !why.empty()) {
    complain(kCannotRead, {name, why});
    return kWrongUse;
  }
  std::ifstream file(name);
  std::string text;
  for (int number = 1; std::getline(file, text); ++number) {
    if (text.empty()) continue;
    auto line = candump::parse(text);
    if (!line) {
      complain(kBadLine, {name, std::to_string(number)});
      return kWrongUse;
    }
    if (line->frame.error) {
      ++sorted.errors;
      continue;
    }
    if (!filter.passes(line->frame))
      sorted.left_out.add(line->frame);
    else
      sorted.log.push_back({std::move(*line), number});
  }
  return kDone;
}

/// What only a master sends is played onto a bus that has none; what devices send, too, where real ones are.
int may_play(ToolBus& bus, const std::optional<Holder>& holder, const Log& log, const PlayOptions& options) {
  const bool nothing_real = bus.transport().nothing_real;
  const bool commands = std::any_of(log.begin(), log.end(),
                                    [](const Played& p) { return canopen::sent_by_masters(p.line.frame); });
  if (holder && (commands || !nothing_real)) return refuse_held(*holder, options.bus, kWhat);
  if (!nothing_real && !options.may_move) {
    complain(kMayMove, {options.bus});
    return kWrongUse;
  }
  return commands ? must_be_idle(bus, kWhat, {}) : kDone;
}

/// Before the first frame: a log is played whole or not at all.
int all_pass(ToolBus& bus, const Log& log, const PlayOptions& options) {
  if (bus.transport().bus->carries_fd()) return kDone;
  const auto fd = std::find_if(log.begin(), log.end(), [](const Played& p) { return p.line.frame.fd; });
  if (fd == log.end()) return kDone;
  complain(kNoFd, {options.file, std::to_string(fd->number), options.bus});
  return kWrongUse;
}

/// `played` counts what was played, `heard` what came from others with an identifier that was played.
int send_all(ToolBus& bus, const Log& log, const PlayOptions& options, FrameCount& played,
             FrameCount& heard) {
  const auto compare = [&](const image::CanFrame& frame) {
    if (!frame.error && played.has(frame)) heard.add(frame);
    return false;
  };
  const image::Nanoseconds begin = clock_ns(CLOCK_MONOTONIC);
  for (const auto& [line, number] : log) {
    const auto after = static_cast<double>(line.time - log.front().line.time) / options.speed;
    const image::Nanoseconds due = begin + static_cast<image::Nanoseconds>(after);
    for (bool sent = false; !sent;) {
      if (bus.ended()) return kStopped;
      const image::Nanoseconds early = due - clock_ns(CLOCK_MONOTONIC);
      if (early <= 0) sent = bus.transport().bus->send(line.frame);
      if (!sent && bus.gone()) return kInfrastructure;
      if (sent) played.add(line.frame);
      bus.listen(early > 0 ? early : sent ? 0 : image::kMillisecond, compare);
    }
  }
  return kDone;
}

void tell(const FrameCount& played, const FrameCount& heard, const Sorted& sorted, bool as_json) {
  const auto all = static_cast<std::int64_t>(sorted.log.size()) + sorted.left_out.frames();
  std::string line =
      text::render(kPlayed, std::vector<std::string>{std::to_string(played.frames()), std::to_string(all)},
                   text::user_language());
  if (sorted.left_out.frames() > 0)
    line += "; " +
            text::render(kLeftOut, std::vector<std::string>{sorted.left_out.words()}, text::user_language());
  if (as_json)
    print_json_line({{"played", played.frames()},
                     {"of", all},
                     {"left_out", sorted.left_out.counts()},
                     {"error_frames", sorted.errors},
                     {"two_senders", heard.counts()}});
  else
    print_line(line);
  if (sorted.errors > 0) complain(kErrors, {std::to_string(sorted.errors)});
  if (heard.frames() > 0) complain(kTwoSenders, {heard.words()});
}

}  // namespace

int play(const PlayOptions& options) {
  FrameFilter filter;
  if (!filter.set(options)) return kWrongUse;
  Sorted sorted;
  const Log& log = sorted.log;
  int code = read_log(options.file, filter, sorted);
  if (code != kDone) return code;
  std::optional<Holder> holder;
  if (!find_holder(options.bus, holder, code)) return code;
  CanopenBusOptions bus_options;
  bus_options.bus = options.bus;
  bus_options.bit_rate = options.bit_rate;
  const auto bus = ToolBus::open(bus_options, code);
  if (bus == nullptr) return code;
  code = may_play(*bus, holder, log, options);
  if (code == kDone) code = all_pass(*bus, log, options);
  if (code == kDone) {
    FrameCount played, heard;
    code = send_all(*bus, log, options, played, heard);
    tell(played, heard, sorted, options.json);
  }
  return bus->finish(code);
}

}  // namespace servogate::gateway::command
