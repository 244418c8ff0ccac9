// SPDX-License-Identifier: Apache-2.0
// A line that a running control holds: seen through the control, and locked to `servogate modbus`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/comes.hpp"
#include "tests/modbus_line/rig/units.hpp"
#include "tests/shell/line.hpp"
#include "tests/usercan/rig/process.hpp"

namespace servogate::modbus_line {
namespace {

using nlohmann::json;

/// The minimal example with a unit on a real line, as `servogate up` runs it in this folder.
class HeldLine : public ::testing::Test {
 protected:
  HeldLine() {
    desk_.line("cp \"" + shell::source("examples/minimal/minimal.st") + "\" . && cp \"" +
               shell::source("examples/minimal/machine.toml") + "\" . && cp -r \"" +
               shell::source("devices") + "\" . && cat >> machine.toml <<'END'\n" +
               "[[line]]\nname = \"cabinet\"\nurl = \"" + url_ + "\"\ntimeout = \"10 s\"\n" +
               "[[station]]\nname = \"panel\"\nkind = \"modbus\"\nline = \"cabinet\"\nunit = 7\n" +
               "device = \"modbus-io-16-16-4-2\"\n" + "END");
    setenv("XDG_RUNTIME_DIR", desk_.path("").c_str(), 1);
    control_ = std::make_unique<usercan::Process>(
        std::vector<std::string>{"up", desk_.path("machine.toml"), "--realtime=best-effort"});
    unsetenv("XDG_RUNTIME_DIR");
  }
  shell::Ended tool(const std::string& words) const {
    return desk_.line("XDG_RUNTIME_DIR=\"" + desk_.path("") + "\" $SG " + words);
  }
  /// The line as the control's status has it, once it is so.
  json line_once(const std::function<bool(const json&)>& met) const {
    json line;
    EXPECT_TRUE(tests::comes([&] {
      const json status = json::parse(tool("status --json").out, nullptr, false);
      if (!status.is_object() || !status.contains("modbus")) return false;
      line = status["modbus"][0];
      return met(line);
    })) << line
        << control_->said();
    return line;
  }

  Units units_{Units::Wire::tcp, {7}};
  const std::string url_ = "tcp:127.0.0.1:" + units_.port();
  shell::Desk desk_;
  std::unique_ptr<usercan::Process> control_;
};

TEST_F(HeldLine, is_locked_to_commands_and_its_counters_stand_in_the_status) {
  json line = line_once([](const json& l) { return l["units"][0]["quality"] == "good"; });
  EXPECT_EQ(line["name"], "cabinet");
  EXPECT_EQ(line["url"], url_);
  EXPECT_EQ(line["units"][0]["station"], "panel");
  EXPECT_GE(line["counters"]["requests"], 1);
  EXPECT_EQ(line["counters"]["openings"], 1);
  for (const std::string words : {"read LINE 7 inputs 0", "write LINE 7 coils 3 1 --i-may-move", "scan LINE"})
    for (const std::string& name : {url_, desk_.path("machine.toml") + "#cabinet"}) {
      std::string command = words;
      command.replace(command.find("LINE"), 4, name);
      const shell::Ended ended = tool("modbus " + command);
      EXPECT_EQ(ended.code, 1) << command;
      EXPECT_TRUE(ended.err_has("the running control of 'minimal machine' uses bus " + url_)) << ended.err;
    }
  EXPECT_FALSE(units_.output(7, 3));
  units_.unplug();
  line = line_once([](const json& l) {
    return l["units"][0]["quality"] == "bad" && l["counters"]["failed_openings"] > 0;
  });
  EXPECT_GE(line["counters"]["broken"], 1);
  EXPECT_TRUE(tool("status").out_has("line cabinet (" + url_ + "): ")) << tool("status").out;
  EXPECT_TRUE(tool("status").out_has("  unit 7 (panel)  bad, ")) << tool("status").out;
}

}  // namespace
}  // namespace servogate::modbus_line
