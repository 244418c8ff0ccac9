// SPDX-License-Identifier: Apache-2.0
// The PLC as the logic of a cycle, without a machine around it.
#include "plc/logic/logic.hpp"

#include <gtest/gtest.h>

#include "firmware_if/image/alarm_numbers.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/plc/built.hpp"

namespace servogate::plc {
namespace {

struct Still final : image::Clock {
  image::Nanoseconds now_ns() const noexcept override { return 0; }
};

/// A cycle of 10 ms with logic and nothing else.
struct Cycle {
  explicit Cycle(const std::string& text) : logic(build(text, kSymbols), {{"t.st", text}}, clock) {
    image.now.period_ns = 10 * image::kMillisecond;
  }
  void step() {
    notices.clear();
    logic.scan(image, notices);
    image.now.t_ns += image.now.period_ns;
    ++image.now.number;
  }
  bool order(image::RequestKind kind, std::uint32_t index, double value = 0.0) {
    image::Request request;
    request.kind = kind;
    request.index = index;
    request.value = value;
    return logic.order(request);
  }
  std::string read(const std::string& name) {
    const Engine& engine = logic.program()->engine;
    return engine.read(*engine.find(name));
  }

  Still clock;
  Logic logic;
  image::ProcessImage image;
  image::Notices notices;
};

constexpr const char* kCounts = "PROGRAM Main VAR n : DINT; END_VAR n := n + 1; bit_out := TRUE; END_PROGRAM";
const image::Place kOut = kSymbols[7].place;

TEST(Logic, tells_a_fault_once_with_its_number_and_has_the_words_for_it) {
  Cycle c("PROGRAM Main VAR n, d : DINT; END_VAR\nbit_out := TRUE;\nn := 1 / d;\nEND_PROGRAM");
  c.step();
  ASSERT_EQ(c.notices.records().size(), 1u);
  const image::AlarmRecord record = c.notices.records()[0];
  EXPECT_EQ(record.number, image::alarm::kPlcFault);
  EXPECT_EQ(record.line, 3);
  EXPECT_NE(c.logic.fault_words(record, text::Language::english).find("divided by zero"), std::string::npos);
  EXPECT_FALSE(c.image.packets.bit(kOut));
  c.step();
  EXPECT_TRUE(c.notices.records().empty());
}

TEST(Logic, takes_another_program_between_two_scans_without_allocating) {
  Cycle c(kCounts);
  c.step();
  LogicChange change;
  change.number = 1;
  change.online = true;
  const std::string text = "PROGRAM Main VAR fresh, n : DINT; END_VAR n := n + 10; word := 7; END_PROGRAM";
  change.files = {{"t.st", text}};
  const Logic::Plan plan = c.logic.prepare(change, compile(change.files, kSymbols, {}));
  ASSERT_TRUE(plan.possible);
  EXPECT_EQ(plan.kept, 1u);
  EXPECT_EQ(plan.fresh, std::vector<std::string>{"Main.fresh"});
  c.step();
  EXPECT_EQ(c.read("n"), "2") << "nothing changes before it is ordered";
  const std::uint64_t before = counting::allocations();
  EXPECT_TRUE(c.order(image::RequestKind::logic, 1));
  c.step();
  EXPECT_EQ(counting::allocations(), before);
  EXPECT_FALSE(c.image.packets.bit(kOut)) << "the new program does not write it";
  c.logic.settle();
  EXPECT_EQ(c.read("n"), "12");
  EXPECT_FALSE(c.order(image::RequestKind::logic, 1)) << "once";
}

TEST(Logic, a_change_that_was_withdrawn_is_not_carried_out) {
  Cycle c(kCounts);
  LogicChange force;
  force.kind = LogicChange::Kind::force;
  force.number = 5;
  force.name = "n";
  force.value = "100";
  EXPECT_TRUE(c.logic.prepare(force, {}).possible);
  c.logic.withdraw(5);
  EXPECT_FALSE(c.order(image::RequestKind::logic, 5));
  force.number = 6;
  EXPECT_TRUE(c.logic.prepare(force, {}).possible);
  EXPECT_TRUE(c.order(image::RequestKind::logic, 6));
  c.step();
  c.logic.settle();
  EXPECT_EQ(c.logic.forced(), (std::vector<std::pair<std::string, std::string>>{{"n", "100"}}));
  EXPECT_EQ(c.read("n"), "100");
}

TEST(Logic, that_is_held_writes_nothing_and_goes_on_where_it_stood) {
  Cycle c(kCounts);
  c.step();
  EXPECT_TRUE(c.image.packets.bit(kOut));
  c.order(image::RequestKind::logic_scan, 0, 1.0);
  c.step();
  c.step();
  EXPECT_FALSE(c.image.packets.bit(kOut)) << "held: what it writes is off";
  EXPECT_EQ(c.read("n"), "1");
  c.order(image::RequestKind::logic_scan, 3, 2.0);
  for (int i = 0; i < 5; ++i) c.step();
  EXPECT_EQ(c.read("n"), "4") << "three scans were asked for";
  EXPECT_FALSE(c.image.packets.bit(kOut));
  c.order(image::RequestKind::logic_scan, 0, 0.0);
  c.step();
  EXPECT_EQ(c.read("n"), "5");
  EXPECT_TRUE(c.image.packets.bit(kOut));
}

TEST(Logic, fills_a_sample_in_the_next_scan_and_gives_it_back_before) {
  Cycle c(kCounts);
  const Handle n = *c.logic.program()->engine.find("n");
  LogicSample sample;
  sample.ranges = {{n.address, n.type->size}};
  c.logic.ask(sample);
  EXPECT_FALSE(c.logic.filled(sample));
  EXPECT_TRUE(c.logic.take_back());
  c.step();
  EXPECT_FALSE(c.logic.filled(sample)) << "it was taken back";
  c.logic.ask(sample);
  c.step();
  EXPECT_TRUE(c.logic.filled(sample));
  EXPECT_FALSE(c.logic.take_back()) << "the cycle is through with it";
  EXPECT_EQ(sample.bytes[0], 2);
  EXPECT_EQ(sample.at.number, 1);
}

}  // namespace
}  // namespace servogate::plc
