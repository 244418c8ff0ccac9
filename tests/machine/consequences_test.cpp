// SPDX-License-Identifier: Apache-2.0
#include "machine/consequences.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

LoadResult mill(const std::string& from = {}, const std::string& to = {}) {
  std::string text = test::example("mill");
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  return parse(text, test::source("examples/mill/machine.toml"));
}

std::vector<std::string> said(const LoadResult& loaded, text::Language language = text::Language::english) {
  std::vector<std::string> out;
  for (const Consequence& c : consequences(loaded)) out.push_back(c.str(language));
  return out;
}

bool has(const std::vector<std::string>& lines, const std::string& line) {
  return std::find(lines.begin(), lines.end(), line) != lines.end();
}

TEST(Consequences, say_what_a_millimetre_is) {
  EXPECT_TRUE(has(said(mill()), "X: 1 mm = 26214.4 counts; 500 mm/s = 3000 rpm"));
  EXPECT_TRUE(
      has(said(mill(), text::Language::russian), "X: 1 мм = 26214.4 дискрет; 500 мм/с = 3000 об/мин"));
}

TEST(Consequences, say_how_far_a_home_switch_on_modbus_is_off) {
  std::string text = test::example("mill");
  const std::string home = "{ name = \"x_home\", channel = \"di6\", place = \"SA6\" },";
  text.erase(text.find(home), home.size());
  const std::string door = "  { name = \"door_closed\"";
  text.insert(text.find(door), "  { name = \"x_home\", channel = \"di6\", place = \"SA6\" },\n");
  const LoadResult loaded = parse(text, test::source("examples/mill/machine.toml"));
  ASSERT_TRUE(loaded.ok()) << test::lines_of(loaded.findings, text::Language::english);
  EXPECT_TRUE(has(said(loaded),
                  "home X: the switch is read over Modbus every 20 ms, ±1.0 mm at 50 mm/s; the index pulse "
                  "then gives the exact zero"));
}

TEST(Consequences, without_an_index_the_slow_edge_counts) {
  const LoadResult loaded = mill("method = \"switch_and_index\"", "method = \"switch\"");
  EXPECT_TRUE(has(said(loaded), "home X: the switch is read over GPIO every 1 ms, ±0.005 mm at 5 mm/s"));
}

/// 250 ms of rising and falling jerk-limited deceleration by hand: v / a + a / j = 0.5 + 0.1 s, way v * t
/// / 2.
TEST(Consequences, say_the_stopping_distance) {
  EXPECT_TRUE(has(said(mill()), "X: stops from 500 mm/s within 150 mm, in 0.6 s"));
}

/// The stop of 0.6 s, 0.1 s to take a full acceleration back, 0.1 s for Z's brake and ten cycles until it is
/// told, three cycles; rounded up. The spindle stops in 2 s, and its command may wait for nine cycles.
TEST(Consequences, say_how_long_the_safety_relay_has_to_wait) {
  const auto told = [](const char* seconds) {
    return "emergency stop: all axes are at rest with their brakes closed after " + std::string(seconds) +
           " s, the spindle after 2.01 s; the safety relay's delay t_d must be longer";
  };
  EXPECT_TRUE(has(said(mill()), told("0.82")));
  LoadResult slow_brake = mill();
  for (AxisConfig& a : slow_brake.machine.axes)
    if (a.brake.present()) a.brake.engage_delay = 0.4;
  EXPECT_TRUE(has(said(slow_brake), told("1.12")));
}

TEST(Consequences, a_brake_is_told_as_late_as_its_process_data_or_its_station_go) {
  LoadResult loaded = mill();
  AxisConfig& z = loaded.machine.axes.at(2);
  EXPECT_NEAR(brake_command_time(loaded, z), 0.010, 1e-12) << "its drive takes outputs with every tenth SYNC";
  EXPECT_TRUE(has(said(loaded), "Z: power is switched off 110 ms after the brake is told to close"));
  loaded.machine.control.cycle_time = 0.015;
  EXPECT_NEAR(brake_command_time(loaded, z), 0.150, 1e-12);
  loaded.machine.control.cycle_time = 0.001;
  z.brake.drive_output = false;
  const auto by = [&](StationKind kind) {
    for (const StationConfig& s : loaded.machine.stations)
      for (const PointConfig& p : s.points)
        if (s.kind == kind && !p.is_input()) z.brake.point = p.name;
    return brake_command_time(loaded, z);
  };
  EXPECT_NEAR(by(StationKind::gpio), 0.001, 1e-12);
  EXPECT_NEAR(by(StationKind::modbus), 0.021, 1e-12) << "the poll of its line, and a cycle";
  EXPECT_EQ(brake_command_time(loaded, loaded.machine.axes.at(0)), 0.0) << "X has no brake";
}

TEST(Consequences, count_how_long_a_spindle_waits_for_its_command) {
  LoadResult loaded = mill();
  const std::string name = loaded.machine.node(loaded.machine.spindles[0].drive)->device;
  for (PdoConfig& pdo : loaded.devices.at(name).rpdos) pdo.transmission = 200;
  bool told = false;
  for (const Consequence& c : consequences(loaded))
    if (c.figures.contains("spindle_stop_time")) {
      told = true;
      EXPECT_NEAR(c.figures.at("spindle_stop_time"), 2.2, 1e-9) << "2 s, and 199 cycles rounded up";
    }
  EXPECT_TRUE(told);
}

