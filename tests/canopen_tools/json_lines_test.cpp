// SPDX-License-Identifier: Apache-2.0
// `--json` of the commands that go on: what happens is one object a line of standard output.
#include <sstream>

#include "tests/canopen_tools/workbench.hpp"

namespace servogate::canopen_tools {
namespace {

/// The objects among the lines of both streams; every one has its schema.
std::vector<json> objects_of(const std::string& said) {
  std::vector<json> objects;
  std::istringstream lines(said);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('{')) continue;
    objects.push_back(json::parse(line, nullptr, false));
    if (!objects.back().is_object()) {
      ADD_FAILURE() << line;
      objects.pop_back();
      continue;
    }
    EXPECT_EQ(objects.back().value("schema", 0), 1) << line;
  }
  return objects;
}

/// The first one with this event.
json event_of(const std::string& said, const std::string& event) {
  for (json& o : objects_of(said))
    if (o.value("event", "") == event) return o;
  return json::object();
}

class JsonLines : public Workbench {};

TEST_F(JsonLines, of_can_bus_say_where_it_serves) {
  const std::string socket = path("second.sock");
  const usercan::Process bus({"can", "bus", "a", "b", "--listen", "unix:" + socket, "--json"});
  ASSERT_TRUE(bus.says("\"event\":\"serving\"")) << bus.said();
  const json serving = event_of(bus.said(), "serving");
  EXPECT_EQ(serving["address"], "unix:" + socket);
  EXPECT_EQ(serving["buses"], json::array({"a", "b"}));
  EXPECT_EQ(serving["bit_rate"], 1'000'000);
}

TEST_F(JsonLines, of_drives_say_who_lives_and_what_happens_to_them) {
  const usercan::Process& process =
      drives("3,4", {"--json", "--fault", "over_current node=4", "--profile", "stepper"});
  ASSERT_TRUE(process.says("\"event\":\"done\"")) << process.said();
  std::vector<int> nodes;
  for (const json& o : objects_of(process.said()))
    if (o["event"] == "node") nodes.push_back(o["node"]);
  EXPECT_EQ(nodes, (std::vector<int>{3, 4}));
  const json done = event_of(process.said(), "done");
  EXPECT_EQ(done["node"], 4);
  EXPECT_EQ(done["what"], "over_current node=4");
}

TEST_F(JsonLines, of_an_io_module_are_its_outputs_as_they_change) {
  const usercan::Process io({"io", bus(), "--node", "9", "--json"});
  ASSERT_TRUE(io.says("\"event\":\"node\"")) << io.said();
  ASSERT_EQ(tool("sdo $BUS 9 write 6200:2 0x80 u8 --i-may-move --listen 0.1").code, 0);
  ASSERT_TRUE(io.says("\"event\":\"output\"")) << io.said();
  const json output = event_of(io.said(), "output");
  EXPECT_EQ(output["node"], 9);
  EXPECT_EQ(output["name"], "dq15");
  EXPECT_EQ(output["value"], true);
  EXPECT_EQ(io.said().find("9.dq15 on"), std::string::npos) << "the words for people are left out";
}

TEST_F(JsonLines, of_dump_are_the_frames) {
  const auto other = join();
  const usercan::Process dump({"dump", bus(), "--count", "3", "--json"});
  std::string said;
  // Until it listens, what is sent passes unseen.
  while (objects_of(said = dump.said()).size() < 3) {
    other->send({.id = 0x181, .length = 2, .data = {0xDE, 0xAD}});
    other->send({.id = 0x18FF0001, .extended = true, .length = 0});
    other->send({.id = 0x701, .remote = true, .length = 1});
  }
  bool standard = false, extended = false, remote = false;
  for (const json& frame : objects_of(said)) {
    EXPECT_EQ(frame["bus"], "can0");
    EXPECT_GT(frame["t"], 1e9) << "seconds since 1970";
    standard = standard || (frame["id"] == "181" && frame["data"] == "DEAD");
    extended = extended || (frame["id"] == "18FF0001" && frame["data"] == "");
    remote = remote || (frame["id"] == "701" && frame["remote"] == true);
  }
  EXPECT_TRUE(standard && extended && remote) << said;
}

TEST_F(JsonLines, of_play_count_what_was_played_and_left_out) {
  desk_.write(
      "run.log",
      "(1.000000) can0 201#0102\n(1.001000) can0 181#0A\n(1.002000) can0 181#0B\n(1.003000) can0 080#\n");
  const json played = facts("play $BUS run.log --from master");
  EXPECT_EQ(played["schema"], 1);
  EXPECT_EQ(played["played"], 2);
  EXPECT_EQ(played["of"], 4);
  EXPECT_EQ(played["left_out"], (json{{"181", 2}}));
  EXPECT_EQ(played["two_senders"], json::object());
}

TEST_F(JsonLines, of_can_restart_name_the_error_where_it_can_do_nothing) {
  const json refused = facts("can restart $BUS", 2);
  EXPECT_EQ(refused["error"]["code"], "restart.not-by-hand");
  const json absent = facts("can restart socketcan:none7", 4);
  EXPECT_EQ(absent["error"]["code"], "restart.no-interface");
}

}  // namespace
}  // namespace servogate::canopen_tools
