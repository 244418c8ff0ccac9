// SPDX-License-Identifier: Apache-2.0
// Scans that somebody else ends, because they do not come back.
#include "plc/engine/scan_watch.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "tests/plc/built.hpp"

namespace servogate::plc {
namespace {

const std::vector<std::string> kLoops = {
    "WHILE never = 0 DO ; END_WHILE;",        "REPEAT UNTIL never > 0 END_REPEAT;",
    "FOR i := 1 TO 3 BY never DO ; END_FOR;", "FOR i := 0 TO 9223372036854775807 DO x := SIN(x); END_FOR;",
    "WHILE TRUE DO s := s; END_WHILE;",       "WHILE TRUE DO i := f(i); END_WHILE;"};

/// A program that no budget ends, once it has come to the loop in its line 5.
std::shared_ptr<const Image> endless(const std::string& loop) {
  Options unlimited;
  unlimited.instruction_budget = std::numeric_limits<std::int64_t>::max();
  return build(
      "FUNCTION f : LINT VAR_INPUT n : LINT; END_VAR f := n; END_FUNCTION\n"
      "FUNCTION_BLOCK Before END_FUNCTION_BLOCK\n"
      "PROGRAM Main VAR before : Before; never, i : LINT; x : LREAL; s : ARRAY[0..999] OF LINT; END_VAR\n"
      "bit_out := TRUE; before();\n" +
          loop + "\nEND_PROGRAM",
      kSymbols, unlimited);
}
const image::Place kOut = kSymbols[7].place;

/// Ends the scan that is under way, from the test's own thread; nobody knows how far it has come.
ScanResult scan_until_ended(Engine& e, image::Packets& p, ScanWatch& watch) {
  ScanResult result;
  std::thread cycle([&] { result = e.scan(p, 0); });
  while (watch.under_way() == 0) std::this_thread::yield();
  watch.end(watch.under_way());
  cycle.join();
  return result;
}

TEST(ScanWatch, ends_a_scan_from_another_thread_wherever_it_is) {
  for (const std::string& loop : kLoops) {
    SCOPED_TRACE(loop);
    Engine e(endless(loop));
    ScanWatch watch;
    e.watch(&watch);
    image::Packets p;
    p.set_bit(kOut, true);
    EXPECT_EQ(scan_until_ended(e, p, watch).fault, Fault::overrun);
    EXPECT_FALSE(p.bit(kOut)) << "what the program writes is off";
    EXPECT_EQ(watch.under_way(), 0u);
    EXPECT_EQ(e.scan(p, 1).fault, Fault::overrun) << "until the restart";
    e.restart();
    EXPECT_EQ(scan_until_ended(e, p, watch).fault, Fault::overrun);
  }
}

/// Ends the scan under way when a clock is looked at for the third time: a scan that is profiled looks when a
/// task begins, then before and behind its first call, which stands right before the loop.
struct EndsBeforeTheLoop final : image::Clock {
  ScanWatch& watch;
  mutable int looks = 0;
  explicit EndsBeforeTheLoop(ScanWatch& w) : watch(w) {}
  image::Nanoseconds now_ns() const noexcept override {
    if (++looks == 3) watch.end(watch.under_way());
    return looks;
  }
};

TEST(ScanWatch, ends_every_form_of_loop_and_names_its_line) {
  for (const std::string& loop : kLoops) {
    SCOPED_TRACE(loop);
    Engine e(endless(loop));
    ScanWatch watch;
    e.watch(&watch);
    const EndsBeforeTheLoop clock(watch);
    e.measure(&clock);
    std::vector<Times> blocks(e.image().units.size());
    e.profile(blocks.data());
    image::Packets p;
    EXPECT_EQ(
        e.describe(e.scan(p, 0)).str(text::Language::english),
        "t.st:5:1: error: task cycle: the scan did not come back and was ended here [plc-fault-overrun]");
  }
}

TEST(ScanWatch, that_ends_a_scan_that_is_over_ends_no_other) {
  Engine e(
      build("PROGRAM Main VAR i, n : DINT; END_VAR FOR i := 1 TO 10 DO n := n + 1; END_FOR; END_PROGRAM"));
  ScanWatch watch;
  e.watch(&watch);
  image::Packets p;
  ASSERT_EQ(e.scan(p, 0).fault, Fault::none);
  watch.end(1);
  ASSERT_EQ(e.scan(p, 1).fault, Fault::none);
  watch.end_next();
  EXPECT_EQ(e.scan(p, 2).fault, Fault::overrun);
  EXPECT_EQ(e.read(*e.find("n")), "20") << "it did nothing";
}

}  // namespace
}  // namespace servogate::plc
