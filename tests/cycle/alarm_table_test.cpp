// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "firmware_if/image/alarms/drive_report.hpp"
#include "firmware_if/image/frames/frame_record.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/alarms.hpp"
#include "tests/places/places.hpp"

namespace servogate::cycle {
namespace {

using image::AlarmNames;
using image::AlarmRow;
using image::Reaction;
using tests::alarm_names;
using tests::alarm_table;

TEST(AlarmTable, has_each_number_and_each_name_once_and_every_text_in_both_languages) {
  std::set<std::string_view> ids;
  image::AlarmNumber last = 0;
  for (const AlarmRow* each : alarm_table().rows()) {
    const AlarmRow& row = *each;
    EXPECT_GT(row.number, last);
    last = row.number;
    EXPECT_TRUE(ids.insert(row.text.id).second) << row.text.id;
    for (const std::string_view t : {row.text.english, row.text.russian, row.remedy_en, row.remedy_ru})
      EXPECT_FALSE(t.empty()) << row.number;
    EXPECT_NE(row.text.english, row.text.russian) << row.number;
    EXPECT_NE(row.reaction, Reaction::none) << row.number;
    EXPECT_EQ(alarm_table().find(row.number), &row);
  }
  EXPECT_EQ(alarm_table().find(999), nullptr);
  EXPECT_EQ(alarm_table().find(1099), nullptr);
}

std::multiset<std::string> placeholders(std::string_view text) {
  std::multiset<std::string> out;
  for (std::size_t i = 0; i + 2 < text.size(); ++i)
    if (text[i] == '{' && text[i + 2] == '}') out.emplace(text.substr(i, 3));
  return out;
}

TEST(AlarmTable, says_the_same_figures_in_both_languages) {
  for (const AlarmRow* each : alarm_table().rows()) {
    const AlarmRow& row = *each;
    EXPECT_EQ(placeholders(row.text.english), placeholders(row.text.russian)) << row.number;
    EXPECT_EQ(placeholders(row.remedy_en), placeholders(row.remedy_ru)) << row.number;
  }
}

TEST(AlarmTable, has_a_row_for_every_number_that_the_code_raises) {
  const std::string folder = tests::source_dir();
  int numbers = 0;
  for (const char* file : {"/kernel/axis/alarms/axis_alarms.hpp", "/kernel/channel/alarms/master_alarms.hpp",
                           "/firmware_if/image/alarm_numbers.hpp"}) {
    std::ifstream in(folder + file);
    ASSERT_TRUE(in) << file;
    for (std::string line; std::getline(in, line);) {
      const std::size_t equals = line.find(" = ");
      if (line.find("constexpr AlarmNumber") == std::string::npos || equals == std::string::npos) continue;
      ++numbers;
      const auto number = static_cast<image::AlarmNumber>(std::stoi(line.substr(equals + 3)));
      EXPECT_NE(alarm_table().find(number), nullptr) << line;
    }
  }
  EXPECT_EQ(numbers, std::ssize(alarm_table().rows()));
}

TEST(AlarmTable, is_the_source_of_the_manual_page) {
  std::ifstream in(tests::source_dir() + "/docs/alarms.md", std::ios::binary);
  std::stringstream page;
  page << in.rdbuf();
  if (page.str() == alarms_page(alarm_table())) return;
  const std::string made = tests::binary_dir() + "/alarms.md";
  std::ofstream(made, std::ios::binary) << alarms_page(alarm_table());
  FAIL() << "docs/alarms.md differs from the table; the page as it should be: " << made;
}

TEST(AlarmText, names_axis_value_limit_and_unit_in_both_languages) {
  image::AlarmRecord r;
  r.number = axis::alarm::kFollowingError;
  r.axis = 1;
  r.value = 1.2399;
  r.limit = 1.0;
  r.detail1 = 103.25;
  r.detail2 = 710.0;
  AlarmNames names = alarm_names();
  names.axes = {"X", "Y"};
  EXPECT_EQ(render(r, names, text::Language::english),
            "Y: following error 1.2399 mm, allowed 1 mm, at 103.25 mm/s and 710 ‰ of the rated torque");
  EXPECT_EQ(render(r, names, text::Language::russian),
            "Y: ошибка слежения 1.2399 мм, допустимо 1 мм, при скорости 103.25 мм/с и моменте 710 ‰ от "
            "номинального");
  names.units = {"mm", "°"};
  EXPECT_EQ(render(r, names, text::Language::english),
            "Y: following error 1.2399 °, allowed 1 °, at 103.25 °/s and 710 ‰ of the rated torque");
}

TEST(AlarmText, says_of_a_following_error_when_the_torque_is_not_known) {
  image::AlarmRecord r;
  r.number = axis::alarm::kFollowingError;
  r.axis = 0;
  r.value = -1.5;
  r.limit = 1.0;
  r.detail2 = std::numeric_limits<double>::quiet_NaN();
  AlarmNames names = alarm_names();
  names.axes = {"X"};
  EXPECT_EQ(
      render(r, names, text::Language::english),
      "X: following error -1.5 mm, allowed 1 mm, at 0 mm/s and a torque that the drive does not report");
  EXPECT_EQ(render(r, names, text::Language::russian),
            "X: ошибка слежения -1.5 мм, допустимо 1 мм, при скорости 0 мм/с и моменте, о котором привод не "
            "сообщает");
}

TEST(AlarmText, holds_what_the_interpreter_found_with_file_line_and_column) {
  const gateway::AlarmRooms rooms({},
                                  {{},
                                   [](int process, int number, text::Language language) -> std::string {
                                     if (process != 0 || number != 17) return {};
                                     return language == text::Language::russian ? "p.nc:3:9: error: нет [P1]"
                                                                                : "p.nc:3:9: error: no [P1]";
                                   }},
                                  {});
  image::AlarmRecord r;
  r.number = alarm::kProgramError;
  r.process = 0;
  r.line = 3;
  r.value = 17;
  EXPECT_EQ(render(r, alarm_names(), text::Language::english), "program error in line 3");
  AlarmNames names;
  names.table = &rooms.table();
  EXPECT_EQ(render(r, names, text::Language::english), "program error in line 3: p.nc:3:9: error: no [P1]");
  EXPECT_EQ(render(r, names, text::Language::russian),
            "ошибка программы, строка 3: p.nc:3:9: error: нет [P1]");
  r.value = 18;
  EXPECT_EQ(render(r, names, text::Language::english), "program error in line 3") << "not kept any more";
}

TEST(AlarmText, names_file_and_line_of_the_block_that_stands_still) {
  image::AlarmRecord r;
  r.number = alarm::kUnknownM;
  r.process = 0;
  r.line = 12;
  r.value = 77;
  EXPECT_EQ(render(r, alarm_names(), text::Language::english), "line 12: the PLC does not know M77");
  EXPECT_EQ(render(r, alarm_names(), text::Language::russian), "строка 12: ПЛК не знает функцию M77");
  const gateway::AlarmRooms rooms({},
                                  {[](int, std::uint32_t run, int file) {
                                     return run == 4 && file == 1 ? std::string("parts/sub.nc")
                                                                  : std::string();
                                   },
                                   {}},
                                  {});
  AlarmNames names;
  names.table = &rooms.table();
  r.run = 4;
  r.file = 1;
  EXPECT_EQ(render(r, names, text::Language::english), "parts/sub.nc:12: the PLC does not know M77");
}

TEST(AlarmText, decodes_status_word_and_error_code) {
  image::AlarmRecord r;
  r.number = axis::alarm::kDriveFault;
  r.axis = 0;
  r.detail.put(image::DriveReport{0x0218, 0x8611, 0, 0});
  AlarmNames names = alarm_names();
  names.axes = {"X"};
  EXPECT_EQ(render(r, names, text::Language::english),
            "X: drive fault, error 0x8611, status word 0x0218 fault");
  names.error_text = [](const image::AlarmRecord&, std::uint16_t code, text::Language) {
    return code == 0x8611 ? std::string("following error") : std::string();
  };
  EXPECT_EQ(render(r, names, text::Language::english),
            "X: drive fault, error 0x8611 (following error), status word 0x0218 fault");
  r.number = axis::alarm::kDriveRefuses;
  r.value = static_cast<double>(image::DriveState::ready_to_switch_on);
  r.limit = static_cast<double>(image::DriveState::switched_on);
  r.detail1 = 500;
  r.detail.put(image::DriveReport{0x0221, 0, 0, 0});
  EXPECT_EQ(render(r, names, text::Language::english),
            "X: the drive does not go from ready to switch on to switched on (waited 500 ms), status word "
            "0x0221 ready to switch on, no main voltage");
  r.value = static_cast<double>(image::DriveState::switched_on);
  r.limit = static_cast<double>(image::DriveState::operation_enabled);
  r.detail.put(image::DriveReport{0x0233, 0, 0, 0});
  r.detail2 = 1.0;
  EXPECT_EQ(
      render(r, names, text::Language::english),
      "X: the drive does not go from switched on to operation enabled (waited 500 ms), status word 0x0233 "
      "switched on; its 6061h does not show the mode that it was given, and before that it is not enabled: "
      "compare 6060h, 6061h and 6502h (`servogate od`)");
}

TEST(AlarmText, names_node_axis_and_bus_of_what_is_lost) {
  image::AlarmRecord r;
  r.number = alarm::kNodeLost;
  r.axis = 1;
  r.part = {0, 2};
  r.value = 301;
  r.limit = 300;
  AlarmNames names = alarm_names();
  names.axes = {"X", "Y"};
  names.devices = {"can"};
  names.part_name = [](const image::PartPlace& place) {
    return place == image::PartPlace{0, 2} ? std::string("can.y") : std::string();
  };
  EXPECT_EQ(render(r, names, text::Language::english),
            "node 2 (can.y, axis Y): no heartbeat for 301 ms, allowed 300 ms");
  EXPECT_EQ(render(r, names, text::Language::russian),
            "узел 2 (can.y, ось Y): нет контрольного сообщения 301 мс, допустимо 300 мс");
  r.axis = -1;
  r.part.part = 7;
  EXPECT_EQ(render(r, names, text::Language::english), "node 7: no heartbeat for 301 ms, allowed 300 ms");
  r.number = alarm::kBusSendOverflow;
  r.value = 3;
  EXPECT_EQ(render(r, names, text::Language::english), "bus can: 3 frames could not be sent");
}

TEST(AlarmText, of_a_foreign_frame_says_what_it_means) {
  image::AlarmRecord r;
  r.number = alarm::kForeignFrame;
  r.part.device = 0;
  image::FrameDetail frame;
  frame.id = 0x205;
  frame.length = 2;
  r.detail.put(frame);
  AlarmNames names = alarm_names();
  names.devices = {"can"};
  const std::string said = render(r, names, text::Language::english);
  EXPECT_TRUE(said.starts_with("bus can: another master sends ")) << said;
  EXPECT_NE(said.find("node 5"), std::string::npos) << said;
  EXPECT_TRUE(render(r, names, text::Language::russian).starts_with("шина can: другой ведущий передаёт "));
  r.number = alarm::kLeadLost;
  r.limit = 3.5;
  EXPECT_TRUE(render(r, names, text::Language::english)
                  .starts_with("bus can: this control stood still for 3.5 s, and another one leads the bus "
                               "now: it sends "));
}

TEST(AlarmTable, of_another_master_stops_the_machine_and_takes_the_power) {
  for (const image::AlarmNumber number : {alarm::kForeignFrame, alarm::kLeadLost})
    EXPECT_EQ(alarm_table().find(number)->reaction, image::Reaction::stop_and_power_off) << number;
  EXPECT_EQ(alarm_table().find(alarm::kForeignRequest)->reaction, image::Reaction::warn);
}

TEST(AlarmText, knows_every_state_of_the_status_word) {
  const std::pair<std::uint16_t, const char*> kStates[] = {
      {0x0000, "not ready to switch on"}, {0x0040, "switch on disabled"},
      {0x0031, "ready to switch on"},     {0x0033, "switched on"},
      {0x0037, "operation enabled"},      {0x0017, "quick stop active"},
      {0x001F, "fault reaction active"},  {0x0018, "fault"}};
  for (const auto& [word, state] : kStates) {
    const std::string text = image::statusword_text(word, text::Language::english);
    EXPECT_EQ(text.substr(7), state) << text;
  }
  EXPECT_EQ(image::statusword_text(0x08B7, text::Language::english),
            "0x08B7 operation enabled, warning, internal limit");
}

TEST(AlarmText, leaves_no_placeholder_open_in_any_alarm) {
  for (const AlarmRow* row : alarm_table().rows())
    for (const auto language : {text::Language::english, text::Language::russian}) {
      image::AlarmRecord r;
      r.number = row->number;
      EXPECT_EQ(render(r, alarm_names(), language).find('{'), std::string::npos) << row->number;
      EXPECT_EQ(render_remedy(r, alarm_names(), language).find('{'), std::string::npos) << row->number;
      EXPECT_FALSE(render_remedy(r, alarm_names(), language).empty());
    }
}

TEST(AlarmText, gives_places_of_a_diameter_axis_as_diameters_and_lengths_as_they_are) {
  AlarmNames names = alarm_names();
  names.axes = {"X", "Z"};
  names.units = {"mm", "mm"};
  names.diameters = {true, false};
  image::AlarmRecord r;
  r.number = axis::alarm::kHomingInterrupted;
  r.axis = 0;
  r.value = 41.25;
  r.detail1 = static_cast<double>(image::JogEnd::feed);
  EXPECT_EQ(
      render(r, names, text::Language::english),
      "X: homing was broken off at 82.5 mm in diameter: the PLC withdrew X.feed_enable (in the examples: "
      "the door is open)");
  EXPECT_NE(render(r, names, text::Language::russian).find("82.5 mm по диаметру"), std::string::npos);
  r.axis = 1;
  r.detail1 = static_cast<double>(image::JogEnd::power);
  EXPECT_EQ(render(r, names, text::Language::english),
            "Z: homing was broken off at 41.25 mm: its drive was switched off");
  r.number = axis::alarm::kOffPath;
  r.axis = 0;
  r.value = 0.5;
  r.limit = 20.0;
  EXPECT_EQ(render(r, names, text::Language::english),
            "X: stopped 0.5 mm away from the end of the path at 40 mm in diameter");
}

}  // namespace
}  // namespace servogate::cycle
