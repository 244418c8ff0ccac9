// SPDX-License-Identifier: Apache-2.0
// A day in the shop through the command line: origins and tools are touched off, a program is held in the
// cut, the tool is retracted and changed, the program goes on, is stopped in the cut, and is finished. What
// the machine did is judged by the trace of its records, which a replay writes.
#include <gtest/gtest.h>
#include <signal.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using nlohmann::json;

struct Point {
  double x = 0.0, y = 0.0;
};
/// The groove of the program below, in its own coordinates, 2 mm deep.
constexpr Point kGroove[] = {{0, 0}, {60, 0}, {60, 30}, {0, 30}, {0, 0}};
constexpr double kDepth = -2.0, kTolerance = 0.01, kBin = 0.5;

struct Nearest {
  double off = 1e9, along = 0.0;
};
/// How far a point is off the groove, and how far along it.
Nearest nearest(const Point& p) {
  Nearest best;
  double before = 0.0;
  for (std::size_t n = 0; n + 1 < std::size(kGroove); ++n) {
    const Point a = kGroove[n], b = kGroove[n + 1];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double t =
        std::clamp(((p.x - a.x) * (b.x - a.x) + (p.y - a.y) * (b.y - a.y)) / (length * length), 0.0, 1.0);
    const double off = std::hypot(p.x - a.x - t * (b.x - a.x), p.y - a.y - t * (b.y - a.y));
    if (off < best.off) best = {off, before + t * length};
    before += length;
  }
  return best;
}

class ShopDay : public ::testing::TestWithParam<bool> {
 protected:
  void up() {
    const std::string number = std::to_string(++records_);
    shell_.up("mill", {"--virtual", "--speed", "20", "--state", (shell_.folder() / "state").string(),
                       "--record", (shell_.folder() / ("day" + number + ".rec")).string()});
    shell_.ready();
  }
  Outcome good(const std::vector<std::string>& words) {
    Outcome o = shell_.run(words);
    std::string all;
    for (const std::string& w : words) all += w + " ";
    EXPECT_EQ(o.exit, 0) << all << ": " << o.out << o.err;
    return o;
  }
  /// The cut is under way in this line, that far in X.
  /// The number behind the first of these words.
  static double number_behind(const std::string& text, const std::string& words) {
    const auto at = text.find(words);
    EXPECT_NE(at, std::string::npos) << words << " in " << text;
    return at == std::string::npos ? 0.0 : std::stod(text.substr(at + words.size()));
  }
  void cutting(int line, double x) {
    ASSERT_TRUE(shell_.until([&](const json& s) {
      return s["line"] == line && s["axes"][0]["work"] > x && s["axes"][2]["work"] < -1.9;
    }));
  }
  std::string program() {
    const std::string path = (shell_.folder() / "groove.nc").string();
    std::ofstream(path) << "N10 (UAO,1)\nN20 T1.1 M6\nN30 S1200 M3\nN40 G0 X0 Y0 Z5\nN50 G1 Z-2 F600\n"
                           "N60 X60 F1200\nN70 Y30\nN80 X0\nN90 Y0\nN100 G0 Z5\nN110 M30\n";
    return path;
  }
  /// The rows of a trace in which the tool is below the surface: none off the groove, none too deep.
  void judge(const std::string& record) {
    const std::string trace = record + ".csv";
    const Outcome o = shell_.run({"replay", record, "--trace", trace});
    ASSERT_TRUE(o.exit == 0 || !o.err.empty()) << o.out;
    std::ifstream in(trace);
    std::string header, line;
    std::getline(in, header);
    int x = -1, y = -1, z = -1, in_motion = -1, n = 0;
    std::stringstream names(header);
    for (std::string name; std::getline(names, name, ','); ++n) {
      if (name == "line") in_motion = n;
      if (name == "X.work") x = n;
      if (name == "Y.work") y = n;
      if (name == "Z.work") z = n;
    }
    ASSERT_GE(x, 0) << header;
    while (std::getline(in, line)) {
      std::vector<std::string> fields;
      std::stringstream row(line);
      for (std::string f; std::getline(row, f, ',');) fields.push_back(f);
      if (static_cast<int>(fields.size()) <= z || fields[static_cast<std::size_t>(z)] == "nan") continue;
      const int block = std::stoi(fields[static_cast<std::size_t>(in_motion)]);
      if (block < 5 || block > 10) continue;  // the coordinates of another block, or of none
      const double depth = std::stod(fields[static_cast<std::size_t>(z)]);
      if (depth > -1e-3) continue;
      const Nearest at = nearest(
          {std::stod(fields[static_cast<std::size_t>(x)]), std::stod(fields[static_cast<std::size_t>(y)])});
      worst_ = std::max(worst_, at.off);
      deepest_ = std::min(deepest_, depth);
      if (depth < kDepth + kTolerance) cut_[static_cast<std::size_t>(at.along / kBin)] = true;
    }
  }

  Shell shell_;
  int records_ = 0;
  double worst_ = 0.0, deepest_ = 0.0;
  std::array<bool, 361> cut_{};  ///< by kBin of the way along the groove
};

