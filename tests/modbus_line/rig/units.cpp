// SPDX-License-Identifier: Apache-2.0
#include "tests/modbus_line/rig/units.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

#include "drivers/clock.hpp"

namespace servogate::modbus_line {

namespace {

image::Nanoseconds now() { return drivers::clock_ns(CLOCK_MONOTONIC); }

std::uint16_t crc_of(const std::uint8_t* bytes, std::size_t size) {
  std::uint16_t crc = 0xFFFF;
  for (std::size_t i = 0; i < size; ++i) {
    crc = static_cast<std::uint16_t>(crc ^ bytes[i]);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0xA001 : crc >> 1);
  }
  return crc;
}

void write_all(int fd, const Bytes& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t n = ::write(fd, bytes.data() + at, bytes.size() - at);
    if (n <= 0) return;  // the other side has gone
    at += static_cast<std::size_t>(n);
  }
}

}  // namespace

Bytes with_crc(Bytes frame) {
  const std::uint16_t crc = crc_of(frame.data(), frame.size());
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  return frame;
}

Units::Units(Wire wire, const std::vector<std::uint8_t>& units) : wire_(wire) {
  for (const std::uint8_t unit : units) {
    mock::StationSettings settings;
    settings.unit = unit;
    stations_.emplace(unit, mock::ModbusStation(settings));
  }
  begin();
}

Units::Units(const mock::StationSettings& unit, Wire wire) : wire_(wire) {
  counted_ = unit.inverter && unit.inverter->registers.coding == modbus::Coding::huanyang;
  stations_.emplace(unit.unit, mock::ModbusStation(unit));
  begin();
}

void Units::begin() {
  signal(SIGPIPE, SIG_IGN);
  if (wire_ == Wire::tcp) {
    listen();
  } else {
    int master = -1;
    char name[128] = {};
    if (openpty(&master, &slave_, name, nullptr, nullptr) != 0) ADD_FAILURE() << "no pseudo terminal";
    termios raw{};
    tcgetattr(slave_, &raw);
    cfmakeraw(&raw);
    tcsetattr(slave_, TCSANOW, &raw);
    device_ = name;
    connections_.push_back({master, next_connection_++, {}});
  }
  thread_ = std::thread([this] { work(); });
}

Units::~Units() {
  stop_ = true;
  thread_.join();
  close_all();
  if (listening_ >= 0) ::close(listening_);
  if (slave_ >= 0) ::close(slave_);
}

void Units::listen() {
  listening_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  setsockopt(listening_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port_);
  if (bind(listening_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listening_, 8) != 0)
    ADD_FAILURE() << "cannot listen on loopback";
  socklen_t size = sizeof address;
  getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
}

void Units::bend(Bend bend) {
  const std::scoped_lock lock(lock_);
  bend_ = std::move(bend);
}

void Units::unplug() {
  const std::scoped_lock lock(lock_);
  plugged_ = false;
  if (listening_ >= 0) ::close(listening_);
  listening_ = -1;
  close_all();
}

void Units::plug() {
  const std::scoped_lock lock(lock_);
  plugged_ = true;
  listen();
}

void Units::close_all() {
  for (const Connection& c : connections_) ::close(c.fd);
  connections_.clear();
}

Bytes Units::frame(const Asked& asked, const Bytes& pdu) const {
  Bytes bytes;
  if (wire_ == Wire::tcp) {
    const std::size_t behind = pdu.size() + 1;
    bytes = {static_cast<std::uint8_t>(asked.transaction >> 8),
             static_cast<std::uint8_t>(asked.transaction),
             0,
             0,
             static_cast<std::uint8_t>(behind >> 8),
             static_cast<std::uint8_t>(behind)};
  }
  bytes.push_back(asked.unit);
  bytes.insert(bytes.end(), pdu.begin(), pdu.end());
  return wire_ == Wire::tcp ? bytes : with_crc(bytes);
}

void Units::with(std::uint8_t unit, const std::function<void(mock::ModbusStation&)>& act) {
  const std::scoped_lock lock(lock_);
  act(stations_.at(unit));
}

bool Units::output(std::uint8_t unit, std::uint16_t n) {
  bool on = false;
  with(unit, [&](const mock::ModbusStation& s) { on = s.output(n); });
  return on;
}

std::vector<Asked> Units::asked() const {
  const std::scoped_lock lock(lock_);
  return asked_;
}

std::size_t Units::asked_of(std::uint8_t unit) const {
  const std::scoped_lock lock(lock_);
  return static_cast<std::size_t>(std::ranges::count(asked_, unit, &Asked::unit));
}

