// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/server/modbus/modbus_server.hpp"

namespace servogate::gateway {

using modbus::Exception;

namespace {

constexpr std::chrono::milliseconds kSnapshots{20}, kPatience{2000};

modbus::Response refused(const modbus::Request& asked, Exception exception) {
  return {asked.function, exception, asked.address, asked.count, {}};
}

}  // namespace

ModbusServer::ModbusServer(const machine::ModbusServerConfig& config, Desk& desk)
    : client_(desk, image::Asker::modbus, "modbus", text::user_language()) {
  for (const std::string& range : config.write)
    if (const auto bytes = parse_range(range)) open_.push_back(*bytes);
  client_.subscribe(kSnapshots, [this](const image::ProcessImage& image, const cycle::AlarmSnapshot& alarms) {
    const std::scoped_lock lock(seen_lock_);
    if (seen_ == nullptr) seen_ = std::make_unique<image::ProcessImage>();
    *seen_ = image;
    alarms_ = {alarms.count, alarms.count > 0 ? alarms.records[0].number : std::uint16_t{0}};
  });
}

ModbusServer::~ModbusServer() = default;

std::unique_ptr<ModbusServer> ModbusServer::open(const machine::ModbusServerConfig& config, Desk& desk,
                                                 drivers::Notice& why) {
  std::unique_ptr<ModbusServer> s(new ModbusServer(config, desk));
  modbus::ServerSettings settings;
  settings.listen = modbus::parse_tcp(config.listen).value_or(modbus::TcpAddress{"127.0.0.1", "502"});
  settings.clients = config.clients;
  s->server_ = modbus::TcpServer::open(
      settings, [s = s.get()](const modbus::Request& asked, const std::string&) { return s->answer(asked); },
      why);
  return s->server_ != nullptr ? std::move(s) : nullptr;
}

modbus::Response ModbusServer::answer(const modbus::Request& asked) {
  if (modbus::writes(asked.function)) return write(asked);
  const std::scoped_lock lock(seen_lock_);
  if (seen_ == nullptr) return refused(asked, Exception::server_device_busy);
  return read_registers(asked, *seen_, alarms_);
}

/// One request to the gate for each place, in their order; the first that is refused ends it.
modbus::Response ModbusServer::write(const modbus::Request& asked) {
  const auto writes = places_of(asked, open_);
  if (!writes) return refused(asked, Exception::illegal_data_address);
  for (const PlaceWrite& w : *writes) {
    const auto reply = client_.ask(ask::SetPlace{w.place, w.value}, kPatience);
    if (!reply) return refused(asked, Exception::server_device_busy);
    if (!reply->ok) return refused(asked, Exception::server_device_failure);
  }
  return {asked.function, Exception::none, asked.address, asked.count, asked.data};
}

}  // namespace servogate::gateway
