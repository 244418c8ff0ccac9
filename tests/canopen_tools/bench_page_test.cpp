// SPDX-License-Identifier: Apache-2.0
// Every command of docs/bench.md, with the simulated drive of the page, in granted time.
#include <filesystem>
#include <fstream>

#include "tests/canopen_tools/lockstep_bench.hpp"

namespace servogate::canopen_tools {
namespace {

constexpr std::string_view kBus = "socketcand:127.0.0.1:29536/can0";

/// Lines of the fenced blocks that call the program, without its name; continued ones are one.
std::vector<std::string> commands_of(const std::string& page) {
  std::ifstream in(shell::source(page));
  std::vector<std::string> out;
  bool fenced = false, goes_on = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("```")) {
      fenced = !fenced;
    } else if (fenced && (goes_on || line.starts_with("servogate "))) {
      const bool more = line.ends_with('\\');
      if (more) line.pop_back();
      if (goes_on)
        out.back() += line.substr(line.find_first_not_of(' '));
      else
        out.push_back(line.substr(std::string_view("servogate ").size()));
      goes_on = more;
    }
  }
  return out;
}

class BenchPage : public LockstepBench {};

TEST_F(BenchPage, leads_a_newcomer_to_a_tuned_axis_with_its_report) {
  std::filesystem::create_directory_symlink(shell::source("examples"), path("examples"));
  std::string plant;
  int run = 0;
  for (std::string line : commands_of("docs/bench.md")) {
    if (line.starts_with("can bus ")) continue;
    if (const std::size_t at = line.find("--plant "); at != std::string::npos) {
      plant = line.substr(at + 8);
      continue;
    }
    ++run;
    const std::size_t bus = line.find(kBus);
    if (bus != std::string::npos) line.replace(bus, kBus.size(), "$BUS_OF_DRIVE");
    const Ended ended = bus != std::string::npos ? on_drive(line, plant) : tool(line);
    EXPECT_EQ(ended.code, 0) << line << "\n" << ended.out << ended.err;
  }
  EXPECT_GE(run, 10);
  const auto facts_of = [&](const std::string& folder) {
    return json::parse(desk_.text(folder + "/meta.json"), nullptr, false);
  };
  ASSERT_TRUE(facts_of("tune1").is_object());
  EXPECT_EQ(facts_of("tune1")["kept"], true);
  ASSERT_TRUE(facts_of("axis1").is_object());
  EXPECT_NEAR(facts_of("axis1")["inertia_kg_m2"], 0.002, 0.03 * 0.002);
  for (const char* report : {"axis1/report.html", "tune1/report.html", "step1/report.html", "steps.html"})
    EXPECT_NE(desk_.text(report).find("</html>"), std::string::npos) << report;
}

TEST_F(BenchPage, has_the_same_commands_in_both_languages) {
  EXPECT_EQ(commands_of("docs/ru/bench.md"), commands_of("docs/bench.md"));
}

}  // namespace
}  // namespace servogate::canopen_tools
