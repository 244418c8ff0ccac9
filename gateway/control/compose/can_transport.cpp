// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/can_transport.hpp"

#include <algorithm>
#include <charconv>

#include "drivers/gsusb/adapters.hpp"
#include "drivers/slcan/slcan_bus.hpp"
#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/master/master_claim.hpp"

namespace servogate::gateway {
namespace {

const text::Entry kNoTransport{
    "can.no-transport",
    "'{0}' is no bus that can be opened here; known: socketcan:IF, socketcand:HOST:PORT/NAME, "
    "socketcand:unix:PATH/NAME, lockstep:HOST:PORT/NAME, udp:GROUP:PORT, gsusb:SERIAL, slcan:PATH",
    "«{0}» — не шина, которую можно открыть; известны: socketcan:IF, socketcand:ХОСТ:ПОРТ/ИМЯ, "
    "socketcand:unix:ПУТЬ/ИМЯ, lockstep:ХОСТ:ПОРТ/ИМЯ, udp:ГРУППА:ПОРТ, gsusb:СЕРИЙНЫЙ, slcan:ПУТЬ"};
const text::Entry kMockElsewhere{
    "can.mock-elsewhere", "'{0}' lives inside one control; for several processes: servogate can bus can0",
    "«{0}» живёт внутри одного управления; для нескольких процессов: servogate can bus can0"};

using Opened = std::optional<CanTransport>;

/// Of a bus without a wire, where nobody said it.
std::uint32_t assumed_rate(const CanTransportOptions& options) {
  return options.bit_rate != 0 ? options.bit_rate : 1'000'000;
}

Opened open_socketcan(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  auto bus = socketcan::SocketCanBus::open({std::string(rest), options.bit_rate, options.filters}, why);
  if (bus == nullptr) return std::nullopt;
  CanTransport t;
  t.descriptor = bus->descriptor();
  t.nothing_real = bus->link().kind == "vcan" || bus->link().kind == "vxcan";
  t.bus = std::move(bus);
  return t;
}

/// "ADDRESS/NAME"; the name is behind the last slash, as a path has slashes, too.
Opened open_served(std::string_view rest, const CanTransportOptions& options, std::string participant,
                   drivers::Notice& why) {
  const std::size_t slash = rest.rfind('/');
  const auto address = usercan::parse_address(rest.substr(0, slash));
  if (!address || slash == std::string_view::npos || slash + 1 == rest.size()) {
    why = {&kNoTransport, {std::string(rest)}};
    return std::nullopt;
  }
  usercan::SocketcandConfig config;
  config.address = *address;
  config.bus = rest.substr(slash + 1);
  config.bit_rate = assumed_rate(options);
  config.lockstep = std::move(participant);
  auto bus = usercan::SocketcandBus::open(config, why);
  if (bus == nullptr) return std::nullopt;
  CanTransport t;
  t.descriptor = bus->descriptor();
  t.nothing_real = bus->simulated();
  t.lockstep = config.lockstep.empty() ? nullptr : bus.get();
  t.bus = std::move(bus);
  return t;
}

Opened open_socketcand(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  return open_served(rest, options, {}, why);
}

Opened open_lockstep(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  return open_served(rest, options, options.participant.empty() ? "control" : options.participant, why);
}

Opened open_udp(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  const auto address = usercan::parse_address(rest);
  if (!address || address->host.empty()) {
    why = {&kNoTransport, {"udp:" + std::string(rest)}};
    return std::nullopt;
  }
  auto bus = usercan::UdpBus::open({address->host, address->port, assumed_rate(options)}, why);
  if (bus == nullptr) return std::nullopt;
  CanTransport t;
  t.descriptor = bus->descriptor();
  t.nothing_real = true;
  t.bus = std::move(bus);
  return t;
}

/// "SERIAL" or "SERIAL/CHANNEL".
Opened open_gsusb(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  gsusb::GsUsbConfig config;
  const std::size_t slash = rest.rfind('/');
  config.adapter = rest.substr(0, slash);
  config.bit_rate = options.bit_rate;
  config.listen_only = options.listen_only;
  if (slash != std::string_view::npos) {
    const std::string_view channel = rest.substr(slash + 1);
    const auto [end, error] =
        std::from_chars(channel.data(), channel.data() + channel.size(), config.channel);
    if (error != std::errc{} || end != channel.data() + channel.size()) {
      why = {&kNoTransport, {"gsusb:" + std::string(rest)}};
      return std::nullopt;
    }
  }
  auto port = usb::open_libusb(gsusb::adapter_kind(), config.adapter, why);
  if (port == nullptr) return std::nullopt;
  auto bus = gsusb::GsUsbBus::open(std::move(port), config, why);
  if (bus == nullptr) return std::nullopt;
  CanTransport t;
  t.descriptor = bus->descriptor();
  t.adapter = bus.get();
  t.bus = std::move(bus);
  return t;
}

/// "PATH" or "PATH@BAUD".
Opened open_slcan(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why) {
  const auto place = slcan::parse_place(rest);
  if (!place) {
    why = {&kNoTransport, {"slcan:" + std::string(rest)}};
    return std::nullopt;
  }
  auto bus = slcan::SlcanBus::open({*place, options.bit_rate, options.listen_only}, why);
  if (bus == nullptr) return std::nullopt;
  CanTransport t;
  t.descriptor = bus->descriptor();
  t.bus = std::move(bus);
  return t;
}

struct Scheme {
  std::string_view name;
  Opened (*open)(std::string_view rest, const CanTransportOptions& options, drivers::Notice& why);
};
constexpr Scheme kSchemes[] = {
    {"socketcan:", &open_socketcan}, {"socketcand:", &open_socketcand},
    {"lockstep:", &open_lockstep},   {"udp:", &open_udp},
    {"gsusb:", &open_gsusb},         {"slcan:", &open_slcan},
};

}  // namespace

std::optional<CanTransport> open_can(std::string_view url, const CanTransportOptions& options,
                                     drivers::Notice& why) {
  for (const Scheme& s : kSchemes)
    if (url.starts_with(s.name)) return s.open(url.substr(s.name.size()), options, why);
  why = {url.starts_with("mock:") ? &kMockElsewhere : &kNoTransport, {std::string(url)}};
  return std::nullopt;
}

std::vector<socketcan::Filter> master_filters(const std::vector<int>& nodes) {
  constexpr std::uint32_t kNode = 0x07F, kFunction = 0x780, kWhole = 0x7FF,
                          kAnnouncements = kWhole & ~(canopen::MasterClaim::kCobs - 1);
  // Function code and node-ID share the identifier: CiA 301, 7.3.5.
  std::vector<socketcan::Filter> filters = {{canopen::cob::kNmt, kWhole},
                                            {canopen::cob::kSync, kFunction},
                                            {canopen::cob::heartbeat(0), kFunction},
                                            {canopen::MasterClaim::kFirstCob, kAnnouncements}};
  // Of another master's nodes, too: they tell of it.
  for (int number = 1; number <= 4; ++number) filters.push_back({canopen::cob::rpdo(number, 0), kFunction});
  for (const int node : nodes) filters.push_back({static_cast<std::uint32_t>(node), kNode});
  return filters;
}

}  // namespace servogate::gateway
