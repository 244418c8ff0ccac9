// SPDX-License-Identifier: Apache-2.0
// `servogate io` as a product: the modules as the tools of a bus see them.
#include "tests/canopen_tools/workbench.hpp"

namespace servogate::canopen_tools {
namespace {

class SimulatedModules : public Workbench {
 protected:
  usercan::Process& modules(const std::vector<std::string>& words) {
    std::vector<std::string> line{"io", bus()};
    line.insert(line.end(), words.begin(), words.end());
    process_ = std::make_unique<usercan::Process>(line);
    EXPECT_TRUE(process_->says("Servogate simulated")) << process_->said();
    return *process_;
  }
  std::unique_ptr<usercan::Process> process_;
};

TEST_F(SimulatedModules, a_module_is_found_with_its_kind_and_tells_its_outputs) {
  usercan::Process& io = modules({"--node", "9", "--di", "8", "--aq", "0"});
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 1u);
  EXPECT_EQ(nodes[0]["node"], 9);
  EXPECT_EQ(nodes[0]["device_type"], 0x0007'0191);
  EXPECT_EQ(facts("sdo $BUS 9 read 6000")["value"], 1);
  EXPECT_EQ(facts("sdo $BUS 9 read 6411", 1)["abort"], 0x0602'0000) << "no analogue outputs";
  EXPECT_EQ(tool("sdo $BUS 9 write 6200:2 0x81 u8").code, 2) << "a valve may hang on it";
  ASSERT_EQ(tool("sdo $BUS 9 write 6200:2 0x81 u8 --i-may-move --listen 0.1").code, 0);
  EXPECT_TRUE(io.says("9.dq8 on")) << io.said();
  EXPECT_TRUE(io.says("9.dq15 on")) << io.said();
}

TEST_F(SimulatedModules, an_encoder_is_one_for_the_tools_of_a_bus) {
  modules({"--node", "9", "--kind", "encoder", "--counts", "1000", "--turns", "16"});
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 1u);
  EXPECT_EQ(nodes[0]["device_type"], 0x0002'0196);
  EXPECT_EQ(facts("sdo $BUS 9 read 6501")["value"], 1000);
  const json turns = facts("sdo $BUS 9 read 6502");
  EXPECT_EQ(turns["value"], 16);
  EXPECT_EQ(turns["name"], "") << "the modes of a drive are another object by the same number";
  EXPECT_EQ(tool("sdo $BUS 9 write 6003 4711 u32").code, 0);
  EXPECT_EQ(facts("sdo $BUS 9 read 6004")["value"], 4711) << "the preset is what it reads where it stands";
}

TEST_F(SimulatedModules, several_modules_live_in_one_process) {
  modules({"--node", "9,10"});
  EXPECT_EQ(facts("scan $BUS")["nodes"].size(), 2u);
}

TEST_F(SimulatedModules, more_terminals_than_a_module_has_are_refused) {
  EXPECT_EQ(tool("io $BUS --node 9 --di 65").code, 2);
  EXPECT_EQ(tool("io $BUS --node 9 --ai 13").code, 2);
}

}  // namespace
}  // namespace servogate::canopen_tools
