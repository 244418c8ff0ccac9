// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/compose/devices/device_table.hpp"

#include "firmware_if/text/finding.hpp"
#include "gateway/control/compose/devices/board_device.hpp"
#include "gateway/control/compose/devices/gpio_device.hpp"
#include "gateway/control/compose/devices/modbus_device.hpp"
#include "gateway/control/compose/devices/world_device.hpp"

namespace servogate::gateway {

namespace {

bool not_empty(std::string_view rest) { return !rest.empty(); }

const std::string kChipForm = text::both("chip:LABEL", "chip:МЕТКА");
const std::string kMockForm = text::both("mock:NAME", "mock:ИМЯ");
const std::string kUsbForm = text::both("usb:SERIAL, usb:any", "usb:СЕРИЙНЫЙ, usb:any");
const std::string kTcpForm = text::both("tcp:HOST:PORT", "tcp:ХОСТ:ПОРТ");

const DeviceRow kRows[] = {
    {DeviceKind::line, "mock:", kMockForm, true, not_empty, open_world_device},
    {DeviceKind::line, "tcp:", kTcpForm, false, is_tcp_peer, open_modbus},
    {DeviceKind::line, "rtu:", "rtu:/dev/...", false, is_serial_device, open_modbus, serial_available},
    {DeviceKind::chip, "mock:", kMockForm, true, not_empty, open_world_device},
    {DeviceKind::chip, "chip:", kChipForm, false, not_empty, open_gpio_device, gpio_available},
    {DeviceKind::board, "mock:", kMockForm, true, not_empty, open_mock_board},
    {DeviceKind::board, "usb:", kUsbForm, false, not_empty, open_usb_board, usb_board_available},
};

}  // namespace

std::span<const DeviceRow> device_rows() { return kRows; }

const DeviceRow* device_row(DeviceKind kind, std::string_view url) {
  for (const DeviceRow& row : kRows)
    if (row.kind == kind && url.starts_with(row.scheme) && row.well_formed(url.substr(row.scheme.size())))
      return &row;
  return nullptr;
}

std::string device_forms(DeviceKind kind) {
  std::string english, russian;
  for (const DeviceRow& row : kRows) {
    if (row.kind != kind) continue;
    const std::string form(row.form);
    english += (english.empty() ? "" : ", ") + text::in_language(form, text::Language::english);
    russian += (russian.empty() ? "" : ", ") + text::in_language(form, text::Language::russian);
  }
  return text::both(english, russian);
}

}  // namespace servogate::gateway
