// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/events/bus_event.hpp"

#include <vector>

#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/402/statusword.hpp"
#include "firmware_if/canopen/master/pdo/pdo_watch.hpp"
#include "firmware_if/text/hex.hpp"

namespace servogate::canopen {
namespace {

using text::Entry;
using text::Language;

// {0} is always the name of the node or of the segment.
constexpr Entry kEvents[] = {
    {"can-none", "{0}: nothing happened", "{0}: событий нет"},
    {"can-node-booted", "{0}: configured and operational", "{0}: настроен и работает"},
    {"can-boot-failed", "{0}: boot stopped at step \"{1}\": {2}",
     "{0}: загрузка остановилась на шаге «{1}»: {2}"},
    {"can-emcy", "{0}: emergency message {1}: {2}; error register {3}, manufacturer's bytes {4}",
     "{0}: аварийное сообщение {1}: {2}; регистр ошибок {3}, байты изготовителя {4}"},
    {"can-error-history", "{0}: error history 1003h:{3} has {1}, of which no message has come: {2}",
     "{0}: в истории ошибок 1003h:{3} есть {1}, о которой сообщения не было: {2}"},
    {"can-heartbeat-lost", "{0}: no heartbeat for {1} ms", "{0}: нет heartbeat уже {1} мс"},
    {"can-node-restarted", "{0}: has restarted by itself", "{0}: узел сам перезапустился"},
    {"can-node-left", "{0}: has left state Operational, NMT state is now {1}",
     "{0}: вышел из состояния Operational, состояние NMT теперь {1}"},
    {"can-pdo-missing", "{0}: no process data ({2}) for {1} cycles",
     "{0}: нет данных процесса ({2}) уже {1} циклов"},
    {"can-pdo-short", "{0}: process data {3} has {2} bytes where {1} are mapped",
     "{0}: в данных процесса {3} байтов {2}, а отображено {1}"},
    {"can-sdo-failed", "{0}: {1}", "{0}: {1}"},
    {"can-refused",
     "{0}: the drive stays in \"{1}\" and does not go to \"{2}\" for {3} ms; statusword {4}: {5}",
     "{0}: привод остаётся в состоянии «{1}» и не переходит в «{2}» уже {3} мс; слово состояния {4}: {5}"},
    {"can-handover-held",
     "{0}: the command is {1} counts away from the actual position at Operation enabled; the drive holds its "
     "place",
     "{0}: задание отстоит от действительного положения на {1} дискрет при разрешении работы; привод "
     "удерживает место"},
    {"can-not-interpolating",
     "{0}: in interpolated position mode bit 12 of the statusword (interpolation active) has not come for "
     "{1} "
     "ms; statusword {2}",
     "{0}: в режиме интерполяции бит 12 слова состояния (интерполяция активна) не появился за {1} мс; слово "
     "состояния {2}"},
    {"can-foreign-frame", "{0}: frame {1} [{2}] comes from somebody else; another master is on the bus",
     "{0}: кадр {1} [{2}] отправлен кем-то другим; на шине есть ещё один ведущий"},
    {"can-foreign-request", "{0}: request {1} [{2}] comes from somebody else",
     "{0}: запрос {1} [{2}] отправлен кем-то другим"},
    {"can-lead-lost",
     "{0}: this control stood still for {3} ms and another one leads the bus now, as frame {1} [{2}] shows; "
     "nothing is sent any more",
     "{0}: управление стояло {3} мс, и шиной управляет другое, как показывает кадр {1} [{2}]; больше ничего "
     "не отправляется"},
    {"can-unknown-node", "{0}: node {1} is on the bus but not in the machine file",
     "{0}: узел {1} есть на шине, но не описан в файле станка"},
    {"can-send-failed", "{0}: frame {1} was not sent, the transmit queue is full",
     "{0}: кадр {1} не отправлен, очередь передачи переполнена"},
    {"can-bus-state", "{0}: CAN controller is now {1}", "{0}: состояние контроллера CAN: {1}"},
};
static_assert(std::size(kEvents) == static_cast<std::size_t>(BusEventKind::bus_state) + 1);

constexpr Entry kBusStates[] = {
    {"can-state-active", "error active (normal)", "error active (норма)"},
    {"can-state-warning", "at the error warning limit", "предупреждение об ошибках (error warning)"},
    {"can-state-passive", "error passive", "пассивная ошибка (error passive)"},
    {"can-state-bus-off", "bus off: nothing can be sent or received",
     "отключён от шины (bus off): обмена нет"},
    {"can-state-down", "down: the interface is switched off or gone", "интерфейс выключен или исчез"},
};

// {0} what was done with which object, {1} expected, {2} came.
constexpr Entry kReading{"can-reading", "reading {0}", "чтение {0}"};
constexpr Entry kWriting{"can-writing", "writing {0}", "запись {0}"};
constexpr Entry kNoAnswer{"can-no-answer", "{0}: no answer", "{0}: нет ответа"};
constexpr Entry kNoMessage{"can-no-message", "the expected message did not come",
                           "ожидаемое сообщение не пришло"};
constexpr Entry kAborted{"can-aborted", "{0}: refused by the device, {3} ({1})",
                         "{0}: отказ устройства, {3} ({1})"};
constexpr Entry kWrongValue{"can-wrong-value", "{0}: expected {1}, got {2}",
                            "{0}: ожидалось {1}, получено {2}"};
constexpr Entry kWrongLength{"can-wrong-length", "{0}: expected {1} bytes, got {2}",
                             "{0}: ожидалось байтов {1}, получено {2}"};
constexpr Entry kWrongText{"can-wrong-text", "{0}: expected \"{1}\", got \"{2}\"",
                           "{0}: ожидалось «{1}», получено «{2}»"};
constexpr Entry kNotInList{"can-not-in-list", "{0}: {1} is none of the {2} that the device has",
                           "{0}: {1} нет среди {2}, которые есть у устройства"};
constexpr Entry kFlashError{"can-flash-error", "{0}: {3} ({2})", "{0}: {3} ({2})"};
constexpr Entry kFlashTimeout{"can-flash-timeout", "{0}: the flash is still at work ({2})",
                              "{0}: память всё ещё занята ({2})"};
constexpr Entry kWaiver{"can-waiver", " (of a device without it: {0})", " (для устройства без этого: {0})"};
constexpr Entry kBadProtocol{"can-bad-protocol", "{0}: the answer is against the SDO protocol, {3} ({1})",
                             "{0}: ответ нарушает протокол SDO, {3} ({1})"};

std::string hex(std::uint64_t value, int digits) { return text::hex_number(value, digits) + "h"; }

std::string fill(const Entry& entry, const std::vector<std::string>& arguments, Language language) {
  return text::render(entry, arguments, language);
}

std::string object_words(const BootReport& report, Language language) {
  std::string object = hex(report.index, 4) + ":" + hex(report.subindex, 2);
  object.pop_back();
  if (const auto name = object_name(report.index); !name.empty()) object += " " + std::string(name);
  return fill(report.writing ? kWriting : kReading, {object}, language);
}

std::string problem_words(const BootReport& report, Language language) {
  if (report.index == 0) return fill(kNoMessage, {}, language);
  const std::string what = object_words(report, language);
  const std::string code = hex(static_cast<std::uint32_t>(report.abort), 8);
  const std::string words = fill(abort_text(report.abort), {code}, language);
  switch (report.problem) {
    case BootProblem::aborted:
      return fill(kAborted, {what, code, "", words}, language);
    case BootProblem::wrong_value:
      return fill(kWrongValue, {what, hex(report.expected, 8), hex(report.got, 8)}, language);
    case BootProblem::wrong_length:
      return fill(kWrongLength, {what, std::to_string(report.expected), std::to_string(report.got)},
                  language);
    case BootProblem::bad_protocol:
      return fill(kBadProtocol, {what, code, "", words}, language);
    case BootProblem::wrong_text:
      return fill(kWrongText,
                  {what, std::string(report.expected_text.view()), std::string(report.got_text.view())},
                  language);
    case BootProblem::not_in_list:
      return fill(
          kNotInList,
          {what, std::to_string(static_cast<std::int8_t>(report.expected)), std::to_string(report.got)},
          language);
    case BootProblem::flash_error:
    case BootProblem::flash_timeout: {
      const std::string status = hex(report.got, 8);
      const std::string reason =
          fill(flash_error_text(report.got), {std::to_string(report.got >> 1 & 0x7F)}, language);
      return fill(report.problem == BootProblem::flash_error ? kFlashError : kFlashTimeout,
                  {what, "", status, reason}, language);
    }
    default:
      return fill(kNoAnswer, {what}, language);
  }
}

/// What may be said of a device that is not made for it.
std::string waiver_words(const BootReport& report, Language language) {
  const std::string_view key = boot_waiver(report);
  return key.empty() ? std::string() : fill(kWaiver, {std::string(key)}, language);
}

std::string bytes_words(const std::uint8_t* bytes, std::size_t count) {
  return text::hex_bytes({bytes, count}, " ");
}

std::string nmt_state_words(std::int64_t state) {
  switch (state) {
    case 0:
      return "Boot-up";
    case 4:
      return "Stopped";
    case 5:
      return "Operational";
    case 127:
      return "Pre-operational";
    default:
      return std::to_string(state);
  }
}

std::vector<std::string> arguments_of(const BusEvent& e, std::string_view name, const DriveProfile* profile,
                                      Language language) {
  std::vector<std::string> arguments{std::string(name)};
  const auto add = [&arguments](std::string value) { arguments.push_back(std::move(value)); };
  switch (e.kind) {
    case BusEventKind::boot_failed:
      add(fill(boot_step_text(e.boot.step), {}, language));
      add(problem_words(e.boot, language) + waiver_words(e.boot, language));
      break;
    case BusEventKind::emcy:
      add(hex(e.emcy.error_code, 4));
      add(describe_error_code(e.emcy.error_code, profile, language));
      add(hex(e.emcy.error_register, 2));
      add(bytes_words(e.emcy.manufacturer.data(), e.emcy.manufacturer.size()));
      break;
    case BusEventKind::error_history:
      add(hex(e.emcy.error_code, 4));
      add(describe_error_code(e.emcy.error_code, profile, language));
      add(hex(e.pdo, 2).substr(0, 2));
      break;
    case BusEventKind::node_left:
      add(nmt_state_words(e.got));
      break;
    case BusEventKind::pdo_missing:
      add(std::to_string(e.got));
      add(e.pdo == 0 ? "TPDO" : e.pdo == PdoWatch::kSdo ? "SDO" : "TPDO" + std::to_string(e.pdo));
      break;
    case BusEventKind::pdo_short:
      add(std::to_string(e.expected));
      add(std::to_string(e.got));
      add(hex(e.frame.id, 3));
      break;
    case BusEventKind::sdo_failed:
      add(problem_words(e.boot, language));
      break;
    case BusEventKind::refused:
      add(fill(state_text(e.refusal.from), {}, language));
      add(fill(state_text(e.refusal.wanted), {}, language));
      add(std::to_string(e.refusal.waited_ms));
      add(hex(e.statusword, 4));
      add(describe_statusword(e.statusword, language));
      break;
    case BusEventKind::not_interpolating:
      add(std::to_string(e.got));
      add(hex(e.statusword, 4));
      break;
    case BusEventKind::foreign_frame:
    case BusEventKind::foreign_request:
    case BusEventKind::lead_lost:
    case BusEventKind::send_failed:
      add(hex(e.frame.id, 3));
      add(bytes_words(e.frame.data.data(), e.frame.length < 8 ? e.frame.length : 8));
      add(std::to_string(e.got));
      break;
    case BusEventKind::unknown_node:
      add(std::to_string(e.node));
      break;
    case BusEventKind::bus_state:
      add(fill(kBusStates[static_cast<int>(e.bus_state)], {}, language));
      break;
    default:
      add(std::to_string(e.got));
      break;
  }
  return arguments;
}

}  // namespace

const text::Entry& bus_event_entry(const BusEvent& event) noexcept {
  return kEvents[static_cast<int>(event.kind)];
}

std::string describe(const BusEvent& event, std::string_view node_name, const DriveProfile* profile,
                     Language language) {
  return fill(bus_event_entry(event), arguments_of(event, node_name, profile, language), language);
}

std::string describe_error_code(std::uint16_t code, const DriveProfile* profile, Language language) {
  if (profile)
    for (const ErrorText& own : profile->error_texts)
      if (own.code == code)
        return language == Language::russian && !own.russian.empty() ? own.russian : own.english;
  return fill(error_code_text(code), {}, language);
}

}  // namespace servogate::canopen
