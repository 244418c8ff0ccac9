// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <atomic>
#include <thread>

#include "firmware_if/canopen/301/nmt.hpp"
#include "tests/canopen_tools/workbench.hpp"
#include "tests/comes.hpp"

namespace servogate::canopen_tools {
namespace {

/// Sends a frame again and again while it lives, as a control would.
class Sender {
 public:
  Sender(std::unique_ptr<usercan::SocketcandBus> bus, const image::CanFrame& frame)
      : bus_(std::move(bus)), thread_([this, frame] {
          while (!stop_) {
            bus_->send(frame);
            usleep(20'000);
            for (image::CanFrame heard; bus_->receive(heard);) {
            }
          }
        }) {}
  ~Sender() {
    stop_ = true;
    thread_.join();
  }

 private:
  std::unique_ptr<usercan::SocketcandBus> bus_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_F(Workbench, scan_names_every_node_with_identity_modes_and_state) {
  drives("1,5");
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 2u) << nodes;
  const json& five = nodes[1];
  EXPECT_EQ(five["node"], 5);
  EXPECT_EQ(five["device"], "servo drive (CiA 402)");
  EXPECT_EQ(five["profile"], 402);
  EXPECT_EQ(five["product_code"], 0x0001'0192);
  EXPECT_EQ(five["serial_number"], 5);
  EXPECT_EQ(five["device_name"], "Servogate simulated drive");
  EXPECT_EQ(five["state"], "pre_operational");
  EXPECT_EQ(five["modes"], json::parse(R"(["pp","vl","pv","tq","hm","ip","csp","csv","cst"])"));
  EXPECT_FALSE(five["heartbeat_seen"]) << "it only answers SDO";
}

TEST_F(Workbench, scan_sees_heartbeats_and_the_state_they_tell) {
  drives("7");
  ASSERT_EQ(tool("sdo $BUS 7 write 1017 50").code, 0);
  ASSERT_EQ(tool("nmt $BUS start 7 --i-may-move --listen 0.1").code, 0);
  const json node = facts("scan $BUS")["nodes"][0];
  EXPECT_TRUE(node["heartbeat_seen"]);
  EXPECT_EQ(node["heartbeat_ms"], 50);
  EXPECT_EQ(node["state"], "operational");
}

TEST_F(Workbench, scan_of_an_empty_bus_is_a_failed_check_that_says_where_to_look) {
  const Ended ended = tool("scan $BUS --seconds 0.3");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("termination")) << ended.err;
}

TEST_F(Workbench, a_bus_that_is_not_there_is_infrastructure) {
  EXPECT_EQ(tool("scan socketcand:127.0.0.1:1/can0").code, 4);
  EXPECT_EQ(tool("sdo socketcand:127.0.0.1:1/can0 1 read 1000").code, 4);
  EXPECT_EQ(tool("scan nonsense:can0").code, 4);
}

TEST_F(Workbench, sdo_reads_with_the_type_of_the_standard) {
  drives("5");
  const Ended text = tool("sdo $BUS 5 read 1008");
  EXPECT_EQ(text.out, "1008h:00 Manufacturer device name = \"Servogate simulated drive\"\n") << text.err;
  EXPECT_EQ(tool("sdo $BUS 5 read 0x1018:2").out, "1018h:02 Identity object = 65938 (00010192h)\n");
  EXPECT_EQ(facts("sdo $BUS 5 read 60C2:2")["value"], -3);
  EXPECT_EQ(facts("sdo $BUS 5 read 60C2h:2 hex")["value"], "FD");
}

TEST_F(Workbench, sdo_writes_numbers_of_both_signs_and_text_of_many_segments) {
  drives("5");
  ASSERT_EQ(tool("sdo $BUS 5 write 607C -123456").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 607C")["value"], -123456);
  ASSERT_EQ(tool("sdo $BUS 5 write 6083 0x10000").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 6083")["value"], 65536);
  const std::string name = "the drive of the third axis, behind the door";
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 '" + name + "' str").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 2100 str")["value"], name);
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 '" + name + "!' str --no-block").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 2100 str")["value"], name + "!");
  ASSERT_EQ(tool("sdo $BUS 5 read 2100 str --save name.bin").code, 0);
  EXPECT_EQ(desk_.text("name.bin"), name + "!");
}

TEST_F(Workbench, sdo_says_abort_codes_in_words_and_in_both_languages) {
  drives("5");
  Ended ended = tool("sdo $BUS 5 read 5FFF");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("0602 0000h: the object does not exist in the device")) << ended.err;
  ended = tool("sdo $BUS 5 read 5FFF", "ru_RU.UTF-8");
  EXPECT_TRUE(ended.err_has("объекта нет в словаре устройства")) << ended.err;
  EXPECT_EQ(facts("sdo $BUS 5 write 6041 1 u16", 1)["abort"], 0x0601'0002);
  ended = tool("sdo $BUS 6 read 1000 --timeout 50");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("node 6, 1000h:00: no answer")) << ended.err;
}

