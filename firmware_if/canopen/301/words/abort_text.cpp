// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/sdo_codec.hpp"

namespace servogate::canopen {
namespace {

struct Row {
  AbortCode code;
  text::Entry entry;
};

constexpr Row kRows[] = {
    {AbortCode::none, {"sdo-abort-none", "no abort", "прерывания нет"}},
    {AbortCode::toggle_not_alternated,
     {"sdo-abort-toggle", "the toggle bit did not alternate", "бит чередования сегментов не изменился"}},
    {AbortCode::timed_out,
     {"sdo-abort-timeout", "the SDO transfer timed out", "истекло время ожидания обмена SDO"}},
    {AbortCode::command_specifier_invalid,
     {"sdo-abort-specifier", "unknown or invalid SDO command", "неизвестная или недопустимая команда SDO"}},
    {AbortCode::block_size_invalid,
     {"sdo-abort-block-size", "invalid block size (block transfer)",
      "недопустимый размер блока (блочная передача)"}},
    {AbortCode::sequence_number_invalid,
     {"sdo-abort-sequence", "invalid sequence number (block transfer)",
      "недопустимый номер в последовательности (блочная передача)"}},
    {AbortCode::crc_error,
     {"sdo-abort-crc", "checksum error (block transfer)", "ошибка контрольной суммы (блочная передача)"}},
    {AbortCode::out_of_memory,
     {"sdo-abort-memory", "the device is out of memory", "у устройства не хватает памяти"}},
    {AbortCode::unsupported_access,
     {"sdo-abort-access", "this access to the object is not supported",
      "такой доступ к объекту не поддерживается"}},
    {AbortCode::write_only,
     {"sdo-abort-write-only", "the object can only be written, not read",
      "объект доступен только для записи"}},
    {AbortCode::read_only,
     {"sdo-abort-read-only", "the object can only be read, not written",
      "объект доступен только для чтения"}},
    {AbortCode::object_does_not_exist,
     {"sdo-abort-no-object", "the object does not exist in the device", "объекта нет в словаре устройства"}},
    {AbortCode::cannot_be_mapped,
     {"sdo-abort-not-mappable", "the object cannot be mapped into a PDO", "объект нельзя включить в PDO"}},
    {AbortCode::mapping_too_long,
     {"sdo-abort-map-length", "the mapped objects exceed the length of the PDO",
      "включённые объекты не помещаются в PDO"}},
    {AbortCode::parameter_incompatible,
     {"sdo-abort-incompatible", "the parameter does not agree with others",
      "параметр несовместим с другими"}},
    {AbortCode::internal_incompatible,
     {"sdo-abort-internal", "the device does not agree with itself",
      "внутренняя несовместимость в устройстве"}},
    {AbortCode::hardware_error,
     {"sdo-abort-hardware", "access failed because of a hardware error",
      "отказ доступа из-за аппаратной ошибки"}},
    {AbortCode::length_mismatch,
     {"sdo-abort-length", "the data type does not match: wrong length",
      "тип данных не подходит: неверная длина"}},
    {AbortCode::length_too_high,
     {"sdo-abort-too-long", "the data type does not match: too long",
      "тип данных не подходит: слишком большая длина"}},
    {AbortCode::length_too_low,
     {"sdo-abort-too-short", "the data type does not match: too short",
      "тип данных не подходит: слишком малая длина"}},
    {AbortCode::subindex_does_not_exist,
     {"sdo-abort-no-subindex", "the subindex does not exist", "субиндекса нет у этого объекта"}},
    {AbortCode::value_invalid,
     {"sdo-abort-value", "the value is not allowed for this parameter", "недопустимое значение параметра"}},
    {AbortCode::value_too_high,
     {"sdo-abort-value-high", "the value is too high", "слишком большое значение параметра"}},
    {AbortCode::value_too_low,
     {"sdo-abort-value-low", "the value is too low", "слишком малое значение параметра"}},
    {AbortCode::maximum_below_minimum,
     {"sdo-abort-min-max", "the maximum is below the minimum", "максимум меньше минимума"}},
    {AbortCode::resource_not_available,
     {"sdo-abort-resource", "the resource is not available (SDO connection)",
      "ресурс недоступен (соединение SDO)"}},
    {AbortCode::general_error,
     {"sdo-abort-general", "general error of the device", "общая ошибка устройства"}},
    {AbortCode::cannot_transfer,
     {"sdo-abort-transfer", "the data cannot be transferred or stored",
      "данные не могут быть переданы или сохранены"}},
    {AbortCode::local_control,
     {"sdo-abort-local", "the data cannot be stored: the device is under local control",
      "данные не сохранены: устройство под местным управлением"}},
    {AbortCode::device_state,
     {"sdo-abort-state", "the data cannot be stored in the device's present state",
      "данные не сохранены: не позволяет текущее состояние устройства"}},
    {AbortCode::no_object_dictionary,
     {"sdo-abort-no-dictionary", "the device has no object dictionary or could not build it",
      "в устройстве нет словаря объектов или его не удалось построить"}},
    {AbortCode::no_data_available, {"sdo-abort-no-data", "there is no data", "данных нет"}},
};

constexpr text::Entry kUnknown{"sdo-abort-unknown", "SDO abort code {0}, not in CiA 301",
                               "код прерывания SDO {0}, в CiA 301 его нет"};

}  // namespace

const text::Entry& abort_text(AbortCode code) noexcept {
  for (const Row& row : kRows)
    if (row.code == code) return row.entry;
  return kUnknown;
}

}  // namespace servogate::canopen
