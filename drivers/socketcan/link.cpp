// SPDX-License-Identifier: Apache-2.0
#include "drivers/socketcan/link.hpp"

#include <sys/socket.h>

#include <linux/can.h>
#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/rtnetlink.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <span>

namespace servogate::socketcan {
namespace {

using Bytes = std::span<const std::byte>;

/// Walks the attributes of a netlink message; a broken length ends the walk.
template <typename Visit>
void each_attribute(Bytes bytes, Visit visit) noexcept {
  while (bytes.size() >= sizeof(rtattr)) {
    rtattr head;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (head.rta_len < sizeof head || head.rta_len > bytes.size()) return;
    visit(static_cast<int>(head.rta_type & ~(NLA_F_NESTED | NLA_F_NET_BYTEORDER)),
          bytes.subspan(sizeof head, head.rta_len - sizeof head));
    const std::size_t padded = RTA_ALIGN(head.rta_len);
    if (padded >= bytes.size()) return;
    bytes = bytes.subspan(padded);
  }
}

template <typename T>
T value_of(Bytes bytes) noexcept {
  T value{};
  if (bytes.size() >= sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
  return value;
}

image::CanState state_of(std::uint32_t kernel_state) noexcept {
  switch (kernel_state) {
    case CAN_STATE_ERROR_ACTIVE:
      return image::CanState::error_active;
    case CAN_STATE_ERROR_WARNING:
      return image::CanState::error_warning;
    case CAN_STATE_ERROR_PASSIVE:
      return image::CanState::error_passive;
    case CAN_STATE_BUS_OFF:
      return image::CanState::bus_off;
    default:
      return image::CanState::down;
  }
}

/// Attributes of a controller, kind "can" and its like.
void read_controller(Bytes data, LinkInfo& link, bool& has_state) noexcept {
  each_attribute(data, [&](int type, Bytes bytes) {
    if (type == IFLA_CAN_BITTIMING) link.bit_rate = value_of<can_bittiming>(bytes).bitrate;
    if (type == IFLA_CAN_RESTART_MS) link.restart_ms = value_of<std::uint32_t>(bytes);
    if (type == IFLA_CAN_STATE) {
      link.state = state_of(value_of<std::uint32_t>(bytes));
      has_state = true;
    }
    if (type == IFLA_CAN_BERR_COUNTER) {
      const auto counter = value_of<can_berr_counter>(bytes);
      link.counters = true;
      link.transmit_errors = counter.txerr;
      link.receive_errors = counter.rxerr;
    }
  });
}

/// What a link message holds, without allocation unless names are asked for.
void read_message(const ifinfomsg& head, Bytes attributes, LinkInfo& link, bool names) {
  link.index = head.ifi_index;
  link.is_can = head.ifi_type == ARPHRD_CAN;
  link.up = (head.ifi_flags & IFF_UP) != 0;
  bool has_state = false;
  each_attribute(attributes, [&](int type, Bytes bytes) {
    const auto text = [&] {
      const char* begin = reinterpret_cast<const char*>(bytes.data());
      return std::string(begin, strnlen(begin, bytes.size()));
    };
    if (type == IFLA_IFNAME && names) link.name = text();
    if (type == IFLA_MTU) link.fd = value_of<std::uint32_t>(bytes) >= CANFD_MTU;
    if (type == IFLA_TXQLEN) link.transmit_queue = value_of<std::uint32_t>(bytes);
    if (type != IFLA_LINKINFO) return;
    each_attribute(bytes, [&](int inner, Bytes content) {
      if (inner == IFLA_INFO_KIND && names) {
        const char* begin = reinterpret_cast<const char*>(content.data());
        link.kind = std::string(begin, strnlen(begin, content.size()));
      }
      if (inner == IFLA_INFO_DATA) read_controller(content, link, has_state);
    });
  });
  if (!link.up)
    link.state = image::CanState::down;
  else if (!has_state)
    link.state = image::CanState::error_active;
}

int open_route(unsigned groups) {
  const int s = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (s < 0) return -1;
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = groups;
  if (bind(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    close(s);
    return -1;
  }
  return s;
}

/// Visits the link messages in a datagram. True: the end of a dump, or an answer, was among them.
template <typename Visit>
bool each_link(Bytes datagram, int* error, Visit visit) {
  bool ended = false;
  while (datagram.size() >= sizeof(nlmsghdr)) {
    nlmsghdr head;
    std::memcpy(&head, datagram.data(), sizeof head);
    if (head.nlmsg_len < sizeof head || head.nlmsg_len > datagram.size()) break;
    const Bytes body = datagram.subspan(NLMSG_HDRLEN, head.nlmsg_len - NLMSG_HDRLEN);
    if (head.nlmsg_type == NLMSG_DONE || head.nlmsg_type == NLMSG_ERROR) ended = true;
    if (head.nlmsg_type == NLMSG_ERROR && error != nullptr) *error = -value_of<nlmsgerr>(body).error;
    if (head.nlmsg_type == RTM_NEWLINK && body.size() >= sizeof(ifinfomsg))
      visit(value_of<ifinfomsg>(body), body.subspan(NLMSG_ALIGN(sizeof(ifinfomsg))));
    const std::size_t padded = NLMSG_ALIGN(head.nlmsg_len);
    if (padded >= datagram.size()) break;
    datagram = datagram.subspan(padded);
  }
  return ended;
}

/// Asks and reads until the answer has ended. 0, or what errno said.
template <typename Request, typename Visit>
int ask(const Request& request, Visit visit) {
  const int s = open_route(0);
  if (s < 0) return errno;
  int error = 0;
  const timeval patience{2, 0};
  setsockopt(s, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (::send(s, &request, request.head.nlmsg_len, 0) < 0) error = errno;
  std::vector<std::byte> buffer(1 << 16);
  for (bool ended = error != 0; !ended;) {
    const ssize_t got = recv(s, buffer.data(), buffer.size(), 0);
    if (got <= 0) break;
    ended = each_link({buffer.data(), static_cast<std::size_t>(got)}, &error, visit);
  }
  close(s);
  return error;
}

constexpr std::size_t kRoom = 192;

struct LinkRequest {
  nlmsghdr head{};
  ifinfomsg link{};
  std::array<char, kRoom> room{};
};

/// Attributes of a message to the kernel, one after the other.
struct Attributes {
  std::array<char, kRoom> bytes{};
  std::size_t used = 0;

  /// What does not fit is left out, and the kernel refuses the message.
  void put(int type, const void* data, std::size_t size) noexcept {
    if (used + RTA_SPACE(size) > bytes.size()) return;
    rtattr head{};
    head.rta_type = static_cast<unsigned short>(type);
    head.rta_len = static_cast<unsigned short>(RTA_LENGTH(size));
    std::memcpy(bytes.data() + used, &head, sizeof head);
    std::memcpy(bytes.data() + used + RTA_LENGTH(0), data, size);
    used += RTA_SPACE(size);
  }
};

std::vector<LinkInfo> all_links() {
  LinkRequest request;
  request.head.nlmsg_len = NLMSG_LENGTH(sizeof request.link);
  request.head.nlmsg_type = RTM_GETLINK;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP;
  std::vector<LinkInfo> links;
  ask(request, [&links](const ifinfomsg& head, Bytes attributes) {
    read_message(head, attributes, links.emplace_back(), true);
  });
  return links;
}

}  // namespace

std::optional<LinkInfo> read_link(const std::string& name) {
  for (LinkInfo& link : all_links())
    if (link.name == name) return std::move(link);
  return std::nullopt;
}

std::vector<std::string> can_interfaces() {
  std::vector<std::string> names;
  for (const LinkInfo& link : all_links())
    if (link.is_can) names.push_back(link.name);
  return names;
}

int set_link(int index, const LinkSetting& setting) {
  LinkRequest request;
  request.head.nlmsg_type = RTM_NEWLINK;
  request.head.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
  request.link.ifi_index = index;
  if (setting.up) {
    request.link.ifi_change = IFF_UP;
    request.link.ifi_flags = *setting.up ? IFF_UP : 0;
  }
  Attributes controller;
  if (setting.bit_rate != 0) {
    can_bittiming timing{};
    timing.bitrate = setting.bit_rate;
    controller.put(IFLA_CAN_BITTIMING, &timing, sizeof timing);
  }
  if (setting.listen_only) {
    const can_ctrlmode mode{CAN_CTRLMODE_LISTENONLY, *setting.listen_only ? CAN_CTRLMODE_LISTENONLY : 0U};
    controller.put(IFLA_CAN_CTRLMODE, &mode, sizeof mode);
  }
  Attributes whole;
  if (controller.used > 0) {
    Attributes info;
    info.put(IFLA_INFO_KIND, "can", 4);
    info.put(IFLA_INFO_DATA, controller.bytes.data(), controller.used);
    whole.put(IFLA_LINKINFO, info.bytes.data(), info.used);
    std::memcpy(request.room.data(), whole.bytes.data(), whole.used);
  }
  request.head.nlmsg_len = static_cast<std::uint32_t>(NLMSG_LENGTH(sizeof request.link) + whole.used);
  return ask(request, [](const ifinfomsg&, Bytes) {});
}

int restart_link(int index) {
  const int error = set_link(index, {.up = false});
  return error != 0 ? error : set_link(index, {.up = true});
}

std::string command_up(const LinkInfo& link, std::uint32_t bit_rate) {
  std::string command = "ip link set " + link.name + " up";
  if (link.kind == "vcan" || link.kind == "vxcan") return command;
  return command + " type can bitrate " + std::to_string(bit_rate) + " restart-ms 100";
}

LinkWatch::LinkWatch(int index) : index_(index), socket_(open_route(RTMGRP_LINK)) {}
LinkWatch::~LinkWatch() {
  if (socket_ >= 0) close(socket_);
}

bool LinkWatch::poll(LinkInfo& link) noexcept {
  if (socket_ < 0) return false;
  alignas(nlmsghdr) std::array<std::byte, 8192> buffer;
  bool news = false;
  // One look a call when nothing has come; a burst of messages is read in this call and the next ones.
  for (int n = 0; n < 4; ++n) {
    const ssize_t got = recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (got <= 0) break;
    each_link({buffer.data(), static_cast<std::size_t>(got)}, nullptr,
              [&](const ifinfomsg& head, Bytes attributes) {
                if (head.ifi_index != index_) return;
                read_message(head, attributes, link, false);
                news = true;
              });
  }
  return news;
}

}  // namespace servogate::socketcan