TEST_F(Workbench, sdo_tells_what_is_wrong_with_the_line_before_a_bus_is_opened) {
  EXPECT_EQ(tool("sdo $BUS 5 read 12345").code, 2);
  EXPECT_EQ(tool("sdo $BUS 0 read 1000").code, 2);
  EXPECT_EQ(tool("sdo $BUS 5 write 607C").code, 2);
  EXPECT_EQ(tool("sdo $BUS 5 write 2345 1").code, 2) << "the type is not known";
  EXPECT_EQ(tool("sdo $BUS 5 write 1017 70000").code, 2) << "does not fit u16";
  EXPECT_EQ(tool("sdo $BUS 5 read 1000 u31").code, 2);
  EXPECT_EQ(tool("sdo $BUS 5 read 1000 --eds missing.eds").code, 2);
}

TEST_F(Workbench, sdo_finds_objects_by_name_and_says_their_state_in_words) {
  drives("5");
  EXPECT_EQ(tool("sdo $BUS 5 read statusword").out,
            "6041h:00 Statusword = 592 (0250h): Switch on disabled\n");
  EXPECT_EQ(facts("sdo $BUS 5 read 6502")["meaning"], "pp vl pv tq hm ip csp csv cst");
  const Ended several = tool("sdo $BUS 5 read position");
  EXPECT_EQ(several.code, 2);
  EXPECT_TRUE(several.err_has("Position demand value")) << several.err;
}