TEST(Consequences, stopping_distance_agrees_with_an_integration_of_the_jerk_profile) {
  for (const auto& [v, a, j] :
       std::vector<std::array<double, 3>>{{500, 1000, 10000}, {20, 1000, 10000}, {100, 2000, 5000}}) {
    LoadResult loaded = mill();
    loaded.machine.axes[0].max_velocity = v;
    loaded.machine.axes[0].max_acceleration = a;
    loaded.machine.axes[0].max_jerk = j;
    double figure = 0.0;
    for (const Consequence& c : consequences(loaded))
      if (c.subject == "X" && c.figures.contains("stop_distance")) figure = c.figures.at("stop_distance");
    // Reference: jerk -j until -a or until the mirrored ramp ends at rest, integrated in small steps.
    const double peak = std::min(a, std::sqrt(v * j)), ramp = peak / j, hold = v / peak - ramp;
    const double dt = 1e-6;
    double speed = v, acceleration = 0.0, way = 0.0;
    for (double t = 0.0; t < 2 * ramp + hold; t += dt) {
      acceleration += (t < ramp ? -j : t < ramp + hold ? 0.0 : j) * dt;
      speed += acceleration * dt;
      way += speed * dt;
    }
    EXPECT_NEAR(figure, way, 1e-3 * way + 1e-3) << v;
  }
}

TEST(Consequences, bus_load_of_the_mill_is_below_eighty_per_cent) {
  const LoadResult loaded = mill();
  const canopen::SegmentLoad load = segment_load(loaded, loaded.machine.buses.at(0));
  EXPECT_LT(load.load, canopen::kLoadWarning);
  EXPECT_GT(load.load, 0.7);
}

TEST(Consequences, half_the_bit_rate_is_refused_with_what_would_fit) {
  const LoadResult loaded = mill("bit_rate = \"1 Mbit/s\"", "bit_rate = \"500 kbit/s\"");
  EXPECT_FALSE(loaded.ok());
  const std::string lines = test::lines_of(loaded.findings, text::Language::english);
  EXPECT_NE(lines.find("it fits with a cycle of 2 ms"), std::string::npos) << lines;
}

TEST(Consequences, the_room_for_a_stop_is_what_lies_between_switch_and_mechanical_end) {
  int sides = 0;
  for (const Consequence& c : consequences(mill())) {
    if (c.subject != "X" || !c.figures.contains("safe_velocity")) continue;
    ++sides;
    EXPECT_EQ(c.figures.at("room"), 6.0) << "311 mm less 305 mm, not 305 mm less the travel";
    // The switch is read in each cycle; three cycles pass until the stop begins. Below the speed at which the
    // acceleration limit is reached it is two ramps of jerk: v * sqrt(v / j).
    const auto way = [](double v) { return v * 0.003 + v * std::sqrt(v / 10000.0); };
    EXPECT_NEAR(way(c.figures.at("safe_velocity")), 6.0, 1e-6);
    EXPECT_EQ(c.figures.at("velocity"), 50.0) << "the search for the home switch is what is fastest";
    EXPECT_NEAR(c.figures.at("overrun"), way(50.0), 1e-9);
  }
  EXPECT_EQ(sides, 2);
}

TEST(Consequences, without_the_mechanical_end_no_stop_is_called_within_it) {
  const LoadResult loaded =
      mill("mechanical_end_minus = \"-311 mm\"\nmechanical_end_plus = \"311 mm\"\n", "");
  int said = 0;
  for (const Consequence& c : consequences(loaded)) {
    if (c.subject != "X") continue;
    EXPECT_FALSE(c.figures.contains("safe_velocity")) << c.str();
    said += std::string_view(c.entry->id) == "consequence.end_unknown" ? 1 : 0;
  }
  EXPECT_EQ(said, 1);
}

TEST(Consequences, of_the_control_s_death_are_said_for_each_axis_with_a_brake) {
  for (const Consequence& c : consequences(mill())) {
    if (std::string_view(c.entry->id) != "consequence.control_death") continue;
    EXPECT_EQ(c.subject, "Z");
    EXPECT_EQ(c.figures.at("notices"), 0.3);
    EXPECT_EQ(c.figures.at("falls_for"), 0.0);
    EXPECT_TRUE(c.str(text::Language::english).ends_with("; the axis does not fall")) << c.str();
    return;
  }
  FAIL() << "Z is hanging";
}

TEST(Consequences, json_carries_sentence_and_figures) {
  const LoadResult loaded = mill();
  const std::string json = to_json(loaded, consequences(loaded), text::Language::english);
  EXPECT_TRUE(json.starts_with(
      "{\"schema\":1,\"machine\":\"Three-axis mill\",\"consequences\":[{\"subject\":\"bus can\""));
  EXPECT_NE(
      json.find("\"id\":\"consequence.scale\",\"text\":\"X: 1 mm = 26214.4 counts; 500 mm/s = 3000 rpm\","
                "\"figures\":{\"counts_per_unit\":26214.4,\"max_velocity\":500,\"motor_rpm\":3000}"),
      std::string::npos);
}

TEST(Consequences, findings_as_json_escape_what_a_file_says) {
  const LoadResult loaded = parse("\"a\\\"\\u0001\" = 1\n", "m.toml");
  const std::string json = to_json(loaded.findings, text::Language::english);
  EXPECT_NE(json.find("{\"file\":\"m.toml\",\"line\":1,\"column\":1,\"severity\":\"error\",\"code\":"
                      "\"machine.unknown_key\""),
            std::string::npos)
      << json;
  EXPECT_NE(json.find("a\\\"\\u0001"), std::string::npos) << json;
  EXPECT_EQ(json.find('\x01'), std::string::npos);
}

TEST(Consequences, are_said_for_a_file_with_errors_too) {
  const LoadResult loaded = mill("contour_tolerance = \"0.01 mm\"", "contour_tolerance = 0");
  EXPECT_FALSE(loaded.ok());
  EXPECT_TRUE(has(said(loaded), "Y: 1 mm = 26214.4 counts; 500 mm/s = 3000 rpm"));
}

}  // namespace
}  // namespace servogate::machine
