// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/interpreter/restart.hpp"

#include <gtest/gtest.h>

namespace servogate::program {
namespace {

MachineModel mill() {
  MachineModel model;
  for (const char* letter : {"X", "Y", "Z"}) {
    MachineModel::Axis axis;
    axis.letter = letter;
    axis.travel_min = -500.0;
    axis.travel_max = 500.0;
    axis.rapid = 500.0;
    model.axes.push_back(axis);
  }
  model.spindles = 1;
  model.spindle_max_rpm = 6000.0;
  model.power_on = {"G94", "G97", "G90", "G71", "G27"};
  return model;
}

Interpreter fresh(const std::string& text, const Position& stands = {}) {
  return {"nc110", mill(), {}, "p.nc", text, {}, stands};
}

std::variant<RestartPoint, text::Finding> found(const std::string& text, const RestartAt& at,
                                                const Position& stands = {}) {
  return restart(fresh(text, stands), at, image::Packets{});
}

constexpr const char* kPocket =
    "N10 T1.1 M6\n"
    "N20 S2000 M3\n"
    "N30 M8\n"
    "N40 G0 X10 Y10 Z5\n"
    "N50 G1 Z-3 F200\n"
    "N60 X60 F600\n"
    "N70 Y40\n"
    "N80 M9\n"
    "N90 M30\n";

/// The commands that a program gives from the point on, as JSON.
std::vector<std::string> rest_of(Interpreter program) {
  std::vector<std::string> out;
  for (int n = 0; n < 1000; ++n) {
    const Step step = program.next(image::Packets{}, true);
    const auto* command = std::get_if<Command>(&step);
    if (command == nullptr) {
      if (std::holds_alternative<Error>(step)) break;
      continue;
    }
    out.push_back(to_json(*command, {"X", "Y", "Z"}, program.files()));
    if (std::holds_alternative<End>(command->what)) break;
  }
  return out;
}

TEST(Restart, finds_what_is_in_force_before_a_block) {
  for (const RestartAt& at : {RestartAt{RestartAt::By::number, 70}, RestartAt{RestartAt::By::line, 7},
                              RestartAt{RestartAt::By::executed, 7}}) {
    const auto result = found(kPocket, at);
    ASSERT_TRUE(std::holds_alternative<RestartPoint>(result))
        << std::get<text::Finding>(result).str(text::Language::english);
    const auto& point = std::get<RestartPoint>(result);
    EXPECT_EQ(point.line, 7);
    EXPECT_EQ(point.executed, 6);
    EXPECT_EQ(point.position, (Position{60.0, 10.0, -3.0}));
    ASSERT_TRUE(point.spindle.has_value());
    EXPECT_EQ(point.spindle->mode, SpindleMode::cw);
    EXPECT_EQ(point.spindle->speed, 2000.0);
    ASSERT_TRUE(point.coolant.has_value());
    EXPECT_EQ(point.coolant->code, 8);
    EXPECT_EQ(point.tool, 1);
    EXPECT_EQ(point.depth_axis, 2);
    ASSERT_EQ(point.passed.size(), 1u);
    EXPECT_EQ(point.passed[0].code, 6);
  }
}

TEST(Restart, goes_on_with_the_very_commands_of_the_whole_program) {
  const std::string loops =
      "N10 G0 X0 Y0 Z0\nN20 (RPT,3)\nN30 G91 G1 X5 F500\nN40 Y2\nN50 G90\nN60 (ERP)\nN70 G1 X0 Y0\nN80 M30\n";
  for (const std::string& text : {std::string(kPocket), loops}) {
    const std::vector<std::string> whole = rest_of(fresh(text));
    for (int executed = 1; executed < 20; ++executed) {
      const auto result = found(text, {RestartAt::By::executed, executed});
      if (!std::holds_alternative<RestartPoint>(result)) break;
      const std::vector<std::string> rest = rest_of(std::get<RestartPoint>(result).interpreter);
      ASSERT_LE(rest.size(), whole.size());
      EXPECT_EQ(rest,
                std::vector<std::string>(whole.end() - static_cast<std::ptrdiff_t>(rest.size()), whole.end()))
          << executed;
    }
  }
}

TEST(Restart, takes_up_spindle_coolant_plane_and_then_depth) {
  const auto result = found(kPocket, {RestartAt::By::number, 70});
  const auto& point = std::get<RestartPoint>(result);
  const Position stands{0.0, 0.0, 50.0};
  const std::vector<Command> way = approach(point, stands, 300.0, false);
  ASSERT_EQ(way.size(), 5u);
  EXPECT_TRUE(std::holds_alternative<Spindle>(way[0].what));
  EXPECT_EQ(std::get<MFunction>(way[1].what).code, 3) << "the PLC is told";
  EXPECT_EQ(std::get<MFunction>(way[2].what).code, 8);
  const auto& plane = std::get<Line>(way[3].what);
  EXPECT_EQ(plane.to, (Position{60.0, 10.0, 50.0})) << "the depth stays where it is";
  EXPECT_EQ(plane.feed.value, 300.0);
  EXPECT_EQ(plane.corner.transition, Transition::exact_stop);
  EXPECT_EQ(std::get<Line>(way[4].what).to, point.position);
  EXPECT_EQ(approach(point, stands, 300.0, true).size(), 8u) << "each step waits for the operator";
  EXPECT_EQ(approach(point, point.position, 300.0, false).size(), 3u) << "no motion where it stands already";
}

TEST(Restart, brings_the_windows_back_that_the_program_has_set) {
  const auto result =
      found("N10 G29\nN20 (DTL,X0.05,Y0.1)\nN30 (DTL,X0)\nN40 G0 X5\nN50 G1 X9 F100\nN60 M30\n",
            {RestartAt::By::number, 50});
  const auto& point = std::get<RestartPoint>(result);
  const std::vector<Command> way = approach(point, point.position, 300.0, true);
  ASSERT_EQ(way.size(), 1u) << "nothing to be confirmed, nothing moves";
  const auto& windows = std::get<InPosition>(way[0].what);
  EXPECT_EQ(windows.axes, 0b11u);
  EXPECT_EQ(windows.window[0], 0.0);
  EXPECT_EQ(windows.window[1], 0.1);
}

TEST(Restart, gives_the_way_first_and_then_the_program) {
  auto result = found(kPocket, {RestartAt::By::number, 70});
  auto& point = std::get<RestartPoint>(result);
  point.interpreter.begin_with(approach(point, Position{0.0, 0.0, 50.0}, 300.0, false));
  const std::vector<std::string> all = rest_of(point.interpreter);
  ASSERT_GE(all.size(), 6u);
  EXPECT_NE(all[0].find("\"spindle\""), std::string::npos) << all[0];
  EXPECT_NE(all[5].find("\"Y\":40"), std::string::npos) << all[5];
}

TEST(Restart, is_refused_where_it_cannot_be_told) {
  const struct {
    const char *text, *said;
    RestartAt at;
  } rows[] = {{"N10 G0 X1\nN20 M30\n", "the program has no block N50", {RestartAt::By::number, 50}},
              {"N10 (SND,2)\nN20 G0 X1\nN30 M30\n",
               "starts or waits for other processes",
               {RestartAt::By::number, 30}},
              {"N10 G0 X1\nN20 M30\n", "the program has no block line 9", {RestartAt::By::line, 9}},
              {"N10 G0 X1000\nN20 X5\nN30 M30\n", "travel", {RestartAt::By::number, 20}}};
  for (const auto& row : rows) {
    const auto result = found(row.text, row.at);
    ASSERT_TRUE(std::holds_alternative<text::Finding>(result)) << row.text;
    const std::string words = std::get<text::Finding>(result).str(text::Language::english);
    EXPECT_NE(words.find(row.said), std::string::npos) << words;
  }
}

TEST(Restart, takes_signals_of_the_machine_as_they_are_now) {
  const std::string text = "N10 (BEQ,SA0,1,A)\nN20 G0 X1\n\"A\"N30 Y5\nN40 M30\n";
  const RestartAt at{RestartAt::By::number, 30};
  image::Packets packets;
  const auto without = std::get<RestartPoint>(restart(fresh(text), at, packets));
  EXPECT_EQ(without.position[0], 1.0);
  EXPECT_TRUE(without.signals) << "it is said that the result depends on them";
  packets.set_bit({image::Packet::a, image::Format::bl, 0, 1}, true);
  EXPECT_EQ(std::get<RestartPoint>(restart(fresh(text), at, packets)).position[0], 0.0);
  EXPECT_FALSE(std::get<RestartPoint>(found(kPocket, {RestartAt::By::number, 70})).signals);
}

TEST(Restart, goes_by_the_switches_of_the_operator) {
  const std::string text = "N10 G0 X1\n/N20 X2\nN30 Y1\nN40 M30\n";
  RestartAt at{RestartAt::By::number, 30};
  EXPECT_EQ(std::get<RestartPoint>(found(text, at)).position[0], 2.0);
  at.switches.skip_levels = 1;
  EXPECT_EQ(std::get<RestartPoint>(found(text, at)).position[0], 1.0) << "the skipped block is skipped";
}

}  // namespace
}  // namespace servogate::program