TEST_F(Workbench, sdo_makes_several_accesses_behind_one_listening) {
  drives("5");
  const Ended both = tool("sdo $BUS 5 write 6083 4711 6084 0x10 read 6083 profile_deceleration 2100 str");
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_TRUE(both.out_has("6083h:00 Profile acceleration = 4711 (00001267h)\n")) << both.out;
  EXPECT_TRUE(both.out_has("6084h:00 Profile deceleration = 16 (00000010h)\n")) << both.out;
  const json rows = facts("sdo $BUS 5 read 6041 5FFF 6064", 1)["accesses"];
  ASSERT_EQ(rows.size(), 3u) << "one that fails keeps no other from being read";
  EXPECT_EQ(rows[1]["abort"], 0x0602'0000);
  EXPECT_EQ(rows[2]["value"], 0);
  const Ended refused = tool("sdo $BUS 5 write 6041 1 u16 6083 1");
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(refused.err_has("not done any more: 6083h:00")) << refused.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6083")["value"], 4711);
  EXPECT_EQ(tool("sdo $BUS 5 read 6083 write 6060 8").code, 2) << "the strictest of them counts";
  EXPECT_EQ(tool("sdo $BUS 5 read").code, 2);
  EXPECT_EQ(tool("sdo $BUS 5 read 6083 write").code, 2);
  EXPECT_EQ(tool("sdo $BUS 5 read 6083 6084 --save both.bin").code, 2);
}

TEST_F(Workbench, sdo_takes_names_and_types_from_a_data_sheet) {
  drives("5");
  desk_.write("sheet.eds",
              "[FileInfo]\nFileName=sheet.eds\n[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\n"
              "SupportedObjects=1\n1=0x2100\n[2100]\nParameterName=Name of the user\nObjectType=0x7\n"
              "DataType=0x0009\nAccessType=rw\nPDOMapping=0\n");
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 Anna --eds sheet.eds").code, 0);
  EXPECT_EQ(tool("sdo $BUS 5 read 2100 --eds sheet.eds").out, "2100h:00 Name of the user = \"Anna\"\n");
}

TEST_F(Workbench, what_can_move_needs_the_word_and_a_bus_without_a_master) {
  drives("5");
  for (const char* write : {"6040 6", "6060 8", "607A 100", "60FF 100", "6071 10"}) {
    const Ended ended = tool("sdo $BUS 5 write " + std::string(write));
    EXPECT_EQ(ended.code, 2) << write;
    EXPECT_TRUE(ended.err_has("--i-may-move")) << ended.err;
  }
  EXPECT_EQ(tool("nmt $BUS start 5").code, 2);
  EXPECT_EQ(facts("sdo $BUS 5 read 6040")["value"], 0);
  ASSERT_EQ(tool("sdo $BUS 5 write 6040 6 --i-may-move --listen 0.2").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 6041")["value"].get<int>() & 0x6F, 0x21);
}

TEST_F(Workbench, what_takes_the_torque_away_waits_for_nothing_and_asks_for_no_word) {
  drives("5");
  for (const char* step : {"6060 3", "6040 6", "6040 7", "6040 15"})
    ASSERT_EQ(tool("sdo $BUS 5 write " + std::string(step) + " --i-may-move --listen 0.1").code, 0) << step;
  const Sender master(join(), usercan::make(0x080, {}));
  ASSERT_EQ(tool("sdo $BUS 5 write 6040 15").code, 2) << "that one enables";
  ASSERT_EQ(tool("sdo $BUS 5 write 6040 15 --i-may-move").code, 1) << "and the bus is in use";
  ASSERT_EQ(tool("sdo $BUS 5 write 6040 128").code, 2) << "the reset of a fault";
  // Whoever listens first would have heard the master, and refused.
  EXPECT_EQ(tool("sdo $BUS 5 write 6040 2").code, 0) << "quick stop";
  EXPECT_EQ(tool("sdo $BUS 5 write 6040 0").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 6041 --anyway")["value"].get<int>() & 0x4F, 0x40);
}

TEST_F(Workbench, a_bus_in_use_is_refused_with_the_frame_that_shows_it) {
  drives("5");
  const struct {
    image::CanFrame frame;
    const char* words;
  } masters[] = {{usercan::make(0x080, {}), "SYNC (080h)"},
                 {usercan::make(0x205, {6, 0}), "RPDO 1 of node 5 (205h)"},
                 {canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, 9),
                  "NMT command enter pre-operational to node 9 (000h)"}};
  for (const auto& master : masters) {
    const Sender sender(join(), master.frame);
    const Ended ended = tool("sdo $BUS 5 write 6040 6 --i-may-move");
    EXPECT_EQ(ended.code, 1) << master.words;
    EXPECT_TRUE(ended.err_has(master.words)) << ended.err;
    EXPECT_EQ(tool("nmt $BUS stop all --i-may-move").code, 1);
    EXPECT_EQ(tool("lss $BUS fastscan").code, 1);
    EXPECT_EQ(tool("sdo $BUS 5 write 6083 1000").code, 1) << "whatever is written";
    const Ended read = tool("sdo $BUS 5 read 6041");
    EXPECT_EQ(read.code, 1) << master.words;
    EXPECT_TRUE(read.err_has(master.words)) << read.err;
    EXPECT_EQ(tool("sdo $BUS 5 read 6041 --anyway").code, 0);
    EXPECT_EQ(facts("scan $BUS --anyway")["nodes"].size(), 1u);
  }
}

TEST_F(Workbench, nmt_says_the_state_that_came_of_it) {
  drives("5");
  EXPECT_EQ(facts("nmt $BUS start 5 --i-may-move --listen 0.1")["states"][0]["state"], "operational");
  EXPECT_EQ(facts("nmt $BUS stop 5 --i-may-move --listen 0.1")["states"][0]["state"], "stopped");
  const json all = facts("nmt $BUS reset --i-may-move --listen 0.1");
  EXPECT_EQ(all["states"], json::parse(R"([{"node":5,"state":"pre_operational"}])"));
  EXPECT_EQ(tool("nmt $BUS start 200 --i-may-move").code, 2);
  EXPECT_EQ(tool("nmt $BUS fly 5 --i-may-move").code, 2);
}

TEST_F(Workbench, od_finds_the_objects_of_a_drive_without_a_data_sheet) {
  drives("5");
  const json objects = facts("od $BUS 5")["objects"];
  EXPECT_GT(objects.size(), 250u);
  const auto value = [&](const char* index, int subindex) {
    for (const json& o : objects)
      if (o["index"] == index && o["subindex"] == subindex) return o.value("value", json());
    return json("missing");
  };
  EXPECT_EQ(value("1018", 4), 5);
  EXPECT_EQ(value("1A00", 1), 0x6041'0010);
  EXPECT_EQ(value("607D", 1), -2147483648LL);
  EXPECT_EQ(value("6502", 0), 1007);
  EXPECT_EQ(value("60FE", 2), 0);
  const json manufacturer = facts("od $BUS 5 --range 2000-21FF")["objects"];
  ASSERT_EQ(manufacturer.size(), 1u);
  EXPECT_EQ(manufacturer[0]["index"], "2100");
}

TEST_F(Workbench, od_saves_a_configuration_and_finds_what_was_changed_since) {
  drives("5");
  ASSERT_EQ(tool("od $BUS 5 --save a.dcf").code, 0);
  Ended ended = tool("od $BUS 5 --compare a.dcf");
  EXPECT_EQ(ended.code, 0) << ended.out << ended.err;
  ASSERT_EQ(tool("sdo $BUS 5 write 6083 1234").code, 0);
  ASSERT_EQ(tool("sdo $BUS 5 write 1400:2 1").code, 0);
  ended = tool("od $BUS 5 --compare a.dcf");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.out_has("6083h:00 Profile acceleration: the device has 1234")) << ended.out;
  EXPECT_EQ(facts("od $BUS 5 --compare a.dcf", 1)["differences"].size(), 2u);
  // The saved file is a data sheet like others.
  ASSERT_EQ(tool("od $BUS 5 --eds a.dcf --save b.dcf").code, 0);
  EXPECT_EQ(tool("od $BUS 5 --compare b.dcf").code, 0);
  EXPECT_NE(desk_.text("b.dcf").find("NodeID=0x5"), std::string::npos);
  EXPECT_NE(desk_.text("b.dcf").find("LSS_SerialNumber=0x5"), std::string::npos);
}

TEST_F(Workbench, od_restores_what_was_changed_and_compares_before_and_after) {
  drives("5");
  ASSERT_EQ(tool("od $BUS 5 --save a.dcf").code, 0);
  ASSERT_EQ(tool("sdo $BUS 5 write 6083 1234 1800:1 0xC0000185 1A00:0 0 1A00:1 0x606C0020 1A00:0 1").code, 0);
  const Ended ended = tool("od $BUS 5 --restore a.dcf");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.out_has("6083h:00 Profile acceleration: the device has 1234")) << ended.out;
  EXPECT_TRUE(ended.out_has("node 5 is as a.dcf has it")) << ended.out;
  EXPECT_EQ(tool("od $BUS 5 --compare a.dcf").code, 0);
  const json again = facts("od $BUS 5 --restore a.dcf");
  EXPECT_EQ(again["written"], 0);
  EXPECT_TRUE(again["before"].empty());
}

TEST_F(Workbench, od_restores_the_file_of_another_serial_number_only_when_that_is_meant) {
  drives("5");
  ASSERT_EQ(tool("od $BUS 5 --save a.dcf").code, 0);
  std::string other = desk_.text("a.dcf");
  const std::size_t at = other.find("ParameterValue=", other.find("[1018sub4]"));
  ASSERT_NE(at, std::string::npos) << other.substr(0, 2000);
  other.replace(at, other.find('\r', at) - at, "ParameterValue=0x00000007");
  desk_.write("b.dcf", other);
  ASSERT_EQ(tool("sdo $BUS 5 write 6083 1234").code, 0);
  const Ended refused = tool("od $BUS 5 --restore b.dcf");
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(refused.err_has("serial number 7 (00000007h), node 5 has 5 (00000005h)")) << refused.err;
  EXPECT_TRUE(refused.err_has("--anyway")) << refused.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6083")["value"], 1234) << "nothing was written";
  const Ended ended = tool("od $BUS 5 --restore b.dcf --anyway");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(ended.err_has("serial number")) << ended.err;
  EXPECT_FALSE(ended.out_has("1018h:04")) << "it is no parameter: " << ended.out;
  EXPECT_NE(facts("sdo $BUS 5 read 6083")["value"], 1234);
}

TEST_F(Workbench, od_restores_nothing_of_another_device) {
  drives("5");
  ASSERT_EQ(tool("od $BUS 5 --save a.dcf").code, 0);
  std::string other = desk_.text("a.dcf");
  const std::string product = "0x00010192";
  const std::size_t at = other.find("ParameterValue=" + product);
  ASSERT_NE(at, std::string::npos) << other.substr(0, 2000);
  other.replace(at + 15, product.size(), "0x00010193");
  desk_.write("b.dcf", other);
  ASSERT_EQ(tool("sdo $BUS 5 write 6083 1234").code, 0);
  const Ended ended = tool("od $BUS 5 --restore b.dcf");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("of another device")) << ended.err;
  EXPECT_EQ(facts("sdo $BUS 5 read 6083")["value"], 1234);
}

