// SPDX-License-Identifier: Apache-2.0
#include "kernel/program/interpreter/interpreter.hpp"

#include <gtest/gtest.h>

#include <set>

#include "kernel/program/check/canon.hpp"
#include "kernel/program/faults/texts.hpp"
#include "kernel/program/languages/fenix/faults.hpp"
#include "kernel/program/languages/languages.hpp"
#include "kernel/program/languages/nc110/faults/texts.hpp"
#include "tests/program/case_file.hpp"

namespace servogate::program::tests {
namespace {

Interpreter interpreter(const std::string& text, MachineModel machine = mill()) {
  return Interpreter("nc110", std::move(machine), {}, "p.nc", text, {}, Position{});
}

template <typename What>
What expect(Interpreter& run, const image::Packets& packets, bool synchronised = false) {
  const Step step = run.next(packets, synchronised);
  const auto* command = std::get_if<Command>(&step);
  if (command == nullptr || !std::holds_alternative<What>(command->what)) {
    ADD_FAILURE() << "another step: kind " << step.index();
    return {};
  }
  return std::get<What>(command->what);
}

bool waits(Interpreter& run, const image::Packets& packets, int line) {
  const Step step = run.next(packets, false);
  const auto* wait = std::get_if<NeedsSync>(&step);
  return wait != nullptr && wait->line == line;
}

TEST(Interpreter, asks_for_the_end_of_motion_before_it_reads_a_signal) {
  image::Packets packets;
  Interpreter run = interpreter("G0 X1\n(BEQ,SA3,1,L)\nG0 X2\n\"L\"G0 X3");
  expect<Rapid>(run, packets);
  EXPECT_TRUE(waits(run, packets, 2));
  EXPECT_TRUE(waits(run, packets, 2));
  packets.set_bit({image::Packet::a, image::Format::bl, 3, 1}, true);
  EXPECT_DOUBLE_EQ(3.0, expect<Rapid>(run, packets, true).to[0]);
}

TEST(Interpreter, reads_ahead_of_motion_where_the_program_cancels_synchronisation) {
  image::Packets packets;
  Interpreter run = interpreter("G0 X1\n&E0=SK5\n#G0 X2\nG0 XE30");
  expect<Rapid>(run, packets);
  EXPECT_TRUE(waits(run, packets, 3));
}

TEST(Interpreter, writes_signals_in_path_order_without_waiting) {
  image::Packets packets;
  Interpreter run = interpreter("G1 X1 F100\nSA40=1\nG1 X2\nSYVAR3=7");
  expect<Line>(run, packets);
  EXPECT_TRUE(expect<WritePlace>(run, packets).synchronous);
  expect<Line>(run, packets);
  EXPECT_FALSE(expect<WritePlace>(run, packets).synchronous);
}

TEST(Interpreter, sees_its_own_variables_before_they_come_back_in_a_snapshot) {
  const image::Packets untouched;
  Interpreter run = interpreter(
      "SYVAR1.IN=300\nSYVAR3=9\nE10=SYVAR1.IN\nE0=SYVAR3\n(DIS,E10,E0)\nSYVAR8.BL=1\n(DIS,SYVAR1)");
  expect<WritePlace>(run, untouched);
  expect<WritePlace>(run, untouched);
  EXPECT_EQ("E10=2348 E0=9", expect<Message>(run, untouched).text);  // SYVAR3 is the high byte of SYVAR1.IN
  expect<WritePlace>(run, untouched);
  EXPECT_EQ("SYVAR1=1", expect<Message>(run, untouched).text);
}

TEST(Interpreter, reads_nothing_behind_a_wait_until_it_is_over) {
  image::Packets packets;
  Interpreter run = interpreter("(WAI,SA12=1)\nE0=SYVAR5\nG0 XE30");
  expect<Wait>(run, packets);
  EXPECT_TRUE(waits(run, packets, 2));
  EXPECT_DOUBLE_EQ(0.0, expect<Rapid>(run, packets, true).to[0]);
}

TEST(Interpreter, asks_for_a_fresh_snapshot_in_each_turn_of_a_polling_loop) {
  image::Packets packets;
  Interpreter run = interpreter("\"A\"(BEQ,SA3,0,A)\nG0 X1");
  for (int i = 0; i < 5; ++i) {
    const Step step = run.next(packets, true);
    EXPECT_TRUE(std::holds_alternative<NeedsSync>(step));
  }
  packets.set_bit({image::Packet::a, image::Format::bl, 3, 1}, true);
  EXPECT_DOUBLE_EQ(1.0, expect<Rapid>(run, packets, true).to[0]);
}

TEST(Interpreter, keeps_returning_its_end_and_its_error) {
  image::Packets packets;
  Interpreter good = interpreter("G0 X1\nM30\nG0 X2");
  expect<Rapid>(good, packets);
  expect<MFunction>(good, packets);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(expect<End>(good, packets).rewind);
  Interpreter bad = interpreter("G0 X1\nG0 XX");
  expect<Rapid>(bad, packets);
  for (int i = 0; i < 3; ++i) {
    const Step step = bad.next(packets, false);
    ASSERT_TRUE(std::holds_alternative<Error>(step));
    EXPECT_EQ(2, std::get<Error>(step).finding.line);
  }
}

TEST(Interpreter, gives_nothing_of_a_block_that_fails) {
  image::Packets packets;
  Interpreter run = interpreter("G29 T1.1 S500 M3 G1 X1000 F100");
  EXPECT_TRUE(std::holds_alternative<Error>(run.next(packets, false)));
}

TEST(Interpreter, runs_a_typed_block_in_the_modal_state_and_forgets_a_wrong_one) {
  image::Packets packets;
  Interpreter run = interpreter("");
  run.mdi("G1 X10 F200");
  EXPECT_DOUBLE_EQ(10.0, expect<Line>(run, packets).to[0]);
  EXPECT_TRUE(std::holds_alternative<End>(std::get<Command>(run.next(packets, false)).what));
  run.mdi("G91 X1000");
  EXPECT_TRUE(std::holds_alternative<Error>(run.next(packets, false)));
  EXPECT_DOUBLE_EQ(10.0, run.position()[0]);
  run.mdi("X20");
  EXPECT_DOUBLE_EQ(20.0, expect<Line>(run, packets).to[0]);
  run.next(packets, false);
  run.mdi("G91 G0 X5");
  EXPECT_DOUBLE_EQ(25.0, expect<Rapid>(run, packets).to[0]);
  run.next(packets, false);
  run.mdi("X5");
  EXPECT_DOUBLE_EQ(30.0, expect<Rapid>(run, packets).to[0]);
}

TEST(Interpreter, counts_blocks_and_knows_its_files) {
  const auto loader = [](std::string_view) { return std::optional<std::string>("G0 X2\n"); };
  Interpreter run("nc110", mill(), {}, "p.nc", "; c\nG0 X1\n\n(CLS,SUB)\n%\nM30", loader, Position{}, 2);
  EXPECT_EQ(3, run.block_count());
  image::Packets packets;
  run.next(packets, false);
  const Step step = run.next(packets, false);
  EXPECT_EQ(2, std::get<Command>(step).process);
  EXPECT_EQ(1, std::get<Command>(step).file);
  EXPECT_EQ((std::vector<std::string>{"p.nc", "SUB"}), run.files());
  EXPECT_EQ(3, run.executed());
}

TEST(Interpreter, starts_where_the_machine_stands) {
  Position start{};
  start[0] = 7.0;
  start[2] = -3.0;
  Interpreter run("nc110", mill(), {}, "p.nc", "G91 G0 X1 Z-1", {}, start);
  image::Packets packets;
  const Rapid rapid = expect<Rapid>(run, packets);
  EXPECT_DOUBLE_EQ(8.0, rapid.to[0]);
  EXPECT_DOUBLE_EQ(-4.0, rapid.to[2]);
}

TEST(Interpreter, names_a_language_that_this_build_does_not_read) {
  Interpreter run("rs274", mill(), {}, "p.nc", "G0 X1", {}, Position{});
  const Step step = run.next(image::Packets{}, true);
  ASSERT_TRUE(std::holds_alternative<Error>(step));
  EXPECT_EQ("p.nc:1:1: error: there is no dialect rs274 [P903]",
            std::get<Error>(step).finding.str(text::Language::english));
  EXPECT_EQ((std::vector<std::string>{"nc110", "fenix", "sinumerik-808d"}), dialects());
}

TEST(Interpreter, refuses_a_power_on_mode_that_is_none) {
  MachineModel machine = mill();
  machine.power_on.push_back("G88");
  Interpreter run = interpreter("G0 X1", machine);
  const Step step = run.next(image::Packets{}, true);
  ASSERT_TRUE(std::holds_alternative<Error>(step));
  EXPECT_EQ("P902", std::get<Error>(step).finding.entry->id);
}

TEST(Interpreter, is_as_after_power_on_when_a_program_has_ended) {
  image::Packets packets;
  Interpreter run = interpreter("(UIO,X5)\nG91 G70 G29 G1 X1 F10\nM30");
  expect<Line>(run, packets);
  expect<MFunction>(run, packets);
  expect<End>(run, packets);
  run.mdi("G1 X40 F100");
  const Line line = expect<Line>(run, packets);
  EXPECT_DOUBLE_EQ(40.0, line.to[0]);
  EXPECT_EQ(Transition::corner_limited, line.corner.transition);
}

TEST(Json, stays_json_whatever_bytes_a_message_holds) {
  Command command;
  command.line = 1;
  command.what = Message{
      "a\"\\\x01\x8F\xC4"
      "b\xD0\x96\xED\xA0\x80"};
  EXPECT_EQ(
      "{\"cmd\":\"message\",\"line\":1,\"text\":"
      "\"a\\\"\\\\\\u0001\\ufffd\\ufffdb\xD0\x96\\ufffd\\ufffd\\ufffd\"}",
      to_json(command, {"X"}, {"p"}));
}

TEST(Json, writes_numbers_so_that_they_read_back) {
  Command command;
  command.line = 7;
  command.file = 1;
  command.process = 2;
  Rapid rapid;
  rapid.to[0] = 0.1 + 0.2;
  rapid.to[1] = -0.0;
  command.what = rapid;
  EXPECT_EQ(
      "{\"cmd\":\"rapid\",\"line\":7,\"file\":\"SUB\",\"process\":2,\"to\":{\"X\":0.30000000000000004,\"Y\":"
      "0}}",
      to_json(command, {"X", "Y"}, {"p", "SUB"}));
}

TEST(Messages, have_both_languages_and_the_same_placeholders) {
  const auto placeholders = [](std::string_view text) {
    std::string found;
    for (char c = '0'; c <= '9'; ++c)
      if (text.find(std::string{'{', c, '}'}) != std::string_view::npos) found += c;
    return found;
  };
  std::set<std::string_view> ids;
  std::vector<text::Entry> all(messages().begin(), messages().end());
  all.insert(all.end(), nc110::messages().begin(), nc110::messages().end());
  all.insert(all.end(), fenix::messages().begin(), fenix::messages().end());
  for (const text::Entry& message : all) {
    EXPECT_TRUE(ids.insert(message.id).second) << message.id;
    EXPECT_FALSE(message.english.empty()) << message.id;
    EXPECT_EQ(placeholders(message.english), placeholders(message.russian)) << message.id;
    bool cyrillic = false;
    for (const char c : message.russian)
      cyrillic = cyrillic || (static_cast<unsigned char>(c) & 0xF0) == 0xD0;
    EXPECT_TRUE(cyrillic) << message.id;
  }
}

}  // namespace
}  // namespace servogate::program::tests
