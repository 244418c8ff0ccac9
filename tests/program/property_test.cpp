// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <random>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/check/check.hpp"
#include "kernel/program/faults/texts.hpp"
#include "kernel/program/geometry/degrees.hpp"
#include "kernel/program/languages/nc110/values/expressions.hpp"
#include "kernel/program/values/expression.hpp"
#include "tests/program/case_file.hpp"
#include "tests/property_seed.hpp"

namespace servogate::program::tests {
namespace {

std::uint64_t fresh_seed() {
  const std::uint64_t seed = servogate::test::property_seed();
  return seed;
}

// --- expressions
// --------------------------------------------------------------------------------------------------

/// A random expression as a tree: its text, and its value computed without the reader under test.
struct Tree {
  std::string text;
  double value;
};

class Grower {
 public:
  explicit Grower(std::uint64_t seed) : random_(seed) {}

  Tree grow(int depth) {
    if (depth == 0) return leaf();
    switch (pick(8)) {
      case 0:
        return binary(depth, '+');
      case 1:
        return binary(depth, '-');
      case 2:
        return binary(depth, '*');
      case 3:
        return binary(depth, '/');
      case 4:
        return minus(depth);
      case 5:
        return function(depth);
      case 6:
        return modulo(depth);
      default:
        return leaf();
    }
  }

 private:
  static constexpr double kRadian = std::numbers::pi / 180.0;
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  Tree leaf() {
    const int value = pick(20000);
    const std::string digits = std::to_string(value);
    switch (pick(3)) {
      case 0:
        return {digits, static_cast<double>(value)};
      case 1:
        return {digits + ".5", value + 0.5};
      default:
        return {"E" + std::to_string(30 + value % 50), parameter(30 + value % 50)};
    }
  }
  Tree binary(int depth, char op) {
    const Tree a = grow(depth - 1), b = grow(depth - 1);
    if (op == '/' && b.value == 0.0) return a;
    const double value = op == '+'   ? a.value + b.value
                         : op == '-' ? a.value - b.value
                         : op == '*' ? a.value * b.value
                                     : a.value / b.value;
    return {"(" + a.text + (pick(2) == 0 ? " " : "") + op + b.text + ")", value};
  }
  Tree minus(int depth) {
    const Tree a = grow(depth - 1);
    return {"(-" + a.text + ")", -a.value};
  }
  Tree function(int depth) {
    const Tree a = grow(depth - 1);
    switch (pick(5)) {
      case 0:
        return {"ABS(" + a.text + ")", std::abs(a.value)};
      case 1:
        return {"INT(" + a.text + ")", std::trunc(a.value)};
      case 2:
        return {"NEG(" + a.text + ")", -a.value};
      case 3:
        return {"SQR(ABS(" + a.text + "))", std::sqrt(std::abs(a.value))};
      default:
        return {"ART(" + a.text + ")", std::atan(a.value) / kRadian};
    }
  }
  Tree modulo(int depth) {
    const Tree a = grow(depth - 1), b = grow(depth - 1);
    if (b.value == 0.0) return b;
    return {"MOD(" + a.text + "," + b.text + ")", std::fmod(a.value, b.value)};
  }

 public:
  static double parameter(int index) { return index * 1.25 - 40.0; }

