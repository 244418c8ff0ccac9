// SPDX-License-Identifier: Apache-2.0
// Own G and M words of a machine file, through the command line, in every language.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using nlohmann::json;

struct Case {
  std::string language, g, m;
  std::string before, behind;  ///< how a parameter stands behind the letter of an axis
  std::string first, last;     ///< lines of a file of this language
};
const Case kCases[] = {
    {"nc110", "G50", "M77", "E", "", "", ""},
    {"fenix", "G151", "M177", "(R", ")", "%\nG90\n", ""},  // G90 beside a motion counts for its block
    {"sinumerik-808d", "G250", "M277", "=R", "", "", "M17\n"},
};

class OwnCodes : public ::testing::TestWithParam<Case> {
 protected:
  /// The example mill in this language with the table `rows`.
  std::string machine(const std::string& rows) {
    std::filesystem::copy_file(source("examples/mill/mill.st"), scratch_.path("mill.st"),
                               std::filesystem::copy_options::overwrite_existing);
    std::string out;
    std::istringstream lines(read_all(mill_file()));
    bool placed = false;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("dialect = ")) line = "dialect = \"" + GetParam().language + "\"";
      if (GetParam().language != "nc110" &&
          (line.starts_with("power_on = ") || line.starts_with("variables = ")))
        continue;
      if (!placed && line.starts_with("[safety]")) {
        out += rows + "\n";
        placed = true;
      }
      out += line + "\n";
    }
    return scratch_.write("machine.toml", out);
  }
  static std::string row(const std::string& code, const std::string& program, const std::string& words) {
    return "[[own_code]]\ncode = \"" + code + "\"\nprogram = \"" + program + "\"\n" +
           (words.empty() ? "" : "words = { " + words + " }\n");
  }
  std::string rows() const {
    return row(GetParam().g, "own.nc", "X = 30, Y = 31") + row(GetParam().m, "grip.nc", "");
  }
  std::vector<json> motions(const Ending& canon) {
    std::vector<json> out;
    std::istringstream lines(canon.out);
    for (std::string line; std::getline(lines, line);)
      if (json j = json::parse(line); j["cmd"] == "rapid") out.push_back(j["to"]);
    return out;
  }

  Scratch scratch_;
};

TEST_P(OwnCodes, call_the_machine_builders_program_with_the_words_of_their_block) {
  const Case& c = GetParam();
  scratch_.write("own.nc",
                 "G0 X" + c.before + "30" + c.behind + " Y" + c.before + "31" + c.behind + "\n" + c.last);
  scratch_.write("grip.nc", "G0 Z-7\n" + c.last);
  const std::string program =
      scratch_.write("part.nc", c.first + "G90 G0 X1\n" + c.g + " X20 Y30\nZ5\n" + c.m + "\nX2\nM2\n");
  const Ending canon = servogate({"canon", machine(rows()), program});
  ASSERT_EQ(canon.code, 0) << canon.err;
  const std::vector<json> to = motions(canon);
  ASSERT_EQ(to.size(), 5u) << canon.out;
  EXPECT_EQ(to[0]["X"], 1.0);
  EXPECT_EQ(to[1]["X"], 20.0);
  EXPECT_EQ(to[1]["Y"], 30.0);
  EXPECT_EQ(to[2]["Z"], 5.0);
  EXPECT_EQ(to[3]["Z"], -7.0);
  EXPECT_EQ(to[4]["X"], 2.0);
  const Ending check = servogate({"check", scratch_.path("machine.toml"), program});
  EXPECT_EQ(check.code, 0) << check.out << check.err;
}

TEST_P(OwnCodes, are_refused_with_words_that_the_table_does_not_name) {
  const Case& c = GetParam();
  scratch_.write("own.nc", "G0 Z1\n" + c.last);
  scratch_.write("grip.nc", "G0 Z1\n" + c.last);
  const std::string program = scratch_.write("part.nc", c.first + "G90 G0 X1\n" + c.g + " X20 Z3\nM2\n");
  const Ending check = servogate({"check", machine(rows()), program});
  EXPECT_EQ(check.code, 1);
  EXPECT_NE((check.out + check.err).find("Z3 in the block of " + c.g), std::string::npos)
      << check.out << check.err;
}

TEST_P(OwnCodes, that_the_language_has_already_are_refused_at_their_place_of_the_machine_file) {
  const std::string taken = machine(row("G1", "own.nc", "X = 30"));
  scratch_.write("own.nc", GetParam().last);
  const Ending check = servogate({"check", taken});
  EXPECT_EQ(check.code, 1);
  EXPECT_NE((check.out + check.err).find("G1 is a word of the language already"), std::string::npos)
      << check.out << check.err;
  EXPECT_NE((check.out + check.err).find("machine.toml:"), std::string::npos);
}

TEST_P(OwnCodes, whose_program_is_missing_are_named_in_the_machine_file) {
  const Ending check = servogate({"check", machine(row(GetParam().g, "nowhere.nc", ""))});
  EXPECT_EQ(check.code, 1);
  EXPECT_NE((check.out + check.err).find("nowhere.nc"), std::string::npos) << check.out << check.err;
}

INSTANTIATE_TEST_SUITE_P(Languages, OwnCodes, ::testing::ValuesIn(kCases),
                         [](const auto& of) { return of.param.language.substr(0, 5); });

}  // namespace
}  // namespace servogate::machine_run
