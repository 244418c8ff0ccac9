// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/image/alarms/alarm_table.hpp"

#include <algorithm>
#include <stdexcept>

namespace servogate::image {

AlarmTable::AlarmTable(std::initializer_list<AlarmRoom> rooms) {
  for (const AlarmRoom& room : rooms)
    for (const AlarmRow& row : room.rows) items_.push_back({&row, room.words});
  const auto number = [](const Item& item) { return item.row->number; };
  std::ranges::sort(items_, {}, number);
  if (std::ranges::adjacent_find(items_, {}, number) != items_.end())
    throw std::logic_error("two rooms raise the alarm " +
                           std::to_string(std::ranges::adjacent_find(items_, {}, number)->row->number));
}

const AlarmTable::Item* AlarmTable::item(AlarmNumber wanted) const noexcept {
  const auto found = std::lower_bound(items_.begin(), items_.end(), wanted,
                                      [](const Item& i, AlarmNumber n) { return i.row->number < n; });
  return found != items_.end() && found->row->number == wanted ? &*found : nullptr;
}

const AlarmRow* AlarmTable::find(AlarmNumber number) const noexcept {
  const Item* found = item(number);
  return found != nullptr ? found->row : nullptr;
}

const AlarmWords* AlarmTable::words(AlarmNumber number) const noexcept {
  const Item* found = item(number);
  return found != nullptr ? found->words : nullptr;
}

AlarmMark AlarmTable::mark(AlarmNumber number) const noexcept {
  const Item* found = item(number);
  return found != nullptr ? found->row->mark : AlarmMark::none;
}

std::vector<const AlarmRow*> AlarmTable::rows() const {
  std::vector<const AlarmRow*> rows;
  for (const Item& i : items_) rows.push_back(i.row);
  return rows;
}

}  // namespace servogate::image
