// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>

#include <algorithm>

#include "drivers/usercan/address.hpp"
#include "firmware_if/image/interface_map.hpp"
#include "machine/check/check.hpp"

namespace servogate::machine {

namespace {

const text::Entry kListen{
    "machine.modbus_listen",
    "`modbus_server.listen`: \"{0}\" is no address in numbers and a port, as \"127.0.0.1:1502\"",
    "`modbus_server.listen`: «{0}» — не адрес числами и порт, как \"127.0.0.1:1502\""};
const text::Entry kNobody{
    "machine.modbus_nobody",
    "`modbus_server.listen` is open to other computers, but `clients` names none: nobody "
    "but this one would be served",
    "`modbus_server.listen` открыт другим компьютерам, но в `clients` никого нет: ответ "
    "получит только этот"};
const text::Entry kClient{"machine.modbus_client",
                          "`modbus_server.clients`: \"{0}\" is no address in numbers",
                          "`modbus_server.clients`: «{0}» — не адрес числами"};
const text::Entry kRange{
    "machine.modbus_range",
    "`modbus_server.write`: \"{0}\" is no range of bytes of packet K, as \"SK200-SK231\"",
    "`modbus_server.write`: «{0}» — не диапазон байтов пакета K, как \"SK200-SK231\""};
const text::Entry kInterface{
    "machine.modbus_interface",
    "`modbus_server.write`: \"{0}\" reaches into the interface between NC and PLC (SK{1} to "
    "SK{2}), which nobody else writes",
    "`modbus_server.write`: «{0}» захватывает интерфейс ЧПУ и ПЛК (SK{1}–SK{2}), который "
    "никто другой не пишет"};

bool numeric(const std::string& host) {
  unsigned char bytes[16];
  return inet_pton(AF_INET, host.c_str(), bytes) == 1 || inet_pton(AF_INET6, host.c_str(), bytes) == 1;
}

/// Of packet K; nullopt: no byte of it.
std::optional<std::uint32_t> byte_of(std::string_view name, const MachineConfig& machine) {
  const auto place = image::parse_place(name);
  if (!place || place->packet != image::Packet::k || place->format != image::Format::by ||
      place->index >= static_cast<std::uint32_t>(machine.control.k_size))
    return std::nullopt;
  return place->index;
}

}  // namespace

void check_modbus_server(const MachineConfig& m, Reading& reading) {
  const ModbusServerConfig& s = m.modbus_server;
  if (!s.listen.empty()) {
    const auto address = usercan::parse_address(s.listen);
    const bool good = address && numeric(address->host) && address->port > 0;
    if (!good) reading.error(m.where("modbus_server.listen"), kListen, {s.listen});
    const bool here = good && (address->host.starts_with("127.") || address->host == "::1");
    if (good && !here && s.clients.empty()) reading.error(m.where("modbus_server.listen"), kNobody, {});
  }
  for (std::size_t n = 0; n < s.clients.size(); ++n)
    if (!numeric(s.clients[n]))
      reading.error(m.where("modbus_server.clients." + std::to_string(n)), kClient, {s.clients[n]});
  constexpr std::uint32_t kEnd = image::kMachineBase + image::kMachineBlock;
  for (std::size_t n = 0; n < s.write.size(); ++n) {
    const std::string& text = s.write[n];
    const std::size_t dash = text.find('-');
    const auto first = byte_of(std::string_view(text).substr(0, dash), m);
    const auto last = dash == std::string::npos ? first : byte_of(std::string_view(text).substr(dash + 1), m);
    const Where at = m.where("modbus_server.write." + std::to_string(n));
    if (!first || !last || *last < *first)
      reading.error(at, kRange, {text});
    else if (*first < kEnd && *last >= image::kInterfaceBase)
      reading.error(at, kInterface, {text, std::to_string(image::kInterfaceBase), std::to_string(kEnd - 1)});
  }
}

}  // namespace servogate::machine
