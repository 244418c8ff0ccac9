// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/record_file.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>

#include "gateway/control/run/running_machine.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/property_seed.hpp"

namespace servogate::machine_run {
namespace {

std::string small_record(const Scratch& scratch, int cycles) {
  const std::string path = scratch.path("record");
  gateway::RecordHeader header;
  header.machine = "/m.toml";
  header.state.tables.origins[3]["X"] = 1.5;
  header.period_ns = 1000000;
  gateway::RecordWriter writer(path, header);
  writer.take(gateway::ProgramChange{gateway::ProgramChange::Kind::block, 0, {}, {}, "G0 X1"});
  std::mt19937 random(7);
  cycle::CycleInputs in;
  for (int i = 0; i < cycles; ++i) {
    in.number = i;
    in.axes[0].position_counts += static_cast<std::int64_t>(random() % 100);
    in.packet_a[random() % 20] = static_cast<std::uint8_t>(random());
    in.visible[0] += random() % 5;
    writer.wait_for_room();
    writer.take(in);
  }
  EXPECT_EQ(writer.close(), "");
  return path;
}

/// Number of cycles that a reader gives before it ends; `sound`: the record says it is whole.
int cycles_of(const std::string& path, bool& sound, std::string& error) {
  gateway::RecordReader reader;
  error.clear();
  sound = false;
  if (!reader.open(path, error)) {
    EXPECT_NE(error, "");
    return 0;
  }
  cycle::CycleInputs in;
  int n = 0;
  for (; reader.give(in); ++n) EXPECT_EQ(in.number, n);
  EXPECT_EQ(reader.next(), nullptr);
  sound = !reader.damaged();
  return n;
}

TEST(RecordFile, gives_back_header_and_cycles) {
  const Scratch scratch;
  const std::string path = small_record(scratch, 100);
  gateway::RecordReader reader;
  std::string error;
  ASSERT_TRUE(reader.open(path, error)) << error;
  EXPECT_EQ(reader.header().machine, "/m.toml");
  EXPECT_EQ(reader.header().period_ns, 1000000);
  EXPECT_EQ(reader.header().state.tables.origins.at(3).at("X"), 1.5);
  bool sound = false;
  EXPECT_EQ(cycles_of(path, sound, error), 100);
  EXPECT_TRUE(sound);
}

TEST(RecordFile, on_a_full_disk_is_an_alarm_of_the_machine_that_goes_on) {
  std::vector<text::Finding> findings;
  const auto machine = gateway::RunningMachine::compose(machine::load(mill_file()), nullptr,
                                                        {.record = "/dev/full"}, findings);
  ASSERT_NE(machine, nullptr);
  const auto warned = [&] { return machine->control().cycle().alarms().active(cycle::alarm::kRecordBroken); };
  EXPECT_FALSE(warned());
  for (int n = 0; n < 200'000 && !warned(); ++n) ASSERT_TRUE(machine->step());
  EXPECT_TRUE(warned());
  machine->stop();
  EXPECT_EQ(machine->close_files().size(), 1u);
}

TEST(RecordFile, is_read_however_large_it_is) {
  const Scratch scratch;
  const std::string path = small_record(scratch, 100);
  bool sound = false;
  std::string error;
  // A hole of 5 GiB takes no room on the disk; what stands before it is given all the same.
  std::filesystem::resize_file(path, std::uintmax_t{5} << 30);
  EXPECT_EQ(cycles_of(path, sound, error), 100) << error;
  EXPECT_FALSE(sound) << "what follows the end is damage";
}

TEST(RecordFile, gives_back_what_was_loaded_with_texts_tables_and_subprograms) {
  const Scratch scratch;
  const std::string path = scratch.path("record");
  auto file = std::make_shared<gateway::ProgramFile>();
  file->path = "/p.nc";
  file->dialect = "nc110";
  file->text = "N10 G0 X1\r\n\xcf\xf0\n";  // as it stands, whatever its encoding
  program::Tables tables;
  tables.origins[2]["Y"] = -0.1;
  {
    gateway::RecordWriter writer(path, {});
    using Kind = gateway::ProgramChange::Kind;
    cycle::CycleInputs in;
    writer.take(gateway::ProgramChange{Kind::program, 0, file, {}, {}});
    writer.take_subprogram(0, "PECK", "N1 G1\nN2\n");
    writer.take(in);
    writer.take(gateway::ProgramChange{Kind::tables, 0, file, tables, {}});
    writer.take(gateway::ProgramChange{Kind::block, 0, {}, {}, "G0 X1 \"2\""});
    writer.take(gateway::ProgramChange{Kind::modes, 0, {}, {}, {}});
    in.number = 1;
    writer.take(in);
    EXPECT_EQ(writer.close(), "");
  }
  gateway::RecordReader reader;
  std::string error;
  ASSERT_TRUE(reader.open(path, error)) << error;
  const auto changes = reader.changes({});
  ASSERT_EQ(changes.size(), 4u);
  EXPECT_EQ(changes[0].file->path, "/p.nc");
  EXPECT_EQ(changes[0].file->dialect, "nc110");
  EXPECT_EQ(changes[0].file->text, file->text);
  const auto peck = changes[0].file->loader("PECK");
  ASSERT_TRUE(peck);
  EXPECT_EQ(peck->text, "N1 G1\nN2\n");
  EXPECT_FALSE(changes[0].file->loader("OTHER"));
  EXPECT_EQ(changes[1].kind, gateway::ProgramChange::Kind::tables);
  EXPECT_EQ(changes[1].file, changes[0].file) << "its text stands in the record once";
  EXPECT_EQ(changes[1].tables.origins.at(2).at("Y"), -0.1);
  EXPECT_EQ(changes[2].block, "G0 X1 \"2\"");
  EXPECT_EQ(changes[3].kind, gateway::ProgramChange::Kind::modes);
  bool sound = false;
  EXPECT_EQ(cycles_of(path, sound, error), 2);
  EXPECT_TRUE(sound);
}

TEST(RecordFile, cut_at_any_byte_is_noticed) {
  const Scratch scratch;
  const std::string whole = read_all(small_record(scratch, 8));
  bool sound = false;
  std::string error;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const int cycles = cycles_of(scratch.write("cut", whole.substr(0, length)), sound, error);
    ASSERT_FALSE(sound) << length << " of " << whole.size();
    ASSERT_LE(cycles, 8);
  }
}

TEST(RecordFile, changed_at_any_byte_is_noticed) {
  const Scratch scratch;
  const std::string whole = read_all(small_record(scratch, 8));
  const auto seed = static_cast<unsigned>(servogate::test::property_seed());
  std::mt19937 random(seed);
  bool sound = false;
  std::string error;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 << random() % 8));
    cycles_of(scratch.write("changed", changed), sound, error);
    ASSERT_FALSE(sound) << "byte " << at << " of " << whole.size() << ", seed " << seed;
  }
}

TEST(RecordFile, bytes_behind_the_end_are_noticed) {
  const Scratch scratch;
  const std::string whole = read_all(small_record(scratch, 8));
  bool sound = true;
  std::string error;
  cycles_of(scratch.write("longer", whole + "x"), sound, error);
  EXPECT_FALSE(sound);
}

TEST(RecordFile, says_how_many_cycles_a_slow_disk_lost) {
  const Scratch scratch;
  gateway::RecordWriter writer(scratch.path("r"), {});
  cycle::CycleInputs in;
  for (int i = 0; i < 200000 && writer.lost() == 0; ++i) {
    in.number = i;
    for (auto& axis : in.axes) ++axis.position_counts;  // much to write
    writer.take(in);
  }
  ASSERT_GT(writer.lost(), 0u) << "the writer is faster than memory";
  EXPECT_NE(writer.close().find("could not be kept"), std::string::npos);
}

TEST(RecordFile, that_cannot_be_opened_says_why) {
  gateway::RecordWriter writer("/nonexistent/folder/r", {});
  EXPECT_EQ(text::in_language(writer.close(), text::Language::english), std::strerror(ENOENT));
}

}  // namespace
}  // namespace servogate::machine_run
