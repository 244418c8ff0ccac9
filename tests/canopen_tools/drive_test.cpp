// SPDX-License-Identifier: Apache-2.0
// `servogate drive` and `servogate sim` as products: kinds, plants, faults.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>

#include "firmware_if/canopen/306/value_text.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/comes.hpp"

namespace servogate::canopen_tools {
namespace {

/// Waits until a tool's facts satisfy something.
template <class Facts, class Satisfied>
bool comes(Facts facts, Satisfied satisfied) {
  return tests::comes([&] { return satisfied(facts()); });
}

/// A shell line that feeds a simulation by its standard input, step by step, each when the one before has
/// been heard: `heard FILE WORDS` waits for them there; `say WORDS` says them.
std::string fed(const std::string& command, const std::string& steps) {
  return "heard() { while ! grep -qF -- \"$2\" $1; do sleep 0.02; done; }; say() { echo \"$@\" >&3; }; "
         "mkfifo in; : >out; : >err; " +
         command + " <in >out 2>err & p=$!; exec 3>in; " + steps +
         "; kill -INT $p; wait $p; cat out; cat err >&2";
}

class SimulatedDrives : public Workbench {
 protected:
  /// What `od` shows of a node, but for what is that of one device: its serial number.
  json objects(int node, const std::string& more) {
    json all = facts("od $BUS " + std::to_string(node) + more)["objects"];
    const auto own = [](const json& o) { return o["index"] == "1018" && o["subindex"] == 4; };
    all.erase(std::remove_if(all.begin(), all.end(), own), all.end());
    for (json& o : all) o.erase("name");
    return all;
  }
  json value(int node, const std::string& object) {
    return facts("sdo $BUS " + std::to_string(node) + " read " + object)["value"];
  }
  /// Switches a drive on in profile position, where it holds.
  void switch_on(int node) {
    const std::string at = std::to_string(node);
    ASSERT_EQ(tool("sdo $BUS " + at + " write 6060 1 --i-may-move --listen 0.1").code, 0);
    for (const char* word : {"6", "7", "15"})
      ASSERT_EQ(tool("sdo $BUS " + at + " write 6040 " + word + " --i-may-move --listen 0.1").code, 0);
  }
};

TEST_F(SimulatedDrives, a_stepper_and_a_spindle_say_what_they_are_and_which_modes_they_have) {
  drives("1", {"--profile", "stepper"});
  drives("2", {"--profile", "spindle"});
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_EQ(nodes[0]["device"], "stepper drive (CiA 402)");
  EXPECT_EQ(nodes[0]["modes"], json::parse(R"(["pp","pv","hm","ip","csp","csv"])"));
  EXPECT_EQ(nodes[1]["device"], "frequency converter (CiA 402)");
  EXPECT_EQ(nodes[1]["modes"], json::parse(R"(["vl","pv","tq","hm","csp","csv","cst"])"));
  EXPECT_EQ(tool("sdo $BUS 1 write 6060 4 --i-may-move --listen 0.1").code, 1)
      << "a stepper has no torque mode";
  EXPECT_EQ(value(1, "608F:1"), 51200);
}

TEST_F(SimulatedDrives, a_drive_of_a_data_sheet_has_its_objects_and_no_others) {
  drives("3");
  ASSERT_EQ(tool("od $BUS 3 --range 6040-6061 --save small.dcf").code, 0);
  drives("4", {"--profile", path("small.dcf")});
  EXPECT_EQ(tool("sdo $BUS 4 read 6041").code, 0);
  EXPECT_EQ(facts("sdo $BUS 4 read 6083", 1)["abort"], 0x0602'0000);
  EXPECT_EQ(facts("sdo $BUS 3 read 6083")["ok"], true);
}

TEST_F(SimulatedDrives, the_plant_is_what_the_line_says) {
  drives("1", {"--plant", "counts=1000", "inertia=0.01,torque=5", "start=2"});
  EXPECT_EQ(value(1, "608F:1"), 1000);
  EXPECT_EQ(value(1, "6076"), 5000);
  for (const char* wrong :
       {"--plant mass=3", "--plant inertia=0", "--plant inertia", "--plant counts=x", "--profile rocket",
        "--profile missing.eds", "--fault melt", "--fault 'pdo_dropped every=0'", "--script missing.txt",
        "--profile servo --device servo-cia402"})
    EXPECT_EQ(tool("drive $BUS --node 9 " + std::string(wrong)).code, 2) << wrong;
}

TEST_F(SimulatedDrives, a_fault_comes_when_its_time_has_come) {
  desk_.write("faults.txt",
              "# seconds, what goes wrong\n0.3 over_current node=1\n0.1 sdo_abort index=0x6083 "
              "abort=0x06090030 node=2\n");
  drives("1,2", {"--script", path("faults.txt")});
  EXPECT_TRUE(comes([&] { return value(1, "603F"); }, [](const json& code) { return code == 0x2310; }));
  EXPECT_EQ(value(1, "6041").get<int>() & 0x4F, 0x08) << "fault";
  EXPECT_EQ(value(2, "603F"), 0);
  EXPECT_EQ(facts("sdo $BUS 2 read 6083", 1)["abort"], 0x0609'0030);
}

TEST_F(SimulatedDrives, a_node_id_that_is_on_the_bus_is_refused_whoever_would_take_it) {
  drives("1");
  for (const char* words :
       {"drive $BUS --node 1", "drive $BUS --node 9,1", "io $BUS --node 1", "sim $MILL --bus can=$BUS"}) {
    const Ended ended = tool(words);
    EXPECT_EQ(ended.code, 1) << words;
    EXPECT_TRUE(ended.err_has("node 1 is not simulated: a device with this node-ID is on " + bus()))
        << ended.err;
  }
  EXPECT_EQ(facts("scan $BUS")["nodes"].size(), 1u);
}

TEST_F(SimulatedDrives, a_node_id_that_is_named_twice_is_refused) {
  for (const char* words : {"drive $BUS --node 1,1", "io $BUS --node 4,5,4"}) {
    const Ended ended = tool(words);
    EXPECT_EQ(ended.code, 2) << words;
    EXPECT_TRUE(ended.err_has("twice")) << ended.err;
  }
}

TEST_F(SimulatedDrives, another_device_with_the_same_node_id_is_noticed_when_it_comes_later) {
  const usercan::Process& process = drives("5");
  const auto other = join();
  EXPECT_TRUE(other->send(usercan::make(0x706, {0})));
  EXPECT_TRUE(other->send(usercan::make(0x705, {0})));
  EXPECT_TRUE(process.says("has the node-ID 5, too")) << process.said();
  EXPECT_EQ(process.said().find("node-ID 6"), std::string::npos);
}

TEST_F(SimulatedDrives, a_configuration_of_another_node_comes_with_cob_ids_of_the_own_one) {
  drives("9");
  ASSERT_EQ(tool("sdo $BUS 9 write 6083 4711").code, 0);
  ASSERT_EQ(tool("od $BUS 9 --save a.dcf").code, 0);
  const usercan::Process& process = drives("10", {"--profile", path("a.dcf")});
  EXPECT_TRUE(process.says("a.dcf is the configuration of node 9: node 10 takes its values"))
      << process.said();
  EXPECT_EQ(value(10, "6083"), 4711);
  EXPECT_EQ(value(10, "1800:1"), 0x4000'018A);
  EXPECT_EQ(value(10, "1400:1").get<std::int64_t>() & 0x7FF, 0x20A);
  EXPECT_EQ(value(10, "1014"), 0x8A);
  const Ended ended = tool("od $BUS 10 --compare a.dcf");
  EXPECT_TRUE(ended.err_has("a.dcf is the configuration of node 9")) << ended.err;
  EXPECT_EQ(ended.out.find("1800h"), std::string::npos) << ended.out;
  EXPECT_FALSE(tool("od $BUS 9 --compare a.dcf").err_has("configuration of node"));
}

TEST_F(SimulatedDrives, objects_that_cannot_be_simulated_are_named_and_have_their_warning) {
  desk_.write("odd.eds",
              "[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\nSupportedObjects=1\n1=0x2007\n[2007]\n"
              "ParameterName=bad\nObjectType=0x7\nDataType=0x99\nAccessType=rw\nDefaultValue=5\n");
  const usercan::Process& process = drives("4", {"--profile", path("odd.eds")});
  EXPECT_TRUE(process.says("odd.eds:9: ")) << process.said();
  EXPECT_TRUE(process.says("[2007] has the data type 0x99")) << process.said();
  EXPECT_TRUE(process.says("left out, as it cannot be simulated: 2007h:00")) << process.said();
}

TEST_F(SimulatedDrives, a_sheet_may_have_wide_numbers_times_unicode_and_long_bytes) {
  std::string octets;
  for (int i = 0; i < 100; ++i) octets += "A5";
  const struct {
    const char *index, *type, *value, *word, *again;
  } rows[] = {{"2001", "0x0011", "-0.1", "f64", "6.02214076e23"},
              {"2002", "0x000B", "1A044104", "hex", "5804"},
              {"2003", "0x000C", "010203040506", "hex", "FFFFFFFFFFFF"},
              {"2004", "0x000D", "060504030201", "hex", "000000000001"},
              {"2005", "0x000A", octets.c_str(), "hex", "00FF"},
              {"2006", "0x0010", "-8388608", "i24", "8388607"},
              {"2007", "0x0014", "-1", "i56", "-36028797018963968"},
              {"2008", "0x0018", "0xFFFFFFFFFF", "u40", "1"},
              {"2009", "0x000F", octets.c_str(), "domain", "01"}};
  std::string sheet = "[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\nSupportedObjects=9\n";
  int n = 0;
  for (const auto& r : rows) sheet += std::to_string(++n) + "=0x" + r.index + "\n";
  for (const auto& r : rows)
    sheet += "[" + std::string(r.index) +
             "]\nParameterName=own\nObjectType=" + (r.word == std::string("domain") ? "2" : "7") +
             "\nDataType=" + r.type + "\nAccessType=rw\nDefaultValue=" + r.value + "\n";
  desk_.write("wide.eds", sheet);
  const usercan::Process& process = drives("4", {"--profile", path("wide.eds")});
  EXPECT_EQ(process.said().find("left out"), std::string::npos) << process.said();
  EXPECT_EQ(process.said().find("warning"), std::string::npos) << process.said();
  const auto reads = [&](const char* index, const std::string& word) {
    return facts("sdo $BUS 4 read " + std::string(index) + " " + word)["bytes"];
  };
  for (const auto& r : rows) {
    const std::string word = r.word;
    const auto bytes = canopen::encode_value(
        r.value, *canopen::type_named(std::string(r.value).starts_with("0x") ? "u40" : word));
    ASSERT_TRUE(bytes) << r.index;
    EXPECT_EQ(reads(r.index, word), canopen::hex_text(*bytes)) << r.index;
    ASSERT_EQ(tool("sdo $BUS 4 write " + std::string(r.index) + " " + r.again + " " + word).code, 0)
        << r.index;
    EXPECT_EQ(reads(r.index, word),
              canopen::hex_text(*canopen::encode_value(r.again, *canopen::type_named(word))))
        << r.index;
  }
}

TEST_F(SimulatedDrives, a_text_of_a_sheet_is_whole_however_long) {
  std::string words;
  while (words.size() < 20'000) words += "0123456789";
  desk_.write("long.eds",
              "[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\nSupportedObjects=1\n1=0x2001\n"
              "[2001]\nParameterName=own\nObjectType=7\nDataType=0x0009\nAccessType=rw\nDefaultValue=" +
                  words + "\n");
  drives("4", {"--profile", path("long.eds")});
  EXPECT_EQ(facts("sdo $BUS 4 read 2001 str")["value"], words);
}

TEST_F(SimulatedDrives, the_eds_of_a_simulated_drive_makes_the_same_drive_again) {
  const usercan::Process& first = drives("5", {"--profile", "spindle", "--write-eds", path("own.eds")});
  EXPECT_TRUE(first.says("own.eds: EDS of node 5, ")) << first.said();
  const json before = objects(5, "");
  EXPECT_GT(before.size(), 250u);
  const usercan::Process& process = drives("6", {"--profile", path("own.eds")});
  EXPECT_EQ(process.said().find("own.eds:"), std::string::npos)
      << "not a word about the file: " << process.said();
  EXPECT_EQ(process.said().find("left out"), std::string::npos) << process.said();
  // The same but for what follows from the node-ID.
  const json after = objects(6, "");
  ASSERT_EQ(after.size(), before.size());
  int of_the_node = 0;
  for (std::size_t i = 0; i < after.size(); ++i)
    if (after[i] != before[i]) {
      EXPECT_EQ(after[i]["value"].get<std::int64_t>() - before[i]["value"].get<std::int64_t>(), 1)
          << after[i];
      ++of_the_node;
    }
  EXPECT_EQ(of_the_node, 1 + 2 + 8) << "EMCY, the SDO server, the PDOs";
}

TEST_F(SimulatedDrives, an_eds_is_written_of_one_node_and_not_over_what_the_drive_is_made_of) {
  Ended ended = tool("drive $BUS --node 1,2 --write-eds x.eds");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("--write-eds is for one node; --node has 2")) << ended.err;
  desk_.write("s.eds", "[2000]\nParameterName=a\nObjectType=7\nDataType=7\nAccessType=rw\n");
  ended = tool("drive $BUS --node 1 --profile s.eds --write-eds s.eds");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("--write-eds would overwrite --profile, s.eds")) << ended.err;
  EXPECT_EQ(tool("drive $BUS --node 1 --write-eds missing/x.eds").code, 4);
}

TEST_F(SimulatedDrives, od_writes_an_eds_of_which_a_drive_answers_as_the_one_that_was_read) {
  desk_.write(
      "own.eds",
      "[DeviceInfo]\nVendorName=x\n[OptionalObjects]\nSupportedObjects=2\n1=0x1000\n2=0x6083\n"
      "[ManufacturerObjects]\nSupportedObjects=3\n1=0x2001\n2=0x2002\n3=0x4ABC\n"
      "[1000]\nParameterName=Type\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=0x20192\n"
      "[6083]\nParameterName=a\nObjectType=7\nDataType=7\nAccessType=rw\nDefaultValue=4711\n"
      "[2001]\nParameterName=a\nObjectType=7\nDataType=3\nAccessType=rw\nDefaultValue=-5\n"
      "[2002]\nParameterName=a\nObjectType=7\nDataType=9\nAccessType=rw\nDefaultValue=some words\n"
      "[4ABC]\nParameterName=a\nObjectType=7\nDataType=0x18\nAccessType=rw\nDefaultValue=0x0102030405\n");
  drives("5", {"--profile", path("own.eds")});
  const Ended ended = tool("od $BUS 5 --write-eds read.eds");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.err_has("read.eds: EDS of node 5, 5 entries; types guessed from the length: 3"))
      << ended.err;
  const std::string text = desk_.text("read.eds");
  EXPECT_NE(text.find("2001h:00 2002h:00 4ABCh:00\r\n"), std::string::npos) << text;
  const usercan::Process& process = drives("6", {"--profile", path("read.eds")});
  EXPECT_EQ(process.said().find("read.eds:"), std::string::npos)
      << "not a word about the file: " << process.said();
  const auto bytes = [&](int node) {
    json all = json::array();
    for (const char* object : {"1000", "6083", "2001", "2002", "4ABC"})
      all.push_back(facts("sdo $BUS " + std::to_string(node) + " read " + object)["bytes"]);
    return all;
  };
  EXPECT_EQ(bytes(6), bytes(5));
  // A given sheet knows the types.
  const Ended given = tool("od $BUS 5 --eds own.eds --write-eds given.eds");
  ASSERT_EQ(given.code, 0) << given.err;
  EXPECT_TRUE(given.err_has("types guessed from the length: 0")) << given.err;
  EXPECT_NE(desk_.text("given.eds").find("DataType=0x0018\r\n"), std::string::npos);
  EXPECT_EQ(tool("od $BUS 5 --eds own.eds --write-eds own.eds").code, 2)
      << "it would overwrite what it reads";
  EXPECT_EQ(tool("od $BUS 5 --compare own.eds --write-eds y.eds").code, 2);
}

TEST_F(SimulatedDrives, od_prefers_the_eds_that_a_device_stores_itself) {
  const std::string stored =
      "[FileInfo]\nFileName=maker.eds\n[OptionalObjects]\nSupportedObjects=1\n1=0x1000\n"
      "[1000]\nParameterName=Type of the maker\nObjectType=7\nDataType=7\nAccessType=ro\nDefaultValue=5\n";
  const auto sheet = [&](const std::string& content, const char* format) {
    return "[DeviceInfo]\nVendorName=x\n[1000]\nParameterName=a\nObjectType=7\nDataType=7\nAccessType=ro\n"
           "[1021]\nParameterName=Store EDS\nObjectType=2\nAccessType=ro\nDefaultValue=" +
           canopen::hex_text({reinterpret_cast<const std::uint8_t*>(content.data()), content.size()}) +
           "\n[1022]\nParameterName=Format\nObjectType=7\nDataType=5\nAccessType=ro\nDefaultValue=" + format +
           "\n";
  };
  desk_.write("own.eds", sheet(stored, "0"));
  desk_.write("packed.eds", sheet(stored, "0x80"));
  desk_.write("junk.eds", sheet(std::string(200, 'x'), "0"));
  drives("5", {"--profile", path("own.eds")});
  drives("6", {"--profile", path("packed.eds")});
  drives("7", {"--profile", path("junk.eds")});
  const Ended ended = tool("od $BUS 5 --write-eds read.eds");
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.err_has("read.eds: the EDS that node 5 itself stores in 1021h, " +
                            std::to_string(stored.size()) + " bytes"))
      << ended.err;
  EXPECT_TRUE(ended.out_has("Type of the maker")) << ended.out;
  EXPECT_EQ(desk_.text("read.eds"), stored) << "to the byte";
  for (const auto& [node, why] :
       {std::pair("6", "format of its maker (1022h = 128)"), {"7", "1021h is no EDS"}}) {
    const Ended other = tool("od $BUS " + std::string(node) + " --range 1000-1030 --write-eds other.eds");
    EXPECT_EQ(other.code, 0) << other.err;
    EXPECT_TRUE(other.err_has(why)) << other.err;
    EXPECT_TRUE(other.err_has("other.eds: EDS of node ")) << other.err;
  }
}

TEST_F(SimulatedDrives, a_fault_for_a_node_of_another_process_is_refused) {
  const Ended ended = tool("drive $BUS --node 1,2 --fault \"silent node=7\"");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("no drive of this process has the node-ID 7")) << ended.err;
}

TEST_F(SimulatedDrives, a_script_with_a_mistake_is_refused_with_its_line) {
  desk_.write("faults.txt", "0.3 over_current\nsoon reset\n");
  const Ended ended = tool("drive $BUS --node 1 --script faults.txt");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("faults.txt:2: 'soon'")) << ended.err;
}

