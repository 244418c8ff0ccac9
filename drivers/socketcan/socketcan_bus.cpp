// SPDX-License-Identifier: Apache-2.0
#include "drivers/socketcan/socketcan_bus.hpp"

#include <linux/can/raw.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include "drivers/clock.hpp"
#include "drivers/socketcan/kernel_frame.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::socketcan {
namespace {

using image::CanState;

const text::Entry kNoCan{"socketcan.no-can",
                         "this kernel has no CAN: `sudo modprobe can-raw`, or `servogate can bus` and a "
                         "socketcand: url, which need none",
                         "в этом ядре нет CAN: `sudo modprobe can-raw`, либо `servogate can bus` и url "
                         "socketcand:, где CAN ядра не нужен"};
const text::Entry kNoInterface{"socketcan.no-interface",
                               "there is no CAN interface {0}; there are: {1}. A virtual one: {2}",
                               "нет интерфейса CAN {0}; есть: {1}. Виртуальный создаёт: {2}"};
const text::Entry kNotCan{"socketcan.not-can", "{0} is no CAN interface", "{0} — не интерфейс CAN"};
const text::Entry kDown{"socketcan.down", "{0} is down; bring it up with: {1}",
                        "интерфейс {0} выключен; включить: {1}"};
const text::Entry kBitRate{"socketcan.bit-rate",
                           "{0} runs at {1} bit/s, the segment is planned for {2}; set it with: {3}",
                           "{0} работает на {1} бит/с, сегмент рассчитан на {2}; установить: {3}"};
const text::Entry kSystem{"socketcan.system", "{0}: {1}", "{0}: {1}"};

std::string names() {
  std::string list;
  for (const std::string& name : can_interfaces()) list += (list.empty() ? "" : ", ") + name;
  return list.empty() ? text::both("none", "ни одного") : list;
}

/// True: the interface can be used; otherwise `why` is filled.
bool usable(const SocketCanConfig& config, const std::optional<LinkInfo>& link, drivers::Notice& why) {
  if (!link) {
    why = {&kNoInterface,
           {config.interface, names(),
            "ip link add " + config.interface + " type vcan; ip link set " + config.interface + " up"}};
    return false;
  }
  const std::string up = command_up(*link, config.bit_rate != 0 ? config.bit_rate : 1'000'000);
  if (!link->is_can) {
    why = {&kNotCan, {config.interface}};
  } else if (!link->up) {
    why = {&kDown, {config.interface, up}};
  } else if (config.bit_rate != 0 && link->bit_rate != 0 && link->bit_rate != config.bit_rate) {
    why = {&kBitRate,
           {config.interface, std::to_string(link->bit_rate), std::to_string(config.bit_rate),
            "ip link set " + config.interface + " down; " + up}};
  } else {
    return true;
  }
  return false;
}

/// Kernel memory for received frames; a frame takes about 800 bytes of it.
constexpr int kReceiveBytes = 1 << 20;

template <typename T>
bool set_option(int s, int level, int option, const T& value) {
  return setsockopt(s, level, option, &value, sizeof value) == 0;
}

bool set_up(int s, const SocketCanConfig& config, const LinkInfo& link) {
  const int on = 1;
  const can_err_mask_t all_errors = CAN_ERR_MASK;
  std::vector<can_filter> filters;
  for (const Filter& f : config.filters) {
    const canid_t kind = f.extended ? CAN_EFF_FLAG : 0;
    filters.push_back({f.id | kind, f.mask | CAN_EFF_FLAG});
  }
  if (!filters.empty() && setsockopt(s, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                     static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0)
    return false;
  // More than the system's limit where the process may have it.
  if (!set_option(s, SOL_SOCKET, SO_RCVBUFFORCE, kReceiveBytes))
    set_option(s, SOL_SOCKET, SO_RCVBUF, kReceiveBytes);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = link.index;
  return set_option(s, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) &&
         set_option(s, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, on) && set_option(s, SOL_SOCKET, SO_TIMESTAMPNS, on) &&
         set_option(s, SOL_SOCKET, SO_RXQ_OVFL, on) &&
         bind(s, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

std::unique_ptr<SocketCanBus> SocketCanBus::open(const SocketCanConfig& config, drivers::Notice& why) {
  const int s = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (s < 0) {
    why = errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT
              ? drivers::Notice{&kNoCan, {}}
              : drivers::Notice{&kSystem, {config.interface, text::words_of(errno)}};
    return nullptr;
  }
  std::optional<LinkInfo> link = read_link(config.interface);
  if (!usable(config, link, why)) {
    close(s);
    return nullptr;
  }
  if (!set_up(s, config, *link)) {
    why = {&kSystem, {config.interface, text::words_of(errno)}};
    close(s);
    return nullptr;
  }
  const std::uint32_t rate = link->bit_rate != 0 ? link->bit_rate : config.bit_rate;
  std::unique_ptr<SocketCanBus> bus(new SocketCanBus(s, std::move(*link), rate));
  if (bus->watch_.good()) return bus;
  why = {&kSystem, {config.interface, text::words_of(errno)}};
  return nullptr;
}

SocketCanBus::SocketCanBus(int socket, LinkInfo link, std::uint32_t bit_rate)
    : socket_(socket),
      link_(std::move(link)),
      watch_(link_.index),
      bit_rate_(bit_rate),
      state_(link_.state) {}

SocketCanBus::~SocketCanBus() { close(socket_); }

bool SocketCanBus::send(const image::CanFrame& frame) noexcept {
  if (frame.error || (frame.fd && !link_.fd) || state_ == CanState::down || state_ == CanState::bus_off)
    return false;
  const std::size_t before = queue_.size();
  if (!queue_.push(frame)) {
    flush();
    if (!queue_.push(frame)) return false;
  }
  flush();
  if (queue_.size() > before) ++statistics_.waited;
  return true;
}

void SocketCanBus::flush() noexcept {
  while (!queue_.empty()) {
    canfd_frame out;
    const std::size_t size = to_kernel(queue_.first(), out);
    const ssize_t written = ::send(socket_, &out, size, MSG_DONTWAIT);
    if (written == static_cast<ssize_t>(size)) {
      queue_.pop();
      ++statistics_.sent;
      continue;
    }
    if (written < 0 && errno == EINTR) continue;
    return;  // ENOBUFS, EAGAIN: the kernel's queue is full, the rest waits here; ENETDOWN: watch_ tells
  }
}

void SocketCanBus::abandon(CanState state) noexcept {
  state_ = state;
  statistics_.abandoned += queue_.clear();
}

void SocketCanBus::fill() noexcept {
  Batch& b = batch_;
  for (std::size_t i = 0; i < kBatch; ++i) {
    b.parts[i] = {&b.frames[i], sizeof b.frames[i]};
    b.heads[i] = {};
    b.heads[i].msg_hdr.msg_iov = &b.parts[i];
    b.heads[i].msg_hdr.msg_iovlen = 1;
    b.heads[i].msg_hdr.msg_control = b.control[i].data();
    b.heads[i].msg_hdr.msg_controllen = b.control[i].size();
  }
  b.next = b.count = 0;
  const int got = recvmmsg(socket_, b.heads.data(), kBatch, MSG_DONTWAIT, nullptr);
  if (got > 0) {
    b.count = static_cast<std::size_t>(got);
    realtime_ahead_ = drivers::realtime_ahead();
  }
}

void SocketCanBus::read_control(msghdr& head, image::CanFrame& frame) noexcept {
  for (cmsghdr* c = CMSG_FIRSTHDR(&head); c != nullptr; c = CMSG_NXTHDR(&head, c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) {
      timespec t{};
      std::memcpy(&t, CMSG_DATA(c), sizeof t);
      frame.timestamp_ns = t.tv_sec * image::kSecond + t.tv_nsec - realtime_ahead_;
    } else if (c->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t counter = 0;
      std::memcpy(&counter, CMSG_DATA(c), sizeof counter);
      statistics_.overflowed += counter - overflow_counter_;
      overflow_counter_ = counter;
    }
  }
}

bool SocketCanBus::take(image::CanFrame& frame) noexcept {
  while (batch_.next < batch_.count) {
    const std::size_t i = batch_.next++;
    if (!from_kernel(batch_.frames[i], batch_.heads[i].msg_len, frame)) continue;
    read_control(batch_.heads[i].msg_hdr, frame);
    if (frame.error) {
      ++statistics_.errors;
      const CanState now = state_after(frame, state_);
      if (now == CanState::bus_off) abandon(now);
      state_ = now;
    } else {
      ++statistics_.received;
    }
    return true;
  }
  return false;
}

bool SocketCanBus::receive(image::CanFrame& frame) noexcept {
  if (!looked_) {
    looked_ = true;
    if (watch_.poll(news_) && (news_.state != link_.state || news_.up != link_.up)) {
      link_.state = news_.state;
      link_.up = news_.up;
      if (news_.state == CanState::down || news_.state == CanState::bus_off) abandon(news_.state);
      state_ = news_.state;
    }
    flush();
  }
  if (take(frame)) return true;
  fill();
  if (take(frame)) return true;
  looked_ = false;
  return false;
}

}  // namespace servogate::socketcan