void Units::work() {
  while (!stop_) {
    std::vector<pollfd> wanted;
    image::Nanoseconds wait = 5 * image::kMillisecond;
    {
      const std::scoped_lock lock(lock_);
      wait = std::min(wait, send_due());
      for (const Connection& c : connections_) wanted.push_back({c.fd, POLLIN, 0});
      if (listening_ >= 0) wanted.push_back({listening_, POLLIN, 0});
    }
    const timespec patience{0, static_cast<long>(wait)};
    if (ppoll(wanted.data(), wanted.size(), &patience, nullptr) <= 0) continue;
    const std::scoped_lock lock(lock_);
    for (const pollfd& p : wanted) {
      if (p.revents == 0) continue;
      if (p.fd == listening_) accept_one();
      const auto c = std::ranges::find(connections_, p.fd, &Connection::fd);
      if (c == connections_.end() || read(*c)) continue;
      ::close(c->fd);
      connections_.erase(c);
    }
  }
}

void Units::accept_one() {
  const int fd = accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
  if (fd >= 0) connections_.push_back({fd, next_connection_++, {}});
}

bool Units::read(Connection& connection) {
  std::uint8_t bytes[512];
  const ssize_t n = wire_ == Wire::tcp ? recv(connection.fd, bytes, sizeof bytes, MSG_DONTWAIT)
                                       : ::read(connection.fd, bytes, sizeof bytes);
  if (n < 0 && errno == EAGAIN) return true;  // the number is that of another one now
  if (n <= 0) return wire_ == Wire::rtu;
  connection.received.insert(connection.received.end(), bytes, bytes + n);
  Asked asked;
  asked.connection = connection.number;
  while (take_request(connection, asked)) {
    asked.t_ns = now();
    asked_.push_back(asked);
    answer(asked);
  }
  return true;
}

bool Units::take_request(Connection& connection, Asked& asked) const {
  Bytes& in = connection.received;
  const std::size_t before = wire_ == Wire::tcp ? 6 : 0, behind = wire_ == Wire::tcp ? 0 : 2;
  if (in.size() < before + 2) return false;
  std::size_t size = 0;  // of unit and PDU
  if (wire_ == Wire::tcp) {
    size = static_cast<std::size_t>(in[4] << 8 | in[5]);
    asked.transaction = static_cast<std::uint16_t>(in[0] << 8 | in[1]);
  } else {
    const bool multiple = !counted_ && (in[1] == 15 || in[1] == 16);
    if (multiple && in.size() < 7) return false;
    if (counted_ && in.size() < 3) return false;
    size = counted_ ? 3u + in[2] : multiple ? 7u + in[6] : 6u;
  }
  if (in.size() < before + size + behind) return false;
  asked.unit = in[before];
  const auto begin = in.begin() + static_cast<std::ptrdiff_t>(before);
  asked.pdu.assign(begin + 1, begin + static_cast<std::ptrdiff_t>(size));
  if (wire_ == Wire::rtu && crc_of(in.data(), size + 2) != 0)
    ADD_FAILURE() << "a request with a wrong checksum";
  in.erase(in.begin(), begin + static_cast<std::ptrdiff_t>(size + behind));
  return true;
}

void Units::answer(const Asked& asked) {
  Bytes good;
  if (const auto station = stations_.find(asked.unit); station != stations_.end()) {
    modbus::Pdu request, response;
    std::ranges::copy(asked.pdu, request.bytes.begin());
    request.size = asked.pdu.size();
    if (station->second.serve(asked.t_ns, request, response))
      good.assign(response.bytes.begin(),
                  response.bytes.begin() + static_cast<std::ptrdiff_t>(response.size));
  }
  Reply reply;
  if (bend_)
    reply = bend_(asked, good);
  else if (!good.empty())
    reply.bytes = frame(asked, good);
  pending_.push_back({reply, asked.connection, asked.t_ns + reply.delay_ns});
  send_due();
}

/// Sends what is due; how long until the next one.
image::Nanoseconds Units::send_due() {
  const image::Nanoseconds t = now();
  image::Nanoseconds next = image::kSecond;
  for (std::size_t i = 0; i < pending_.size();) {
    const Pending& p = pending_[i];
    if (p.due_ns > t) {
      next = std::min(next, p.due_ns - t);
      ++i;
      continue;
    }
    const auto c = std::ranges::find(connections_, p.connection, &Connection::number);
    if (c != connections_.end()) {
      write_all(c->fd, p.reply.bytes);
      if (p.reply.hang_up) shutdown(c->fd, SHUT_RDWR);
    }
    pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return next;
}

}  // namespace servogate::modbus_line
