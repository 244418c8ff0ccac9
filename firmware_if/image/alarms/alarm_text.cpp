// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/alarms/alarm_text.hpp"

#include "firmware_if/image/alarms/drive_report.hpp"

namespace servogate::image {

using text::Language;

namespace {

constexpr std::string_view kReactionWords[][2] = {
    {"none", "нет"},
    {"warning", "предупреждение"},
    {"stop at block end", "останов в конце кадра"},
    {"stop on the path", "останов на траектории"},
    {"stop of each axis", "останов каждой оси"},
    {"stop of each axis, then power off", "останов каждой оси, затем отключение питания"},
    {"quick stop", "быстрый останов"},
    {"power off", "отключение питания"}};
constexpr std::string_view kResetWords[][2] = {
    {"reset", "сброс"},
    {"reset after the cause has gone", "сброс после устранения причины"},
    {"goes by itself", "снимается автоматически"}};

/// "2 (can.y, axis Y)".
std::string part_words(const AlarmRecord& r, const AlarmNames& names, Language language) {
  std::string words = names.part_name ? names.part_name(r.part) : std::string();
  if (r.axis >= 0) {
    if (!words.empty()) words += ", ";
    words += (language == Language::russian ? "ось " : "axis ") + name_at(names.axes, r.axis);
  }
  return std::to_string(r.part.part) + (words.empty() ? "" : " (" + words + ")");
}

std::string where(const AlarmRecord& r, const AlarmNames& names, Language language) {
  if (r.source >= 0) return name_at(names.sources, r.source);
  if (r.part.part >= 0) return part_words(r, names, language);
  return r.part.device < 0 ? "-" : name_at(names.devices, r.part.device);
}

AlarmArguments arguments(const AlarmRecord& r, const AlarmNames& names, Language language) {
  const DriveReport report = r.detail.get<DriveReport>().value_or(DriveReport{});
  AlarmArguments out = {r.axis < 0 ? "-" : name_at(names.axes, r.axis),
                        text::number(r.value, 4),
                        text::number(r.limit, 4),
                        where(r, names, language),
                        statusword_text(report.statusword, language),
                        error_words(r, report.error_code, names, language),
                        text::number(r.detail1, 4),
                        text::number(r.detail2, 1),
                        object_text(report.object_index, report.object_subindex),
                        std::to_string(r.line)};
  const AlarmWords* room = names.table != nullptr ? names.table->words(r.number) : nullptr;
  if (room != nullptr) room->arguments(r, names, language, out);
  return out;
}

const AlarmRow* row_of(const AlarmRecord& record, const AlarmNames& names) {
  return names.table != nullptr ? names.table->find(record.number) : nullptr;
}

}  // namespace

std::string name_at(const std::vector<std::string>& names, int index) {
  return index >= 0 && index < std::ssize(names) ? names[static_cast<std::size_t>(index)]
                                                 : std::to_string(index);
}

std::string error_words(const AlarmRecord& r, std::uint16_t code, const AlarmNames& names,
                        Language language) {
  if (code == 0) return language == Language::russian ? "без кода" : "without a code";
  const std::string out = hex_text(code, 4);
  const std::string words = names.error_text ? names.error_text(r, code, language) : std::string();
  return words.empty() ? out : out + " (" + words + ")";
}

std::string_view words(Reaction reaction, Language language) {
  return kReactionWords[static_cast<int>(reaction)][language == Language::russian];
}

std::string_view words(ResetCondition condition, Language language) {
  return kResetWords[static_cast<int>(condition)][language == Language::russian];
}

std::string render(const AlarmRecord& record, const AlarmNames& names, Language language) {
  const AlarmRow* row = row_of(record, names);
  if (row == nullptr) return "alarm " + std::to_string(record.number);
  std::string sentence = text::render(row->text, arguments(record, names, language), language);
  if (const AlarmWords* room = names.table->words(record.number); room != nullptr)
    if (const std::string more = room->appendix(record, language); !more.empty()) sentence += ": " + more;
  return sentence;
}

std::string render_remedy(const AlarmRecord& record, const AlarmNames& names, Language language) {
  const AlarmRow* row = row_of(record, names);
  if (row == nullptr) return {};
  const text::Entry remedy{row->text.id, row->remedy_en, row->remedy_ru};
  return text::render(remedy, arguments(record, names, language), language);
}

std::vector<AlarmFact> facts_of(const AlarmRecord& r, const AlarmNames& names) {
  std::vector<AlarmFact> facts;
  if (r.part.device >= 0) facts.push_back({"segment", r.part.device});
  if (r.part.part >= 0) facts.push_back({"node", r.part.part});
  if (const auto report = r.detail.get<DriveReport>()) {
    if (report->object_index != 0)
      facts.push_back(
          {"object", hex_text(report->object_index, 4) + ":" + std::to_string(report->object_subindex)});
    if (report->statusword != 0) facts.push_back({"statusword", hex_text(report->statusword, 4)});
    if (report->error_code != 0) facts.push_back({"error_code", hex_text(report->error_code, 4)});
  }
  const AlarmWords* room = names.table != nullptr ? names.table->words(r.number) : nullptr;
  if (room != nullptr)
    for (AlarmFact& fact : room->facts(r)) facts.push_back(std::move(fact));
  return facts;
}

}  // namespace servogate::image
