// SPDX-License-Identifier: Apache-2.0
// What a node of the machine file is to be before it may run (program, version, configuration, patience), and
// what its loss does.
#include <gtest/gtest.h>

#include <memory>

#include "firmware_if/canopen/device/node/program_store.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"

namespace servogate::machine_run {
namespace {

using image::Reaction;

/// The example mill with more keys for the node of X.
machine::LoadResult mill_with(const std::string& keys) {
  return changed_mill(
      [&](std::string& text) { replace(text, "name = \"x\"\n", "name = \"x\"\n" + keys + "\n"); });
}

struct NodeKeys : testing::Test {
  Scratch scratch;
  std::unique_ptr<Mill> mill;
  image::CanBus* listener = nullptr;
  void start(const std::string& keys, std::string_view program = "") {
    const machine::LoadResult machine = mill_with(keys);
    for (const text::Finding& f : machine.findings)
      EXPECT_NE(f.severity, text::Severity::error) << f.str(text::Language::english);
    ASSERT_TRUE(machine.ok());
    mill = std::make_unique<Mill>(machine, program);
    listener = &mill->control().world().wire(0)->add_endpoint("listener");
  }
  mock::SimulatedDrive& drive() { return *mill->control().world().drive("can.x"); }
  bool online(double patience_s = 15.0) {
    return mill->until([&] { return mill->axis("X").drive.online; }, patience_s);
  }
  /// How often an object of node 1 was written by SDO since the last time.
  int writes(std::uint16_t index) {
    int n = 0;
    image::CanFrame f;
    while (listener->receive(f))
      n += f.id == 0x601 && f.data[0] >> 5 == 1 && (f.data[1] | f.data[2] << 8) == index;
    return n;
  }
  std::string first_words() {
    const auto history = mill->control().cycle().alarms().history();
    if (history.empty()) return {};
    return image::render(history.front(), mill->control().alarm_names(), text::Language::english);
  }
};

TEST_F(NodeKeys, another_software_version_is_named_with_both) {
  ASSERT_NO_FATAL_FAILURE(start("software_version = \"2.7\""));
  EXPECT_FALSE(online(5.0));
  EXPECT_EQ(first_words(),
            "node 1 (can.x, axis X): boot stopped at step \"software version\": reading 100Ah:00 "
            "Manufacturer software "
            "version: expected \"2.7\", got \"0.1\"");
}

TEST_F(NodeKeys, a_program_is_written_where_another_one_runs_and_is_seen_to_run) {
  std::string bytes;
  for (int i = 0; i < 5000; ++i) bytes += static_cast<char>(i * 37 >> 3);
  const auto crc =
      canopen::program_identification({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const std::string file = "program = \"" + scratch.write("drive.bin", bytes) + "\"\nprogram_version = ";
  ASSERT_NO_FATAL_FAILURE(start(file + std::to_string(crc)));
  ASSERT_TRUE(online(60.0)) << first_words();
  EXPECT_EQ(drive().object(0x1F56, 1), crc);

  ASSERT_NO_FATAL_FAILURE(start(file + std::to_string(crc ^ 1)));
  EXPECT_FALSE(online(30.0));
  char expected[16], got[16];
  std::snprintf(expected, sizeof expected, "%08Xh", crc ^ 1);
  std::snprintf(got, sizeof got, "%08Xh", crc);
  EXPECT_EQ(first_words(),
            std::string("node 1 (can.x, axis X): boot stopped at step \"program of the device\": reading "
                        "1F56h:01 Program software identification: expected ") +
                expected + ", got " + got);

  ASSERT_NO_FATAL_FAILURE(start(file + std::to_string(crc) + "\nprogram_when = \"never\""));
  EXPECT_FALSE(online(5.0));
  EXPECT_EQ(drive().object(0x1F56, 1), 0x0001'0000) << "it has kept its program";
  EXPECT_NE(first_words().find("got 00010000h"), std::string::npos) << first_words();
}

constexpr const char* kDcf =
    "[FileInfo]\nFileName=x.dcf\n[MandatoryObjects]\nSupportedObjects=1\n1=0x6065\n"
    "[6065]\nParameterName=Following error window\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
    "DefaultValue=65536\nParameterValue=12345\nPDOMapping=0\n";

TEST_F(NodeKeys, a_configuration_is_written_at_every_boot_or_where_1020_tells_another_date) {
  const std::string file = "configuration = \"" + scratch.write("x.dcf", kDcf) + "\"\n";
  const std::string dated = file + "configuration_date = \"2026-11-22 14:30:00\"\nconfiguration_store = true";
  for (const auto& [keys, second_time] : {std::pair(file, 1), std::pair(dated, 0)}) {
    ASSERT_NO_FATAL_FAILURE(start(keys));
    ASSERT_TRUE(online()) << first_words();
    EXPECT_EQ(writes(0x6065), 1);
    EXPECT_EQ(drive().object(0x6065), 12'345);
    mill->inject("can.x", fault::Kind::reset);
    ASSERT_TRUE(mill->until([&] { return !mill->axis("X").drive.online; }, 5.0));
    ASSERT_TRUE(online());
    EXPECT_EQ(writes(0x6065), second_time) << keys;
    EXPECT_EQ(drive().object(0x6065), 12'345);
  }
  EXPECT_EQ(drive().object(0x1020, 1), 15'666) << "days since 1984-01-01";
  EXPECT_EQ(drive().object(0x1020, 2), 52'200'000);
}

TEST_F(NodeKeys, a_silent_node_is_named_after_its_own_time_and_attempts) {
  const auto told_after = [&](const std::string& keys) {
    start(keys);
    mill->inject("can.x", fault::Kind::silent);
    EXPECT_TRUE(mill->until([&] { return mill->alarms(cycle::alarm::kBootFailed) > 0; }, 60.0));
    return static_cast<double>(mill->image().now.t_ns) * 1e-9;
  };
  const double once = told_after("boot_timeout = \"500 ms\"\nboot_attempts = 1");
  EXPECT_NEAR(once, 0.5, 0.1);
  EXPECT_NE(first_words().find("reset of communication and boot-up message"), std::string::npos)
      << first_words();
  const double three = told_after("boot_timeout = \"500 ms\"\nboot_attempts = 3");
  EXPECT_GT(three, 3.0 * once);
  EXPECT_GT(told_after("boot_timeout = \"3 s\"\nboot_attempts = 1"), 2.9);
}

TEST_F(NodeKeys, a_slow_node_boots_where_it_is_given_the_time_for_its_answers) {
  const auto boots = [&](const std::string& keys) {
    start(keys);
    drive().inject({.kind = fault::Kind::sdo_late, .delay_ns = 300 * image::kMillisecond});
    EXPECT_TRUE(mill->until(
        [&] { return mill->axis("X").drive.online || mill->alarms(cycle::alarm::kBootFailed) > 0; }, 120.0));
    return mill->axis("X").drive.online;
  };
  EXPECT_FALSE(boots("sdo_retries = 0"));
  EXPECT_NE(first_words().find("no answer"), std::string::npos) << first_words();
  EXPECT_TRUE(boots("sdo_timeout = \"500 ms\"\nsdo_retries = 0")) << first_words();
}

TEST_F(NodeKeys, an_error_code_is_told_in_the_words_of_the_device_file_in_both_languages) {
  ASSERT_NO_FATAL_FAILURE(start(""));
  ASSERT_TRUE(mill->power_on()) << mill->alarm_list();
  mill->inject("can.x", fault::Kind::over_current);
  ASSERT_TRUE(mill->until([&] { return mill->alarms(axis::alarm::kDriveFault) > 0; }, 2.0));
  for (const image::AlarmRecord& r : mill->control().cycle().alarms().history()) {
    if (r.number != axis::alarm::kDriveFault) continue;
    const auto words = [&](text::Language language) {
      return image::render(r, mill->control().alarm_names(), language);
    };
    EXPECT_NE(words(text::Language::english).find("continuous over-current at the output"), std::string::npos)
        << words(text::Language::english);
    EXPECT_NE(words(text::Language::russian).find("длительная перегрузка по току на выходе"),
              std::string::npos)
        << words(text::Language::russian);
  }
}

constexpr const char* kLine = "N10 G90 G94 G71\nN20 G1 X150 Y100 F3000\nN30 M30\n";

/// The first fault after X's drive has fallen silent in the middle of a line, and after how many cycles it
/// came.
struct Loss {
  image::AlarmRecord fault;
  std::int64_t cycles = 0;
  image::DriveState other = image::DriveState::offline;
};
enum class Lost { drive, bus };
Loss lose_x(const std::string& keys, Lost what = Lost::drive) {
  Mill mill(mill_with(keys), kLine);
  EXPECT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.ask(image::RequestKind::start), cycle::Refusal::none);
  EXPECT_TRUE(mill.until([&] { return mill.axis("X").command > 50.0; }, 20.0));
  const std::int64_t cut = mill.image().now.number;
  if (what == Lost::drive)
    mill.inject("can.x", fault::Kind::silent);
  else
    mill.control().world().wire(0)->force_bus_off(0);
  const image::AlarmNumber awaited = what == Lost::drive ? axis::alarm::kPdoMissing : cycle::alarm::kBusOff;
  // A long patience lets the lost axis fall behind first: that is a warning.
  EXPECT_TRUE(mill.until([&] { return mill.alarms(awaited) > 0; }, 2.0)) << mill.alarm_list();
  Loss loss;
  for (const image::AlarmRecord& r : mill.control().cycle().alarms().history())
    if (r.reaction > Reaction::warn && loss.fault.number == 0) loss.fault = r;
  loss.cycles = loss.fault.cycle - cut;
  mill.until([&] { return mill.standing(); }, 5.0);
  mill.run(1.0);
  loss.other = mill.axis("Y").drive.state;
  return loss;
}

TEST(NodeLoss, has_the_reaction_that_the_node_declares) {
  const Loss standard = lose_x("");
  EXPECT_EQ(standard.fault.reaction, Reaction::stop_on_path);
  EXPECT_EQ(standard.other, image::DriveState::operation_enabled) << "Y stands and holds";
  EXPECT_EQ(lose_x("loss_reaction = \"stop_axes\"").fault.reaction, Reaction::stop_axes);
  const Loss quick = lose_x("loss_reaction = \"quick_stop\"");
  EXPECT_EQ(quick.fault.reaction, Reaction::quick_stop);
  EXPECT_NE(quick.other, image::DriveState::operation_enabled);
  EXPECT_EQ(lose_x("loss_reaction = \"power_off\"").fault.reaction, Reaction::power_off);
}

TEST(NodeLoss, by_a_bus_that_is_off_has_the_strongest_reaction_of_its_nodes_at_once) {
  const Loss standard = lose_x("", Lost::bus);
  EXPECT_EQ(standard.fault.number, cycle::alarm::kBusOff);
  EXPECT_EQ(standard.fault.reaction, Reaction::stop_on_path);
  const Loss declared = lose_x("loss_reaction = \"quick_stop\"\nloss_cycles = 1000", Lost::bus);
  EXPECT_EQ(declared.fault.number, cycle::alarm::kBusOff);
  EXPECT_EQ(declared.fault.reaction, Reaction::quick_stop);
  EXPECT_LE(declared.cycles, 2);
}

TEST(NodeLoss, counts_after_as_many_cycles_without_process_data_as_the_node_declares) {
  const Loss three = lose_x("loss_cycles = 3");
  const Loss twenty = lose_x("loss_cycles = 20");
  EXPECT_EQ(three.fault.number, axis::alarm::kPdoMissing);
  EXPECT_EQ(twenty.fault.number, axis::alarm::kPdoMissing);
  EXPECT_LE(three.cycles, 5);
  EXPECT_EQ(twenty.cycles - three.cycles, 17);
}

}  // namespace
}  // namespace servogate::machine_run
