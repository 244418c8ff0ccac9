// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <net/if.h>

#include <algorithm>
#include <charconv>

#include "drivers/slcan/serial_port.hpp"
#include "drivers/usercan/address.hpp"
#include "machine/check/check.hpp"

namespace servogate::machine {

namespace {

bool has_blank(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) <= ' ' || c == 0x7F; });
}

bool any_name(std::string_view rest) { return !rest.empty(); }

/// As the kernel names interfaces: at most 15 bytes without blanks, '/' and ':'.
bool interface_name(std::string_view rest) {
  return !rest.empty() && rest.size() < IFNAMSIZ && rest != "." && rest != ".." && !has_blank(rest) &&
         rest.find_first_of("/:") == std::string_view::npos;
}

/// "ADDRESS/NAME"; the name is behind the last slash, as a path has slashes, too. It stands in a line of
/// "< open NAME >".
bool served(std::string_view rest) {
  const std::size_t slash = rest.rfind('/');
  if (slash == std::string_view::npos) return false;
  const std::string_view name = rest.substr(slash + 1);
  const auto address = usercan::parse_address(rest.substr(0, slash));
  const bool reachable = address && (address->host.empty() ? !address->path.empty() : address->port > 0);
  return reachable && !name.empty() && !has_blank(name) && name.find_first_of("<>") == std::string_view::npos;
}

/// 224.0.0.0 to 239.255.255.255 and a port.
bool group(std::string_view rest) {
  const auto address = usercan::parse_address(rest);
  in_addr numbers{};
  return address && address->port > 0 && inet_pton(AF_INET, address->host.c_str(), &numbers) == 1 &&
         IN_MULTICAST(ntohl(numbers.s_addr));
}

/// "SERIAL", "any", or with "/CHANNEL".
bool adapter(std::string_view rest) {
  const std::size_t slash = rest.rfind('/');
  const std::string_view serial = rest.substr(0, slash);
  if (serial.empty() || has_blank(serial)) return false;
  if (slash == std::string_view::npos) return true;
  const std::string_view channel = rest.substr(slash + 1);
  std::uint8_t number = 0;
  const auto [end, error] = std::from_chars(channel.data(), channel.data() + channel.size(), number);
  return error == std::errc{} && end == channel.data() + channel.size();
}

/// "PATH" or "PATH@BAUD".
bool port(std::string_view rest) { return slcan::parse_place(rest).has_value(); }

struct Scheme {
  std::string_view name;
  bool (*fits)(std::string_view rest);
};
constexpr Scheme kSchemes[] = {{"mock:", &any_name},     {"socketcan:", &interface_name},
                               {"socketcand:", &served}, {"lockstep:", &served},
                               {"udp:", &group},         {"gsusb:", &adapter},
                               {"slcan:", &port}};

}  // namespace

bool is_can_url(std::string_view url) {
  return std::any_of(std::begin(kSchemes), std::end(kSchemes), [url](const Scheme& s) {
    return url.starts_with(s.name) && s.fits(url.substr(s.name.size()));
  });
}

}  // namespace servogate::machine
