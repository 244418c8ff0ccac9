// SPDX-License-Identifier: Apache-2.0
// The board of a station on a dummy USB host: usb_board_gadget FUNCTIONFS_FOLDER MACHINE STATION. The station is simulated whatever its
// url is. Lines "POINT VALUE" on standard input set inputs. Ends when it is killed.
#include <linux/usb/functionfs.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <mutex>
#include <sstream>
#include <thread>

#include "drivers/clock.hpp"
#include "firmware_if/board/protocol/messages.hpp"
#include "gateway/control/compose/simulated/world_setup.hpp"
#include "machine/load.hpp"
#include "tests/usb_gadget/functionfs.hpp"

namespace {

using namespace servogate;

/// The world of the machine file in real time.
class Board {
 public:
  Board(const machine::LoadResult& loaded, const std::string& station)
      : world_(gateway::simulated_world(loaded)), board_(world_->board(station)), start_ns_(now()) {
    world_->close_operator_points();
  }
  bool there() const { return board_ != nullptr; }
  void pass() {
    const std::scoped_lock lock(mutex_);
    world_->advance_to(now() - start_ns_);
  }
  std::vector<std::uint8_t> exchange(std::span<const std::uint8_t> message) {
    const std::scoped_lock lock(mutex_);
    world_->advance_to(now() - start_ns_);
    const auto answer = board_->exchange(message);
    return {answer.begin(), answer.end()};
  }
  bool play(const std::string& point, double value) {
    return world_->play_input(point, {value}) == mock::World::Played::done;
  }

 private:
  static image::Nanoseconds now() { return drivers::clock_ns(CLOCK_MONOTONIC); }
  std::unique_ptr<mock::World> world_;
  mock::SimulatedBoard* board_;
  image::Nanoseconds start_ns_;
  std::mutex mutex_;
};

[[noreturn]] void serve(Board& board, const gadget::FunctionFs& function) {
  std::array<std::uint8_t, board::kMostBytes> data{};
  for (;;) {
    const ssize_t got = read(function.out(), data.data(), data.size());
    if (got < 0 && errno != ESHUTDOWN && errno != EINTR) std::_Exit(4);
    if (got <= 0) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      continue;
    }
    const auto answer = board.exchange({data.data(), static_cast<std::size_t>(got)});
    if (write(function.in(), answer.data(), answer.size()) < 0 && errno != ESHUTDOWN && errno != EINTR) std::_Exit(4);
  }
}

/// Nothing is asked of endpoint 0 that the kernel does not answer: what comes is refused.
void serve_requests(const gadget::FunctionFs& function) {
  usb_functionfs_event event{};
  for (;;) {
    const ssize_t got = read(function.requests(), &event, sizeof event);
    if (got < 0 && (errno == EIDRM || errno == EINTR)) continue;
    if (got != static_cast<ssize_t>(sizeof event) || event.type == FUNCTIONFS_UNBIND) return;
    if (event.type != FUNCTIONFS_SETUP) continue;
    const bool to_host = (event.u.setup.bRequestType & USB_DIR_IN) != 0;
    // Going the other way than asked for stalls the request.
    const ssize_t done = to_host ? read(function.requests(), &event, 0) : write(function.requests(), &event, 0);
    if (done < 0 && errno == EBADF) return;
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 4) {
    std::fprintf(stderr, "usb_board_gadget FUNCTIONFS_FOLDER MACHINE STATION\n");
    return 2;
  }
  machine::LoadResult loaded = machine::load(arguments[2]);
  for (machine::StationConfig& station : loaded.machine.stations)
    if (station.kind == machine::StationKind::board) station.url = "mock:" + station.name;
  Board board(loaded, arguments[3]);
  if (!board.there()) {
    std::fprintf(stderr, "%s has no board '%s'\n", arguments[2], arguments[3]);
    return 2;
  }
  const gadget::FunctionFs function(arguments[1], {board::kInterfaceClass, board::kInterfaceSubclass, board::kInterfaceProtocol});
  std::printf("ready\n");
  std::fflush(stdout);
  std::thread(serve, std::ref(board), std::cref(function)).detach();
  std::thread([&] {
    for (;; std::this_thread::sleep_for(std::chrono::milliseconds(1))) board.pass();
  }).detach();
  std::thread([&] {
    for (std::string line; std::getline(std::cin, line);) {
      std::istringstream words(line);
      std::string point;
      double value = 0.0;
      if (words >> point >> value && board.play(point, value))
        std::printf("%s\n", line.c_str());
      else
        std::printf("no such input: %s\n", line.c_str());
      std::fflush(stdout);
    }
  }).detach();
  serve_requests(function);
  std::_Exit(0);  // the others wait for a host that has gone
} catch (const std::exception& e) {
  std::fprintf(stderr, "usb_board_gadget: %s\n", e.what());
  return 4;
}
