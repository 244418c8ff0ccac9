// SPDX-License-Identifier: Apache-2.0
// Scenarios run on the example mill in this process.
#include <gtest/gtest.h>

#include "bench/scenario/reading/read_scenario.hpp"
#include "gateway/command/scenario/one_run.hpp"
#include "gateway/command/scenario/results.hpp"
#include "gateway/command/scenario/shrink.hpp"
#include "tests/places/places.hpp"

namespace servogate::gateway::command {
namespace {

using scenario::Outcome;
using Status = Outcome::Status;

const std::string kHead =
    "schema = 1\ntitle = \"t\"\nmachine = \"" + tests::source_dir() + "/examples/mill/machine.toml\"\n";
constexpr const char* kReady = "[[given]]\ndo = \"ready\"\n";

scenario::Scenario read(const std::string& text, std::uint64_t seed = 1) {
  std::vector<text::Finding> findings;
  auto scenarios = scenario::read_scenarios(tests::source_dir() + "/a.scenario.toml", text, seed, findings);
  for (const text::Finding& f : findings) ADD_FAILURE() << f.str();
  return scenarios.empty() ? scenario::Scenario{} : std::move(scenarios.front());
}

Outcome run(const std::string& text, const TestOptions& options = {}) {
  const scenario::Scenario s = read(text);
  Outcome outcome = run_one(s, options);
  outcome.message = text::in_language(outcome.message);
  return outcome;
}

TEST(ScenarioRun, passes_when_what_is_expected_happens) {
  const Outcome o = run(kHead + kReady + R"(
[[step]]
do = "jog X +5 mm"
wait = true
[[step]]
expect = {signal = "X.actual", equals = "5 mm", tolerance = "0.01 mm"}
)");
  EXPECT_EQ(o.status, Status::passed) << o.message;
  EXPECT_GT(o.virtual_s, 3.0);
}

TEST(ScenarioRun, says_what_was_expected_and_what_there_was) {
  const std::string text = kHead + kReady + R"(
[[step]]
do = "jog X +5 mm"
[[step]]
expect = {signal = "X.actual", above = "6 mm"}
within = "4 s"
)";
  const Outcome o = run(text);
  EXPECT_EQ(o.status, Status::failed);
  EXPECT_TRUE(o.message.starts_with("expected X.actual > 6 mm within 4 s, got X.actual = ")) << o.message;
  EXPECT_NE(o.diagram.find("X.actual [mm]"), std::string::npos) << o.diagram;
  EXPECT_EQ(o.at.line, 9);
  // The same once more: to the last digit.
  const Outcome again = run(text);
  EXPECT_EQ(o.message, again.message);
  EXPECT_EQ(o.diagram, again.diagram);
  EXPECT_EQ(o.virtual_s, again.virtual_s);
}

TEST(ScenarioRun, a_refusal_fails_unless_it_is_expected) {
  const std::string start = "[[step]]\ndo = \"start\"\n", calm = "[[step]]\nexpect = {no_alarm = true}\n";
  const Outcome refused = run(kHead + start + calm);
  EXPECT_EQ(refused.status, Status::failed);
  EXPECT_TRUE(refused.message.starts_with("expected `start` to be accepted")) << refused.message;
  EXPECT_EQ(run(kHead + start + "refused = true\n" + calm).status, Status::passed);
  const Outcome other = run(kHead + start + "refused = \"gate.no_such_reason\"\n" + calm);
  EXPECT_EQ(other.status, Status::failed);
}

TEST(ScenarioRun, what_must_always_hold_is_watched_while_steps_go_on) {
  const Outcome o = run(kHead + kReady + R"(
[[step]]
never = {signal = "X.actual", above = "3 mm"}
always = true
[[step]]
do = "jog X +5 mm"
wait = true
)");
  EXPECT_EQ(o.status, Status::failed);
  EXPECT_TRUE(o.message.starts_with("expected never X.actual > 3 mm, got X.actual = 3.")) << o.message;
}

TEST(ScenarioRun, a_button_that_is_held_jogs_until_it_is_let_go_or_its_hand_is_gone) {
  for (const char* const end : {"jog_stop X", "fall_silent"}) {
    const Outcome o = run(kHead + kReady + R"(
[[step]]
do = "jog X +"
[[step]]
after = "1 s"
expect = {signal = "X.moving", equals = true}
[[step]]
do = ")" + end + R"("
[[step]]
expect = {standstill = "X", distance = "20 mm"}
within = "1 s"
[[step]]
expect = {signal = "X.jog_end", equals = ")" +
                          (std::string(end) == "fall_silent" ? "silent" : "asked") + R"("}
)");
    EXPECT_EQ(o.status, Status::passed) << end << ": " << o.message;
  }
}

TEST(ScenarioRun, what_the_machine_does_not_have_is_refused_with_its_place) {
  const Outcome o = run(kHead + R"(
[[step]]
do = "jog Q +5 mm"
[[step]]
expect = {signal = "nowhere", equals = 1}
[[step]]
fault = {device = "can.q", kind = "silent"}
[[step]]
expect = {signal = "X.actual", equals = "5 deg"}
[[step]]
expect = {standstill = "Q"}
)");
  EXPECT_EQ(o.status, Status::impossible);
  ASSERT_EQ(o.findings.size(), 5u);
  EXPECT_EQ(o.findings[0].line, 5);
  EXPECT_EQ(o.virtual_s, 0.0) << "and nothing has moved";
}

TEST(ScenarioRun, a_known_failure_passes_and_a_pass_of_it_fails) {
  const std::string head = kHead + "expected_failure = \"known\"\n";
  EXPECT_EQ(run(head + "[[step]]\nexpect = {alarm = 1001}\n").status, Status::skipped);
  EXPECT_EQ(run(head + "[[step]]\nexpect = {no_alarm = true}\n").status, Status::failed);
}

TEST(ScenarioRun, without_its_faults_nothing_is_noticed) {
  const std::string text = kHead + kReady + R"(
[[step]]
fault = {device = "can.y", kind = "silent"}
[[step]]
expect = {alarm = 2004}
within = "1 s"
)";
  EXPECT_EQ(run(text).status, Status::passed);
  TestOptions options;
  options.without_faults = true;
  EXPECT_EQ(run(text, options).status, Status::failed);
}