TEST_P(ShopDay, ends_with_the_whole_groove_cut_and_nothing_else) {
  const bool killed = GetParam();
  up();
  // Two origins and three tools.
  good({"jog", "X", "+20mm"});
  good({"jog", "Y", "+10mm"});
  good({"origin", "here", "1", "X0", "Y0"});
  good({"origin", "set", "1", "Z-60"});
  good({"jog", "X", "+100mm"});
  good({"origin", "here", "2", "X0", "Y0"});
  good({"tool", "set", "1", "length=30", "radius=4"});
  good({"tool", "set", "2", "length=45.5", "radius=3"});
  good({"jog", "Z", "-20mm"});
  good({"tool", "here", "3", "Z5"});
  good({"load", program()});
  // So slow that a computer with other work has seconds to see each cut.
  good({"override", "2"});
  good({"start"});
  // Held in the cut: retract, spindle off, tool changed, and back.
  cutting(6, 15.0);
  good({"hold"});
  ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "held"; }));
  const json held = shell_.status();
  good({"jog", "Z", "+20mm"});
  good({"jog", "X", "-30mm"});
  good({"mdi", "M5", "--wait"});
  good({"mdi", "M6", "--wait"});
  const Outcome early = shell_.run({"resume"});
  EXPECT_EQ(early.exit, 1);
  EXPECT_TRUE(contains(early.err, "X was jogged away from the program by -30 mm: `servogate return` first"))
      << early.err;
  EXPECT_TRUE(contains(good({"status"}).out, "away from the path by 20.0000")) << "status says it";
  const Outcome motion = shell_.run({"mdi", "G0 X0"});
  EXPECT_EQ(motion.exit, 1);
  EXPECT_TRUE(contains(motion.err, "M, S and T functions")) << motion.err;
  EXPECT_TRUE(contains(good({"return", "--feed", "2000"}).out, "back on the path"));
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(shell_.status()["axes"][a]["command"].get<double>(), held["axes"][a]["command"].get<double>(),
                1e-6);
  // Back along the groove, and forward again.
  EXPECT_TRUE(contains(good({"retrace", "--mm", "5"}).out, "the axes stand 5 mm back on the path"));
  EXPECT_TRUE(contains(good({"status"}).out, "back on its path by 5.000 mm"));
  const Outcome behind = shell_.run({"resume"});
  EXPECT_EQ(behind.exit, 1);
  EXPECT_TRUE(contains(behind.err, "went back on its path by 5 mm: `servogate return` leads forward"))
      << behind.err;
  EXPECT_TRUE(contains(good({"return"}).out, "back on the path"));
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(shell_.status()["axes"][a]["command"].get<double>(), held["axes"][a]["command"].get<double>(),
                1e-6);
  const Outcome stands = shell_.run({"resume"});
  EXPECT_EQ(stands.exit, 1);
  EXPECT_TRUE(contains(stands.err, "servogate mdi \"M3 S1200\"")) << stands.err;
  good({"mdi", "M3 S1200", "--wait"});
  good({"resume"});
  // Stopped in the cut.
  cutting(6, 40.0);
  if (killed) {
    shell_.end(SIGKILL);
    up();
    good({"load", (shell_.folder() / "groove.nc").string()});
  } else {
    good({"input", "estop_chain_ok", "off"});
    ASSERT_TRUE(shell_.until([](const json& s) { return s["state"] == "stopped_by_alarm"; }));
    good({"input", "estop_chain_ok", "on"});
    good({"reset"});
    good({"power", "on"});
  }
  good({"override", "100"});
  if (!killed) good({"jog", "Z", "+10mm"});
  const std::int64_t tool = shell_.status()["tool"];
  if (tool != 1) good({"mdi", "T1.1 M6", "--wait"});
  // The tool was reground: its new length counts from here on.
  good({"tool", "set", "1", "length=29.5"});
  const Outcome plan = shell_.run({"start", "--interrupted"});
  EXPECT_TRUE(contains(plan.out, "begins at line ")) << plan.out << plan.err;
  EXPECT_TRUE(contains(plan.out, "that much is cut again")) << plan.out;
  const double overlap = number_behind(plan.out, "was interrupted ");
  EXPECT_GT(overlap, 0.0) << "printed: " << plan.out;
  EXPECT_LE(overlap, 60.0) << "no block is longer; printed: " << plan.out;
  if (!killed) {  // the tool was only lifted: what is cut again is where it stands
    double way = 0.0;
    for (const char* axis : {"  X stands at ", "  Y stands at "}) {
      const std::string line = plan.out.substr(plan.out.find(axis));
      way += std::abs(number_behind(line, "stands at ") - number_behind(line, "begins at "));
    }
    EXPECT_NEAR(overlap, way, 0.2) << "an emergency stop ends each axis by itself; printed: " << plan.out;
  }
  good({"start", "--interrupted", "--yes", "--feed", "2000", "--wait"});
  EXPECT_EQ(shell_.status()["state"], "ended");
  good({"down"});
  shell_.wait();
  for (int n = 1; n <= records_; ++n)
    judge((shell_.folder() / ("day" + std::to_string(n) + ".rec")).string());
  EXPECT_LE(worst_, kTolerance + 1e-4) << "where metal was cut, the path is the programmed one";
  EXPECT_NEAR(deepest_, kDepth, kTolerance);
  for (std::size_t n = 0; n < 360; ++n) EXPECT_TRUE(cut_[n]) << n * kBin << " mm along the groove";
}

INSTANTIATE_TEST_SUITE_P(, ShopDay, ::testing::Values(false, true), [](const auto& which) {
  return which.param ? "after_kill_minus_9" : "after_an_emergency_stop";
});

}  // namespace
}  // namespace servogate::gateway::testing
