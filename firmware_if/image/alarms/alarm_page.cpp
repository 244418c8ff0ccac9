// SPDX-License-Identifier: Apache-2.0
#include <iterator>
#include <vector>

#include "firmware_if/image/alarms/alarm_text.hpp"

namespace servogate::image {

namespace {

struct Room {
  AlarmNumber first;
  std::string_view english;
};
constexpr Room kRooms[] = {{1000, "Axes and spindles"},
                           {2000, "Buses and drives"},
                           {3000, "Inputs and outputs"},
                           {4000, "Program and channel"},
                           {5000, "PLC"},
                           {6000, "Real time and system"}};

constexpr std::string_view kPlaceholders[] = {"AXIS",  "VALUE",   "LIMIT",   "WHERE",  "STATUS",
                                              "ERROR", "FIGURE1", "FIGURE2", "OBJECT", "LINE"};

}  // namespace

std::string alarms_page(const AlarmTable& table) {
  const std::vector<std::string> names(std::begin(kPlaceholders), std::end(kPlaceholders));
  std::string page =
      "# Alarms\n\nMade from the alarm tables of the rooms (`gateway/control/compose/alarms`); do not edit. "
      "The "
      "reaction is "
      "the default; a\n"
      "machine file may ask for a stronger one. While the machine reacts to a first fault, further faults "
      "are its\n"
      "consequences and are shown under it.\n";
  AlarmNumber room_end = 0;
  for (const AlarmRow* each : table.rows()) {
    const AlarmRow& row = *each;
    if (row.number >= room_end) {
      for (const Room& room : kRooms)
        if (row.number / 1000 == room.first / 1000)
          page += "\n## " + std::to_string(room.first) + " " + std::string(room.english) + "\n";
      room_end = static_cast<AlarmNumber>((row.number / 1000 + 1) * 1000);
    }
    page += "\n### " + std::to_string(row.number) + " `" + std::string(row.text.id) + "`\n\n";
    page += "- " + text::render(row.text, names, text::Language::english) + "\n";
    page += "- " + text::render(row.text, names, text::Language::russian) + "\n";
    page += "- Reaction: " + std::string(words(row.reaction, text::Language::english)) +
            ". Goes with: " + std::string(words(row.reset, text::Language::english)) + ".\n";
    page +=
        "- Remedy: " + std::string(row.remedy_en) + "\n- Что делать: " + std::string(row.remedy_ru) + "\n";
  }
  return page;
}

}  // namespace servogate::image
