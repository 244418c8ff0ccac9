// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/canopen/bus/tool_bus.hpp"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "drivers/clock.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/options.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/bus/named_bus.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kGone{"can.gone", "the bus {0} is gone", "шина {0} исчезла"};

constexpr image::Nanoseconds kPatience = 2 * image::kSecond;  ///< for room in the send queue
constexpr std::uint32_t kDefaultBitRate = 1'000'000;
constexpr std::uint32_t kRepetitions = 1;
constexpr std::size_t kLargestObject = std::size_t{64} << 20;

}  // namespace

std::unique_ptr<ToolBus> ToolBus::open(const CanopenBusOptions& options, int& code) {
  code = kWrongUse;
  const auto named = named_bus(options.bus, options.bit_rate);
  if (!named) return nullptr;
  CanTransportOptions transport_options;
  transport_options.bit_rate = named->bit_rate;
  transport_options.participant = "tool";
  drivers::Notice why;
  auto opened = open_can(named->url, transport_options, why);
  code = kInfrastructure;
  if (!opened) {
    complain(*why.entry, why.arguments);
    return nullptr;
  }
  code = kDone;
  std::unique_ptr<ToolBus> bus(new ToolBus(named->url, std::move(*opened), options));
  // Time is not granted before everybody is there.
  if (bus->transport_.lockstep != nullptr) bus->time_ended_ = !bus->transport_.lockstep->wait_grant();
  return bus;
}

ToolBus::ToolBus(std::string url, CanTransport transport, const CanopenBusOptions& options)
    : url_(std::move(url)),
      transport_(std::move(transport)),
      timeout_(std::llround(options.timeout_ms * 1e6)),
      blocks_(!options.no_block) {}

std::uint32_t ToolBus::bit_rate() const noexcept {
  const std::uint32_t own = transport_.bus->bit_rate();
  return own != 0 ? own : kDefaultBitRate;
}

bool ToolBus::over() const { return (signals_count_ && signals_.ended()) || gone(); }

image::Nanoseconds ToolBus::now() const {
  return transport_.lockstep != nullptr ? transport_.lockstep->granted() : drivers::clock_ns(CLOCK_MONOTONIC);
}

/// Until something comes, or a part of the time.
void ToolBus::pause(image::Nanoseconds until) {
  if (transport_.lockstep != nullptr) {
    transport_.lockstep->done(until, usercan::LockstepWake::frames);
    time_ended_ = !transport_.lockstep->wait_grant();
    return;
  }
  pollfd p{transport_.descriptor, POLLIN, 0};
  const image::Nanoseconds nap =
      std::min(std::max<image::Nanoseconds>(0, until - now()), 50 * image::kMillisecond);
  const timespec limit{nap / image::kSecond, nap % image::kSecond};
  ppoll(&p, 1, &limit, nullptr);
}

bool ToolBus::wait_until(image::Nanoseconds t) {
  if (transport_.lockstep != nullptr) {
    // What comes meanwhile is heard then.
    while (now() < t && !gone()) {
      transport_.lockstep->done(t, usercan::LockstepWake::wish);
      time_ended_ = !transport_.lockstep->wait_grant();
    }
  } else {
    const timespec until{t / image::kSecond, t % image::kSecond};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
  }
  return !gone();
}

bool ToolBus::listen(image::Nanoseconds at_most, const Handler& handler) {
  const image::Nanoseconds until = now() + at_most;
  image::CanFrame frame;
  for (;;) {
    while (transport_.bus->receive(frame))
      if (handler(frame)) return true;
    if (now() >= until || over()) return false;
    pause(until);
  }
}

bool ToolBus::send(const image::CanFrame& frame) {
  const image::Nanoseconds until = now() + kPatience;
  while (!transport_.bus->send(frame)) {
    if (over() || now() > until) return false;
    // What comes meanwhile is nobody's answer: nothing was asked yet.
    listen(image::kMillisecond, [](const image::CanFrame&) { return false; });
  }
  return true;
}

canopen::SdoClient& ToolBus::client(canopen::NodeId node) {
  auto& client = clients_[node];
  if (!client) {
    client.emplace(node, timeout_, kRepetitions);
    client->allow_blocks(blocks_);
  }
  return *client;
}

canopen::SdoStatus ToolBus::run(canopen::NodeId node) {
  canopen::SdoClient& sdo = client(node);
  const std::uint32_t answer = canopen::cob::sdo_response(node);
  while (sdo.busy() && !over()) {
    // A sub-block of a download goes out frame by frame as long as the bus takes them.
    while (sdo.poll(now(), *transport_.bus)) {
    }
    listen(std::min(timeout_, 5 * image::kMillisecond), [&](const image::CanFrame& frame) {
      return frame.id == answer && !frame.extended && !frame.remote && sdo.on_frame(frame);
    });
  }
  if (sdo.busy()) sdo.cancel();
  sdo.poll(now(), *transport_.bus);  // an abort that is due
  return sdo.result().status == canopen::SdoStatus::idle ? canopen::SdoStatus::no_answer
                                                         : sdo.result().status;
}

SdoOutcome ToolBus::read(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex) {
  canopen::SdoClient& sdo = client(node);
  SdoOutcome outcome;
  sdo.upload(index, subindex);
  outcome.status = run(node);
  std::vector<std::uint8_t> memory;
  // Longer than the client's own buffer: again, into memory that grows with the object.
  for (std::size_t room = std::size_t{64} << 10;
       outcome.status != canopen::SdoStatus::done &&
       sdo.result().abort == canopen::AbortCode::out_of_memory &&
       outcome.status != canopen::SdoStatus::aborted && room <= kLargestObject;
       room *= 16) {
    memory.resize(room);
    sdo.upload_into(index, subindex, memory);
    outcome.status = run(node);
  }
  outcome.abort = sdo.result().abort;
  if (outcome.ok()) outcome.data.assign(sdo.data().begin(), sdo.data().end());
  return outcome;
}

SdoOutcome ToolBus::write(canopen::NodeId node, std::uint16_t index, std::uint8_t subindex,
                          std::span<const std::uint8_t> data) {
  canopen::SdoClient& sdo = client(node);
  SdoOutcome outcome;
  sdo.download_from(index, subindex, data);
  outcome.status = run(node);
  outcome.abort = sdo.result().abort;
  return outcome;
}

int ToolBus::finish(int code) const {
  if (signals_.ended()) {
    code = kStopped;
  } else if (gone()) {
    complain(kGone, {url_});
    code = kInfrastructure;
  }
  return unless_frames_lost(code, url_, *transport_.bus);
}

}  // namespace servogate::gateway::command