TEST_F(SimulatedDrives, faults_come_on_command_by_standard_input) {
  const Ended ended =
      desk_.line(fed("$SG drive " + bus() + " --node 5",
                     "say emcy code=0x8611; heard err 'node 5: emcy'; "
                     "while ! grep -q '\"state\":\"fault\"' out; do say status; sleep 0.1; done; "
                     "say nonsense; heard err nonsense"));
  EXPECT_TRUE(ended.err_has("node 5: emcy code=0x8611")) << ended.err;
  EXPECT_TRUE(ended.err_has("'nonsense' is no fault")) << ended.err;
  const std::size_t last = ended.out.rfind("{", ended.out.size());
  ASSERT_NE(last, std::string::npos) << ended.out;
  const json status = json::parse(ended.out.substr(last), nullptr, false);
  EXPECT_EQ(status.value("error_code", ""), "8611") << ended.out;
  EXPECT_EQ(status.value("state", ""), "fault") << ended.out;
}

TEST_F(SimulatedDrives, faults_by_the_names_of_a_machine_file_are_for_sim) {
  desk_.write("faults.txt", "0.1 unplug device=can.x\n0.2 over_current\n");
  const usercan::Process& process = drives("1", {"--script", path("faults.txt")});
  EXPECT_TRUE(process.says("[drive.no-machine]")) << process.said();
  for (const char* wrong : {"--fault unplug", "--fault 'silent every=3'", "--fault 'silent device='"})
    EXPECT_EQ(tool("drive $BUS --node 9 " + std::string(wrong)).code, 2) << wrong;
}