TEST(Shrink, leaves_the_one_step_that_matters) {
  const scenario::Scenario s = read(kHead + R"(
[[step]]
never = {alarm = 1001}
always = true
[random]
steps = 64
[[random.action]]
weight = 20
do = "hold"
[[random.action]]
do = "stop"
)",
                                    3);
  const auto stops = [](const scenario::Scenario& tried) {
    int n = 0;
    for (const scenario::Step& step : tried.steps)
      if (const auto* what = std::get_if<scenario::Do>(&step.what)) n += what->words == "stop" ? 1 : 0;
    return n;
  };
  ASSERT_GE(stops(s), 1) << "another seed is needed";
  int runs = 0;
  const scenario::Scenario smallest = shrink(s, [&](const scenario::Scenario& tried) {
    ++runs;
    return stops(tried) > 0;
  });
  EXPECT_EQ(smallest.steps.size(), 2u) << drawn_steps(smallest);
  EXPECT_EQ(stops(smallest), 1);
  EXPECT_LT(runs, 200);
}

TEST(Results, junit_holds_what_hosts_read) {
  Results all;
  all.scenarios.push_back(
      read(kHead + "verifies = \"SAF-1\"\ncases = [{a = 1}]\n[[step]]\nexpect = {no_alarm = true}\n"));
  Result r;
  r.status = Status::failed;
  r.message = "expected a < b & c, got \x01 at 1.204 s";
  r.line = 7;
  r.artifacts = {"out/t.csv"};
  all.results.push_back(r);
  const std::string xml = to_junit(all);
  for (const char* const part :
       {"name=\"t [a=1]\"", "line=\"7\"", "message=\"expected a &lt; b &amp; c, got \\x01 at 1.204 s\"",
        "[[ATTACHMENT|out/t.csv]]", "failures=\"1\"", "value=\"SAF-1\"", "servogate test"})
    EXPECT_NE(xml.find(part), std::string::npos) << part << "\n" << xml;
}

}  // namespace
}  // namespace servogate::gateway::command
