// SPDX-License-Identifier: Apache-2.0
#include "drivers/board/usb_board.hpp"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "drivers/bus_thread.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::board {
namespace {

constexpr int kLookAgain_ms = 500;
constexpr std::chrono::microseconds kBrief{50};
constexpr image::Nanoseconds kServe = 10 * image::kMillisecond;
const std::string kName = text::both("servogate board", "плата servogate");
const text::Entry kNoStart{"board.no-start", "the board {0} was opened, but its pipes do not start: {1}",
                           "плата {0} открыта, но её каналы не запускаются: {1}"};

}  // namespace

const usb::DeviceKind& board_kind() {
  static const usb::DeviceKind kind{
      kName, "usb", {}, {kInterfaceClass, kInterfaceSubclass, kInterfaceProtocol}, nullptr};
  return kind;
}

std::unique_ptr<UsbBoard> UsbBoard::open(const std::string& serial, drivers::Notice& why) {
  return open([serial](drivers::Notice& reason) { return usb::open_libusb(board_kind(), serial, reason); },
              why);
}

std::unique_ptr<UsbBoard> UsbBoard::open(Opener opener, drivers::Notice& why) {
  auto port = opener(why);
  if (port == nullptr) return nullptr;
  std::unique_ptr<UsbBoard> board(new UsbBoard(std::move(opener), std::move(port)));
  if (!board->start()) {
    why = {&kNoStart, {kName, board->port_->failure()}};
    return nullptr;
  }
  board->thread_ = std::thread([b = board.get()] { b->work(); });
  return board;
}

UsbBoard::UsbBoard(Opener opener, std::unique_ptr<usb::UsbPort> port)
    : opener_(std::move(opener)), port_(std::move(port)) {}

UsbBoard::~UsbBoard() {
  if (!thread_.joinable()) return;
  ending_.end();
  if (usb::UsbPort* port = awake_.load()) port->wake();
  thread_.join();
}

bool UsbBoard::start() noexcept {
  under_way_.fill(false);
  if (!port_->start(kMostBytes, *this)) return false;
  awake_.store(port_.get());
  return true;
}

void UsbBoard::work() noexcept {
  drivers::begin_bus_thread("board");
  while (!ending_.ended()) {
    if (port_ != nullptr)
      serve();
    else
      look_for_it();
  }
  if (port_ == nullptr) return;
  // The last message says that the control ends.
  pump();
  port_->serve(kServe);
}

void UsbBoard::serve() noexcept {
  pump();
  if (!port_->serve(kServe)) give_up();
}

void UsbBoard::pump() noexcept {
  for (std::size_t slot = 0; slot < under_way_.size(); ++slot) {
    if (under_way_[slot]) continue;
    Bytes message;
    if (!outgoing_.try_dequeue(message)) return;
    under_way_[slot] = port_->write(slot, {message.data.data(), message.size});
  }
}

void UsbBoard::give_up() noexcept {
  awake_.store(nullptr);
  // Asleep, not spinning: the cycle may have less priority than this thread, and one processor.
  while (waking_.load()) std::this_thread::sleep_for(kBrief);
  port_.reset();
  Bytes old;
  while (outgoing_.try_dequeue(old)) {
  }
}

void UsbBoard::look_for_it() noexcept {
  pollfd wait{ending_.descriptor(), POLLIN, 0};
  ::poll(&wait, 1, kLookAgain_ms);
  if (ending_.ended()) return;
  try {
    drivers::Notice why;
    port_ = opener_(why);
  } catch (const std::exception&) {
    port_.reset();
  }
  if (port_ != nullptr && !start()) port_.reset();
}

std::size_t UsbBoard::read(std::span<std::uint8_t> buffer) noexcept {
  Bytes message;
  if (!incoming_.try_dequeue(message)) return 0;
  std::copy_n(message.data.begin(), message.size, buffer.begin());
  return message.size;
}

bool UsbBoard::write(std::span<const std::uint8_t> message) noexcept {
  if (awake_.load() == nullptr || message.size() > kMostBytes) return false;
  Bytes bytes;
  bytes.size = message.size();
  std::copy(message.begin(), message.end(), bytes.data.begin());
  if (!outgoing_.try_enqueue(bytes)) return false;
  waking_.store(true);
  if (usb::UsbPort* port = awake_.load()) port->wake();
  waking_.store(false);
  return true;
}

void UsbBoard::read(std::span<const std::uint8_t> bytes) noexcept {
  Bytes message;
  message.size = std::min(bytes.size(), message.data.size());
  std::copy_n(bytes.begin(), message.size, message.data.begin());
  incoming_.try_enqueue(message);  // the cycle stands still: the newest that it missed are old
}

void UsbBoard::written(std::size_t slot, bool) noexcept { under_way_[slot] = false; }

}  // namespace servogate::board