TEST_F(SimulatedDrives, sim_unplugs_a_node_of_the_machine_file_for_a_time) {
  usercan::Process sim({"sim", shell::source("examples/mill/machine.toml"), "--bus", "can=" + bus(),
                        "--fault", "unplug device=can.x at=1 for=6", "--fault",
                        "over_current device=panel at=0.1"});
  EXPECT_TRUE(sim.says("possible are silent")) << "a Modbus station has no current: " << sim.said();
  const auto answers = [&](bool wanted) {
    return comes([&] { return json(tool("sdo $BUS 1 read 1000 --timeout 100 --listen 0.25").code); },
                 [&](const json& code) { return (code == 0) == wanted; });
  };
  EXPECT_TRUE(sim.says("unplug device=can.x")) << sim.said();
  EXPECT_TRUE(answers(false)) << "unplugged";
  EXPECT_TRUE(answers(true)) << "plugged in again";
}

TEST_F(SimulatedDrives, overload_heats_the_motor_until_it_faults_and_cannot_be_reset_at_once) {
  drives("1", {"--plant", "gravity=4,thermal-time=0.5,brake=10"});
  switch_on(1);
  EXPECT_TRUE(comes([&] { return value(1, "603F"); }, [](const json& code) { return code == 0x2350; }))
      << "4 N m of 2.4 rated";
}

