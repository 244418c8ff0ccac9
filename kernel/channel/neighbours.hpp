// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "firmware_if/image/process_image.hpp"

namespace servogate::channel {

/// What the processes of one machine tell each other inside a cycle: a restart reaches a process only while
/// that one waits for it, and whoever sends it stands until then (NC-110 15.4). One for all processes; only
/// on the cycle's thread. Everything real-time safe.
class Meeting {
 public:
  explicit Meeting(int processes) noexcept : count_(processes) {}
  /// Processes of the machine, 1 to image::kMaxProcesses.
  int count() const noexcept { return count_; }

  /// Process `me` waits for `partner`. True: that one has sent, the wait is over; asked again until then.
  bool wait(int me, int partner) noexcept {
    Seat& seat = seats_[static_cast<std::size_t>(me)];
    const bool over = seat.released;
    seat = over ? Seat{} : Seat{partner, false};
    return over;
  }
  /// Process `me` sends to `to`. True: it waited for `me` and goes on; asked again until then.
  bool send(int me, int to) noexcept {
    Seat& seat = seats_[static_cast<std::size_t>(to)];
    if (seat.waits_for != me || seat.released) return false;
    seat.released = true;
    return true;
  }
  /// The program of `me` has ended: it waits for nobody.
  void leave(int me) noexcept { seats_[static_cast<std::size_t>(me)] = {}; }

  /// How many programs process `of` has been given, as far as this cycle may know; from 1 on.
  void show_programs(int of, std::uint64_t count) noexcept {
    programs_[static_cast<std::size_t>(of)] = count;
  }
  std::uint64_t programs(int of) const noexcept { return programs_[static_cast<std::size_t>(of)]; }

 private:
  struct Seat {
    int waits_for = -1;
    bool released = false;
  };
  int count_;
  std::array<Seat, image::kMaxProcesses> seats_{};
  std::array<std::uint64_t, image::kMaxProcesses> programs_{};
};

/// What came of a program that was to be given to another process.
enum class Supply { given, busy, not_found };

/// Gives process `to` the program `name` as process `from` finds it; busy: the one there is still being
/// read, ask again. Outside the cycle, on the feeder's thread.
using ProgramSupplier = std::function<Supply(int from, int to, const std::string& name)>;

}  // namespace servogate::channel