TEST_F(Workbench, od_finds_no_difference_to_what_it_has_saved_whatever_the_type) {
  std::string sheet =
      "[FileInfo]\nFileName=own.eds\n[DeviceInfo]\nVendorName=x\n[ManufacturerObjects]\n"
      "SupportedObjects=4\n";
  const struct {
    const char *index, *type, *word, *value;
  } rows[] = {{"2001", "0x0008", "f32", "1.17549435e-38"},
              {"2002", "0x0009", "str", "'Привод оси X; 5%'"},
              {"2003", "0x0015", "i64", "-9223372036854775808"},
              {"2004", "0x001B", "u64", "0xFFFFFFFFFFFFFFFF"}};
  int n = 0;
  for (const auto& r : rows) sheet += std::to_string(++n) + "=0x" + r.index + "\n";
  for (const auto& r : rows)
    sheet += "[" + std::string(r.index) + "]\nParameterName=own\nObjectType=0x7\nDataType=" + r.type +
             "\nAccessType=rw\nPDOMapping=0\n";
  desk_.write("own.eds", sheet);
  drives("5", {"--profile", path("own.eds")});
  for (const auto& r : rows)
    ASSERT_EQ(tool("sdo $BUS 5 write " + std::string(r.index) + " " + r.value + " " + r.word).code, 0);
  const Ended saved = tool("od $BUS 5 --eds own.eds --save own.dcf");
  ASSERT_EQ(saved.code, 0) << saved.err;
  EXPECT_FALSE(saved.err_has("not saved")) << saved.err;
  EXPECT_TRUE(saved.err_has("4 values of node 5")) << saved.err;
  const json compared = facts("od $BUS 5 --compare own.dcf");
  EXPECT_EQ(compared["differences"].size(), 0u) << compared;
  EXPECT_EQ(compared["compared"], 4) << "none is left out";
  EXPECT_NE(desk_.text("own.dcf").find("ParameterValue=Привод оси X; 5%\r\n"), std::string::npos);
}

