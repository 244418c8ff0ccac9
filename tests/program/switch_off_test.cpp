// SPDX-License-Identifier: Apache-2.0
// What a row of the NC-110 checklist names can be switched off in the language's tables; then a case that
// proves the row has to come out otherwise.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/fenix/fenix.hpp"
#include "kernel/program/languages/nc110/nc110.hpp"
#include "kernel/program/languages/sinumerik/iso/iso.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

constexpr int kMostSteps = 20'000;

/// The language without one of its words: G41, M5, u, TMR or SIN.
class Language {
 public:
  Language(const Dialect& base, const std::string& without)
      : dialect_(base),
        g_(dialect_.g.begin(), dialect_.g.end()),
        m_(dialect_.m.begin(), dialect_.m.end()),
        variables_(dialect_.variables.begin(), dialect_.variables.end()) {
    const bool number = without.size() > 1 && without[1] >= '0' && without[1] <= '9';
    for (GRule& rule : g_)
      if (number && without == "G" + std::to_string(rule.number)) rule.function = Function::later;
    for (MRule& rule : m_)
      if (number && without == "M" + std::to_string(rule.code)) rule.action = MAction::later;
    for (VariableRule& rule : variables_)
      if (rule.name == without) rule.set = nullptr;
    for (const FunctionRow& row : dialect_.expressions.functions)
      if (row.name != without) functions_.push_back(row);
    if (without.size() == 1) dialect_.letters[static_cast<std::size_t>(without[0])] = {};
    dialect_.g = g_;
    dialect_.m = m_;
    dialect_.variables = variables_;
    dialect_.expressions.functions = functions_;
  }
  const Dialect& dialect() const { return dialect_; }

 private:
  Dialect dialect_;
  std::vector<GRule> g_;
  std::vector<MRule> m_;
  std::vector<VariableRule> variables_;
  std::vector<FunctionRow> functions_;
};

/// All that a case gives: commands, the error, warnings.
std::string outcome(const CaseFile& c, const Dialect& dialect) {
  const ProgramLoader loader = [&c](std::string_view name) -> std::optional<LoadedProgram> {
    const auto at = c.subprograms.find(std::string(name));
    if (at == c.subprograms.end()) return std::nullopt;
    return LoadedProgram{at->second};
  };
  Execution run(dialect, c.machine, c.tables, c.name, c.program, loader, c.start, 0);
  std::vector<std::string> letters;
  for (const auto& axis : c.machine.axes) letters.push_back(axis.letter);
  std::string out;
  const image::Packets packets;
  for (int step = 0; step < kMostSteps; ++step) {
    const Step next = run.next(packets, true);
    if (const auto* error = std::get_if<Error>(&next)) {
      out += error->finding.str() + "\n";
      break;
    }
    if (std::holds_alternative<NeedsSync>(next)) continue;
    const auto& command = std::get<Command>(next);
    out += to_json(command, letters, run.flow().names()) + "\n";
    if (std::holds_alternative<End>(command.what)) break;
  }
  for (const auto& warning : run.warnings()) out += warning.str() + "\n";
  return out;
}

struct Switch {
  const char* row;
  const char* word;
};
constexpr Switch kSwitches[] = {
    {"A98", "G0"},   {"A101", "G1"},  {"A108", "G2"},  {"A112", "G3"},  {"A189", "G4"},  {"A106", "G6"},
    {"A190", "G9"},  {"A115", "G18"}, {"B13", "G20"},  {"A147", "G21"}, {"A138", "G28"}, {"A139", "G29"},
    {"A120", "G33"}, {"A127", "G34"}, {"A151", "G40"}, {"A149", "G41"}, {"A150", "G42"}, {"A162", "G70"},
    {"A191", "G72"}, {"A192", "G73"}, {"A193", "G74"}, {"A188", "G79"}, {"A169", "G81"}, {"A170", "G82"},
    {"A171", "G83"}, {"A174", "G84"}, {"A181", "G85"}, {"A182", "G86"}, {"A183", "G89"}, {"A187", "G91"},
    {"A194", "G93"}, {"A197", "G96"}, {"A71", "M0"},   {"A72", "M1"},   {"A73", "M2"},   {"A75", "M4"},
    {"A76", "M5"},   {"A84", "M13"},  {"A86", "M19"},  {"A87", "M30"},  {"A200", "u"},   {"A201", "v"},
    {"A202", "w"},   {"A160", "b"},   {"A158", "r"},   {"A100", "p"},   {"A68", "t"},    {"A114", "R"},
    {"A117", "K"},   {"B130", "TMR"}, {"B131", "UOV"}, {"B133", "ERF"}, {"B134", "MCD"}, {"B135", "USB"},
    {"B138", "USO"}, {"B136", "UVR"}, {"B142", "RMS"}, {"B148", "TIM"}, {"B149", "TOT"}, {"B97", "RTA"},
    {"B33", "SIN"},  {"B34", "COS"},  {"B35", "TAN"},  {"B36", "ARS"},  {"B37", "ARC"},  {"B38", "ART"},
    {"B39", "SQR"},  {"B40", "ABS"},  {"B41", "INT"},  {"B42", "NEG"},  {"B43", "MOD"},  {"B12", "-"},
    {"A199", "G35"},
};

