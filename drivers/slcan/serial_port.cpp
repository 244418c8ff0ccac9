// SPDX-License-Identifier: Apache-2.0
#include "drivers/slcan/serial_port.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <iterator>
#include <utility>

#include "firmware_if/text/system_words.hpp"

namespace servogate::slcan {
namespace {

const text::Entry kNoPort{"slcan.no-port", "the serial port {0} cannot be opened: {1}",
                          "последовательный порт {0} не открыть: {1}"};
const text::Entry kNoRight{"slcan.no-right",
                           "no right to use the serial port {0}: add yourself to its group (sudo usermod -aG "
                           "dialout $USER) and log in "
                           "again",
                           "нет прав на последовательный порт {0}: добавьте себя в его группу (sudo usermod "
                           "-aG dialout $USER) и войдите "
                           "снова"};
const text::Entry kInUse{"slcan.in-use", "the serial port {0} is used by another program; end it first",
                         "последовательный порт {0} занят другой программой; сначала завершите её"};
const text::Entry kNotSerial{"slcan.not-serial", "{0} is no serial port", "{0} — не последовательный порт"};

struct Speed {
  std::uint32_t baud;
  speed_t code;
};
constexpr Speed kSpeeds[] = {{9600, B9600},         {19'200, B19200},      {38'400, B38400},
                             {57'600, B57600},      {115'200, B115200},    {230'400, B230400},
                             {460'800, B460800},    {500'000, B500000},    {921'600, B921600},
                             {1'000'000, B1000000}, {2'000'000, B2000000}, {3'000'000, B3000000}};

const Speed* speed_of(std::uint32_t baud) {
  const auto* const found =
      std::find_if(std::begin(kSpeeds), std::end(kSpeeds), [=](const Speed& s) { return s.baud == baud; });
  return found == std::end(kSpeeds) ? nullptr : found;
}

int outcome(ssize_t n) noexcept {
  if (n > 0) return static_cast<int>(n);
  return n < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

}  // namespace

std::optional<SerialPlace> parse_place(std::string_view text) {
  SerialPlace place;
  const std::size_t at = text.rfind('@');
  place.path = text.substr(0, at);
  if (place.path.empty()) return std::nullopt;
  if (at == std::string_view::npos) return place;
  const std::string_view baud = text.substr(at + 1);
  const auto [end, error] = std::from_chars(baud.data(), baud.data() + baud.size(), place.baud);
  if (error != std::errc{} || end != baud.data() + baud.size() || speed_of(place.baud) == nullptr)
    return std::nullopt;
  return place;
}

std::optional<SerialPort> SerialPort::open(const SerialPlace& place, drivers::Notice& why) {
  const int descriptor = ::open(place.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == EACCES || errno == EPERM)
      why = {&kNoRight, {place.path}};
    else if (errno == EBUSY)
      why = {&kInUse, {place.path}};
    else
      why = {&kNoPort, {place.path, text::words_of(errno)}};
    return std::nullopt;
  }
  SerialPort port(descriptor);
  termios settings{};
  if (tcgetattr(descriptor, &settings) != 0) {
    why = {&kNotSerial, {place.path}};
    return std::nullopt;
  }
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    why = {&kInUse, {place.path}};
    return std::nullopt;
  }
  ioctl(descriptor, TIOCEXCL);
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  const speed_t code = speed_of(place.baud)->code;
  cfsetispeed(&settings, code);
  cfsetospeed(&settings, code);
  if (tcsetattr(descriptor, TCSANOW, &settings) != 0) {
    why = {&kNoPort, {place.path, text::words_of(errno)}};
    return std::nullopt;
  }
  tcflush(descriptor, TCIOFLUSH);
  return port;
}

SerialPort::SerialPort(SerialPort&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

SerialPort::~SerialPort() {
  if (descriptor_ < 0) return;
  ioctl(descriptor_, TIOCNXCL);
  ::close(descriptor_);
}

int SerialPort::write(std::string_view bytes) noexcept {
  return outcome(::write(descriptor_, bytes.data(), bytes.size()));
}

int SerialPort::read(char* bytes, std::size_t size) noexcept {
  return outcome(::read(descriptor_, bytes, size));
}

}  // namespace servogate::slcan