TEST_F(SimulatedDrives, sim_serves_the_drives_of_a_machine_and_tells_its_switches) {
  usercan::Process sim(
      {"sim", shell::source("examples/mill/machine.toml"), "--bus", "can=" + bus(), "--json"});
  ASSERT_TRUE(sim.says("simulated drives on")) << sim.said();
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 4u) << nodes;
  EXPECT_TRUE(sim.says("\"point\"")) << sim.said();
  sim.signal(SIGINT);
  EXPECT_EQ(sim.wait(), 0);
}

TEST_F(SimulatedDrives, sim_tells_what_became_of_a_played_input_and_names_the_inputs_there_are) {
  const Ended ended = desk_.line(
      fed("$SG sim " + shell::source("examples/mill/machine.toml") + " --bus can=" + bus(),
          "say input door_closed off; say input x_limit_plus on; say input x_limit_plus auto; "
          "say input door_closed auto; say input dor_closed on; say input door_closed 3; say input; "
          "say input home on node=1; heard err 'node 1: input home on'; heard out 'x_limit_plus off'"));
  EXPECT_TRUE(ended.out_has("input door_closed is off")) << ended.out;
  EXPECT_TRUE(ended.out_has("input x_limit_plus is on")) << ended.out;
  EXPECT_TRUE(ended.out_has("input x_limit_plus follows its axis or its output again\nx_limit_plus off"))
      << ended.out;
  EXPECT_TRUE(ended.err_has("'door_closed' follows nothing by itself")) << ended.err;
  EXPECT_TRUE(ended.err_has("the machine has no input 'dor_closed'; it has ")) << ended.err;
  EXPECT_TRUE(ended.err_has("; inputs of the drives are negative_limit, positive_limit, home")) << ended.err;
  EXPECT_TRUE(ended.err_has("'door_closed' is on or off (1 or 0), not 3")) << ended.err;
  EXPECT_TRUE(ended.err_has("expected input POINT on|off|auto|NUMBER")) << ended.err;
  EXPECT_TRUE(ended.err_has("node 1: input home on")) << ended.err;
}

TEST_F(SimulatedDrives, sim_serves_no_two_buses_on_one_wire) {
  std::ifstream file(shell::source("tests/machine/broken/two_buses_on_one_wire.toml"));
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string wire = "url = \"mock:can\"";
  text.replace(text.rfind(wire), wire.size(), "url = \"mock:can2\"");
  desk_.write("two.toml", text);
  const Ended ended = tool("sim two.toml --bus can=$BUS --bus can2=socketcand:unix:./bus.sock/can0");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("the buses 'can' and 'can2' would be one wire")) << ended.err;
}

TEST_F(SimulatedDrives, sim_says_that_a_mock_bus_can_be_reached_by_nobody) {
  const Ended ended = tool("sim $MILL");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("--bus can=URL")) << ended.err;
  EXPECT_EQ(tool("sim $MILL --bus nobus=$BUS").code, 2);
  EXPECT_EQ(tool("sim missing.toml").code, 2);
}

}  // namespace
}  // namespace servogate::canopen_tools
