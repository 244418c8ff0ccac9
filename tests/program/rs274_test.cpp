// SPDX-License-Identifier: Apache-2.0
// Milling programs of the ISO dialect that another interpreter reads, too: LinuxCNC's rs274. What it made of
// them stands in the files (tests/program/sinumerik/rs274), so the comparison needs no LinuxCNC; where there
// is one, the files are compared with it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "kernel/program/check/canon.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"
#include "tests/program/rs274_canon.hpp"

namespace servogate::program::tests {
namespace {

const std::string kFolder = servogate::tests::source_dir() + "/tests/program/sinumerik/rs274";

std::vector<std::string> ours(const CaseFile& c) {
  Interpreter interpreter(c.dialect, c.machine, c.tables, c.name + ".nc", c.program, c.loader(), c.start);
  std::vector<std::string> lines;
  const auto error = write_canon(interpreter, c.machine, [&](std::string_view line) {
    lines.emplace_back(line);
    return true;
  });
  if (error) ADD_FAILURE() << c.path << ": " << error->str(text::Language::english);
  return canon_steps(lines);
}

std::vector<std::string> texts(const std::vector<CaseFile::Line>& lines) {
  std::vector<std::string> all;
  for (const CaseFile::Line& line : lines) all.push_back(line.text);
  return all;
}

/// The first step that differs, as a sentence; empty where there is none.
std::string difference(const std::vector<std::string>& one, const std::vector<std::string>& other) {
  for (std::size_t i = 0; i < std::max(one.size(), other.size()); ++i) {
    const std::string a = i < one.size() ? one[i] : "(nothing)",
                      b = i < other.size() ? other[i] : "(nothing)";
    if (!same_step(a, b))
      return "step " + std::to_string(i + 1) + ": servogate " + a + "\n        rs274 " + b;
  }
  return {};
}

void record(const CaseFile& c, const std::vector<std::string>& steps) {
  std::ifstream in(c.path);
  std::string text(std::istreambuf_iterator<char>(in), {});
  if (const auto at = text.find("[rs274]\n"); at != std::string::npos) text.erase(at);
  text += "[rs274]\n";
  for (const std::string& step : steps) text += step + "\n";
  std::ofstream(c.path) << text;
}

TEST(Rs274, reads_at_least_fifty_programs_as_we_do_or_the_file_says_how_they_differ) {
  int same = 0, different = 0;
  for (const std::string& path : case_paths(kFolder)) {
    const CaseFile c = read_case(path);
    const std::string found = difference(ours(c), texts(c.rs274));
    if (c.differs.empty()) {
      EXPECT_EQ(found, "") << path;
      ++same;
    } else {
      EXPECT_FALSE(c.motions.empty()) << path << ": [motions] has ours";
      EXPECT_NE(found, "") << path << ": there is no difference, [differs] says:\n" << c.differs.front().text;
      ++different;
    }
  }
  std::printf("%d programs alike, %d with a difference that their file names\n", same, different);
  EXPECT_GE(same + different, 50);
}

TEST(Rs274, of_this_computer_makes_of_each_program_what_its_file_says) {
  const std::string rs274 = rs274_program();
  if (rs274.empty()) GTEST_SKIP() << "no rs274 on this computer (Debian: linuxcnc-uspace)";
  for (const std::string& path : case_paths(kFolder)) {
    const CaseFile c = read_case(path);
    std::vector<std::string> steps;
    try {
      steps = rs274_steps(run_rs274(rs274, c));
    } catch (const std::runtime_error& refused) {
      ADD_FAILURE() << path << ": " << refused.what();
      continue;
    }
    if (std::getenv("SERVOGATE_UPDATE") != nullptr)
      record(c, steps);
    else
      EXPECT_EQ(difference(steps, texts(c.rs274)), "") << path;
  }
}

}  // namespace
}  // namespace servogate::program::tests