TEST_F(Workbench, od_names_what_a_configuration_cannot_hold) {
  drives("5");
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 ' indented' str").code, 0);
  const Ended saved = tool("od $BUS 5 --range 2000-21FF --save a.dcf");
  EXPECT_EQ(saved.code, 0);
  EXPECT_TRUE(saved.err_has("a DCF cannot hold their values: 2100h:00")) << saved.err;
}

TEST_F(Workbench, an_empty_text_is_written_saved_and_found_again) {
  drives("5");
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 'X axis' str").code, 0);
  desk_.write("nothing", "");
  ASSERT_EQ(tool("sdo $BUS 5 write 2100 @nothing str").code, 0);
  EXPECT_EQ(facts("sdo $BUS 5 read 2100 str")["value"], "");
  const Ended saved = tool("od $BUS 5 --range 2100-2100 --save a.dcf");
  ASSERT_EQ(saved.code, 0);
  EXPECT_FALSE(saved.err_has("cannot hold")) << saved.err;
  EXPECT_NE(desk_.text("a.dcf").find("ParameterValue=\r\n"), std::string::npos) << desk_.text("a.dcf");
  EXPECT_EQ(tool("sdo $BUS 5 write 6083 @nothing u32").code, 2) << "a number is never empty";
}

TEST_F(Workbench, a_dcf_with_bytes_that_are_none_is_refused_with_its_line) {
  desk_.write("bad.dcf",
              "[2000]\nParameterName=key\nObjectType=7\nDataType=10\nAccessType=rw\nParameterValue=hello\n");
  const Ended ended = tool("od $BUS 5 --compare bad.dcf");
  EXPECT_EQ(ended.code, 2);
  EXPECT_TRUE(ended.err_has("bad.dcf:6: error: [2000] ParameterValue = hello: bytes are expected"))
      << ended.err;
}

