// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/check/check.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/faults/texts.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

std::string file_text(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

const std::string kMill = servogate::tests::source_dir() + "/examples/mill/";

std::optional<std::string> from_mill(std::string_view name) {
  std::string text = file_text(kMill + std::string(name) + ".nc");
  if (text.empty()) return std::nullopt;
  return text;
}

CheckReport check(const std::string& text, const MachineModel& machine = mill(),
                  const ProgramLoader& loader = {}) {
  return check_program("nc110", machine, {}, "p.nc", text, loader, Position{});
}

TEST(CheckProgram, finds_nothing_wrong_with_the_example) {
  const std::string text = file_text(kMill + "bracket.nc");
  const CheckReport report = check_program("nc110", mill(), {}, "bracket.nc", text, from_mill, Position{});
  for (const auto& finding : report.findings) ADD_FAILURE() << finding.str(text::Language::english);
  EXPECT_TRUE(report.good());
  EXPECT_GE(report.blocks, 150);
  EXPECT_EQ(3u, report.tools.size());
  for (const auto& extent : report.extents) {
    EXPECT_TRUE(extent.moved);
    EXPECT_EQ(0, extent.outside_line);
  }
  EXPECT_EQ(23, report.functions) << "M, S and T that the PLC answers";
  EXPECT_DOUBLE_EQ(0.5, report.dwell_seconds);
}

TEST(CheckProgram, example_uses_what_it_promises_to_show) {
  std::set<std::string> seen;
  Interpreter interpreter("nc110", mill(), {}, "bracket.nc", file_text(kMill + "bracket.nc"), from_mill,
                          Position{});
  const std::vector<std::string> letters = {"X", "Y", "Z"};
  bool helix = false;
  const auto error = run_dry(
      interpreter,
      [&](const Command& command) {
        const std::string json = to_json(command, letters, interpreter.files());
        seen.insert(json.substr(8, json.find('"', 8) - 8));
        if (const auto* arc = std::get_if<Arc>(&command.what))
          helix = helix || std::abs(arc->sweep_deg) > 720.0;
        return true;
      },
      kDryRunBlocks);
  EXPECT_FALSE(error);
  for (const char* cmd :
       {"rapid", "line", "arc", "dwell", "spindle", "tool", "m", "message", "write", "wait", "end"})
    EXPECT_TRUE(seen.contains(cmd)) << cmd;
  EXPECT_TRUE(helix);
}

TEST(CheckProgram, adds_up_path_and_dwells) {
  // T-LIN-02; T-HEL-01.
  EXPECT_NEAR(85.440, check("G0 X10 Y10\nG1 X90 Y40 F200").path_mm, 1e-3);
  EXPECT_NEAR(339.560, check("G0 X20\nG3 X-6.1803 Y-19.0211 Z-13.5 I0 J0 K5 F500").path_mm, 1e-3);
  EXPECT_NEAR(251.526, check("G0 X20\nG3 I0 J0 Z-10 K5 F500").path_mm, 1e-3);
  EXPECT_NEAR(31.559, check("G0 X20\nG3 X0 Y20 Z-3 I J F500").path_mm, 1e-3);
  EXPECT_NEAR(3.5, check("TMR=1.5\nG4\n(DLY,2)").dwell_seconds, 1e-12);
}

TEST(CheckProgram, tells_what_who_sees_the_commands_objects_to_at_its_place_and_goes_on) {
  int seen = 0;
  const auto objects = [&](const Command& command) -> std::optional<text::Finding> {
    ++seen;
    if (command.line != 2) return std::nullopt;
    text::Finding finding;
    finding.entry = &entry(Fault::arc_zero);
    return finding;
  };
  const CheckReport report =
      check_program("nc110", mill(), {}, "p.nc", "G0 X1\n  G0 X2\nX3", {}, Position{}, objects);
  EXPECT_EQ(4, seen) << "three motions and the end";
  EXPECT_FALSE(report.finished);
  ASSERT_EQ(1u, report.findings.size());
  EXPECT_EQ(0u, report.findings[0].str().find("p.nc:2:3: error: "));
}

TEST(CheckProgram, leaves_errors_behind_a_read_signal_to_the_machine) {
  const auto by_machine = [](const std::string& text) { return check(text).by_machine; };
  EXPECT_TRUE(by_machine("G0 X301").empty());
  EXPECT_TRUE(by_machine("G0 X301\nE1=SK3").empty()) << "the error comes first";
  EXPECT_TRUE(by_machine("SK3=1\nG0 X301").empty()) << "a write is the program's own";
  EXPECT_EQ(std::vector<std::size_t>{0}, by_machine("E1=SK3\nG0 X301"));
  EXPECT_EQ(std::vector<std::size_t>{1}, by_machine("G0 X301\nE1=SK3\nG0 Y301")) << "of Y alone";
  EXPECT_EQ(std::vector<std::size_t>{0}, by_machine("(BEQ,SA3,1,A)\n(UAO,7)\n\"A\""));
  EXPECT_TRUE(by_machine("\"A\"(BEQ,SA3,0,A)").empty()) << "a program without end is a warning anyway";
}

TEST(CheckProgram, goes_on_after_a_motion_out_of_the_travel_and_names_the_first_line_of_each_axis) {
  const CheckReport report = check("G0 X10\nX301\nX500 Y-400\nX0");
  ASSERT_EQ(2u, report.findings.size());
  EXPECT_EQ("p.nc:2:1: error: X would go to 301, the travel ends at 300 [P701]",
            report.findings[0].str(text::Language::english));
  EXPECT_EQ("p.nc:3:6: error: Y would go to -400, the travel ends at -300 [P701]",
            report.findings[1].str(text::Language::english));
  EXPECT_EQ(2, report.extents[0].outside_line);
  EXPECT_EQ(3, report.extents[1].outside_line);
  EXPECT_EQ(0, report.extents[2].outside_line);
  EXPECT_DOUBLE_EQ(500.0, report.extents[0].max);
  EXPECT_DOUBLE_EQ(-400.0, report.extents[1].min);
  EXPECT_FALSE(report.extents[2].moved);
  EXPECT_TRUE(report.finished);
  EXPECT_FALSE(report.good());
}

TEST(CheckProgram, tells_a_missing_feed_once_and_in_how_many_more_blocks_and_all_other_errors) {
  std::string text = "G1 X1\n";
  for (int n = 2; n <= 1500; ++n) text += "X" + std::to_string(n % 100) + "\n";
  const CheckReport report = check(text + "(UAO,7)\nX5 F100\nX6\nX301\n");
  ASSERT_EQ(4u, report.findings.size());
  const auto said = [&](std::size_t i) { return report.findings[i].str(text::Language::english); };
  EXPECT_EQ("p.nc:1504:1: error: X would go to 301, the travel ends at 300 [P701]", said(0));
  EXPECT_EQ("p.nc:1:1: error: no feed: F was never programmed [P703]", said(1));
  EXPECT_EQ("p.nc:2:1: warning: more blocks without a feed: 1499, the last one in line 1500 [P726]", said(2));
  EXPECT_EQ(0u, said(3).find("p.nc:1501:")) << said(3);
  EXPECT_FALSE(report.good());
}

TEST(CheckProgram, tells_a_single_block_without_feed_alone) {
  const CheckReport once = check("G1 X1\nX2 F100\nX3\nM30\n");
  ASSERT_EQ(1u, once.findings.size());
  EXPECT_EQ("p.nc:1:1: error: no feed: F was never programmed [P703]",
            once.findings[0].str(text::Language::english));
  const CheckReport loop = check("(RPT,99)\nG1 X1\nX2\n(ERP)\nX5\nM30\n");
  ASSERT_EQ(2u, loop.findings.size()) << "a block of a loop is one block";
  EXPECT_EQ("p.nc:3:1: warning: more blocks without a feed: 2, the last one in line 5 [P726]",
            loop.findings[1].str(text::Language::english));
}

TEST(CheckProgram, names_places_of_a_diameter_axis_as_diameters) {
  MachineModel lathe = mill();
  lathe.axes[0].diameter = true;
  EXPECT_EQ("p.nc:1:4: error: X (diameter) would go to 602, the travel ends at 600 [P701]",
            check("G0 X602", lathe).findings.at(0).str(text::Language::english));
  EXPECT_EQ("p.nc:1:4: error: X (диаметр) вышла бы на 602, ход кончается на 600 [P701]",
            check("G0 X602", lathe).findings.at(0).str(text::Language::russian));
  EXPECT_EQ("p.nc:2:4: error: X (diameter) would go to 50, the working field ends at 40 (DLO) [P702]",
            check("(DLO,X-40 X40)\nG0 X50", lathe).findings.at(0).str(text::Language::english));
}

TEST(CheckProgram, takes_the_line_ends_and_end_marks_of_old_computers) {
  for (const char* text :
       {"G0 X1\nX301\n\x1A", "G0 X1\r\nX301\r\n\x1A\x1A\x1A", "G0 X1\r\r\nX301\r\r\n\x1A\r\n"}) {
    const CheckReport report = check(text);
    ASSERT_EQ(1u, report.findings.size());
    EXPECT_EQ(0u, report.findings[0].str().find("p.nc:2:1: error: X would go to 301"));
    EXPECT_EQ(2, report.blocks);
  }
  const CheckReport filled = check(std::string("G0 X1\x1A\0\0\0", 9));
  EXPECT_TRUE(filled.findings.empty());
  const CheckReport tape = check("G0 X1\rX2\r(UAO,7)\r\x1A");
  ASSERT_EQ(2u, tape.findings.size());
  EXPECT_EQ("p.nc:1:6: warning: this line ends with CR alone; such ends are taken as line ends [P113]",
            tape.findings[0].str(text::Language::english));
  EXPECT_EQ(0u, tape.findings[1].str().find("p.nc:3:"));
  const CheckReport inside = check("G0 X1\x1A\nX2\n");
  ASSERT_FALSE(inside.findings.empty());
  EXPECT_EQ("P201", inside.findings[0].entry->id) << "in the middle it ends nothing";
}

TEST(CheckProgram, counts_arcs_with_their_bulge) {
  const CheckReport report = check("G0 X10\nG3 X-10 Y0 I0 J0 F100");
  EXPECT_NEAR(10.0, report.extents[1].max, 1e-9);
  EXPECT_NEAR(0.0, report.extents[1].min, 1e-9);
  const CheckReport full = check("G0 X10\nG2 I0 J0 F100");
  EXPECT_NEAR(-10.0, full.extents[0].min, 1e-9);
  EXPECT_NEAR(-10.0, full.extents[1].min, 1e-9);
}

TEST(CheckProgram, stops_a_program_without_end_after_a_million_blocks) {
  const CheckReport moving = check("\"A\" G0 X1\n(BNC,A)");
  ASSERT_EQ(1u, moving.findings.size());
  EXPECT_EQ("P514", moving.findings[0].entry->id);
  EXPECT_EQ(0u, moving.findings[0].str().find("p.nc:1:5: "));
  EXPECT_EQ(text::Severity::warning, moving.findings[0].severity) << "it may be meant to run until stopped";
  EXPECT_GE(moving.executed, kDryRunBlocks);
  const CheckReport still = check("\"A\"\n(BNC,A)");
  ASSERT_EQ(1u, still.findings.size());
  EXPECT_EQ("P513", still.findings[0].entry->id);
  EXPECT_EQ(0u, still.findings[0].str().find("p.nc:2:1: "));
  const CheckReport polling = check("\"A\"(BEQ,SA3,0,A)");
  ASSERT_EQ(1u, polling.findings.size());
  EXPECT_EQ("P514", polling.findings[0].entry->id);
}

TEST(CheckProgram, finds_all_of_a_file_and_of_its_subprograms) {
  const auto loader = [](std::string_view name) -> std::optional<std::string> {
    if (name == "SUB") return "G0 X1\nG99\n";
    return std::nullopt;
  };
  const CheckReport report = check("G0 XX\n(CLS,SUB)\nJOG=1\nE30=SIN(\n(BNC,NO)", mill(), loader);
  std::vector<std::string> ids;
  for (const auto& finding : report.findings) ids.emplace_back(finding.entry->id);
  EXPECT_EQ((std::vector<std::string>{"P204", "P901", "P301", "P501", "P211"}), ids);
  EXPECT_EQ("SUB", report.findings.back().file);
  EXPECT_EQ(2, report.findings.back().line);
}

TEST(CheckProgram, names_a_subprogram_by_the_path_at_which_people_open_it) {
  const auto loader = [](std::string_view name) -> std::optional<LoadedProgram> {
    if (name == "SUB") return LoadedProgram{"G0 X1\n  G1 Y301 F100\n", "parts/sub.nc"};
    if (name == "BAD") return LoadedProgram{"G0 X1\nX2 G99\n", "parts/bad.nc"};
    return std::nullopt;
  };
  const CheckReport outside = check("G0 X1\n(CLS,SUB)", mill(), loader);
  ASSERT_EQ(1u, outside.findings.size());
  EXPECT_EQ("parts/sub.nc:2:6: error: Y would go to 301, the travel ends at 300 [P701]",
            outside.findings[0].str(text::Language::english));
  const CheckReport wrong = check("(CLS,BAD)", mill(), loader);
  ASSERT_EQ(1u, wrong.findings.size());
  EXPECT_EQ(0u, wrong.findings[0].str().find("parts/bad.nc:2:4: error: "));
  EXPECT_EQ((std::vector<std::string>{"p.nc", "BAD"}), wrong.files)
      << "canon's `file` is the name of the call";
}

TEST(CheckProgram, names_ten_thousand_findings_of_a_file_and_says_that_there_are_more) {
  std::string text;
  for (int i = 0; i < 10'500; ++i) text += "G0 X1 ; why\n";
  const CheckReport commented = check(text);
  EXPECT_TRUE(commented.good()) << "warnings, however many, keep nothing from running";
  ASSERT_EQ(10'001u, commented.findings.size());
  EXPECT_EQ("p.nc:10001:7: warning: from here on 500 more warnings are not named [P907]",
            commented.findings.back().str(text::Language::english));
  text += "G0 !\n";
  const CheckReport wrong = check(text);
  ASSERT_EQ(10'002u, wrong.findings.size()) << "an error behind them is named";
  EXPECT_EQ("p.nc:10501:4: error: the character ! has no meaning here [P201]",
            wrong.findings.back().str(text::Language::english));
}

std::vector<std::string> errors_of(const CheckReport& report) {
  std::vector<std::string> out;
  for (const text::Finding& f : report.findings)
    if (f.severity == text::Severity::error)
      out.push_back(std::to_string(f.line) + " " + std::string(f.entry->id));
  return out;
}

TEST(CheckProgram, finds_every_error_of_the_run_not_only_the_first) {
  using Errors = std::vector<std::string>;
  EXPECT_EQ((Errors{"2 P706", "4 P706", "5 P801"}),
            errors_of(check("G1 X10 F100\nG2 X20 I0 J3\nG1 X5\nG2 X40 I0 J3\nT1 G1 X10\nX9\nM30")));
  EXPECT_EQ((Errors{"2 P707", "4 P707", "5 P305"}),
            errors_of(check("G1 X10 F100\nG2 X20\nG1 X5\nG2 X40\nE1=1/0\nM30")));
  EXPECT_FALSE(check("G1 X10 F100\nG2 X20\nM30").finished);
}

TEST(CheckProgram, finds_errors_of_the_run_behind_those_of_reading) {
  const std::vector<std::string> found = errors_of(check("G1 X10 F100\nG0 !\nE1=1/0\nM30"));
  EXPECT_EQ(2u, found.size());
}

TEST(CheckProgram, names_no_error_that_only_follows_from_a_block_that_was_passed_over) {
  // Both arcs are right where the block before them has brought the axes there.
  EXPECT_EQ(1u,
            errors_of(check("G1 X0 Y0 F100\nG1 X10 Y0 T1\nG3 X0 Y10 I0 J0\nG3 X-10 Y0 I0 J0\nM30")).size());
}

TEST(CheckProgram, names_an_error_in_a_loop_once_and_ends) {
  EXPECT_EQ(1u, errors_of(check("(RPT,50)\nE1=1/0\n(ERP)\nM30")).size());
  EXPECT_EQ(1u, errors_of(check("(RPT,5)\nG0 X1\nM30")).size()) << "nothing follows the end of the file";
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "E1=1/0\n";
  EXPECT_EQ(100u, errors_of(check(many)).size());
}

TEST(CheckProgram, checks_a_program_of_more_blocks_than_a_loop_may_run) {
  std::string text;
  for (long long i = 0; i < kDryRunBlocks + 10; ++i) text += "X1\n";
  const CheckReport report = check(text);
  EXPECT_TRUE(report.good());
  EXPECT_EQ(kDryRunBlocks + 10, report.executed);
}

TEST(CheckProgram, lists_tools_once_with_their_calls) {
  const CheckReport report = check("T1.1 M6\nT2.2 M6\nT1.1 M6\nT1.2 M6");
  ASSERT_EQ(3u, report.tools.size());
  EXPECT_EQ(2, report.tools[0].calls);
  EXPECT_EQ(1, report.tools[0].line);
  EXPECT_EQ(2, report.tools[2].corrector);
}

}  // namespace
}  // namespace servogate::program::tests
