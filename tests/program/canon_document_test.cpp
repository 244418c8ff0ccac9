// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <fstream>

#include "kernel/program/check/canon.hpp"
#include "tests/places/places.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

/// A sample of docs/canon.md: a fenced block `nc` and the fenced block `json` after it.
struct Sample {
  int line = 0;
  std::string program;
  std::string output;
};

std::vector<Sample> samples_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<Sample> samples;
  std::string* into = nullptr;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line == "```nc") {
      samples.push_back({number, {}, {}});
      into = &samples.back().program;
    } else if (line == "```json") {
      into = samples.empty() ? nullptr : &samples.back().output;
    } else if (line == "```") {
      into = nullptr;
    } else if (into != nullptr) {
      *into += line + "\n";
    }
  }
  return samples;
}

TEST(CanonDocument, shows_what_the_program_really_prints) {
  const auto samples = samples_of(servogate::tests::source_dir() + "/docs/canon.md");
  ASSERT_GE(samples.size(), 5u);
  std::string all;
  for (const Sample& sample : samples) {
    Interpreter run("nc110", mill(), {}, "sample.nc", sample.program, {}, Position{});
    std::string output;
    const auto error = write_canon(run, mill(), [&](std::string_view line) {
      output += std::string(line) + "\n";
      return true;
    });
    EXPECT_FALSE(error) << sample.line;
    EXPECT_EQ(sample.output, output) << "docs/canon.md:" << sample.line;
    all += output;
  }
  for (const char* cmd : {"rapid", "line", "arc", "dwell", "spindle", "tool", "m", "h", "message", "write",
                          "wait", "stop", "end", "process", "in_position", "spindle_mark"})
    EXPECT_NE(std::string::npos, all.find(std::string("{\"cmd\":\"") + cmd + "\""))
        << cmd << " has no sample";
}

}  // namespace
}  // namespace servogate::program::tests
