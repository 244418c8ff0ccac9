// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/bit_rate_detection.hpp"

#include <poll.h>

#include "drivers/clock.hpp"
#include "drivers/socketcan/socketcan_bus.hpp"
#include "firmware_if/text/system_words.hpp"
#include "gateway/control/compose/can_transport.hpp"

namespace servogate::gateway::command {

namespace {

/// Those of CiA 301 and those between that people use, the frequent ones first.
constexpr std::uint32_t kRates[] = {1'000'000, 500'000, 250'000, 125'000, 800'000,
                                    100'000,   50'000,  20'000,  10'000};
/// A wrong rate shows itself within one frame; a quiet bus speaks once a heartbeat.
constexpr image::Nanoseconds kListening = 1200 * image::kMillisecond;
constexpr int kConvincing = 3;  ///< frames without an error between them

/// Frames come, and no errors.
bool frames_come(image::CanBus& bus, int descriptor) {
  int frames = 0, errors = 0;
  const image::Nanoseconds until = drivers::clock_ns(CLOCK_MONOTONIC) + kListening;
  for (image::CanFrame frame; frames < kConvincing && drivers::clock_ns(CLOCK_MONOTONIC) < until;) {
    while (bus.receive(frame)) (frame.error ? errors : frames) += 1;
    if (errors > 0) return false;
    pollfd p{descriptor, POLLIN, 0};
    const timespec nap{0, 20 * image::kMillisecond};
    ppoll(&p, 1, &nap, nullptr);
  }
  return frames > 0;
}

bool frames_come(const std::string& interface, std::string& problem) {
  drivers::Notice why;
  const auto bus = socketcan::SocketCanBus::open({interface, 0, {}}, why);
  if (bus == nullptr) {
    problem = why.str();
    return false;
  }
  return frames_come(*bus, bus->descriptor());
}

}  // namespace

DetectedRate detect_bit_rate(const socketcan::LinkInfo& link,
                             const std::function<bool(std::uint32_t)>& tell) {
  DetectedRate found;
  socketcan::LinkSetting down;
  down.up = false;
  for (const std::uint32_t rate : kRates) {
    if (found.bit_rate || !found.problem.empty() || !tell(rate)) break;
    socketcan::LinkSetting listening;
    listening.bit_rate = rate;
    listening.listen_only = true;
    int error = socketcan::set_link(link.index, listening);
    if (error == ERANGE || error == EDOM || error == EINVAL)
      continue;  // this controller does not have this rate
    socketcan::LinkSetting up;
    up.up = true;
    if (error == 0) error = socketcan::set_link(link.index, up);
    if (error != 0)
      found.problem = text::words_of(error);
    else if (frames_come(link.name, found.problem))
      found.bit_rate = rate;
    socketcan::set_link(link.index, down);
  }
  socketcan::LinkSetting before;
  before.listen_only = false;
  before.bit_rate = link.bit_rate;
  socketcan::set_link(link.index, before);
  return found;
}

DetectedRate detect_bit_rate(const std::string& url, const std::function<bool(std::uint32_t)>& tell) {
  DetectedRate found;
  for (const std::uint32_t rate : kRates) {
    if (found.bit_rate || !tell(rate)) break;
    drivers::Notice why;
    CanTransportOptions options;
    options.bit_rate = rate;
    options.listen_only = true;
    const auto listening = open_can(url, options, why);
    if (!listening && gsusb::is_no_timing(why)) continue;  // this adapter does not have this rate
    if (!listening) {
      found.problem = why.str();
      break;
    }
    if (frames_come(*listening->bus, listening->descriptor)) found.bit_rate = rate;
  }
  return found;
}

}  // namespace servogate::gateway::command
