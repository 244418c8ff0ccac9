// SPDX-License-Identifier: Apache-2.0
// The example lathe end to end: turret through the PLC, constant cutting speed, diameters outside and radii
// inside.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

/// A trace by column name.
struct Trace {
  explicit Trace(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::stringstream head(line);
    for (std::string name; std::getline(head, name, ',');) columns.push_back(name);
    for (std::size_t i = 0; i < columns.size(); ++i) index[columns[i]] = i;
    while (std::getline(in, line)) {
      std::vector<double> row;
      for (const char* at = line.c_str(); *at != '\0';) {
        char* end = nullptr;
        row.push_back(std::strtod(at, &end));
        at = *end == ',' ? end + 1 : end;
      }
      rows.push_back(std::move(row));
    }
  }
  double at(std::size_t row, const std::string& column) const { return rows[row][index.at(column)]; }
  std::vector<std::string> columns;
  std::map<std::string, std::size_t> index;
  std::vector<std::vector<double>> rows;
};

constexpr double kFace = 23.0;  // the line of bush.nc that faces at G96 S150 and G95 F0.2

TEST(Lathe, cuts_threads_whose_lead_and_deviation_stand_in_the_report) {
  for (const bool by_setpoint : {false, true}) {
    Shell shell;
    const auto file = [&](const char* name) { return (shell.folder() / name).string(); };
    std::filesystem::copy(std::filesystem::path(Shell::example("lathe/machine.toml")).parent_path(),
                          shell.folder() / "lathe", std::filesystem::copy_options::recursive);
    if (by_setpoint) {
      std::string machine = shell.text("lathe/machine.toml");
      const std::string spindle = "[[spindle]]\n";
      machine.insert(machine.find(spindle) + spindle.size(), "thread_master = \"setpoint\"\n");
      std::ofstream(file("lathe/machine.toml")) << machine;
    }
    const Outcome o = shell.run({"run", file("lathe/machine.toml"), file("lathe/thread.nc"), "--virtual",
                                 "--report", file("r.json")});
    ASSERT_EQ(o.exit, 0) << o.err;
    const json threads = json::parse(shell.text("r.json"))["threads"];
    ASSERT_EQ(threads.size(), 6u) << "four passes, and a thread of two starts";
    for (std::size_t n = 0; n < threads.size(); ++n) {
      const json& thread = threads[n];
      EXPECT_EQ(thread["axis"], "Z");
      EXPECT_NEAR(thread["lead_mm"].get<double>(), n < 4 ? 1.5 : 3.0, 1e-4) << n;
      EXPECT_NEAR(thread["speed_rpm"][0].get<double>(), 600.0, 6.0);
      EXPECT_GT(thread["off_mm"]["least"].get<double>(), -0.01) << n;
      EXPECT_LT(thread["off_mm"]["greatest"].get<double>(), 0.01) << n;
    }
  }
}

