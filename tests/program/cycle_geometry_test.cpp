// SPDX-License-Identifier: Apache-2.0
// The cycles of Fenix and of the ISO dialect, judged by what they cut and leave: random numbers, and geometry
// that knows nothing of the cycles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/program/cut_judge.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

constexpr double kTolerance = 2e-3;  ///< mm
constexpr std::size_t kX = 0, kZ = 1;

MachineModel iso_lathe() {
  MachineModel machine = machine_of("XZ", true);
  machine.power_on = {"G291"};
  return machine;
}
MachineModel iso_mill() {
  MachineModel machine = machine_of("XYZ", false);
  machine.power_on = {"G291"};
  return machine;
}
MachineModel fenix_lathe(double clearance = 1.0) {
  MachineModel machine = machine_of("XZ", true);
  machine.variables["P404"] = clearance;
  return machine;
}

class Random {
 public:
  double mm(double low, double high) {
    return std::round(std::uniform_real_distribution<double>(low, high)(engine_) * 1000.0) / 1000.0;
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  bool coin() { return whole(0, 1) == 1; }

 private:
  std::mt19937_64 engine_{servogate::test::property_seed()};
};

std::string dia(double radius) { return digits(2.0 * radius); }

/// In the coordinates of the work: along Z with X out of it, or along X with Z out of it.
std::vector<Stroke> seen(const std::vector<Way>& ways, bool along_z) {
  return strokes(ways, along_z ? kZ : kX, along_z ? kX : kZ);
}

/// All strokes take what they may, and leave the outline and nothing over it.
void expect_cut_to(Stock stock, const std::vector<Stroke>& all, const Outline& outline,
                   const std::string& program) {
  for (const Stroke& s : all)
    ASSERT_EQ(stock.take(s, [&](double a) { return outline.lowest(a); }), "") << program;
  for (std::size_t n = 0; n < stock.heights().size(); ++n) {
    const double a = stock.place(n);
    if (a < outline.first() + 0.1 || a > outline.last() - 0.1) continue;
    ASSERT_LE(stock.heights()[n], outline.highest(a, Stock::kGrid) + kTolerance) << "at " << a << "\n"
                                                                                 << program;
  }
}

/// A contour of lines that falls to one side: its points in the coordinates of the work, the lowest first.
struct Contour {
  std::vector<std::pair<double, double>> points;
  std::string blocks;  ///< N10 and so on, G00 first
  int last = 10;
};

Contour random_contour(Random& random, bool along_z, double front) {
  Contour c;
  double a = front, r = along_z ? random.mm(3.0, 8.0) : random.mm(-30.0, -20.0);
  const double first = r;
  c.points.push_back({a, r});
  const int parts = random.whole(2, 6);
  for (int i = 0; i < parts; ++i) {
    if (i > 0 && random.whole(0, 2) == 0) {
      r += random.mm(0.5, 4.0);
    } else {
      a -= random.mm(1.0, along_z ? 12.0 : 4.0);
      if (i > 0 && random.coin()) r += random.mm(0.1, 3.0);
    }
    c.points.push_back({a, r});
    c.last += 10;
    c.blocks += "N" + std::to_string(c.last) + " G01 X" + dia(along_z ? r : a) + " Z" +
                digits(along_z ? a : r) + "\n";
  }
  c.blocks = "N10 G00 " + (along_z ? "X" + dia(first) : "Z" + digits(first)) + "\n" + c.blocks;
  return c;
}

/// G71 and G72, and G70 behind them.
void judge_stock_removal(bool along_z, bool finishes) {
  Random random;
  for (int n = 0; n < 120; ++n) {
    const double front = along_z ? 2.0 : 40.0;
    const Contour c = random_contour(random, along_z, front);
    const double u = random.mm(0.0, 1.0), w = random.mm(0.0, 0.5);
    const double top = (along_z ? c.points.back().second + random.mm(1.0, 6.0)
                                : std::max(2.0, c.points.back().second + random.mm(1.0, 3.0)));
    const std::string word = along_z ? "G71" : "G72";
    const std::string depth = along_z ? "U" + digits(random.mm(0.5, 6.0)) : "W" + digits(random.mm(0.5, 4.0));
    const std::string program =
        "G98 G00 X" + dia(along_z ? top : front) + " Z" + digits(along_z ? front : top) + "\n" + word + " " +
        depth + " R" + digits(random.mm(0.1, 0.9)) + "\n" + word + " P10 Q" + std::to_string(c.last) + " U" +
        dia(u) + " W" + digits(w) + " F200\n" +
        (finishes ? "G70 P10 Q" + std::to_string(c.last) + "\n" : "") + "M30\n" + c.blocks;
    const Outline whole(c.points);
    const Outline left = finishes ? whole : whole.shifted(along_z ? w : u, along_z ? u : w);
    const double edge = std::min(left.last(), front) - 0.01;
    Stock stock(left.first() + 0.001, edge, [&](double) { return top; });
    const auto ways = ways_of("sinumerik-808d", iso_lathe(), program);
    ASSERT_GT(ways.size(), 2u) << program;
    expect_cut_to(stock, seen(ways, along_z), left, program);
    EXPECT_NEAR(ways.back().to[kX], along_z ? top : front, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[kZ], along_z ? front : top, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(CycleGeometry, of_stock_removal_along_Z_leaves_the_allowance_and_nothing_else) {
  judge_stock_removal(true, false);
}
TEST(CycleGeometry, of_stock_removal_along_X_leaves_the_allowance_and_nothing_else) {
  judge_stock_removal(false, false);
}
TEST(CycleGeometry, of_finishing_behind_stock_removal_leaves_the_contour) {
  judge_stock_removal(true, true);
  judge_stock_removal(false, true);
}

TEST(CycleGeometry, of_a_repeated_pattern_comes_nearer_with_each_pass_and_ends_at_the_allowance) {
  Random random;
  for (int n = 0; n < 100; ++n) {
    const Contour c = random_contour(random, true, 2.0);
    const double u = random.mm(0.0, 1.0), w = random.mm(0.0, 0.5), escape = random.mm(1.0, 6.0);
    const int passes = random.whole(1, 6);
    const double start = c.points.back().second + u + escape + random.mm(1.0, 6.0);
    const std::string program = "G98 G00 X" + dia(start) + " Z2.\nG73 U" + digits(escape) + " W0 R" +
                                std::to_string(passes) + "\nG73 P10 Q" + std::to_string(c.last) + " U" +
                                dia(u) + " W" + digits(w) + " F200\nM30\n" + c.blocks;
    const Outline left = Outline(c.points).shifted(w, u);
    Stock stock(left.first() + 0.001, 1.99, [&](double a) { return left.highest(a) + escape; });
    const auto all = seen(ways_of("sinumerik-808d", iso_lathe(), program), true);
    double deepest = passes == 1 ? 0.0 : escape;
    int cuts = 0;
    for (const Stroke& s : all)
      if (s.cuts && std::abs(s.a0 - (2.0 + w)) < kTolerance && s.a1 < s.a0) {  // the first one of a pass
        EXPECT_NEAR(s.r0 - c.points[0].second - u, deepest, kTolerance) << program;
        deepest -= passes == 1 ? 0.0 : escape / (passes - 1);
        ++cuts;
      }
    EXPECT_EQ(cuts, passes) << program;
    expect_cut_to(stock, all, left, program);
    if (::testing::Test::HasFailure()) return;
  }
}

/// G90 and G94: passes of a cylinder, a face or a cone.
TEST(CycleGeometry, of_single_passes_cuts_the_cylinder_face_or_cone_and_returns) {
  Random random;
  for (int n = 0; n < 200; ++n) {
    const bool along_z = random.coin();
    const double start_a = along_z ? 2.0 : 30.0, top = along_z ? 30.0 : 2.0;
    const double end_a = start_a - random.mm(5.0, 25.0), taper = -random.mm(0.0, 3.0) * random.whole(0, 1);
    double r = top - random.mm(4.0, 6.0);
    const std::string at_start =
        "G98 G00 X" + dia(along_z ? top : start_a) + " Z" + digits(along_z ? start_a : top);
    std::string program = at_start + "\n" + (along_z ? "G90" : "G94") + " X" + dia(along_z ? r : end_a) +
                          " Z" + digits(along_z ? end_a : r) + " R" + digits(taper) + " F200\n";
    const int more = random.whole(0, 4);
    for (int i = 0; i < more; ++i) {
      r -= random.mm(0.2, 2.0);
      program += along_z ? "X" + dia(r) + "\n" : "Z" + digits(r) + "\n";
    }
    const Outline outline({{start_a, r + taper}, {end_a, r}});
    const auto ways = ways_of("sinumerik-808d", iso_lathe(), program);
    expect_cut_to(Stock(end_a + 0.001, start_a - 0.01, [&](double) { return top; }), seen(ways, along_z),
                  outline, program);
    EXPECT_NEAR(ways.back().to[kX], along_z ? top : start_a, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[kZ], along_z ? start_a : top, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// Fenix G70, G71, G77 and G78.
TEST(CycleGeometry, of_passes_with_a_bevel_leaves_their_shape_in_one_cut_or_in_many) {
  Random random;
  for (int n = 0; n < 300; ++n) {
    const bool along_z = random.coin(), many = random.coin();
    const double start_a = along_z ? 60.0 : 30.0, top = along_z ? 30.0 : 60.0;
    const double end_a = start_a - random.mm(5.0, 20.0), r = top - random.mm(3.0, 8.0);
    const double bevel_a = random.mm(0.0, 4.0), bevel_r = random.mm(0.0, 2.0);
    const double step = random.mm(0.4, 3.0);
    std::string word = along_z ? (many ? "G77(" : "G70(") : (many ? "G78(" : "G71(");
    if (many)
      word += (along_z ? dia(step) : digits(step)) + "," + (along_z ? digits(bevel_a) : dia(bevel_a));
    else
      word += (along_z ? digits(bevel_a) : dia(bevel_a)) + "," + (along_z ? dia(bevel_r) : digits(bevel_r));
    const std::string program = "%\nN1 G90 G27 G94 F1500\nN2 G0 X" + dia(along_z ? top : start_a) + " Z" +
                                digits(along_z ? start_a : top) + "\nN3 " + word + ") X" +
                                dia(along_z ? r : end_a) + " Z" + digits(along_z ? end_a : r) + "\n";
    const Outline outline(
        {{start_a, r}, {end_a + bevel_a, r}, {end_a, many ? top : r + bevel_r}, {end_a, top}});
    const auto ways = ways_of("fenix", fenix_lathe(0.5), program);
    const auto all = seen(ways, along_z);
    expect_cut_to(Stock(end_a + 0.03, start_a - 0.01, [&](double) { return top; }), all, outline, program);
    double before = top;
    for (const Stroke& s : all) {
      if (!s.cuts || std::abs(s.r0 - s.r1) > 1e-6 || !many) continue;
      EXPECT_LE(before - s.r0, step + kTolerance) << program;
      before = s.r0;
    }
    EXPECT_NEAR(ways.back().to[kX], along_z ? top : start_a, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[kZ], along_z ? start_a : top, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

void expect_bottoms(Holes holes, const std::vector<Stroke>& all, const std::vector<double>& places,
                    double depth, const std::string& program) {
  for (const Stroke& s : all) ASSERT_EQ(holes.take(s), "") << program;
  const auto bottoms = holes.bottoms();
  ASSERT_EQ(bottoms.size(), places.size()) << program;
  for (const double place : places) {
    const bool cut = std::any_of(bottoms.begin(), bottoms.end(), [&](const auto& b) {
      return std::abs(b.first - place) < kTolerance && std::abs(b.second - depth) < kTolerance;
    });
    EXPECT_TRUE(cut) << "no bottom at " << place << "\n" << program;
  }
}

/// From `first` in steps towards `last`, and `last` itself.
std::vector<double> places_between(double first, double last, double step) {
  std::vector<double> places;
  const double way = last - first;
  for (double gone = 0.0; gone < std::abs(way) - 1e-6; gone += step)
    places.push_back(first + std::copysign(gone, way));
  places.push_back(last);
  return places;
}

TEST(CycleGeometry, of_grooves_of_the_ISO_dialect_is_pecked_to_the_bottom_at_each_place) {
  Random random;
  for (int n = 0; n < 200; ++n) {
    const bool along_z = random.coin();  // the pecks of G74; those of G75 go along X
    const double start_x = along_z ? random.mm(20.0, 30.0) : 30.0, start_z = along_z ? 2.0 : -5.0;
    const double depth = along_z ? -random.mm(1.0, 20.0) : 30.0 - random.mm(2.0, 10.0);
    const double last = along_z ? start_x - random.mm(0.0, 8.0) : start_z - random.mm(0.0, 8.0);
    const double peck = random.mm(0.7, 6.0), step = random.mm(0.8, 4.0),
                 relief = random.mm(0.0, 0.3) * random.whole(0, 1);
    const auto increments = [](double mm) { return std::to_string(std::lround(mm * 1000.0)); };
    const std::string program =
        "G98 G00 X" + dia(start_x) + " Z" + digits(start_z) + "\n" + (along_z ? "G74 R" : "G75 R") +
        digits(random.mm(0.1, 0.6)) + "\n" + (along_z ? "G74" : "G75") + " X" + dia(along_z ? last : depth) +
        " Z" + digits(along_z ? depth : last) + " P" + increments(along_z ? step : peck) + " Q" +
        increments(along_z ? peck : step) + (relief > 0.0 ? " R" + digits(relief) : "") + " F100\n";
    const auto ways = ways_of("sinumerik-808d", iso_lathe(), program);
    const auto all = along_z ? strokes(ways, kX, kZ) : strokes(ways, kZ, kX);
    const double first = along_z ? start_x : start_z;
    expect_bottoms(Holes(along_z ? start_z : start_x, peck, relief), all, places_between(first, last, step),
                   depth, program);
    EXPECT_NEAR(ways.back().to[kX], start_x, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[kZ], start_z, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G72 and G73 peck one groove or hole, G74 and G75 cut several in one go each.
TEST(CycleGeometry, of_grooves_of_Fenix_is_cut_to_the_bottom_at_each_place) {
  Random random;
  for (int n = 0; n < 200; ++n) {
    const bool along_z = random.coin(), pecks = random.coin();
    const double start_x = 30.0, start_z = 40.0;
    const double depth = (along_z ? start_z : start_x) - random.mm(2.0, 15.0);
    const double side = random.mm(1.0, 12.0), step = random.mm(0.7, 5.0);
    const double first = along_z ? start_x : start_z, last = first - side;
    const std::string word = pecks ? (along_z ? "G73(" : "G72(") : (along_z ? "G74(" : "G75(");
    const bool in_x = pecks != along_z;
    std::string program =
        "%\nN1 G90 G27 G94 F1500\nN2 G0 X60 Z40\nN3 " + word + (in_x ? dia(step) : digits(step)) + ") ";
    if (pecks)
      program += (along_z ? "Z" + digits(depth) : "X" + dia(depth)) + "\n";
    else
      program += "X" + dia(along_z ? last : depth) + " Z" + digits(along_z ? depth : last) + "\n";
    const auto ways = ways_of("fenix", fenix_lathe(), program);
    const auto all = along_z ? strokes(ways, kX, kZ) : strokes(ways, kZ, kX);
    const double top = along_z ? start_z : start_x;
    expect_bottoms(Holes(top, pecks ? step : 1e9), all,
                   pecks ? std::vector<double>{first} : places_between(first, last, step), depth, program);
    EXPECT_NEAR(ways.back().to[along_z ? kZ : kX], top, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[along_z ? kX : kZ], pecks ? first : last, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G81, G810 to G812 and G820 to G823: one hole.
TEST(CycleGeometry, of_holes_of_Fenix_goes_in_its_passes_to_the_bottom_and_back_to_its_level) {
  Random random;
  constexpr int kCycles[] = {81, 810, 811, 812, 820, 821, 822, 823};
  for (int n = 0; n < 340; ++n) {
    const int cycle = kCycles[random.whole(0, 7)];
    const bool alone = cycle == 81;  // neither approaches nor leaves
    const bool deep = cycle == 812 || cycle >= 822, bores = cycle >= 820, breaks = !deep && random.coin();
    const double approach = random.mm(0.5, 3.0), depth = -random.mm(2.0, 30.0),
                 retreat = approach + random.mm(0.5, 4.0);
    const double first = random.mm(1.2, 6.0), next = random.mm(1.2, 6.0), shift = -random.mm(0.1, 0.4);
    std::string call =
        "G" + std::to_string(cycle) + "(" + digits(approach) + "," + digits(depth) + "," + digits(retreat);
    call += bores ? "," + dia(shift) : ",";
    call += deep ? "," + digits(first) + "," + digits(next) : breaks ? "," + digits(first) : "";
    const std::string program =
        "%\nN1 G90 G27 G94 F1500 S300 M3\n" +
        (breaks ? "N2 G67(" + digits(next) + "," + digits(random.mm(0.2, 1.0)) + ")\n" : "N2 G68\n") +
        "N3 G0 X20 Z" + (alone ? digits(approach) : std::string("60")) + "\nN4 " + call + ")\n";
    const auto ways = ways_of("fenix", fenix_lathe(), program);
    auto all = strokes(ways, kX, kZ);
    for (Stroke& s : all)  // the tool leaves the wall and comes back to the hole
      if (bores && std::abs(s.a1 - s.a0) < 1e-9) s.a0 = s.a1 = 10.0;
    const double step = deep || breaks ? std::max(first, next) : 1e9;
    expect_bottoms(Holes(approach, step, std::abs(shift)), all, {10.0}, depth, program);
    EXPECT_NEAR(ways.back().to[kZ], alone ? depth : retreat, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G824 to G826: passes further and further out, each to the bottom.
TEST(CycleGeometry, of_wide_bores_of_Fenix_cuts_each_pass_to_the_bottom_and_the_last_at_its_diameter) {
  Random random;
  for (int n = 0; n < 200; ++n) {
    const int cycle = random.whole(824, 826);
    const double begin = 10.0, end = begin + random.mm(1.0, 8.0), step = random.mm(0.5, 3.0);
    const double allowance = random.mm(0.0, 0.5) * random.whole(0, 1), approach = 1.0,
                 depth = -random.mm(3.0, 15.0);
    const double retreat = random.mm(2.0, 6.0), first = random.mm(1.2, 4.0), next = random.mm(1.2, 4.0);
    std::string call = "G" + std::to_string(cycle) + "(" + digits(approach) + "," + digits(depth) + "," +
                       dia(end) + "," + dia(step) + "," + dia(allowance) + ",,," + digits(retreat);
    if (cycle == 826) call += "," + digits(first) + "," + digits(next);
    const std::string program = "%\nN1 G90 G27 G94 F1500 S300 M3\nN2 G0 X20 Z10\nN3 " + call + ")\n";
    const auto ways = ways_of("fenix", fenix_lathe(), program);
    std::vector<double> places;
    const double rough = end - std::min(allowance, end - begin);
    for (double x = begin; std::abs(x - end) > 1e-9;) {
      x = rough - x > 1e-9 ? std::min(x + step, rough) : end;
      places.push_back(x);
    }
    expect_bottoms(Holes(approach, cycle == 826 ? std::max(first, next) : 1e9), strokes(ways, kX, kZ), places,
                   depth, program);
    EXPECT_NEAR(ways.back().to[kZ], retreat, kTolerance) << program;
    EXPECT_NEAR(ways.back().to[kX], end, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G81, G82, G83, G73, G85, G86 and G89, and the taps G84 and G74.
TEST(CycleGeometry,
     of_holes_of_milling_goes_in_its_pecks_to_the_bottom_and_back_to_the_plane_that_was_chosen) {
  Random random;
  constexpr int kCycles[] = {73, 74, 81, 82, 83, 84, 85, 86, 89};
  for (int n = 0; n < 300; ++n) {
    const int cycle = kCycles[random.whole(0, 8)];
    const bool pecks = cycle == 73 || cycle == 83, to_r = random.coin(), increments = random.coin();
    const double initial = 20.0, level = random.mm(1.0, 5.0), depth = -random.mm(2.0, 30.0),
                 peck = random.mm(1.5, 7.0);
    const double x = random.mm(-50.0, 50.0), dx = random.mm(2.0, 20.0);
    std::string program =
        "S500 M3 F500\nG90 G00 X0. Y0. Z" + digits(initial) + "\n" + (increments ? "G91 " : "G90 ") +
        (to_r ? "G99 G" : "G98 G") + std::to_string(cycle) + " X" + digits(x) + " Y5. Z" +
        digits(increments ? depth - level : depth) + " R" + digits(increments ? level - initial : level) +
        (pecks ? " Q" + digits(peck) : "") + " F500\n";
    program += "G91 X" + digits(dx) + " K3\nG80\n";
    const auto ways = ways_of("sinumerik-808d", iso_mill(), program);
    expect_bottoms(Holes(level, pecks ? peck : 1e9), strokes(ways, 0, 2), {x, x + dx, x + 2 * dx, x + 3 * dx},
                   depth, program);
    EXPECT_NEAR(ways.back().to[2], to_r ? level : initial, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G98 and G99 may change from hole to hole: each is left to the plane that its own block chose.
TEST(CycleGeometry, of_a_row_of_holes_leaves_each_to_the_plane_of_its_block) {
  Random random;
  constexpr int kCycles[] = {73, 81, 82, 83, 85, 86, 89};
  for (int n = 0; n < 150; ++n) {
    const int cycle = kCycles[random.whole(0, 6)], holes = random.whole(2, 6);
    const bool pecks = cycle == 73 || cycle == 83;
    const double initial = 20.0, level = random.mm(1.0, 5.0), depth = -random.mm(2.0, 30.0),
                 peck = random.mm(1.5, 7.0);
    std::string program = "S500 M3 F500\nG90 G00 X0. Y0. Z" + digits(initial) + "\n";
    std::vector<double> places, planes;
    for (int i = 0; i < holes; ++i) {
      const bool to_r = random.coin();
      planes.push_back(to_r ? level : initial);
      places.push_back(random.mm(-5.0, 5.0) + 15.0 * (i + 1));
      program += to_r ? "G99 " : "G98 ";
      if (i == 0)
        program += "G" + std::to_string(cycle) + " Y5. Z" + digits(depth) + " R" + digits(level) +
                   (pecks ? " Q" + digits(peck) : "") + " F500 ";
      program += "X" + digits(places.back()) + "\n";
    }
    const auto ways = ways_of("sinumerik-808d", iso_mill(), program + "G80\nG00 X200.\n");
    expect_bottoms(Holes(level, pecks ? peck : 1e9), strokes(ways, 0, 2), places, depth, program);
    std::size_t left = 0;
    for (const Way& w : ways) {  // the way to the next hole begins on the plane of the one before
      if (std::abs(w.to[0] - w.from[0]) < 1e-9 || std::abs(w.from[0]) < 1e-9) continue;
      ASSERT_LT(left, planes.size()) << program;
      EXPECT_NEAR(w.from[2], planes[left++], kTolerance) << program;
    }
    EXPECT_EQ(left, planes.size()) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G76 leaves the wall at the bottom, G87 goes in beside it and cuts upwards.
TEST(CycleGeometry, of_fine_and_back_boring_moves_only_beside_the_wall) {
  Random random;
  for (int n = 0; n < 100; ++n) {
    const double level = random.mm(1.0, 5.0), depth = -random.mm(2.0, 30.0), shift = random.mm(0.1, 1.0);
    MachineModel machine = iso_mill();
    machine.variables["ZSFI5"] = random.whole(1, 4);
    const std::string start = "S500 M3\nG90 G00 X0. Y0. Z20.\n";
    const std::string fine = start + "G99 G76 X10. Y5. Z" + digits(depth) + " R" + digits(level) + " Q" +
                             digits(shift) + " F500\nG80\n";
    const auto ways = ways_of("sinumerik-808d", machine, fine);
    double bottom = level;
    for (const Way& w : ways) {
      const double across = std::hypot(w.to[0] - w.from[0], w.to[1] - w.from[1]);
      if (w.kind == Way::Kind::cut) bottom = std::min(bottom, w.to[2]);
      if (across > 1e-9 && std::min(w.from[2], w.to[2]) < level - 1e-9) {
        EXPECT_NEAR(across, shift, kTolerance) << fine;
      }
      const bool out = w.kind == Way::Kind::rapid && w.to[2] > w.from[2] && w.from[2] < level - 1e-9;
      if (out) {
        EXPECT_NEAR(std::hypot(w.to[0] - 10.0, w.to[1] - 5.0), shift, kTolerance) << fine;
      }
    }
    EXPECT_NEAR(bottom, depth, kTolerance) << fine;
    EXPECT_NEAR(ways.back().to[0], 10.0, kTolerance);
    EXPECT_NEAR(ways.back().to[2], level, kTolerance);
    const std::string back = start + "G98 G87 X10. Y5. Z" + digits(depth / 2.0) + " R" + digits(depth) +
                             " Q" + digits(shift) + " F500\nG80\n";
    double highest = -1e9;
    for (const Way& w : ways_of("sinumerik-808d", machine, back)) {
      if (w.kind == Way::Kind::cut) {
        EXPECT_GT(w.to[2], w.from[2]) << back;
        EXPECT_NEAR(std::hypot(w.to[0] - 10.0, w.to[1] - 5.0), 0.0, kTolerance) << back;
        highest = std::max(highest, w.to[2]);
      } else if (std::abs(w.to[2] - w.from[2]) > 1e-9 && std::min(w.to[2], w.from[2]) < 0.0) {
        EXPECT_NEAR(std::hypot(w.to[0] - 10.0, w.to[1] - 5.0), shift, kTolerance) << back;
      }
    }
    EXPECT_NEAR(highest, std::round(depth / 2.0 * 1000.0) / 1000.0, kTolerance) << back;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G83 to G85 from the face, G87 to G89 from the side.
TEST(CycleGeometry, of_holes_of_turning_goes_in_its_pecks_to_the_bottom_and_back) {
  Random random;
  constexpr int kCycles[] = {83, 84, 85, 87, 88, 89};
  for (int n = 0; n < 300; ++n) {
    const int cycle = kCycles[random.whole(0, 5)];
    const bool side = cycle >= 87, pecks = cycle == 83 || cycle == 87;
    const double start = 40.0, level = -random.mm(1.0, 5.0), depth = start - random.mm(8.0, 30.0),
                 peck = random.mm(1.5, 7.0);
    MachineModel machine = iso_lathe();
    machine.variables["ZSFI20"] = random.whole(0, 1);
    const std::string program =
        "S500 M3\nG98 F500\nG00 X" + dia(side ? start : 5.0) + " Z" + digits(side ? 5.0 : start) + "\nG" +
        std::to_string(cycle) + (side ? " X" + dia(depth) : " Z" + digits(depth)) + " R" + digits(level) +
        (pecks ? " Q" + std::to_string(std::lround(peck * 1000.0)) : "") + " F500\nG80\n";
    const auto ways = ways_of("sinumerik-808d", machine, program);
    expect_bottoms(Holes(start + level, pecks ? peck : 1e9), strokes(ways, side ? kZ : kX, side ? kX : kZ),
                   {5.0}, depth, program);
    EXPECT_NEAR(ways.back().to[side ? kX : kZ], start, kTolerance) << program;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G76: no pass takes more than the first one's chip, the last ones are at the full depth; G92 at its own.
TEST(CycleGeometry, of_threads_goes_down_the_flank_by_equal_chips_to_the_full_depth) {
  Random random;
  for (int n = 0; n < 200; ++n) {
    const double start_x = 20.0, start_z = 5.0, root = 20.0 - random.mm(3.0, 6.0),
                 depth = random.mm(0.8, 2.5);
    const double first = random.mm(0.2, 0.6), least = random.mm(0.03, 0.15), allowance = random.mm(0.0, 0.1);
    const double end = -random.mm(10.0, 30.0), lead = random.mm(0.5, 3.0);
    const int finishing = random.whole(1, 3), angle = random.coin() ? 60 : 0;
    const auto micrometres = [](double mm) { return std::to_string(std::lround(mm * 1000.0)); };
    const std::string pack = "0" + std::to_string(finishing) + "10" + (angle == 60 ? "60" : "00");
    const std::string program = "S500 M3\nG99 G00 X" + dia(start_x) + " Z" + digits(start_z) + "\nG76 P" +
                                pack + " Q" + micrometres(least) + " R" + digits(allowance) + "\nG76 X" +
                                dia(root) + " Z" + digits(end) + " P" + micrometres(depth) + " Q" +
                                micrometres(first) + " F" + digits(lead) + "\n";
    std::vector<double> depths;
    for (const Way& w : ways_of("sinumerik-808d", iso_lathe(), program)) {
      if (w.kind == Way::Kind::rapid) continue;
      EXPECT_GE(std::min(w.from[kX], w.to[kX]), root - kTolerance) << program;
      EXPECT_GE(w.to[kZ], end - kTolerance) << program;
      if (std::abs(w.to[kX] - w.from[kX]) > 1e-9) continue;  // the run-out
      depths.push_back(root + depth - w.from[kX]);
      EXPECT_NEAR(start_z - w.from[kZ], depths.back() * std::tan(angle / 2.0 * 3.14159265358979 / 180.0),
                  kTolerance)
          << program;
    }
    ASSERT_GT(depths.size(), static_cast<std::size_t>(finishing)) << program;
    for (std::size_t i = 0; i < depths.size(); ++i) {
      const double before = i == 0 ? 0.0 : depths[i - 1], chip = depths[i] * depths[i] - before * before;
      const bool small = depths[i] - before <= least + kTolerance ||
                         i + static_cast<std::size_t>(finishing) >= depths.size();
      if (!small) {
        EXPECT_LE(chip, first * first + 4.0 * kTolerance) << program;
      }
    }
    for (std::size_t i = depths.size() - static_cast<std::size_t>(finishing); i < depths.size(); ++i)
      EXPECT_NEAR(depths[i], depth, kTolerance) << program;
    EXPECT_NEAR(depths[depths.size() - static_cast<std::size_t>(finishing) - 1],
                depth - std::min(allowance, depth), kTolerance)
        << program;
    const std::string single = "S500 M3\nG99 G00 X" + dia(start_x) + " Z" + digits(start_z) + "\nG92 X" +
                               dia(root) + " Z" + digits(end) + " F" + digits(lead) + "\n";
    double deepest = 1e9, furthest = 1e9;
    for (const Way& w : ways_of("sinumerik-808d", iso_lathe(), single))
      if (w.kind == Way::Kind::thread)
        deepest = std::min(deepest, w.to[kX]), furthest = std::min(furthest, w.to[kZ]);
    EXPECT_NEAR(deepest, root, kTolerance) << single;
    EXPECT_NEAR(furthest, end, kTolerance) << single;
    if (::testing::Test::HasFailure()) return;
  }
}

/// G851 with G852 and G853: chamfers at the edges, arcs in the corners of a groove with upright walls.
TEST(CycleGeometry, of_a_finished_groove_has_its_chamfers_and_arcs) {
  Random random;
  for (int n = 0; n < 100; ++n) {
    const double depth = random.mm(3.0, 8.0), width = random.mm(8.0, 20.0);
    const double chamfer = random.mm(0.2, 1.0), radius = random.mm(0.3, 2.0);
    const std::string edge = "0," + digits(chamfer) + "," + digits(chamfer), corner = "1," + digits(radius);
    const std::string program = "%\nN1 G90 G26 G94 F1000\nN2 G0 X60 Z20\nN3 G851(" + edge + ",," + corner +
                                ",,," + corner + ",,," + edge + ")\nN4 G852(0,0," + digits(depth) + ",," +
                                digits(width) + ",0,,0," + digits(depth) + ")\nN5 G853(0,50,1,1.5,0,0,0,1)\n";
    const auto outline = [&](double z) {
      const double a = -z;  // from the edge where the work begins
      if (a < -chamfer || a > width + chamfer) return 50.0;
      if (a < 0.0) return 50.0 - chamfer - a;
      if (a > width) return 50.0 - chamfer + (a - width);
      const double wall = std::min(a, width - a);
      const double arc =
          wall >= radius ? 0.0 : radius - std::sqrt(radius * radius - (radius - wall) * (radius - wall));
      return 50.0 - depth + arc;
    };
    const auto near = [&](double z, bool highest) {
      double found = outline(z);
      for (const double off : {-0.02, -0.01, -0.001, 0.001, 0.01, 0.02})
        found = highest ? std::max(found, outline(z + off)) : std::min(found, outline(z + off));
      return found;
    };
    Stock stock(-width - 2.0, 2.0, [](double) { return 50.0; });
    for (const Stroke& s : strokes(ways_of("fenix", fenix_lathe(), program), kZ, kX))
      ASSERT_EQ(stock.take(s, [&](double z) { return near(z, false); }), "") << program;
    for (double z = -width - 1.5; z < 1.5; z += 0.05) {
      ASSERT_LE(stock.height(z), near(z, true) + 0.01) << z << "\n" << program;
      ASSERT_GE(stock.height(z), near(z, false) - 0.01) << z << "\n" << program;
    }
  }
}

}  // namespace
}  // namespace servogate::program::tests