TEST_F(Workbench, od_of_a_node_that_is_not_there_fails) {
  const Ended ended = tool("od $BUS 9 --timeout 50");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("node 9 does not answer")) << ended.err;
  EXPECT_EQ(tool("od $BUS 9 --range zz").code, 2);
}

TEST_F(Workbench, lss_gives_a_device_another_node_id) {
  drives("5");
  const json steps =
      facts("lss $BUS select 0:10192:10000:5 inquire node 17 store waiting --listen 0.1")["steps"];
  EXPECT_EQ(steps[1]["node"], 5);
  EXPECT_EQ(steps[1]["serial_number"], 5);
  ASSERT_EQ(tool("nmt $BUS reset-comm --i-may-move --listen 0.1").code, 0);
  EXPECT_EQ(facts("sdo $BUS 17 read 1018:4")["value"], 5);
}

TEST_F(Workbench, lss_gives_no_node_id_to_several_devices_at_once) {
  drives("5,6");
  for (const char* steps : {"configuration node 7 waiting", "configuration inquire", "node 7"}) {
    Ended ended;
    // The devices are processes of their own: on a busy computer one of them answers too late.
    EXPECT_TRUE(tests::comes([&] {
      ended = tool("lss $BUS " + std::string(steps) + " --listen 0.1");
      return ended.err_has("2 devices answer (00000000:00010192:00010000:00000005|00000006)");
    })) << ended.err;
    EXPECT_EQ(ended.code, 1) << steps;
    EXPECT_TRUE(ended.err_has("select VENDOR:PRODUCT:REVISION:SERIAL")) << ended.err;
    EXPECT_EQ(ended.out.find("node-ID"), std::string::npos) << ended.out;
  }
  ASSERT_EQ(tool("nmt $BUS reset-comm --i-may-move --listen 0.1").code, 0);
  EXPECT_EQ(facts("scan $BUS")["nodes"].size(), 2u) << "both have their own";
  const json steps = facts("lss $BUS configuration store waiting --listen 0.1")["steps"];
  EXPECT_EQ(steps[1]["devices"], 2) << "what all may be told";
}

TEST_F(Workbench, lss_gives_a_node_id_to_the_only_device_in_configuration) {
  drives("5");
  const Ended ended = tool("lss $BUS configuration node 17 store waiting --listen 0.1");
  ASSERT_EQ(ended.code, 0) << ended.err;
  ASSERT_EQ(tool("nmt $BUS reset-comm --i-may-move --listen 0.1").code, 0);
  EXPECT_EQ(facts("sdo $BUS 17 read 1018:4")["value"], 5);
}

