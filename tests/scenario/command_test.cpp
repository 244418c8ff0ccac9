// SPDX-License-Identifier: Apache-2.0
// `servogate test` as a pipeline calls it.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/places/places.hpp"

namespace servogate::scenario {
namespace {

namespace fs = std::filesystem;

struct Ending {
  int code = -1;
  std::string out;
};

class Command : public testing::Test {
 protected:
  Command() {
    static int number = 0;
    folder_ =
        testing::TempDir() + "servogate-test-" + std::to_string(::getpid()) + "-" + std::to_string(++number);
    fs::create_directories(folder_);
  }
  ~Command() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ + "/" + name) << content;
  }
  std::string read(const std::string& name) const {
    std::ifstream file(folder_ + "/" + name);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }
  /// A scenario that ends well, or not.
  void scenario(const std::string& name, const std::string& title, bool good,
                const std::string& more = {}) const {
    write(name, "schema = 1\ntitle = \"" + title + "\"\nmachine = \"" + tests::source_dir() +
                    "/examples/mill/machine.toml\"\n" + more +
                    "[[step]]\nexpect = {signal = \"X.homed\", equals = " + (good ? "false" : "true") +
                    "}\n");
  }
  Ending run(const std::string& arguments) const {
    const std::string line =
        "cd " + folder_ + " && LANG=C " + tests::program() + " test " + arguments + " 2>&1";
    Ending e;
    FILE* const pipe = ::popen(line.c_str(), "r");
    std::array<char, 4096> bytes{};
    for (std::size_t n; (n = std::fread(bytes.data(), 1, bytes.size(), pipe)) > 0;)
      e.out.append(bytes.data(), n);
    const int status = ::pclose(pipe);
    e.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return e;
  }
  std::string folder_;
};

TEST_F(Command, ends_with_0_1_or_2) {
  scenario("good.scenario.toml", "good", true);
  EXPECT_EQ(run(".").code, 0);
  scenario("bad.scenario.toml", "bad", false);
  const Ending failed = run(".");
  EXPECT_EQ(failed.code, 1);
  EXPECT_NE(
      failed.out.find("FAILED  bad.scenario.toml:4: bad\n  expected X.homed = on, got X.homed = off at 0 s"),
      std::string::npos)
      << failed.out;
  EXPECT_NE(failed.out.find("again: servogate test 'bad.scenario.toml' --name 'bad'"), std::string::npos)
      << failed.out;
  write("wrong.scenario.toml", "schema = 1\n");
  const Ending wrong = run(".");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_EQ(wrong.out.find("ok "), std::string::npos) << "nothing is run: " << wrong.out;
  fs::create_directories(folder_ + "/empty");
  EXPECT_EQ(run("empty").code, 2);
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("good.scenario.toml --shard 3/2").code, 2);
}

TEST_F(Command, what_the_machine_does_not_have_is_2_and_a_real_machine_4) {
  scenario("a.scenario.toml", "a", true, "[[step]]\nfault = {device = \"can.q\", kind = \"silent\"}\n");
  const Ending impossible = run("a.scenario.toml");
  EXPECT_EQ(impossible.code, 2);
  EXPECT_NE(impossible.out.find("a.scenario.toml:4:1: error: "), std::string::npos) << impossible.out;
  std::ifstream file(tests::source_dir() + "/examples/mill/machine.toml");
  std::stringstream mill;
  mill << file.rdbuf();
  std::string text = mill.str();
  text.replace(text.find("mock:can"), 8, "socketcan:can7");
  text.replace(text.find("[safety]"), 8, "[safety]\nmock_inputs_guard_real_drives = true");
  text.replace(text.find("\"mill.st\""), 9, "\"" + tests::source_dir() + "/examples/mill/mill.st\"");
  write("real.toml", text);
  write("b.scenario.toml",
        "schema = 1\ntitle = \"b\"\nmachine = \"real.toml\"\n[[step]]\nexpect = {no_alarm = true}\n");
  const Ending real = run("b.scenario.toml");
  EXPECT_EQ(real.code, 4);
  EXPECT_NE(real.out.find("only with --real"), std::string::npos) << real.out;
}

TEST_F(Command, shards_have_every_scenario_once) {
  write("many.scenario.toml",
        "schema = 1\ntitle = \"many\"\nmachine = \"m.toml\"\ncases = [{n = 1}, {n = 2}, {n = 3}, {n = 4}, {n "
        "= 5}]\n"
        "[[step]]\nexpect = {no_alarm = true}\n");
  const std::string whole = run(". --list").out;
  std::string parts;
  for (const char* const shard : {"1/2", "2/2"}) parts += run(std::string(". --list --shard ") + shard).out;
  for (int n = 1; n <= 5; ++n) {
    const std::string name = "many [n=" + std::to_string(n) + "]";
    ASSERT_NE(whole.find(name), std::string::npos) << whole;
    const std::size_t at = parts.find(name);
    ASSERT_NE(at, std::string::npos) << parts;
    EXPECT_EQ(parts.find(name, at + 1), std::string::npos) << parts;
  }
}

TEST_F(Command, results_are_written_for_other_programs) {
  scenario("good.scenario.toml", "good", true, "verifies = [\"SAF-1\"]\ntags = [\"fast\"]\n");
  scenario("bad.scenario.toml", "bad", false, "verifies = [\"SAF-1\"]\n");
  EXPECT_EQ(run(". --junit r.xml --json r.json --trace-table t.md --artifacts failed").code, 1);
  EXPECT_NE(read("r.xml").find("tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"0\""), std::string::npos)
      << read("r.xml");
  EXPECT_NE(read("r.json").find("\"failed\": 1"), std::string::npos);
  EXPECT_NE(read("t.md").find("| SAF-1 | good.scenario.toml: good | passed |"), std::string::npos)
      << read("t.md");
  EXPECT_TRUE(fs::exists(folder_ + "/failed/bad.csv"));
  EXPECT_TRUE(fs::exists(folder_ + "/failed/bad.html"));
  EXPECT_FALSE(fs::exists(folder_ + "/failed/good.csv"));
  const Ending tap = run(". --tap --tag fast");
  EXPECT_EQ(tap.code, 0);
  EXPECT_EQ(tap.out, "TAP version 13\n1..1\nok 1 - good.scenario.toml: good\n");
}

TEST_F(Command, plc_tests_are_written_as_junit_too) {
  const std::string line = "cd " + folder_ + " && " + tests::program() + " plc test " + tests::source_dir() +
                           "/examples/mill/plc/mill.test --junit plc.xml >/dev/null 2>&1";
  EXPECT_EQ(std::system(line.c_str()), 0);
  EXPECT_NE(read("plc.xml").find("failures=\"0\""), std::string::npos) << read("plc.xml");
  EXPECT_NE(read("plc.xml").find("<testcase classname="), std::string::npos);
}

}  // namespace
}  // namespace servogate::scenario
