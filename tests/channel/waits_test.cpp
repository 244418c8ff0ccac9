// SPDX-License-Identifier: Apache-2.0
// What a process says of itself to people: what it waits for and since when, its messages, where it is.
#include <gtest/gtest.h>

#include "firmware_if/image/interface_map.hpp"
#include "tests/channel/rig.hpp"

namespace servogate::channel::test {
namespace {

using image::ProcessState;
using image::RequestKind;
using image::WaitReason;

constexpr const char* kLongLine = "N10 G1 X200 Y100 F9000\nN20 X0 Y100\nN30 M30\n";

image::Place nc(std::string_view name) {
  for (const image::Symbol& s : image::interface_symbols(1, {"X", "Y", "Z"}, 1))
    if (s.name == name) return s.place;
  ADD_FAILURE() << name;
  return {};
}

TEST(Wait, for_a_signal_names_its_place_its_value_its_line_and_since_when) {
  Rig rig("N10 G0 X1\nN20 (WAI,SA5=1)\nN30 G0 X10\nN40 M30\n");
  rig.start();
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == WaitReason::signal; }, 5.0));
  const image::Wait begun = rig.status().wait;
  EXPECT_EQ(begun.place, sa(5));
  EXPECT_EQ(begun.compare, image::Compare::eq);
  EXPECT_EQ(begun.value, 1.0);
  EXPECT_EQ(begun.line, 2);
  EXPECT_EQ(begun.since_ns, rig.image().now.t_ns);
  rig.run(2.0);
  EXPECT_EQ(rig.status().wait, begun) << "the same wait, from its beginning";
}