TEST_F(Workbench, lss_leaves_no_device_in_configuration_when_it_scans_for_the_next) {
  drives("5,6");
  ASSERT_EQ(
      tool("lss $BUS select 0:10192:10000:5 node none select 0:10192:10000:6 node none waiting --listen 0.1")
          .code,
      0);
  ASSERT_EQ(tool("nmt $BUS reset-comm --i-may-move --listen 0.1").code, 0);
  const Ended ended = tool("lss $BUS fastscan node 17 fastscan node 18 waiting --timeout 100 --listen 0.1");
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json nodes = facts("scan $BUS")["nodes"];
  ASSERT_EQ(nodes.size(), 2u) << nodes;
  EXPECT_EQ(nodes[0]["node"], 17);
  EXPECT_EQ(nodes[1]["node"], 18);
}

TEST_F(Workbench, lss_says_that_nobody_answers_and_which_words_are_wrong) {
  const Ended ended = tool("lss $BUS fastscan --timeout 20 --listen 0.1");
  EXPECT_EQ(ended.code, 1);
  EXPECT_TRUE(ended.err_has("nobody answers")) << ended.err;
  EXPECT_EQ(tool("lss $BUS dance").code, 2);
  EXPECT_EQ(tool("lss $BUS node 200").code, 2);
  EXPECT_EQ(tool("lss $BUS bit-rate 123456").code, 2);
  EXPECT_EQ(tool("lss $BUS select 1:2:3").code, 2);
}

TEST_F(Workbench, can_restart_is_for_interfaces_of_linux_that_are_there) {
  EXPECT_EQ(tool("can restart $BUS").code, 2) << "a bus between processes never goes off";
  EXPECT_EQ(tool("can restart gsusb:LAB1").code, 2);
  const Ended none = tool("can restart socketcan:nosuch0");
  EXPECT_EQ(none.code, 4);
  EXPECT_TRUE(none.err_has("there is no CAN interface nosuch0")) << none.err;
}

TEST_F(Workbench, can_check_says_who_speaks_and_who_controls) {
  drives("5");
  ASSERT_EQ(tool("sdo $BUS 5 write 1017 20").code, 0);
  json said = facts("can check $BUS");
  EXPECT_EQ(said["traffic"]["nodes"], json::parse("[5]"));
  EXPECT_FALSE(said["traffic"]["controlled"]);
  EXPECT_GT(said["traffic"]["load_percent"], 0.0);
  const Sender sender(join(), usercan::make(0x080, {}));
  EXPECT_TRUE(tool("can check $BUS").out_has("another master controls this bus: SYNC (080h)"));
  EXPECT_EQ(tool("can check $BUS --detect").code, 4) << "there is nothing to set";
}

TEST_F(Workbench, can_check_finds_a_bus_that_another_protocol_shares_not_healthy) {
  image::CanFrame foreign = usercan::make(0x18FF1234, {1, 2, 3});
  foreign.extended = true;
  const Sender sender(join(), foreign);
  const json said = facts("can check $BUS --seconds 0.5", 1);
  EXPECT_FALSE(said["ok"]);
  EXPECT_GT(said["traffic"]["frames_29_bit"], 0);
  EXPECT_TRUE(tool("can check $BUS --seconds 0.5").out_has("29-bit identifiers, the first (18FF1234h)"));
}

TEST_F(Workbench, can_check_finds_a_full_bus_not_healthy) {
  // Five times of what 10 kbit/s carry, so that processes may come late to their turn.
  std::vector<std::unique_ptr<Sender>> senders;
  for (std::uint32_t id = 0x181; id < 0x189; ++id)
    senders.push_back(std::make_unique<Sender>(
        join(), usercan::make(id, {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55})));
  const json said = facts("can check $BUS --bit-rate 10000 --seconds 1", 1);
  EXPECT_FALSE(said["ok"]);
  EXPECT_GT(said["traffic"]["load_percent"], 90);
  EXPECT_NE(said["sentences"].dump().find("of the bit rate is taken: frames of low priority"),
            std::string::npos)
      << said["sentences"];
  EXPECT_EQ(tool("can check $BUS --seconds 0.5").code, 0) << "1 Mbit/s carry that easily";
}

}  // namespace
}  // namespace servogate::canopen_tools