TEST(Lathe, turns_a_bush_with_three_tools_at_constant_cutting_speed) {
  Shell shell;
  const auto file = [&](const char* name) { return (shell.folder() / name).string(); };
  const Outcome o =
      shell.run({"run", Shell::example("lathe/machine.toml"), Shell::example("lathe/bush.nc"), "--virtual",
                 "--trace", file("t.csv"), "--report", file("r.json"), "--html", file("r.html")});
  ASSERT_EQ(o.exit, 0) << o.err;
  const json report = json::parse(shell.text("r.json"));
  EXPECT_TRUE(report["finished"].get<bool>());
  EXPECT_TRUE(report["alarms"].empty());
  const Trace trace(file("t.csv"));
  const std::vector<std::string> head(trace.columns.begin(), trace.columns.begin() + 10);
  EXPECT_EQ(head, (std::vector<std::string>{"t", "feed", "line", "X.cmd", "X.act", "Z.cmd", "Z.act",
                                            "spindle.cmd", "spindle.act", "spindle.angle"}));
  // A line once begun stays until the next one begins.
  bool begun = false;
  for (std::size_t r = 0; r < trace.rows.size(); ++r) {
    const double line = trace.at(r, "line");
    ASSERT_FALSE(begun && line == 0.0) << r;
    begun = begun || line > 0.0;
  }
  std::string stations;
  double smallest = 1e9;
  int faced = 0;
  for (std::size_t r = 0; r < trace.rows.size(); ++r) {
    for (int station = 1; station <= 3; ++station)
      if (trace.at(r, "turret_pos_" + std::to_string(station)) == 1.0) {
        const char digit = static_cast<char>('0' + station);
        if (stations.empty() || stations.back() != digit) stations += digit;
      }
    smallest = std::min(smallest, r > 5000 ? trace.at(r, "X.cmd") : 1e9);
    const double radius = trace.at(r, "X.cmd"), rpm = trace.at(r, "spindle.cmd");
    if (trace.at(r, "line") != kFace || radius > 23.5 || radius < 7.5) continue;
    ++faced;
    EXPECT_NEAR(trace.at(r, "feed") * 60.0 / rpm, 0.2, 0.002) << radius;
    // Further in the speed rises faster than the spindle can be accelerated, and the feed with it.
    if (radius > 12.0) {
      EXPECT_NEAR(rpm, 150'000.0 / (2.0 * M_PI * radius), 0.01 * rpm) << radius;
    }
  }
  EXPECT_EQ(stations, "1231");
  EXPECT_GT(faced, 2000);
  // X14 is the smallest diameter: 7 mm in the trace.
  EXPECT_NEAR(smallest, 7.0, 0.01);
  EXPECT_NE(shell.text("r.html").find("</html>"), std::string::npos);
}

TEST(Lathe, says_that_X_is_a_diameter_when_it_is_jogged_shown_and_zeroed) {
  Shell shell;
  shell.up("lathe");
  shell.ready();
  const Outcome jog = shell.run({"jog", "X", "-10mm"});
  EXPECT_NE(jog.err.find("-10 mm in diameter (the slide by -5 mm)"), std::string::npos) << jog.err;
  EXPECT_NE(jog.out.find("mm in diameter"), std::string::npos) << jog.out;
  EXPECT_NEAR(shell.status()["axes"][0]["command"].get<double>(), 210.0, 1e-6);
  EXPECT_NE(shell.run({"status"}).out.find("mm (diameter)"), std::string::npos);
  const Outcome zero = shell.run({"zero", "X", "50"});
  EXPECT_NE(zero.out.find("X is 50 mm in diameter here (origin 0 at radius 80)"), std::string::npos)
      << zero.out;
  ASSERT_EQ(shell.run({"mdi", "G0 X40", "--wait"}).exit, 0);
  EXPECT_NEAR(shell.status()["axes"][0]["command"].get<double>(), 200.0, 1e-6);
  ASSERT_EQ(shell.run({"mdi", "T3.3 M6", "--wait"}).exit, 0);
  EXPECT_EQ(shell.status()["tool"], 3);
}

TEST(Lathe, says_places_of_X_as_diameters_wherever_they_are_the_reason) {
  Shell shell;
  shell.up("lathe", {"--virtual"});
  ASSERT_EQ(shell.run({"power", "on"}).exit, 0);
  const auto refused = [&](const std::vector<std::string>& words, const char* said, const char* language) {
    const std::string err = shell.run(words, language).err;
    EXPECT_NE(err.find(said), std::string::npos) << err;
  };
  refused({"jog", "X", "-500"},
          "X cannot jog by -500 mm in diameter: from -244 to 244 mm in diameter is possible", "C");
  refused({"jog", "X", "-500"}, "X не может переместиться на -500 мм по диаметру: возможно от -244 до 244 мм",
          "ru_RU.UTF-8");
  refused({"zero", "X", "1e6"}, "X cannot be given the value 1000000 mm in diameter", "C");
  refused({"jog", "Z", "-5000"}, "Z cannot jog by -5000 mm: from", "C");
  ASSERT_EQ(shell.run({"home", "X"}).exit, 0);
  ASSERT_TRUE(shell.until([](const json& s) { return s["axes"][0]["moving"].get<bool>(); }));
  ASSERT_EQ(shell.run({"input", "estop_chain_ok", "off"}).exit, 0);
  json alarm;
  ASSERT_TRUE(shell.until([&](const json& s) {
    alarm = alarm_of(s, 1107);
    return !alarm.is_null();
  }));
  EXPECT_NE(alarm["text"].get<std::string>().find(" mm in diameter"), std::string::npos) << alarm;
  EXPECT_NE(shell.run({"alarms"}, "ru_RU.UTF-8").out.find(" мм по диаметру"), std::string::npos);

  const std::string path = (shell.folder() / "far.nc").string();
  std::ofstream(path) << "G90 G0 X250\nM30\n";
  const std::string said = "X (diameter) would go to 250, the travel ends at 240 [P701]";
  EXPECT_NE(shell.run({"load", path}).err.find(said), std::string::npos);
  EXPECT_NE(shell.run({"mdi", "G90 G0 X250"}).err.find(said), std::string::npos);
  EXPECT_NE(shell.run({"mdi", "G90 G0 X250"}, "ru_RU.UTF-8").err.find("X (диаметр) вышла бы на 250"),
            std::string::npos);
  const Outcome checked =
      shell.run({"check", Shell::example("lathe/machine.toml"), Shell::example("lathe/bush.nc")});
  EXPECT_NE(checked.out.find("X (diameter): "), std::string::npos) << checked.out;
  EXPECT_NE(checked.out.find(" of -4 to 240 mm"), std::string::npos) << checked.out;
}

TEST(Lathe, keeps_a_cutting_speed_that_was_typed_over_the_next_blocks_and_jogs) {
  Shell shell;
  shell.up("lathe", {"--virtual", "--speed", "20"});
  shell.ready();
  const auto rpm_at = [&](double diameter) {
    EXPECT_TRUE(shell.until(
        [&](const json& s) { return std::abs(s["axes"][0]["command"].get<double>() - diameter) < 1e-6; }));
    EXPECT_TRUE(shell.until([](const json& s) { return s["spindles"][0]["at_speed"].get<bool>(); }));
    return shell.status()["spindles"][0]["command_rpm"].get<double>();
  };
  const auto expected = [](double diameter) { return 100.0 * 1000.0 / (3.14159265358979 * diameter); };
  ASSERT_EQ(shell.run({"mdi", "G0 X100", "--wait"}).exit, 0);
  const Outcome typed = shell.run({"mdi", "G96 S100 M3", "--wait"});
  ASSERT_EQ(typed.exit, 0) << typed.err;
  EXPECT_NEAR(rpm_at(100.0), expected(100.0), 0.5);
  ASSERT_EQ(shell.run({"mdi", "G0 X200", "--wait"}).exit, 0);
  EXPECT_NEAR(rpm_at(200.0), expected(200.0), 0.5) << "a larger diameter, a slower spindle";
  ASSERT_EQ(shell.run({"jog", "X", "-40mm"}).exit, 0);
  EXPECT_NEAR(rpm_at(160.0), expected(160.0), 0.5);
  ASSERT_EQ(shell.run({"mdi", "M5", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"mdi", "G0 X100", "--wait"}).exit, 0);
  EXPECT_EQ(shell.status()["spindles"][0]["command_rpm"], 0.0) << "nothing turns by itself";
  ASSERT_EQ(shell.run({"mdi", "M3", "--wait"}).exit, 0);
  EXPECT_NEAR(rpm_at(100.0), expected(100.0), 0.5) << "the cutting speed holds over M5";
  ASSERT_EQ(shell.run({"mdi", "G97", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"mdi", "G0 X200", "--wait"}).exit, 0);
  EXPECT_NEAR(rpm_at(200.0), expected(100.0), 0.5) << "G97 alone keeps the speed of that moment";
  EXPECT_TRUE(contains(shell.run({"mdi", "G96 M3", "--wait"}).err, "[P821]"));
  EXPECT_NEAR(rpm_at(200.0), expected(100.0), 0.5);
  ASSERT_EQ(shell.run({"mdi", "G97 S300", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"mdi", "G0 X200", "--wait"}).exit, 0);
  ASSERT_EQ(shell.run({"mdi", "G0 X100", "--wait"}).exit, 0);
  EXPECT_NEAR(rpm_at(100.0), 300.0, 0.5);
  ASSERT_EQ(shell.run({"mdi", "S0", "--wait"}).exit, 0);
  EXPECT_EQ(rpm_at(100.0), 0.0);
  ASSERT_EQ(shell.run({"mdi", "S0 M3", "--wait"}).exit, 0);
  EXPECT_EQ(rpm_at(100.0), 0.0) << "never the speed before";
}

}  // namespace
}  // namespace servogate::gateway::testing