 private:
  std::mt19937_64 random_;
};

class FixedValues : public ValueSource {
 public:
  double parameter(int index, int) const override { return Grower::parameter(index); }
  double place(const image::Place&, int) const override { return 0.0; }
  double system(int, int) const override { return 0.0; }
};

TEST(Property, random_expressions_have_the_value_of_an_independent_evaluation) {
  Grower grower(fresh_seed());
  const FixedValues values;
  for (int i = 0; i < 100'000; ++i) {
    const Tree tree = grower.grow(1 + i % 5);
    if (!std::isfinite(tree.value)) continue;
    std::size_t pos = 0;
    const double got = evaluate(nc110::expressions(), tree.text, pos, &values);
    ASSERT_EQ(tree.text.size(), pos) << tree.text;
    ASSERT_EQ(tree.value, got) << tree.text;
    pos = 0;
    ASSERT_NO_THROW(evaluate(nc110::expressions(), tree.text, pos, nullptr)) << tree.text;
  }
}

TEST(Property, operators_bind_as_in_arithmetic) {
  std::mt19937_64 random(fresh_seed());
  const FixedValues values;
  for (int i = 0; i < 10'000; ++i) {
    const double a = static_cast<double>(random() % 100), b = static_cast<double>(random() % 100),
                 c = static_cast<double>(random() % 99 + 1), d = static_cast<double>(random() % 100);
    const std::string text = text::number(a) + "-" + text::number(b) + "*" + text::number(d) + "/" +
                             text::number(c) + "-" + text::number(d) + "+" + text::number(a);
    std::size_t pos = 0;
    ASSERT_EQ(a - b * d / c - d + a, evaluate(nc110::expressions(), text, pos, &values)) << text;
  }
}

TEST(Property, sine_and_cosine_agree_with_the_library_and_are_exact_at_right_angles) {
  std::mt19937_64 random(fresh_seed());
  std::uniform_real_distribution<double> angle(-1000.0, 1000.0);
  for (int i = 0; i < 100'000; ++i) {
    const double a = angle(random);
    ASSERT_NEAR(std::sin(a * std::numbers::pi / 180.0), sin_deg(a), 1e-13);
    ASSERT_NEAR(std::cos(a * std::numbers::pi / 180.0), cos_deg(a), 1e-13);
  }
  for (int quarter = -8; quarter <= 8; ++quarter) {
    EXPECT_EQ(quarter % 2 == 0 ? 0.0 : (quarter % 4 + 4) % 4 == 1 ? 1.0 : -1.0, sin_deg(90.0 * quarter));
    EXPECT_EQ(quarter % 2 != 0 ? 0.0 : quarter % 4 == 0 ? 1.0 : -1.0, cos_deg(90.0 * quarter));
  }
}

// --- programs
// -----------------------------------------------------------------------------------------------------

/// Random programs of the language's own words: many are right, many are not.
class Author {
 public:
  explicit Author(std::uint64_t seed) : random_(seed) {}

