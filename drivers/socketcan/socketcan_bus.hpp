// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "drivers/notice.hpp"
#include "drivers/send_queue.hpp"
#include "drivers/socketcan/link.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::socketcan {

/// Frames pass whose (identifier & mask) == (id & mask), of this length of identifier.
struct Filter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;
};

struct SocketCanConfig {
  std::string interface;
  /// bit/s that the segment is planned for, 0: whatever the interface has. An interface that is set to
  /// another rate is refused; one that has none (vcan) is taken to have this.
  std::uint32_t bit_rate = 0;
  std::vector<Filter> filters;  ///< empty: everything
};

/// Running totals since opening.
struct SocketCanStatistics {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;
  std::uint64_t errors = 0;      ///< error frames
  std::uint64_t waited = 0;      ///< frames that the kernel's queue did not take at once (ENOBUFS)
  std::uint64_t overflowed = 0;  ///< received frames that the kernel dropped because nobody read them
  std::uint64_t abandoned = 0;   ///< queued frames thrown away when the link went down or bus-off
};

/// A CAN interface of Linux by a raw socket. Error frames are received like others (CanFrame::error) and tell
/// the state, as the kernel's link messages do. Frames that the kernel's queue does not take wait in priority
/// order and go out with the next send() or receive(); when the link goes down or the controller bus-off they
/// are thrown away and counted, so that nothing stale moves a drive later.
///
/// send(), receive() and state() make system calls that never wait; they do not allocate. Not thread-safe.
class SocketCanBus final : public image::CanBus {
 public:
  /// nullptr: refused, `why` names the interface, what is wrong and the command that mends it.
  static std::unique_ptr<SocketCanBus> open(const SocketCanConfig& config, drivers::Notice& why);
  ~SocketCanBus() override;
  SocketCanBus(const SocketCanBus&) = delete;
  SocketCanBus& operator=(const SocketCanBus&) = delete;

  /// real-time safe.
  bool send(const image::CanFrame& frame) noexcept override;
  /// Time stamps are the kernel's. real-time safe.
  bool receive(image::CanFrame& frame) noexcept override;
  image::CanState state() const noexcept override { return state_; }
  std::uint32_t bit_rate() const noexcept override { return bit_rate_; }
  bool carries_fd() const noexcept override { return link_.fd; }
  std::uint64_t lost() const noexcept override { return statistics_.overflowed + statistics_.abandoned; }

  const SocketCanStatistics& statistics() const noexcept { return statistics_; }
  /// The interface as it was when it was opened.
  const LinkInfo& link() const noexcept { return link_; }
  /// Frames that wait for the kernel.
  std::size_t waiting() const noexcept { return queue_.size(); }
  /// For poll(2): readable when a frame has come.
  int descriptor() const noexcept { return socket_; }

 private:
  static constexpr std::size_t kBatch = 32;
  struct Batch {
    std::array<canfd_frame, kBatch> frames;
    std::array<std::array<char, 128>, kBatch> control;
    std::array<iovec, kBatch> parts;
    std::array<mmsghdr, kBatch> heads;
    std::size_t count = 0, next = 0;
  };

  SocketCanBus(int socket, LinkInfo link, std::uint32_t bit_rate);
  void flush() noexcept;
  void abandon(image::CanState state) noexcept;
  void fill() noexcept;
  bool take(image::CanFrame& frame) noexcept;
  void read_control(msghdr& head, image::CanFrame& frame) noexcept;

  int socket_;
  LinkInfo link_;
  LinkWatch watch_;
  LinkInfo news_;
  std::uint32_t bit_rate_;
  image::CanState state_ = image::CanState::error_active;
  drivers::SendQueue queue_;
  Batch batch_;
  bool looked_ = false;                 ///< the link was watched since receive() last found nothing
  std::uint32_t overflow_counter_ = 0;  ///< the kernel's own, wraps
  image::Nanoseconds realtime_ahead_ = 0;
  SocketCanStatistics statistics_;
};

}  // namespace servogate::socketcan
