// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <netinet/in.h>

#include <memory>
#include <string>

#include "drivers/notice.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::usercan {

struct UdpBusConfig {
  std::string group;                   ///< IPv4 multicast address, 224.0.0.0/4
  std::uint16_t port = 0;              ///< of this run alone
  std::uint32_t bit_rate = 1'000'000;  ///< bit/s; what bit_rate() answers, there is no wire
};

/// A bus made of multicast datagrams in the form of python-can's `udp_multicast`. Packets never leave this
/// computer (time to live 0). There is no arbitration, and datagrams may be lost when a receiver is late: the
/// kernel says how many, and lost() with it.
///
/// send(), receive() and state() make system calls that never wait; they do not allocate. Not thread-safe.
class UdpBus final : public image::CanBus {
 public:
  /// nullptr: refused, `why` says it (no multicast route: no such bus on this computer).
  static std::unique_ptr<UdpBus> open(const UdpBusConfig& config, drivers::Notice& why);
  ~UdpBus() override;
  UdpBus(const UdpBus&) = delete;
  UdpBus& operator=(const UdpBus&) = delete;

  /// real-time safe.
  bool send(const image::CanFrame& frame) noexcept override;
  /// Time stamps are the kernel's. real-time safe.
  bool receive(image::CanFrame& frame) noexcept override;
  image::CanState state() const noexcept override { return image::CanState::error_active; }
  std::uint32_t bit_rate() const noexcept override { return config_.bit_rate; }
  bool carries_fd() const noexcept override { return true; }
  std::uint64_t lost() const noexcept override { return overflowed_; }
  /// For poll(2): readable when something has come.
  int descriptor() const noexcept { return receiver_; }

 private:
  UdpBus(int receiver, int sender, std::uint16_t own_port, UdpBusConfig config);
  void read_control(msghdr& head, image::CanFrame& frame) noexcept;

  int receiver_, sender_;
  std::uint16_t own_port_;  ///< of sender_: what comes from it is our own
  UdpBusConfig config_;
  std::uint64_t overflowed_ = 0;
  std::uint32_t overflow_counter_ = 0;  ///< the kernel's own, wraps
};

}  // namespace servogate::usercan