TEST(Wait, for_the_plc_names_the_word_and_its_code) {
  Rig rig("N10 T5.2 M6\nN20 S900 M3\nN30 M8\nN40 M30\n");
  rig.logic.delay_cycles = 20;
  std::string waits;
  WaitReason last = WaitReason::none;
  rig.each = [&] {
    const image::Wait& w = rig.status().wait;
    if (w.reason == last) return;
    last = w.reason;
    if (w.reason == WaitReason::t_acknowledge)
      waits += "T" + std::to_string(w.code) + (w.place == nc("NC.t_ack") ? " " : "? ");
    if (w.reason == WaitReason::s_acknowledge)
      waits += "S" + std::to_string(static_cast<int>(w.value)) + (w.place == nc("NC.s_ack") ? " " : "? ");
    if (w.reason == WaitReason::m_acknowledge)
      waits += "M" + std::to_string(w.code) + (w.place == nc("NC.m_ack") ? " " : "? ");
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(waits.substr(0, 12), "T5 M6 S900 M") << waits;
  EXPECT_EQ(rig.status().wait.reason, WaitReason::none) << "a program that has ended waits for nothing";
}

TEST(Wait, on_the_path_names_who_holds_the_feed) {
  struct Case {
    const char* what;
    WaitReason reason;
    const char* place;
    int axis;
    void (*hold)(Rig&);
  };
  const Case cases[] = {
      {"operator", WaitReason::operator_hold, "", -1, [](Rig& r) { r.ask(RequestKind::hold); }},
      {"stop bit", WaitReason::plc_hold, "NC.stop", -1, [](Rig& r) { r.logic.stop_bit = true; }},
      {"feed_enable", WaitReason::feed_enable, "NC.feed_enable", -1,
       [](Rig& r) { r.logic.feed_enable = false; }},
      {"Y.feed_enable", WaitReason::axis_feed_enable, "Y.feed_enable", 1,
       [](Rig& r) { r.logic.axis_feed_enable[1] = false; }},
      {"override", WaitReason::override_zero, "", -1, [](Rig& r) { r.ask(RequestKind::override_feed, 0.0); }},
  };
  for (const Case& c : cases) {
    Rig rig(kLongLine);
    rig.start();
    rig.run(0.6);
    EXPECT_EQ(rig.status().wait.reason, WaitReason::none) << c.what << ": it moves";
    c.hold(rig);
    ASSERT_TRUE(rig.until([&] { return rig.state() == ProcessState::held; }, 1.0)) << c.what;
    rig.run(0.01);
    const image::Wait& w = rig.status().wait;
    EXPECT_EQ(w.reason, c.reason) << c.what;
    EXPECT_EQ(w.axis, c.axis) << c.what;
    EXPECT_EQ(w.line, 1) << c.what;
    EXPECT_EQ(w.place, *c.place == '\0' ? image::Place{} : nc(c.place)) << c.what;
    EXPECT_FALSE(rig.moving());
  }
}

TEST(Wait, before_the_first_motion_is_one_too) {
  Rig rig(kLongLine);
  rig.logic.feed_enable = false;
  rig.start();
  rig.run(0.5);
  EXPECT_EQ(rig.status().wait.reason, WaitReason::feed_enable);
  EXPECT_EQ(rig.x(), 0.0);
}

TEST(Wait, tells_dwell_read_in_enable_and_the_operators_buttons_apart) {
  const auto wait_of = [](const char* program, auto&& change) {
    Rig rig(program);
    change(rig);
    rig.start();
    rig.run(1.0);
    return rig.status().wait;
  };
  const auto nothing = [](Rig&) {};
  EXPECT_EQ(wait_of("N10 TMR=9\nN20 G4\nN30 M30\n", nothing).reason, WaitReason::dwell);
  EXPECT_EQ(wait_of("N10 TMR=9\nN20 G4\nN30 M30\n", nothing).value, 9.0);
  EXPECT_EQ(wait_of("N10 G0 X1\nN20 M00\nN30 M30\n", nothing).reason, WaitReason::program_stop);
  EXPECT_EQ(wait_of("N10 G0 X1\nN20 M01\nN30 M30\n", [](Rig& r) { r.logic.optional_stop = true; }).reason,
            WaitReason::optional_stop);
  EXPECT_EQ(wait_of("N10 G0 X1\nN20 X2\nN30 M30\n",
                    [](Rig& r) { r.ask(RequestKind::mode, static_cast<double>(image::Mode::step)); })
                .reason,
            WaitReason::block_end);
  const image::Wait reading =
      wait_of("N10 G0 X1\nN20 E1=SK10.IN\nN30 M30\n", [](Rig& r) { r.logic.read_in_enable = false; });
  EXPECT_EQ(reading.reason, WaitReason::read_in_enable);
  EXPECT_EQ(reading.place, nc("NC.read_in_enable"));
  EXPECT_EQ(reading.line, 2);
}

TEST(Message, of_a_program_shows_when_its_block_is_reached_and_goes_with_the_next_program) {
  Rig rig("N10 (DIS,\"FIRST\")\nN20 G1 X20 F3000\nN30 (DIS,\"SECOND\")\nN40 (WAI,SA5=1)\nN50 M30\n");
  const auto shown = [&] { return rig.process->texts().message(rig.status().message).value_or(""); };
  EXPECT_EQ(shown(), "");
  rig.start();
  rig.run(0.2);
  EXPECT_EQ(shown(), "FIRST") << "read ahead is not shown";
  ASSERT_TRUE(rig.until([&] { return rig.status().wait.reason == WaitReason::signal; }, 5.0));
  EXPECT_EQ(shown(), "SECOND");
  rig.ask(RequestKind::reset);
  rig.run(0.1);
  EXPECT_EQ(shown(), "");
}

TEST(Status, of_the_last_run_goes_with_a_reset_a_new_program_and_a_new_start) {
  Rig rig("N10 G1 X20 F6000\nN20 X40\nN30 M30\n");
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(rig.status().line, 3);
  EXPECT_EQ(rig.status().blocks_done, 3);
  EXPECT_EQ(rig.process->texts().file(rig.status().run, rig.status().file), "test.nc");
  rig.load("N10 (WAI,SA5=1)\nN20 M30\n");
  rig.run(0.01);
  EXPECT_EQ(rig.status().line, 0) << "loaded";
  EXPECT_EQ(rig.status().blocks_done, 0);
  EXPECT_EQ(rig.state(), ProcessState::idle);
  rig.start();
  rig.run(0.1);
  EXPECT_EQ(rig.status().line, 1) << "not the old program's";
  EXPECT_EQ(rig.status().blocks_done, 1);
  rig.ask(RequestKind::stop);
  rig.run(0.1);
  EXPECT_EQ(rig.status().line, 1) << "a stop leaves it";
  rig.ask(RequestKind::reset);
  rig.run(0.01);
  EXPECT_EQ(rig.status().line, 0) << "reset at rest";
  rig.load(kLongLine);
  rig.start();
  rig.run(0.6);
  EXPECT_EQ(rig.status().line, 1);
  rig.ask(RequestKind::reset);
  rig.run(1.0);
  EXPECT_EQ(rig.status().line, 0) << "reset in motion";
  EXPECT_EQ(rig.status().run, 3u);
}

TEST(Status, counts_the_blocks_that_were_executed_loops_as_often_as_they_ran) {
  Rig rig("N10 E30=0\n\"L\"N20 E30=E30+1\nN30 G0 XE30\nN40 (BLT,E30,3,L)\nN50 M30\n");
  std::vector<std::int64_t> counts;
  rig.each = [&] {
    if (counts.empty() || counts.back() != rig.status().blocks_done)
      counts.push_back(rig.status().blocks_done);
  };
  ASSERT_TRUE(rig.finish()) << rig.alarm_list();
  EXPECT_EQ(rig.status().blocks_done, 1 + 3 * 3 + 1);
  EXPECT_EQ(rig.process->feeder().executed(), 1 + 3 * 3 + 1);
  EXPECT_TRUE(std::is_sorted(counts.begin(), counts.end()));
}

TEST(Texts, keep_the_newest_findings_and_messages_under_the_numbers_they_had) {
  ProgramTexts texts;
  EXPECT_FALSE(texts.message(0) || texts.message(1) || texts.finding(1));
  const int more = static_cast<int>(ProgramTexts::kMessagesKept) + 10;
  for (int i = 1; i <= more; ++i) EXPECT_EQ(texts.add_message(std::to_string(i)), i);
  EXPECT_EQ(texts.message(more), std::to_string(more));
  EXPECT_EQ(texts.message(11), "11");
  EXPECT_FALSE(texts.message(10));
  EXPECT_FALSE(texts.message(more + 1));
  texts.set_files(1, {"a"});
  texts.set_files(1, {"a", "sub"});
  texts.set_files(2, {"b"});
  EXPECT_EQ(texts.file(1, 1), "sub");
  EXPECT_EQ(texts.file(2, 0), "b");
  EXPECT_EQ(texts.file(2, 1), "");
  EXPECT_EQ(texts.file(3, 0), "");
}

}  // namespace
}  // namespace servogate::channel::test
