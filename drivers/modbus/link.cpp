// SPDX-License-Identifier: Apache-2.0
#include "drivers/modbus/link.hpp"

#include <fcntl.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "drivers/clock.hpp"
#include "drivers/modbus/counted_frame.hpp"
#include "firmware_if/modbus/line_time.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::modbus {

using image::Nanoseconds;

namespace {

const text::Entry kNoRight{
    "modbus.no-right",
    "{0} may not be used by this user: sudo usermod -aG dialout $USER, then log in again (`ls -l {0}` tells "
    "the group where it is another)",
    "{0} недоступен этому пользователю: sudo usermod -aG dialout $USER, затем войдите заново (если группа "
    "другая, её покажет `ls -l {0}`)"};
const text::Entry kNoDevice{
    "modbus.no-device",
    "there is no {0}: is the adapter plugged in? `ls /dev/serial/by-id` tells names that stay the same",
    "нет {0}: адаптер подключён? Постоянные имена покажет `ls /dev/serial/by-id`"};
const text::Entry kBusy{"modbus.busy", "another program has {0}: `fuser {0}` tells which, end it first",
                        "{0} занят другой программой: `fuser {0}` покажет какой, сначала завершите её"};
const text::Entry kNoRate{
    "modbus.no-rate",
    "{0} bit/s is no rate of a serial device; usual are 9600, 19200, 38400, 57600 and 115200",
    "{0} бит/с — не скорость последовательного порта; обычны 9600, 19200, 38400, 57600 и 115200"};
const text::Entry kNotOpened{"modbus.not-opened", "{0} cannot be opened: {1}", "{0} не открывается: {1}"};

/// What libmodbus knows; anything else it would take for 9600 without a word.
constexpr std::uint32_t kRates[] = {
    1'200,   2'400,   4'800,   9'600,     19'200,    38'400,    57'600,    115'200,   230'400,   460'800,
    500'000, 576'000, 921'600, 1'000'000, 1'152'000, 1'500'000, 2'500'000, 3'000'000, 3'500'000, 4'000'000};
constexpr std::uint32_t kConnectPatience_us = 999'999;
constexpr std::size_t kHeader = 7;  // MBAP with the unit; Modbus Messaging on TCP/IP V1.0b, 3.1.3

/// How long a system call waits until `deadline`.
timespec left_until(Nanoseconds deadline) noexcept {
  const Nanoseconds left = std::max<Nanoseconds>(0, deadline - drivers::clock_ns(CLOCK_MONOTONIC));
  return {static_cast<time_t>(left / image::kSecond), static_cast<long>(left % image::kSecond)};
}

/// A port of this computer on which nobody listens may be given to the very socket that seeks it.
bool meets_itself(int fd) noexcept {
  sockaddr_storage own{}, other{};
  socklen_t own_size = sizeof own, other_size = sizeof other;
  return getsockname(fd, reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
         getpeername(fd, reinterpret_cast<sockaddr*>(&other), &other_size) == 0 && own_size == other_size &&
         std::memcmp(&own, &other, own_size) == 0;
}

std::string words_of_failure(int error) {
  return error < MODBUS_ENOBASE ? text::words_of(error) : std::string(modbus_strerror(error));
}

}  // namespace

void Link::Free::operator()(_modbus* m) const noexcept {
  modbus_close(m);
  modbus_free(m);
}

Link::Link(LinkSettings settings) : settings_(std::move(settings)) {}
Link::~Link() = default;

std::uint32_t Link::baud() const noexcept {
  const SerialPort* port = std::get_if<SerialPort>(&settings_.peer);
  return port != nullptr ? port->baud : 0;
}

bool Link::open(drivers::Notice& why) {
  close();
  const SerialPort* port = std::get_if<SerialPort>(&settings_.peer);
  const bool opened =
      port != nullptr ? open_serial(*port, why) : open_tcp(std::get<TcpAddress>(settings_.peer), why);
  if (!opened) {
    modbus_.reset();
    return false;
  }
  // Without a time for each byte the time for the answer holds for the whole of it.
  modbus_set_byte_timeout(modbus_.get(), 0, 0);
  return true;
}

bool Link::open_serial(const SerialPort& port, drivers::Notice& why) {
  if (std::ranges::find(kRates, port.baud) == std::end(kRates)) {
    why = {&kNoRate, {std::to_string(port.baud)}};
    return false;
  }
  modbus_.reset(modbus_new_rtu(port.device.c_str(), static_cast<int>(port.baud),
                               static_cast<char>(port.parity), 8, port.stop_bits));
  if (modbus_ == nullptr) {
    why = {&kNotOpened, {port.device, words_of_failure(errno)}};
    return false;
  }
  modbus_set_error_recovery(modbus_.get(), MODBUS_ERROR_RECOVERY_NONE);
  if (modbus_connect(modbus_.get()) != 0) {
    const int error = errno;
    const text::Entry* entry = error == EACCES || error == EPERM                      ? &kNoRight
                               : error == ENOENT || error == ENXIO || error == ENODEV ? &kNoDevice
                               : error == EBUSY                                       ? &kBusy
                                                                                      : &kNotOpened;
    why = {entry, {port.device, words_of_failure(error)}};
    return false;
  }
  // One master a line: as pyserial, picocom and others agree who has it.
  if (flock(modbus_get_socket(modbus_.get()), LOCK_EX | LOCK_NB) != 0) {
    why = {&kBusy, {port.device}};
    return false;
  }
  modbus_flush(modbus_.get());
  return true;
}

bool Link::open_tcp(const TcpAddress& peer, drivers::Notice& why) {
  modbus_.reset(modbus_new_tcp_pi(peer.host.c_str(), peer.port.c_str()));
  const auto refuse = [&] {
    why = {&kNotOpened, {peer.host + ":" + peer.port, words_of_failure(errno)}};
    return false;
  };
  if (modbus_ == nullptr) return refuse();
  modbus_set_error_recovery(modbus_.get(), MODBUS_ERROR_RECOVERY_NONE);
  modbus_set_response_timeout(modbus_.get(), 0, kConnectPatience_us);
  if (modbus_connect(modbus_.get()) != 0) return refuse();
  if (!meets_itself(modbus_get_socket(modbus_.get()))) return true;
  errno = ECONNREFUSED;
  return refuse();
}

void Link::close() noexcept {
  if (modbus_ == nullptr) return;
  modbus_flush(modbus_.get());
  modbus_.reset();
}

Heard Link::exchange(std::uint8_t unit, const Request& request, Response& response, drivers::Waker* waker) {
  Pdu pdu;
  const bool own = request.coding == Coding::huanyang;
  if (!encode(request, pdu) || (own && !serial())) return Heard::malformed;
  if (serial()) modbus_flush(modbus_.get());  // what comes unasked is no answer
  if (!ask(unit, pdu)) return Heard::broken;
  const LineTime wire(baud());
  constexpr std::size_t kFrame = 3;  // station address and checksum
  const Nanoseconds deadline = drivers::clock_ns(CLOCK_MONOTONIC) + settings_.answer_timeout_ns +
                               wire.characters(pdu.size + kFrame) +
                               wire.characters(response_size(request.function, request.count) + kFrame);
  const Heard waited = await(deadline, waker);
  if (waited != Heard::answer) return waited;
  return own ? read_own(unit, request, deadline, response) : read(unit, request, deadline, response);
}

Heard Link::read_own(std::uint8_t unit, const Request& request, Nanoseconds deadline, Response& response) {
  CountedFrame frame;
  const Heard heard = read_counted_frame(modbus_get_socket(modbus_.get()), deadline, frame);
  if (heard != Heard::answer) return heard;
  if (frame.bytes[0] != unit) return Heard::wrong_unit;
  const std::span<const std::uint8_t> pdu(frame.bytes.data() + 1, frame.size - 3);
  return decode_response(pdu, request, response) == AnswerFault::none ? Heard::answer : Heard::malformed;
}

bool Link::ask(std::uint8_t unit, const Pdu& pdu) {
  std::array<std::uint8_t, kHeader + kMaxPdu> bytes{};
  if (serial()) {
    if (modbus_set_slave(modbus_.get(), unit) != 0) return false;
    bytes[0] = unit;
    std::copy_n(pdu.bytes.begin(), pdu.size, bytes.begin() + 1);
    return modbus_send_raw_request(modbus_.get(), bytes.data(), static_cast<int>(pdu.size + 1)) > 0;
  }
  // modbus_send_raw_request() of libmodbus before 3.1.11 gives every request the transaction 0.
  ++transaction_;
  const std::size_t behind = pdu.size + 1;
  bytes = {static_cast<std::uint8_t>(transaction_ >> 8), static_cast<std::uint8_t>(transaction_), 0,   0,
           static_cast<std::uint8_t>(behind >> 8),       static_cast<std::uint8_t>(behind),       unit};
  std::copy_n(pdu.bytes.begin(), pdu.size, bytes.begin() + kHeader);
  const std::size_t size = kHeader + pdu.size;
  return send(modbus_get_socket(modbus_.get()), bytes.data(), size, MSG_NOSIGNAL | MSG_DONTWAIT) ==
         static_cast<ssize_t>(size);
}

Heard Link::await(Nanoseconds deadline, drivers::Waker* waker) {
  const int woken = waker != nullptr ? waker->descriptor() : -1;
  pollfd wanted[] = {{modbus_get_socket(modbus_.get()), POLLIN, 0}, {woken, POLLIN, 0}};
  for (;;) {
    const timespec left = left_until(deadline);
    const int ready = ppoll(wanted, 2, &left, nullptr);
    if (ready == 0) return Heard::silence;
    if (ready < 0 && errno != EINTR) return Heard::broken;
    if (ready < 0) continue;
    if (wanted[0].revents != 0) return Heard::answer;
    if (waker->ended()) return Heard::given_up;
    waker->clear();
  }
}

Heard Link::read(std::uint8_t unit, const Request& request, Nanoseconds deadline, Response& response) {
  const timespec left = left_until(deadline);
  const auto microseconds = static_cast<std::uint32_t>(left.tv_nsec / 1000);
  modbus_set_response_timeout(modbus_.get(), static_cast<std::uint32_t>(left.tv_sec),
                              left.tv_sec == 0 ? std::max<std::uint32_t>(microseconds, 1) : microseconds);
  std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> bytes{};
  const int got = modbus_receive_confirmation(modbus_.get(), bytes.data());
  if (got < 0) {
    if (errno == ETIMEDOUT) return Heard::half;
    return errno >= MODBUS_ENOBASE ? Heard::malformed : Heard::broken;
  }
  if (got == 0) return Heard::wrong_unit;
  const std::size_t before = serial() ? 1 : kHeader, behind = serial() ? 2 : 0;
  const auto size = static_cast<std::size_t>(got);
  if (size < before + behind + 2) return Heard::malformed;
  const std::size_t pdu = size - before - behind;
  if (!serial()) {
    if ((bytes[0] << 8 | bytes[1]) != transaction_) return Heard::wrong_transaction;
    const std::size_t told = static_cast<std::size_t>(bytes[4] << 8 | bytes[5]);
    if (bytes[2] != 0 || bytes[3] != 0 || told != pdu + 1) return Heard::malformed;
  }
  if (bytes[before - 1] != unit) return Heard::wrong_unit;
  return decode_response({bytes.data() + before, pdu}, request, response) == AnswerFault::none
             ? Heard::answer
             : Heard::malformed;
}

}  // namespace servogate::modbus
