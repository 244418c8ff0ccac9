// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "firmware_if/image/alarms/alarm_table.hpp"

/// Alarms in words, outside the cycle. Not real-time safe.
namespace servogate::image {

/// Names that a record holds only as numbers, and the table that its sentence stands in.
struct AlarmNames {
  const AlarmTable* table = nullptr;  ///< nullptr: every alarm is its number
  std::vector<std::string> axes;
  std::vector<std::string> units;    ///< of each axis; missing: mm
  std::vector<bool> diameters;       ///< axes whose positions people see as diameters; missing: none
  std::vector<std::string> devices;  ///< by PartPlace::device
  std::vector<std::string> sources;
  /// Words of the error code of the drive or part that the record names; empty result: only the number is
  /// shown.
  std::function<std::string(const AlarmRecord&, std::uint16_t code, text::Language)> error_text;
  /// A part as the machine file calls it, "can.y"; may be empty.
  std::function<std::string(const PartPlace&)> part_name;
};

/// Sentence of a record, e.g. `X: following error 1.24 mm, allowed 1 mm, at 103.2 mm/s and 71 % torque`.
std::string render(const AlarmRecord& record, const AlarmNames& names, text::Language language);
/// What to do about it.
std::string render_remedy(const AlarmRecord& record, const AlarmNames& names, text::Language language);
/// What a program reads of it: of its part, its detail and its room.
std::vector<AlarmFact> facts_of(const AlarmRecord& record, const AlarmNames& names);

/// "0x8611 (following error)", "without a code".
std::string error_words(const AlarmRecord& record, std::uint16_t code, const AlarmNames& names,
                        text::Language language);
/// The name at this index, the index itself where there is none.
std::string name_at(const std::vector<std::string>& names, int index);

/// Words for reactions and reset conditions, for people.
std::string_view words(Reaction reaction, text::Language language);
std::string_view words(ResetCondition condition, text::Language language);

/// The manual page docs/alarms.md, whole.
std::string alarms_page(const AlarmTable& table);

}  // namespace servogate::image
