// SPDX-License-Identifier: Apache-2.0
// How conditions are judged, on the example mill.
#include <gtest/gtest.h>

#include <fstream>

#include "bench/scenario/reading/read_scenario.hpp"
#include "gateway/command/scenario/one_run.hpp"
#include "tests/places/places.hpp"

namespace servogate::gateway::command {
namespace {

using scenario::Outcome;
using Status = Outcome::Status;

const std::string kHead = "schema = 1\ntitle = \"t\"\nmachine = \"" + tests::source_dir() +
                          "/examples/mill/machine.toml\"\n[[given]]\ndo = \"ready\"\n";

Outcome run(const std::string& steps, const Outputs& outputs = {}) {
  std::vector<text::Finding> findings;
  const auto scenarios =
      scenario::read_scenarios(testing::TempDir() + "/a.scenario.toml", kHead + steps, 1, findings);
  for (const text::Finding& f : findings) ADD_FAILURE() << f.str();
  if (scenarios.empty()) return {};
  Outcome outcome = run_one(scenarios.front(), {}, outputs);
  outcome.message = text::in_language(outcome.message);
  for (const text::Finding& f : outcome.findings) outcome.message += f.str() + "\n";
  return outcome;
}

void passes(const std::string& steps) {
  const Outcome o = run(steps);
  EXPECT_EQ(o.status, Status::passed) << steps << o.message;
}
void fails(const std::string& steps, const std::string& words) {
  const Outcome o = run(steps);
  EXPECT_EQ(o.status, Status::failed) << steps;
  EXPECT_NE(o.message.find(words), std::string::npos) << o.message;
}

const std::string kJog = "[[step]]\ndo = \"jog X +5 mm\"\n";
std::string within(const std::string& condition, const char* time = "3 s") {
  return "[[step]]\nexpect = " + condition + "\nwithin = \"" + time + "\"\n";
}

TEST(Conditions, an_order_is_kept_or_broken) {
  const std::string one = "{signal = \"X.actual\", above = \"1 mm\"}",
                    three = "{signal = \"X.actual\", above = \"3 mm\"}";
  passes(kJog + within("{order = [" + one + ", " + three + "]}"));
  fails(kJog + within("{order = [" + three + ", " + one + "]}"),
        "X.actual > 1 mm came before X.actual > 3 mm");
}

TEST(Conditions, an_edge_counts_from_where_the_watch_begins) {
  passes(kJog + within("{signal = \"X.actual\", edge = \"rising\"}") +
         within("{signal = \"X.moving\", edge = \"falling\"}"));
  fails(within("{signal = \"X.homed\", edge = \"rising\"}", "100 ms"),
        "expected X.homed ↑ within 100 ms, got X.homed = on");
}

TEST(Conditions, a_way_to_standstill_is_limited) {
  passes(kJog + "[[step]]\ndo = \"stop\"\n" + within("{standstill = \"X\", distance = \"2 mm\"}"));
  fails(kJog + within("{standstill = \"X\", distance = \"2 mm\"}"), "X has moved 2.0");
}

TEST(Conditions, units_are_those_of_the_signal) {
  passes(kJog + within("{signal = \"X.velocity\", above = \"0.6 m/min\"}"));
  passes(
      "[[step]]\ndo = \"override 80 %\"\n[[step]]\nexpect = {signal = \"NC.override\", equals = \"80 %\"}\n");
  passes("[[step]]\nexpect = {signal = \"NC.state\", equals = \"idle\"}\n");
  passes("[[step]]\nexpect = {signal = \"X.actual\", between = [\"-0.1 mm\", \"100 µm\"]}\n");
}

TEST(Conditions, variables_of_the_plc_are_seen) {
  passes("[[step]]\ndo = \"set door_closed off\"\n" +
         within("{signal = \"Mill.guard.permits\", equals = 0}", "200 ms"));
}

TEST(Conditions, a_place_beside_the_path_is_noticed) {
  const std::string contour =
      "[[step]]\ndo = \"mdi G1 X50 Y30 F3000\"\n[[step]]\nafter = {signal = \"X.velocity\", above = \"20 "
      "mm/s\"}\nexpect = {path_deviation = \"0.2 mm\"}\nalways = \"600 ms\"\n";
  passes(contour + "[[step]]\nafter = \"600 ms\"\nexpect = {no_alarm = true}\n");
  fails(contour + "[[step]]\nafter = \"50 ms\"\nfault = {device = \"can.x\", kind = \"torque_off\"}\n",
        "expected path_deviation ≤ 0.2 mm for 600 ms");
}

TEST(Conditions, a_reference_is_followed_in_time) {
  const std::string trace = testing::TempDir() + "/reference.csv";
  const std::string steps = kJog + "[[step]]\nafter = \"1 s\"\nexpect = {no_alarm = true}\n";
  const Outcome first = run(steps, {.trace = trace, .report = {}, .html = {}});
  ASSERT_EQ(first.status, Status::passed) << first.message;
  // The same motion once more begins at the same machine time: where the trace leaves its first place.
  std::ifstream file(trace);
  std::string line;
  std::getline(file, line);
  double begins = 0.0;
  for (std::string x; std::getline(file, line) && begins == 0.0;)
    if (std::stod(line.substr(line.find(',', line.find(',', line.find(',') + 1) + 1) + 1)) > 1.0)
      begins = std::stod(line);
  ASSERT_GT(begins, 0.0);
  const auto against = [&](const char* offset) {
    return kJog +
           "[[step]]\nafter = {signal = \"X.command\", above = 1}\nexpect = {reference = \"reference.csv\", "
           "signals = [\"X.cmd\", " +
           "\"X.act\"], tolerance = 0.000001, from = \"" + text::number(begins + std::stod(offset), 6) +
           " s\"}\nalways = \"500 ms\"\n";
  };
  passes(against("0"));
  fails(against("0.01"), "expected reference reference.csv");
}

}  // namespace
}  // namespace servogate::gateway::command
