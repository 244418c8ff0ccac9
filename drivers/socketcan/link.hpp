// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/can_bus.hpp"

/// What the kernel says of a CAN interface, by rtnetlink. Source: linux/rtnetlink.h, linux/can/netlink.h.
namespace servogate::socketcan {

struct LinkInfo {
  int index = 0;
  std::string name;
  std::string kind;  ///< "can" for hardware, "vcan", "vxcan", "slcan"; empty: the driver says none
  bool is_can = false;
  bool up = false;
  bool fd = false;                   ///< takes CAN FD frames
  std::uint32_t bit_rate = 0;        ///< bit/s; 0: the interface has none, or it is not set
  std::uint32_t restart_ms = 0;      ///< automatic restart after bus-off; 0: none
  std::uint32_t transmit_queue = 0;  ///< frames that the kernel keeps waiting
  image::CanState state = image::CanState::down;
  bool counters = false;  ///< the two below are known
  std::uint16_t transmit_errors = 0;
  std::uint16_t receive_errors = 0;
};

/// The interface of this name, nullopt: there is none. Not real-time safe.
std::optional<LinkInfo> read_link(const std::string& name);
/// Names of all CAN interfaces. Not real-time safe.
std::vector<std::string> can_interfaces();
/// What set_link() changes; the rest stays.
struct LinkSetting {
  std::optional<bool> up = {};
  std::uint32_t bit_rate = 0;            ///< bit/s, of an interface that is down; 0: as it is
  std::optional<bool> listen_only = {};  ///< of an interface that is down: hears, and never drives the bus
};
/// Changes an interface; needs CAP_NET_ADMIN. Bit rate and listening are set before it goes up. 0, or what
/// errno said: EOPNOTSUPP of a driver that cannot. Not real-time safe.
int set_link(int index, const LinkSetting& setting);
/// Takes an interface down and brings it up again as it was: its controller leaves bus-off. The kernel's own
/// restart (IFLA_CAN_RESTART) is not asked for: not every driver has it, and kernels before the repair of
/// 2025 follow a null pointer in one that has not. Needs CAP_NET_ADMIN. 0, or what errno said. Not real-time
/// safe.
int restart_link(int index);
/// The command that brings an interface up, as a person types it. Not real-time safe.
std::string command_up(const LinkInfo& link, std::uint32_t bit_rate);

/// Tells when the kernel says something new about an interface.
class LinkWatch {
 public:
  explicit LinkWatch(int index);
  ~LinkWatch();
  LinkWatch(const LinkWatch&) = delete;
  LinkWatch& operator=(const LinkWatch&) = delete;
  /// False: the kernel refused; nothing will be told.
  bool good() const noexcept { return socket_ >= 0; }
  /// Reads what has come, without waiting. False: nothing new. real-time safe (one system call that does not
  /// wait).
  bool poll(LinkInfo& link) noexcept;

 private:
  int index_;
  int socket_ = -1;
};

}  // namespace servogate::socketcan
