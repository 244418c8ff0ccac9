// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/udp_bus.hpp"

#include <arpa/inet.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include "drivers/clock.hpp"
#include "drivers/usercan/message_pack.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::usercan {
namespace {

const text::Entry kNoGroup{"usercan.no-group", "{0} is no multicast address (224.0.0.0 to 239.255.255.255)",
                           "{0} — не групповой адрес (от 224.0.0.0 до 239.255.255.255)"};
const text::Entry kNoMulticast{"usercan.no-multicast",
                               "multicast to {0} on the loopback interface is not possible here: {1}. Bring "
                               "it up with: ip link set lo up",
                               "групповая рассылка на {0} по интерфейсу loopback здесь невозможна: {1}. "
                               "Включить его: ip link set lo up"};

constexpr int kReceiveBytes = 4 << 20;

template <typename T>
bool set_option(int s, int level, int option, const T& value) {
  return setsockopt(s, level, option, &value, sizeof value) == 0;
}

/// The group is joined there and nowhere else: what another computer sends to it is not heard.
constexpr char kHere[] = "lo";

/// Receives from the group only; the port is shared with the other participants.
bool set_up_receiver(int s, const sockaddr_in& group) {
  const int on = 1, off = 0;
  ip_mreqn membership{};
  membership.imr_multiaddr = group.sin_addr;
  membership.imr_ifindex = static_cast<int>(if_nametoindex(kHere));
  if (!set_option(s, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBytes))
    set_option(s, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  return membership.imr_ifindex != 0 && set_option(s, SOL_SOCKET, SO_REUSEADDR, on) &&
         set_option(s, SOL_SOCKET, SO_TIMESTAMPNS, on) && set_option(s, SOL_SOCKET, SO_RXQ_OVFL, on) &&
         set_option(s, IPPROTO_IP, IP_MULTICAST_ALL, off) &&
         bind(s, reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0 &&
         set_option(s, IPPROTO_IP, IP_ADD_MEMBERSHIP, membership);
}

bool set_up_sender(int s, const sockaddr_in& group, std::uint16_t& own_port) {
  const unsigned char stay_here = 0, loop = 1;
  ip_mreqn here{};
  here.imr_ifindex = static_cast<int>(if_nametoindex(kHere));
  sockaddr_in any{};
  any.sin_family = AF_INET;
  any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof any;
  const bool good = set_option(s, IPPROTO_IP, IP_MULTICAST_IF, here) &&
                    set_option(s, IPPROTO_IP, IP_MULTICAST_TTL, stay_here) &&
                    set_option(s, IPPROTO_IP, IP_MULTICAST_LOOP, loop) &&
                    bind(s, reinterpret_cast<const sockaddr*>(&any), sizeof any) == 0 &&
                    connect(s, reinterpret_cast<const sockaddr*>(&group), sizeof group) == 0 &&
                    getsockname(s, reinterpret_cast<sockaddr*>(&any), &size) == 0;
  own_port = any.sin_port;
  return good;
}

}  // namespace

std::unique_ptr<UdpBus> UdpBus::open(const UdpBusConfig& config, drivers::Notice& why) {
  sockaddr_in group{};
  group.sin_family = AF_INET;
  group.sin_port = htons(config.port);
  if (inet_pton(AF_INET, config.group.c_str(), &group.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(group.sin_addr.s_addr))) {
    why = {&kNoGroup, {config.group}};
    return nullptr;
  }
  const int receiver = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int sender = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  std::uint16_t own_port = 0;
  if (receiver >= 0 && sender >= 0 && set_up_receiver(receiver, group) &&
      set_up_sender(sender, group, own_port))
    return std::unique_ptr<UdpBus>(new UdpBus(receiver, sender, own_port, config));
  why = {&kNoMulticast, {config.group, text::words_of(errno)}};
  close(receiver);
  close(sender);
  return nullptr;
}

UdpBus::UdpBus(int receiver, int sender, std::uint16_t own_port, UdpBusConfig config)
    : receiver_(receiver), sender_(sender), own_port_(own_port), config_(std::move(config)) {}

UdpBus::~UdpBus() {
  close(receiver_);
  close(sender_);
}

bool UdpBus::send(const image::CanFrame& frame) noexcept {
  if (frame.error || frame.length > (frame.fd ? 64 : 8)) return false;
  std::array<std::uint8_t, kMaxPacket> packet;
  const double now = static_cast<double>(drivers::clock_ns(CLOCK_REALTIME)) * 1e-9;
  const std::size_t size = pack(frame, now, packet);
  return ::send(sender_, packet.data(), size, MSG_DONTWAIT) == static_cast<ssize_t>(size);
}

void UdpBus::read_control(msghdr& head, image::CanFrame& frame) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&head); c != nullptr; c = CMSG_NXTHDR(&head, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) {
      timespec t{};
      std::memcpy(&t, CMSG_DATA(c), sizeof t);
      const image::Nanoseconds ahead = drivers::realtime_ahead();
      frame.timestamp_ns = t.tv_sec * image::kSecond + t.tv_nsec - ahead;
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t counter = 0;
      std::memcpy(&counter, CMSG_DATA(c), sizeof counter);
      overflowed_ += counter - overflow_counter_;
      overflow_counter_ = counter;
    }
  }
}

bool UdpBus::receive(image::CanFrame& frame) noexcept {
  for (;;) {
    std::array<std::uint8_t, kMaxPacket> packet;
    alignas(cmsghdr) std::array<char, 128> control;
    sockaddr_in from{};
    iovec part{packet.data(), packet.size()};
    msghdr head{};
    head.msg_name = &from;
    head.msg_namelen = sizeof from;
    head.msg_iov = &part;
    head.msg_iovlen = 1;
    head.msg_control = control.data();
    head.msg_controllen = control.size();
    const ssize_t got = recvmsg(receiver_, &head, MSG_DONTWAIT);
    if (got < 0) return false;
    image::CanFrame f;
    const bool good = unpack({packet.data(), static_cast<std::size_t>(got)}, f);
    read_control(head, f);
    if (from.sin_port == own_port_ || !good) continue;
    frame = f;
    return true;
  }
}

}  // namespace servogate::usercan