  std::string program(int blocks) {
    std::string text = "F600\n";
    for (int i = 0; i < blocks; ++i) text += block() + "\n";
    return text;
  }
  /// Bytes that are no program at all.
  std::string noise(std::size_t length) {
    static constexpr std::string_view kAlphabet =
        "GXYZIJKRFSTMHNE0123456789.+-*/()=,\"#&;% \nABLUPtrb\xD0\xA5";
    std::string text;
    for (std::size_t i = 0; i < length; ++i) text += kAlphabet[random_() % kAlphabet.size()];
    return text;
  }

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  std::string value() {
    if (pick(8) == 0) return "E" + std::to_string(30 + pick(5));
    return std::to_string(pick(60) - 30) + (pick(3) == 0 ? ".125" : "");
  }
  std::string block() {
    switch (pick(27)) {
      case 0:
        return "\"L" + std::to_string(pick(4)) + "\"";
      case 1:
        return "(BLT,E10," + std::to_string(pick(40)) + ",L" + std::to_string(pick(4)) + ")";
      case 2:
        return "(RPT," + std::to_string(pick(4)) + ")";
      case 3:
        return "(ERP)";
      case 4:
        return "E10=E10+" + std::to_string(1 + pick(3));
      case 5:
        return "E3" + std::to_string(pick(5)) + "=" + value() + "*SIN(" + value() + ")";
      case 6:
        return "(URT," + std::to_string(pick(360)) + ")";
      case 7:
        return "(UIO,X" + value() + ",Y" + value() + ")";
      case 8:
        return pick(2) == 0 ? "(MIR,X)" : "(MIR)";
      case 9:
        return "(SCF," + std::to_string(1 + pick(2)) + ")";
      case 10:
        return "(UAO,0)";
      case 11:
        return "SYVAR" + std::to_string(pick(20)) + ".IN=" + value();
      case 12:
        return "E11=SYVAR" + std::to_string(pick(20)) + ".IN";
      case 13:
        return "SA" + std::to_string(64 + pick(8)) + "=" + std::to_string(pick(2));
      case 14:
        return "(BEQ,SA" + std::to_string(64 + pick(8)) + ",1,L" + std::to_string(pick(4)) + ")";
      case 15:
        return pick(2) == 0 ? "G91" : "G90";
      case 16:
        return "G" + std::to_string(27 + pick(3));
      case 17:
        return "G2 X" + value() + " Y" + value() + " R" + std::to_string(20 + pick(60));
      case 18:
        return "G3 I" + value() + " J" + value() + " Z" + value();
      case 19:
        return "S" + std::to_string(pick(3000)) + " M" + std::to_string(3 + pick(3));
      case 20:
        return "(WAI,SYVAR" + std::to_string(pick(9)) + "=" + std::to_string(pick(200)) + ")";
      case 21:
        return "(EPP,L" + std::to_string(pick(2)) + ",L" + std::to_string(2 + pick(2)) + ")";
      case 22:
        return "G0 X" + value() + " Z" + value();
      default:
        return "G1 X" + value() + " Y" + value();
    }
  }
  std::mt19937_64 random_;
};

TEST(Property, random_programs_always_end_inside_of_the_travel) {
  Author author(fresh_seed());
  int finished = 0;
  for (int i = 0; i < 4'000; ++i) {
    const std::string text = i % 4 == 3 ? author.noise(200) : author.program(3 + i % 40);
    Interpreter run("nc110", mill(), {}, "p.nc", text, {}, Position{});
    ASSERT_NO_THROW(run.findings()) << text;
    long long commands = 0;
    const auto error = run_dry(
        run,
        [&](const Command&) {
          ++commands;
          for (std::size_t a = 0; a < 3; ++a) EXPECT_LE(std::abs(run.position()[a]), 300.0 + 1e-5) << text;
          return true;
        },
        5'000);
    if (error) {
      ASSERT_NE(nullptr, error->entry) << text;
      ASSERT_EQ(std::string::npos, error->str(text::Language::english).find("{0}")) << text;
    }
    finished += !error;
  }
  EXPECT_GT(finished, 100);
}

/// Machines that lack axes of the planes, or have more than three.
std::vector<MachineModel> shapes() {
  std::vector<MachineModel> out;
  for (const char* letters : {"X", "Z", "C", "XZ", "XY", "YZ", "UV", "XYZAC", "XZABC", "XYZUVWABC"}) {
    MachineModel machine = mill();
    machine.axes.clear();
    for (const char* letter = letters; *letter != '\0'; ++letter) {
      const bool rotary = *letter >= 'A' && *letter <= 'C';
      machine.axes.push_back({std::string(1, *letter), rotary, false, false, -300.0, 300.0, 500.0});
    }
    out.push_back(machine);
    if (std::string_view(letters) != "XZ") continue;
    out.back().axes[0].diameter = true;  // a lathe, and one that powers on in its plane
    out.push_back(out.back());
    out.back().power_on.push_back("G18");
  }
  return out;
}

/// Programs of words for axes that a machine may lack; arcs, helices, planes, cycles and rotations most.
class PlaneAuthor {
 public:
  PlaneAuthor(std::uint64_t seed, const MachineModel& machine) : random_(seed), machine_(machine) {}

  std::string program(int blocks) {
    std::string text = "F600\n";
    for (int i = 0; i < blocks; ++i) text += block() + "\n";
    return text;
  }

 private:
  int pick(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  std::string value() { return std::to_string(pick(60) - 30); }
  std::string axis() {
    return machine_.axes[static_cast<std::size_t>(pick(static_cast<int>(machine_.axes.size())))].letter;
  }
  std::string axis_word() { return " " + axis() + value(); }
  std::string block() {
    const std::string arc = pick(2) == 0 ? "G2" : "G3";
    switch (pick(14)) {
      case 0:
        return arc + axis_word() + " R" + std::to_string(pick(80) - 20);
      case 1:
        return arc + " I" + value() + " J" + value();
      case 2:
        return arc + axis_word() + " I" + value() + " J" + value();
      case 3:
        return arc + axis_word() + " I" + value() + " J" + value() + " K" + std::to_string(1 + pick(5));
      case 4:
        return "I" + value() + " J" + value();
      case 5:
        return "G" + std::to_string(17 + pick(3));
      case 6:
        return "(DPI," + axis() + "," + axis() + ")";
      case 7:
        return "(URT," + std::to_string(pick(4) * 30) + ")";
      case 8:
        return "G8" + std::to_string(pick(7)) + axis_word() + " R" + value() + " I2";
      case 9:
        return "(SCF," + std::to_string(1 + pick(2)) + "," + axis() + ")";
      case 10:
        return "(MIR," + axis() + ")";
      case 11:
        return pick(2) == 0 ? "G91" : "G90";
      case 12:
        return "G79" + axis_word();
      default:
        return (pick(2) == 0 ? "G0" : "G1") + axis_word();
    }
  }
  std::mt19937_64 random_;
  const MachineModel& machine_;
};

TEST(Property, arcs_lie_in_planes_whose_axes_the_machine_has_whatever_machine_it_is) {
  const std::uint64_t seed = fresh_seed();
  std::map<std::size_t, int> arcs;
  for (const MachineModel& machine : shapes()) {
    PlaneAuthor author(seed, machine);
    const std::size_t axes = machine.axes.size();
    const auto judge = [&](const Command& command) -> std::optional<text::Finding> {
      if (const auto* arc = std::get_if<Arc>(&command.what)) {
        EXPECT_LT(arc->axis1, axes);
        EXPECT_LT(arc->axis2, axes);
        EXPECT_NE(arc->axis1, arc->axis2);
        EXPECT_TRUE(std::isfinite(arc->center1) && std::isfinite(arc->center2) &&
                    std::isfinite(arc->sweep_deg));
        ++arcs[axes];
      }
      return std::nullopt;
    };
    for (int i = 0; i < 600; ++i) {
      const std::string text = author.program(3 + i % 12);
      const CheckReport report = check_program("nc110", machine, {}, "p.nc", text, {}, Position{}, judge);
      ASSERT_EQ(axes, report.extents.size());
      for (const auto& extent : report.extents)
        ASSERT_TRUE(std::isfinite(extent.min) && std::isfinite(extent.max)) << text;
      ASSERT_FALSE(testing::Test::HasFailure()) << machine.axes[0].letter << axes << "\n" << text;
    }
  }
  EXPECT_EQ(0, arcs[1]) << "no plane";
  for (const std::size_t axes : {2u, 5u, 9u}) EXPECT_GT(arcs[axes], 50) << axes;
}

/// The next step as a text, for comparison.
std::string text_of(const Step& step, const std::vector<std::string>& files) {
  if (const auto* command = std::get_if<Command>(&step)) return to_json(*command, {"X", "Y", "Z"}, files);
  if (const auto* error = std::get_if<Error>(&step)) return error->finding.str(text::Language::english);
  return "sync " + std::to_string(std::get<NeedsSync>(step).line);
}

TEST(Property, a_copy_taken_anywhere_goes_on_as_the_original_does) {
  const std::uint64_t seed = fresh_seed();
  Author author(seed);
  std::mt19937_64 random(seed + 1);
  const image::Packets packets;
  for (int i = 0; i < 1'000; ++i) {
    const std::string text = author.program(5 + i % 40);
    auto original =
        std::make_unique<Interpreter>("nc110", mill(), Tables{}, "p.nc", text, ProgramLoader{}, Position{});
    for (int k = static_cast<int>(random() % 30); k > 0; --k) original->next(packets, random() % 2 == 0);
    Interpreter copy(*original);
    Interpreter assigned("nc110", mill(), {}, "q.nc", "G0 X1", {}, Position{});
    assigned = *original;
    std::vector<std::string> expected;
    for (int k = 0; k < 40; ++k)
      expected.push_back(text_of(original->next(packets, k % 3 == 0), original->files()));
    original.reset();
    for (int k = 0; k < 40; ++k) {
      ASSERT_EQ(expected[static_cast<std::size_t>(k)], text_of(copy.next(packets, k % 3 == 0), copy.files()))
          << text;
      ASSERT_EQ(expected[static_cast<std::size_t>(k)],
                text_of(assigned.next(packets, k % 3 == 0), assigned.files()));
    }
  }
}

TEST(Property, writing_a_byte_changes_exactly_its_bits_and_its_shares_of_the_larger_formats) {
  // T-SA-17, through the program: SK i.BY, then all formats over it.
  std::mt19937_64 random(fresh_seed());
  for (int round = 0; round < 300; ++round) {
    const int i = static_cast<int>(random() % 200);
    const std::string n = std::to_string(i);
    const std::string text = "SYVAR" + n + "=255\nE0=SYVAR" + std::to_string(8 * i + 3) + ".BL\nE10=SYVAR" +
                             std::to_string(i / 2) + ".IN\nE20=SYVAR" + std::to_string(i / 4) +
                             ".LI\n(DIS,E0,E10,E20)";
    const long long in = i % 2 == 0 ? 255 : -256;
    const long long li = static_cast<std::int32_t>(0xFFu << (8 * (i % 4)));
    const std::string wanted = "E0=1 E10=" + std::to_string(in) + " E20=" + std::to_string(li);
    Interpreter run("nc110", mill(), {}, "p.nc", text, {}, Position{});
    std::string shown;
    const auto error = run_dry(
        run,
        [&](const Command& command) {
          if (const auto* message = std::get_if<Message>(&command.what)) shown = message->text;
          return true;
        },
        100);
    ASSERT_FALSE(error) << error->str(text::Language::english);
    ASSERT_EQ(wanted, shown) << text;
  }
}

}  // namespace
}  // namespace servogate::program::tests
