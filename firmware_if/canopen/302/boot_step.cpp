// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/boot_step.hpp"

#include <iterator>

#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

constexpr text::Entry kSteps[] = {
    {"boot-reset", "reset of communication and boot-up message", "сброс связи и сообщение о загрузке"},
    {"boot-device-type", "device type", "тип устройства"},
    {"boot-identity", "identity", "идентификация"},
    {"boot-software-version", "software version", "версия программы"},
    {"boot-program", "program of the device", "программа устройства"},
    {"boot-modes", "supported drive modes", "поддерживаемые режимы привода"},
    {"boot-encoder-resolution", "resolution of the encoder", "разрешение датчика положения"},
    {"boot-configuration", "configuration (DCF)", "конфигурация (DCF)"},
    {"boot-settings", "settings of the device file", "настройки из файла устройства"},
    {"boot-homing", "homing by the drive", "выход в ноль силами привода"},
    {"boot-node-guarding", "node guarding", "опрос узла (node guarding)"},
    {"boot-heartbeat-consumer", "supervision of the control's heartbeat", "контроль heartbeat управления"},
    {"boot-abort-connection", "reaction to a lost connection", "реакция на потерю связи"},
    {"boot-error-states", "outputs at a lost connection", "выходы при потере связи"},
    {"boot-sync", "SYNC", "SYNC"},
    {"boot-rpdo", "process data to the device (RPDO)", "данные процесса к устройству (RPDO)"},
    {"boot-tpdo", "process data of the device (TPDO)", "данные процесса от устройства (TPDO)"},
    {"boot-interpolation-time", "interpolation time period", "период интерполяции"},
    {"boot-mode", "mode of operation", "режим работы"},
    {"boot-heartbeat-producer", "heartbeat of the device", "heartbeat устройства"},
    {"boot-start", "NMT start and state Operational", "команда NMT Start и состояние Operational"},
    {"boot-done", "done", "завершено"},
};
static_assert(std::size(kSteps) == static_cast<std::size_t>(BootStep::done) + 1);

constexpr text::Entry kFlashErrors[] = {
    {"flash-none", "no error", "ошибки нет"},
    {"flash-no-program", "no valid program in the device", "в устройстве нет годной программы"},
    {"flash-format-unknown", "the program's format is unknown to the device",
     "устройство не знает формата программы"},
    {"flash-format", "the program's format or checksum is wrong",
     "неверный формат или контрольная сумма программы"},
    {"flash-not-cleared", "the flash was not cleared before writing", "память не стёрта перед записью"},
    {"flash-write", "writing the flash failed", "ошибка записи памяти"},
    {"flash-address", "wrong address in the program", "неверный адрес в программе"},
    {"flash-secured", "the flash is write-protected", "память защищена от записи"},
};
constexpr text::Entry kFlashOther{"flash-other", "error {0} of the flash", "ошибка памяти {0}"};

/// By step and object; object 0: any.
struct Waiver {
  BootStep step;
  std::uint16_t index;
  std::string_view key;
};
constexpr Waiver kWaivers[] = {
    {BootStep::identity, 0x1018, "vendor_id, product_code, revision = 0"},
    {BootStep::software_version, 0, "software_version = \"\""},
    {BootStep::program, 0, "program_version = -1"},
    {BootStep::supported_modes, 0, "check_modes = false"},
    {BootStep::encoder_resolution, 0, "encoder.counts_per_rev, encoder.revolutions = 0"},
    {BootStep::configuration, 0, "configuration"},
    {BootStep::settings, object::kDigitalOutputs, "brake_bit = -1, objects"},
    {BootStep::settings, 0, "objects"},
    {BootStep::homing, object::kSupportedHomingMethods, "homing_method_list = false"},
    {BootStep::homing, 0, "home.method, homing_method_none = false"},
    {BootStep::node_guarding, 0, "guard_time = \"0 s\""},
    {BootStep::heartbeat_consumer, 0, "heartbeat_consumer = false"},
    {BootStep::abort_connection, 0, "connection_loss = \"none\""},
    {BootStep::error_states, 0, "connection_loss = \"none\""},
    {BootStep::sync, object::kSyncCounterOverflow, "sync_counter = false"},
    {BootStep::sync, object::kSynchronousWindowLength, "sync_window = \"0 s\""},
    {BootStep::sync, object::kCommunicationCyclePeriod, "cycle_period = false"},
    {BootStep::rpdo, 0, "rpdo, fixed_pdo_map = true"},
    {BootStep::tpdo, 0, "tpdo, fixed_pdo_map = true"},
    {BootStep::interpolation_time, object::kInterpolationBuffer, "ip_buffer = false"},
    {BootStep::interpolation_time, 0, "interpolation_period = false, interpolation_base"},
    {BootStep::mode, 0, "position_mode, speed_mode"},
    {BootStep::heartbeat_producer, 0, "heartbeat, guard_time"},
};

}  // namespace

std::string_view boot_waiver(const BootReport& report) noexcept {
  // Another value than the right one is no inability, and neither is silence.
  if (report.index == 0 || report.problem != BootProblem::aborted) return {};
  for (const Waiver& w : kWaivers)
    if (w.step == report.step && (w.index == 0 || w.index == report.index)) return w.key;
  return {};
}

const text::Entry& flash_error_text(std::uint32_t status) noexcept {
  const std::uint32_t code = status >> 1 & 0x7F;
  return code < std::size(kFlashErrors) ? kFlashErrors[code] : kFlashOther;
}

const text::Entry& boot_step_text(BootStep step) noexcept { return kSteps[static_cast<int>(step)]; }

}  // namespace servogate::canopen
