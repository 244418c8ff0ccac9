// SPDX-License-Identifier: Apache-2.0
#include "drivers/usercan/server/participant.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "drivers/usercan/address.hpp"

namespace servogate::usercan {

Participant::~Participant() { close(socket_); }

void Participant::hear(const image::CanFrame& frame) {
  if (mode != Mode::raw || closed || (frame.remote && !wants_remote)) return;
  heard = true;
  out_ += frame_element(frame, frame.timestamp_ns + epoch).view();
}

bool Participant::read_socket() {
  std::array<char, 16384> bytes;
  in_.erase(0, std::exchange(done_, 0));
  while (in_.size() < kMaxInput) {
    const ssize_t got = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (got == 0) return false;
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    in_.append(bytes.data(), static_cast<std::size_t>(got));
    acknowledge_at_once(socket_);
  }
  return true;
}

std::size_t Participant::sendable(Nanoseconds wall) const noexcept {
  return wall < hold_until_ ? std::min(free_, out_.size()) : out_.size();
}

bool Participant::write_socket(Nanoseconds wall) {
  while (const std::size_t size = sendable(wall)) {
    const ssize_t sent = send(socket_, out_.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    const auto gone = static_cast<std::size_t>(sent);
    out_.erase(0, gone);
    if (free_ != std::string::npos) free_ -= std::min(free_, gone);
  }
  return true;
}

std::optional<std::string_view> Participant::peek(std::size_t& taken) const noexcept {
  return find_element(std::string_view(in_).substr(done_), taken);
}

void Participant::delivered(const image::CanFrame& frame) {
  const auto it = std::find(mailboxes_.begin(), mailboxes_.end(), image::arbitration_key(frame));
  if (it != mailboxes_.end()) mailboxes_.erase(it);
}

bool Participant::offers(std::uint32_t key) const noexcept {
  return std::find(mailboxes_.begin(), mailboxes_.end(), key) != mailboxes_.end();
}

}  // namespace servogate::usercan