constexpr Switch kFenixSwitches[] = {
    {"63", "G0"},    {"64", "G1"},    {"66", "G2"},    {"68", "G3"},    {"71", "G4"},    {"72", "G9"},
    {"73", "G26"},   {"74", "G27"},   {"75", "G30"},   {"84", "G31"},   {"85", "G32"},   {"78", "G45"},
    {"79", "G46"},   {"80", "G50"},   {"81", "G54"},   {"82", "G510"},  {"90", "G67"},   {"91", "G68"},
    {"120", "G70"},  {"121", "G71"},  {"122", "G72"},  {"123", "G73"},  {"124", "G74"},  {"125", "G75"},
    {"126", "G77"},  {"127", "G78"},  {"130", "G81"},  {"131", "G810"}, {"132", "G811"}, {"133", "G812"},
    {"134", "G820"}, {"135", "G821"}, {"136", "G822"}, {"137", "G823"}, {"138", "G824"}, {"139", "G825"},
    {"140", "G826"}, {"141", "G851"}, {"142", "G852"}, {"143", "G853"}, {"144", "G855"}, {"92", "G90"},
    {"93", "G91"},   {"94", "G94"},   {"96", "G96"},   {"97", "G97"},   {"119", "G15"},  {"99", "M0"},
    {"100", "M2"},   {"101", "M30"},  {"102", "M3"},   {"103", "M4"},   {"104", "M5"},   {"108", "M10"},
    {"109", "M17"},  {"110", "M19"},  {"111", "M20"},  {"26", "SIN"},   {"27", "COS"},   {"29", "ASIN"},
    {"30", "ACOS"},  {"31", "ATAN"},  {"32", "LN"},    {"33", "LG"},    {"34", "PW"},    {"36", "R"},
    {"59", "L"},     {"61", "H"},     {"53", "~"},     {"52", "$"},
};

/// Of the ISO dialect as milling has it; its cases begin with G291.
constexpr Switch kIsoSwitches[] = {
    {"41", "G0"},   {"43", "G1"},   {"44", "G2"},   {"49", "G3"},   {"116", "G4"},  {"155", "G9"},
    {"156", "G61"}, {"59", "G28"},  {"62", "G27"},  {"63", "G30"},  {"91", "G53"},  {"92", "G92"},
    {"94", "G54"},  {"97", "G52"},  {"101", "G68"}, {"109", "G51"}, {"117", "G16"}, {"107", "G20"},
    {"125", "G43"}, {"126", "G44"}, {"128", "G41"}, {"129", "G42"}, {"136", "G10"}, {"235", "G81"},
    {"236", "G82"}, {"237", "G83"}, {"231", "G73"}, {"233", "G76"}, {"240", "G85"}, {"241", "G86"},
    {"242", "G87"}, {"243", "G89"}, {"180", "G65"}, {"182", "G66"}, {"147", "M0"},  {"149", "M30"},
    {"142", "M19"}, {"173", "G31"}, {"23", "G93"},  {"24", "G95"},  {"106", "G91"}, {"238", "G84"},
    {"158", "G63"}, {"164", "G60"},
};

void judge(const Dialect& dialect, const std::string& folder, std::span<const Switch> switches) {
  std::map<std::string, std::vector<CaseFile>> cases;
  for (const std::string& path : case_paths(servogate::tests::source_dir() + folder)) {
    const CaseFile c = read_case(path);
    for (const std::string& row : c.rows) cases[row].push_back(c);
  }
  const Language whole(dialect, "");
  for (const Switch& off : switches) {
    const Language language(dialect, off.word);
    bool seen = false;
    for (const CaseFile& c : cases[off.row])
      seen = seen || outcome(c, whole.dialect()) != outcome(c, language.dialect());
    EXPECT_TRUE(seen) << "no case of " << off.row << " sees that " << off.word << " is off";
  }
}

TEST(SwitchedOff, a_word_of_the_language_changes_the_outcome_of_a_case_that_proves_its_row) {
  judge(nc110::dialect(), "/tests/program/nc110", kSwitches);
}

/// A case of turning, or of the Siemens mode, is no other without a word of milling.
TEST(SwitchedOff, a_word_of_the_ISO_dialect_changes_the_outcome_of_a_case_that_proves_its_row) {
  MachineModel mill;
  mill.kind = MachineModel::Kind::milling;
  judge(sinumerik::iso::dialect(mill), "/tests/program/sinumerik", kIsoSwitches);
}

TEST(SwitchedOff, a_word_of_Fenix_changes_the_outcome_of_a_case_that_proves_its_row) {
  judge(fenix::dialect(), "/tests/program/fenix", kFenixSwitches);
}

}  // namespace
}  // namespace servogate::program::tests
