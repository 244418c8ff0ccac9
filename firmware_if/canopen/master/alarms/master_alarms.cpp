// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/alarms/master_alarms.hpp"

#include "firmware_if/canopen/301/words/frame_words.hpp"
#include "firmware_if/canopen/302/boot_detail.hpp"
#include "firmware_if/canopen/master/alarms/master_rows.hpp"
#include "firmware_if/canopen/master/events/bus_event.hpp"
#include "firmware_if/image/alarms/alarm_text.hpp"
#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/image/frames/frame_record.hpp"

namespace servogate::canopen {

namespace {

using image::AlarmRecord;
using text::Language;
namespace alarm = image::alarm;

/// The sentences of these begin with the bus, whichever node has to do with it.
bool of_a_bus(image::AlarmNumber n) {
  using namespace alarm;
  return n == kBusOff || n == kBusErrorPassive || n == kBusDown || n == kBusSendOverflow ||
         n == kForeignFrame || n == kForeignRequest || n == kLeadLost;
}

/// NMT state of a heartbeat.
std::string nmt_words(int state, Language language) {
  const bool russian = language == Language::russian;
  if (state == 4) return russian ? "Stopped (остановлен)" : "Stopped";
  if (state == 127) return russian ? "Pre-operational (не в работе)" : "Pre-operational";
  return std::to_string(state);
}

std::string pdo_words(double pdo) {
  if (pdo <= 0.0) return "";
  return pdo >= 255.0 ? " (SDO)" : " (TPDO" + text::number(pdo, 0) + ")";
}

}  // namespace

std::span<const image::AlarmRow> master_alarm_rows() { return kMasterRows; }

void MasterAlarmWords::arguments(const AlarmRecord& r, const image::AlarmNames& names, Language language,
                                 image::AlarmArguments& out) const {
  if (of_a_bus(r.number)) out[3] = r.part.device < 0 ? "-" : image::name_at(names.devices, r.part.device);
  if (r.number == alarm::kBootFailed) out[6] = boot_words(r, language);
  if (r.number == alarm::kPdoMissing || r.number == alarm::kPdoShort) out[6] = pdo_words(r.detail1);
  if (r.number == alarm::kNodeLeft) out[1] = nmt_words(static_cast<int>(r.value), language);
  if (const auto frame = r.detail.get<image::FrameDetail>())
    out[8] = text::in_language(frame_words(image::frame_of(*frame)), language);
}

std::string MasterAlarmWords::boot_words(const AlarmRecord& r, Language language) const {
  BusEvent event;
  event.kind = BusEventKind::boot_failed;
  const auto detail = r.detail.get<BootDetail>();
  if (!detail) return language == Language::russian ? "запуск не удался" : "start-up failed";
  event.boot = boot_report(*detail);
  if (expected_) event.boot.expected_text = BootText(expected_(r.part));
  const std::string words = describe(event, {}, nullptr, language);
  return words.starts_with(": ") ? words.substr(2) : words;
}

std::vector<image::AlarmFact> MasterAlarmWords::facts(const AlarmRecord& r) const {
  const auto boot = r.detail.get<BootDetail>();
  if (!boot || boot->index == 0) return {};
  return {{"object", image::hex_text(boot->index, 4) + ":" + std::to_string(boot->subindex)}};
}

}  // namespace servogate::canopen
