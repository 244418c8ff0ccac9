// SPDX-License-Identifier: Apache-2.0
#include "machine/bus_place.hpp"

#include <filesystem>

#include "drivers/usercan/address.hpp"

namespace servogate::machine {

namespace {

constexpr std::string_view kAnyAdapter = "gsusb:any/";

std::string address_place(const usercan::Address& address) {
  if (!address.host.empty()) return usercan::in_numbers(address).str();
  std::error_code error;
  const auto whole = std::filesystem::weakly_canonical(std::filesystem::absolute(address.path, error), error);
  return "unix:" + (error ? address.path : whole.string());
}

/// "ADDRESS/NAME"
std::string served_place(std::string_view rest) {
  const std::size_t slash = rest.rfind('/');
  const auto address = usercan::parse_address(rest.substr(0, slash));
  if (!address || slash == std::string_view::npos) return "socketcand:" + std::string(rest);
  return "socketcand:" + address_place(*address) + std::string(rest.substr(slash));
}

std::string udp_place(std::string_view rest) {
  const auto address = usercan::parse_address(rest);
  return "udp:" + (address ? address_place(*address) : std::string(rest));
}

/// "SERIAL" or "SERIAL/CHANNEL"
std::string adapter_place(std::string_view rest) {
  const bool has_channel = rest.find('/') != std::string_view::npos;
  return "gsusb:" + std::string(rest) + (has_channel ? "" : "/0");
}

std::string peer_place(std::string_view rest) {
  const auto address = usercan::parse_address(rest);
  return "tcp:" + (address ? address_place(*address) : std::string(rest));
}

/// Names below /dev/serial/by-id are links.
std::string port_of(std::string_view path) {
  std::error_code error;
  const auto whole = std::filesystem::weakly_canonical(std::filesystem::path(path), error);
  return error ? std::string(path) : whole.string();
}

std::string serial_place(std::string_view rest) { return "rtu:" + port_of(rest); }

/// "PATH" or "PATH@BAUD": one port, whatever its speed.
std::string slcan_place(std::string_view rest) { return "slcan:" + port_of(rest.substr(0, rest.rfind('@'))); }

std::string_view channel_of(std::string_view place) { return place.substr(place.rfind('/') + 1); }

struct Scheme {
  std::string_view name;
  std::string (*place)(std::string_view rest);
};
constexpr Scheme kSchemes[] = {{"socketcand:", &served_place}, {"lockstep:", &served_place},
                               {"udp:", &udp_place},           {"tcp:", &peer_place},
                               {"rtu:", &serial_place},        {"gsusb:", &adapter_place},
                               {"slcan:", &slcan_place}};

}  // namespace

std::string bus_place(std::string_view url) {
  for (const Scheme& s : kSchemes)
    if (url.starts_with(s.name)) return s.place(url.substr(s.name.size()));
  return std::string(url);
}

bool same_place(std::string_view a, std::string_view b) {
  if (a == b) return true;
  const bool adapters = a.starts_with("gsusb:") && b.starts_with("gsusb:");
  return adapters && (a.starts_with(kAnyAdapter) || b.starts_with(kAnyAdapter)) &&
         channel_of(a) == channel_of(b);
}

bool same_bus(std::string_view url, std::string_view other) {
  const auto scheme = [](std::string_view u) { return u.substr(0, u.find(':')); };
  const auto served = [&](std::string_view u) {
    return scheme(u) == "socketcand" || scheme(u) == "lockstep";
  };
  const auto name = [](std::string_view u) { return u.substr(u.rfind('/') + 1); };
  if (scheme(url) != scheme(other) && !(served(url) && served(other))) return false;
  if (served(url) && name(url) != name(other)) return false;
  return same_place(bus_place(url), bus_place(other));
}

}  // namespace servogate::machine
