// SPDX-License-Identifier: Apache-2.0
// A bus that a running control holds: read through it, and locked to everything else.
#include <csignal>

#include "tests/canopen_tools/workbench.hpp"

namespace servogate::canopen_tools {
namespace {

/// A running control of the example mill on its mock bus, found by its socket in this folder.
class HeldBus : public Workbench {
 protected:
  HeldBus() {
    setenv("XDG_RUNTIME_DIR", path("").c_str(), 1);
    control_ = std::make_unique<usercan::Process>(std::vector<std::string>{
        "up", shell::source("examples/mill/machine.toml"), "--virtual", "--state", path("state")});
    unsetenv("XDG_RUNTIME_DIR");
    ready_ = online();
  }
  /// The drives have booted.
  bool online() {
    for (int i = 0; i < 100; ++i) {
      const json status = json::parse(tool("status --json").out, nullptr, false);
      if (status.is_object() && status.contains("buses")) {
        bool all = true;
        for (const json& node : status["buses"][0]["nodes"]) all = all && node["online"] == true;
        if (all) return true;
      }
      usleep(200'000);
    }
    return false;
  }
  const std::string held_ = shell::source("examples/mill/machine.toml") + "#can";
  std::unique_ptr<usercan::Process> control_;
  bool ready_ = false;
};

TEST_F(HeldBus, is_read_through_the_control_that_holds_it) {
  ASSERT_TRUE(ready_) << control_->said();
  const json scanned = facts("scan " + held_);
  EXPECT_EQ(scanned["held_by"]["machine"], "Three-axis mill");
  ASSERT_EQ(scanned["nodes"].size(), 4u);
  EXPECT_EQ(scanned["nodes"][0]["profile"], 402);
  EXPECT_TRUE(scanned["nodes"][0]["online"]);
  EXPECT_EQ(facts("sdo " + held_ + " 1 read 1018:4")["value"], 1);
  EXPECT_EQ(facts("sdo " + held_ + " 1 read 1008")["value"], "Servogate simulated drive");
  EXPECT_EQ(facts("sdo " + held_ + " 2 read 5FFF", 1)["abort"], 0x0602'0000);
  EXPECT_EQ(facts("od " + held_ + " 1 --range 6060-6070")["objects"][0]["index"], "6060");
}

TEST_F(HeldBus, is_locked_to_writes_and_commands_with_the_name_of_its_holder) {
  ASSERT_TRUE(ready_) << control_->said();
  for (const char* words : {"sdo BUS 1 write 6083 1000", "sdo BUS 1 write 6040 6 --i-may-move",
                            "nmt BUS stop all --i-may-move", "lss BUS inquire"}) {
    std::string line = words;
    line.replace(line.find("BUS"), 3, held_);
    const Ended ended = tool(line);
    EXPECT_EQ(ended.code, 1) << line;
    EXPECT_TRUE(ended.err_has("is held by the running control of 'Three-axis mill'")) << ended.err;
  }
  EXPECT_TRUE(tool("can check " + held_).out_has("holds it"));
  EXPECT_EQ(tool("sdo " + held_ + " 99 read 1000").code, 1) << "no node of the machine file";
}

}  // namespace
}  // namespace servogate::canopen_tools
