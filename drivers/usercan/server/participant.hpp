// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "drivers/usercan/socketcand_text.hpp"

namespace servogate::usercan {

using image::Nanoseconds;

/// Who is connected to a bus server: what it says, what waits for it. Part of BusServer.
class Participant {
 public:
  /// What the participant may say next.
  enum class Mode : std::uint8_t { greeted, opened, raw };
  /// Where a participant in lockstep stands.
  enum class Turn : std::uint8_t { none, waiting, working };

  Participant(int socket, std::uint64_t number) : socket_(socket), number_(number) { say("< hi >"); }
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  int socket() const noexcept { return socket_; }
  std::uint64_t number() const noexcept { return number_; }
  const std::string& name() const noexcept { return name_; }

  /// Reads what has come. False: the other end has closed, or is gone.
  bool read_socket();
  /// Writes what the socket takes. False: the other end is gone.
  bool write_socket(Nanoseconds wall);
  void say(std::string_view text) { out_ += text; }
  /// A frame of somebody else has ended on its bus.
  void hear(const image::CanFrame& frame);
  /// Bytes that wait to be read by it.
  std::size_t backlog() const noexcept { return out_.size(); }
  bool wants_to_write(Nanoseconds wall) const noexcept { return sendable(wall) > 0; }
  /// When something that is held back may go out; 0: nothing is.
  Nanoseconds held_until() const noexcept { return out_.size() > free_ ? hold_until_ : 0; }
  /// Keeps everything said from now on back for a moment: python-can wants the answer to `rawmode` alone.
  void hold(Nanoseconds until) noexcept {
    free_ = out_.size();
    hold_until_ = until;
  }
  void release() noexcept { free_ = std::string::npos; }

  /// The next element without taking it; nullopt: none is complete.
  std::optional<std::string_view> peek(std::size_t& taken) const noexcept;
  void take(std::size_t bytes) noexcept { done_ += bytes; }
  void take_all() noexcept { done_ = in_.size(); }
  bool full() const noexcept { return in_.size() - done_ >= kMaxInput; }

  /// A frame of this participant has gone into a mailbox.
  void offered(const image::CanFrame& frame) { mailboxes_.push_back(image::arbitration_key(frame)); }
  /// A frame of this participant has been on the wire.
  void delivered(const image::CanFrame& frame);
  /// A frame of this identifier waits in a mailbox.
  bool offers(std::uint32_t key) const noexcept;
  bool idle() const noexcept { return mailboxes_.empty() && said.empty(); }

  Mode mode = Mode::greeted;
  bool wants_remote = false;
  bool closed = false;  ///< the other end has said everything; what it said is still carried out
  int bus = -1;         ///< of the server's
  int port = -1;        ///< place on it
  Turn turn = Turn::none;
  Nanoseconds wish = 0;                   ///< when it wants time next
  LockstepWake wake = LockstepWake::any;  ///< what gives it time before that
  bool heard = false;                     ///< a frame since its last grant
  int wishes_of_now = 0;                  ///< in a row that are no later than what was granted
  std::deque<image::CanFrame> said;       ///< in lockstep: sent, not in a mailbox yet
  Nanoseconds epoch = 0;                  ///< added to the times of frames
  void set_name(std::string_view name) { name_ = name; }

 private:
  static constexpr std::size_t kMaxInput = 64 << 10;
  std::size_t sendable(Nanoseconds wall) const noexcept;

  int socket_;
  std::uint64_t number_;
  std::string name_;
  std::string in_, out_;
  std::size_t done_ = 0;  ///< bytes of in_ that were carried out
  std::size_t free_ = std::string::npos;
  Nanoseconds hold_until_ = 0;
  std::deque<std::uint32_t> mailboxes_;
};

}  // namespace servogate::usercan
