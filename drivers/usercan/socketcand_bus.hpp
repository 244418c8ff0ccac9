// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/notice.hpp"
#include "drivers/usercan/address.hpp"
#include "drivers/usercan/socketcand_text.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::usercan {

struct SocketcandConfig {
  Address address;
  std::string bus = "can0";
  std::uint32_t bit_rate = 1'000'000;  ///< bit/s; what bit_rate() answers, the protocol does not tell it
  /// Takes part in lockstep under this name; empty: time is the computer's.
  std::string lockstep;
};

/// A bus of a BusServer, or of socketcand itself, as seen by one participant. Nothing is lost on the way:
/// what the socket does not take waits in a buffer, and send() refuses when that is full.
///
/// send(), receive() and state() make system calls that never wait; they do not allocate. Not thread-safe.
class SocketcandBus final : public image::CanBus {
 public:
  /// nullptr: refused, `why` says it. Waits for the server's answers, five seconds at most.
  static std::unique_ptr<SocketcandBus> open(const SocketcandConfig& config, drivers::Notice& why);
  ~SocketcandBus() override;
  SocketcandBus(const SocketcandBus&) = delete;
  SocketcandBus& operator=(const SocketcandBus&) = delete;

  /// real-time safe.
  bool send(const image::CanFrame& frame) noexcept override;
  /// real-time safe.
  bool receive(image::CanFrame& frame) noexcept override;
  /// `down` when the server is gone.
  image::CanState state() const noexcept override {
    return connected_ ? image::CanState::error_active : image::CanState::down;
  }
  std::uint32_t bit_rate() const noexcept override { return config_.bit_rate; }
  std::uint64_t lost() const noexcept override { return lost_; }
  /// For poll(2): readable when something has come.
  int descriptor() const noexcept { return socket_; }
  /// Served by a BusServer, behind which nothing is real; socketcand itself serves real interfaces.
  bool simulated() const noexcept { return simulated_; }
  /// Everything sent has left this process. real-time safe.
  bool flushed() const noexcept { return out_size_ == 0; }

  /// Lockstep: says that everything of the granted instant is done, and that time is wanted at `wish` at the
  /// latest, and before that by `wake`. The first one comes after the first grant.
  bool done(image::Nanoseconds wish, LockstepWake wake = LockstepWake::any) noexcept;
  /// Lockstep: waits for the next grant; everything heard until then can be received afterwards. nullopt:
  /// time has ended, or the server is gone. Not real-time safe.
  std::optional<image::Nanoseconds> wait_grant();
  image::Nanoseconds granted() const noexcept { return granted_; }

 private:
  SocketcandBus(int socket, SocketcandConfig config);
  bool greet(drivers::Notice& why);
  /// Says something and waits for an answer: true when it is this word, false with `why` otherwise.
  bool expect(std::string_view said, std::string_view word, drivers::Notice& why);
  bool wait_readable(int milliseconds) const;
  void say(std::string_view text) noexcept;
  void flush() noexcept;
  bool fill() noexcept;
  std::optional<std::string_view> next_element() noexcept;
  bool read_element(std::string_view element, image::CanFrame& frame) noexcept;
  void disconnect() noexcept;

  static constexpr std::size_t kInput = 256 << 10, kOutput = 64 << 10;

  int socket_;
  SocketcandConfig config_;
  bool connected_ = true;
  std::vector<char> in_, out_;  ///< taken once
  std::size_t in_begin_ = 0, in_end_ = 0, out_size_ = 0;
  std::uint64_t lost_ = 0;
  image::Nanoseconds realtime_ahead_ = 0;
  image::Nanoseconds granted_ = 0;
  std::size_t grant_end_ = 0;  ///< of the input: what was heard until the grant ends here
  bool ended_ = false;
  bool simulated_ = false;
};

}  // namespace servogate::usercan
