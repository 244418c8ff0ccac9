// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/words/alarm_entries.hpp"

#include <algorithm>

namespace servogate::gateway {

namespace {

bool is_of_program(image::AlarmNumber number) {
  return number == cycle::alarm::kProgramError || number == cycle::alarm::kProgramWarning;
}

report::AlarmEntry entry_of(Control& control, const image::AlarmRecord& record,
                            const image::AlarmNames& names, text::Language language) {
  report::AlarmEntry entry;
  entry.record = record;
  if (const image::AlarmRow* row = names.table->find(record.number); row != nullptr)
    entry.id = std::string(row->text.id);
  entry.text = image::render(record, names, language);
  entry.remedy = image::render_remedy(record, names, language);
  entry.facts = image::facts_of(record, names);
  if (record.axis >= 0) entry.axis = control.machine().axes[static_cast<std::size_t>(record.axis)].letter;
  if (is_of_program(record.number) && record.process >= 0)
    entry.finding = control.process(record.process).texts().finding(static_cast<int>(record.value));
  return entry;
}

}  // namespace

std::vector<report::AlarmEntry> alarm_entries(Control& control, std::span<const image::AlarmRecord> records,
                                              text::Language language) {
  const image::AlarmNames names = control.alarm_names();
  std::vector<report::AlarmEntry> entries;
  std::vector<bool> taken(records.size(), false);
  const auto take = [&](std::size_t n, bool consequence) {
    taken[n] = true;
    entries.push_back(entry_of(control, records[n], names, language));
    entries.back().consequence = consequence;
  };
  for (std::size_t n = 0; n < records.size(); ++n) {
    if (taken[n]) continue;
    // A consequence whose first fault is not there any more stands for itself.
    take(n, false);
    for (std::size_t later = n + 1; later < records.size(); ++later)
      if (!taken[later] && records[later].first_fault == records[n].first_fault &&
          records[later].sequence != records[later].first_fault)
        take(later, true);
  }
  return entries;
}

}  // namespace servogate::gateway
