// SPDX-License-Identifier: Apache-2.0
// What a changed program takes over from the one before it, and what stands at an address of its own.
#include "plc/engine/transfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/counting/allocations.hpp"
#include "tests/plc/built.hpp"

namespace servogate::plc {
namespace {

using image::Format;
using image::Packet;

constexpr const char* kFirstProgram = R"(TYPE Light : (Dark, Bright); END_TYPE
FUNCTION_BLOCK Counter VAR_INPUT up : BOOL R_EDGE; END_VAR VAR n : DINT; END_VAR IF up THEN n := n + 1; END_IF; END_FUNCTION_BLOCK
VAR_GLOBAL total : DINT; END_VAR
VAR_GLOBAL CONSTANT limit : INT := 5; END_VAR
PROGRAM Main
VAR RETAIN kept : DINT; END_VAR
VAR flag : BOOL; c : Counter; t : TON; light : Light := Bright; list : ARRAY[1..3] OF INT; old : INT; END_VAR
kept := kept + 1; total := total + 2; flag := TRUE; c(up := flag); t(IN := TRUE, PT := T#1s); list[2] := 7; old := limit;
END_PROGRAM)";
constexpr const char* kSecondProgram = R"(TYPE Light : (Dark, Bright, Blinking); END_TYPE
FUNCTION_BLOCK Counter VAR_INPUT up : BOOL R_EDGE; END_VAR VAR n : DINT; END_VAR IF up THEN n := n + 1; END_IF; END_FUNCTION_BLOCK
VAR_GLOBAL total : DINT; END_VAR
VAR_GLOBAL CONSTANT limit : INT := 9; END_VAR
PROGRAM Main
VAR fresh : INT := 4; list : ARRAY[0..2] OF INT; flag : BOOL; light : Light; shown : INT; t : TON; c : Counter; END_VAR
VAR RETAIN kept : DINT; END_VAR
c(up := flag); t(IN := TRUE, PT := T#1s); shown := limit + fresh + list[2] + total + kept; light := light;
END_PROGRAM)";

/// The second program after a change, with one scan of its own.
std::unique_ptr<Engine> changed(bool all, image::Packets& p, Transfer* plan = nullptr) {
  Engine first(build(kFirstProgram));
  for (int i = 0; i < 3; ++i) first.scan(p, i * 100 * image::kMillisecond);
  auto second = std::make_unique<Engine>(build(kSecondProgram));
  const Transfer transfer = plan_transfer(first.image(), second->image(), all);
  if (plan != nullptr) *plan = transfer;
  second->prepare_transfer(transfer);
  const std::uint64_t before = counting::allocations();
  second->take_over(first, transfer);
  EXPECT_EQ(counting::allocations(), before) << "between two scans nothing is allocated";
  second->scan(p, 300 * image::kMillisecond);
  return second;
}

TEST(Transfer, of_an_online_change_keeps_every_variable_of_the_same_name_and_type) {
  image::Packets p;
  Transfer plan;
  const auto e = changed(true, p, &plan);
  EXPECT_EQ(e->read(*e->find("kept")), "3");
  EXPECT_EQ(e->read(*e->find("total")), "6");
  EXPECT_EQ(e->read(*e->find("list")), "[0,0,7]") << "by subscript, not by place";
  EXPECT_EQ(e->read(*e->find("c.n")), "1") << "the edge goes on: no second one is seen";
  EXPECT_EQ(e->read(*e->find("t.ET")), "\"T#300ms\"") << "timers run on";
  EXPECT_EQ(e->read(*e->find("light")), "\"Dark\"") << "another enumeration of the same name begins anew";
  EXPECT_EQ(e->read(*e->find("limit")), "9") << "constants are those of the new program";
  EXPECT_EQ(e->read(*e->find("shown")), "29");
  EXPECT_NE(std::find(plan.fresh.begin(), plan.fresh.end(), "Main.fresh"), plan.fresh.end());
  EXPECT_NE(std::find(plan.given_up.begin(), plan.given_up.end(), "Main.old"), plan.given_up.end());
}

TEST(Transfer, without_it_keeps_the_retained_values_only) {
  image::Packets p;
  const auto e = changed(false, p);
  EXPECT_EQ(e->read(*e->find("kept")), "3");
  EXPECT_EQ(e->read(*e->find("total")), "0");
  EXPECT_EQ(e->read(*e->find("t.ET")), "\"T#0ms\"");
}

constexpr const char* kValves = R"(FUNCTION_BLOCK Valve
VAR_INPUT go : BOOL; END_VAR
VAR coil AT %Q* : BOOL; ready AT %I* : BOOL; END_VAR
VAR RETAIN strokes AT %M* : DINT; END_VAR
coil := go AND ready; IF coil THEN strokes := strokes + 1; END_IF;
END_FUNCTION_BLOCK
PROGRAM P VAR v : ARRAY[1..2] OF Valve; END_VAR v[1](go := TRUE); v[2](go := NOT v[1].go); END_PROGRAM
CONFIGURATION c
PROGRAM Main : P;
VAR_CONFIG
Main.v[1].coil AT bit_out : BOOL; Main.v[2].coil AT SA65 : BOOL;
Main.v[1].ready AT bit_in : BOOL; Main.v[2].ready AT bit_in : BOOL;
Main.v[1].strokes AT %MD10 : DINT := 5; Main.v[2].strokes AT %MD11 : DINT;
END_VAR
VAR_ACCESS clamp : Main.v[1].coil : BOOL READ_ONLY; END_VAR
END_CONFIGURATION)";

TEST(Engine, reads_writes_forces_and_keeps_what_VAR_CONFIG_put_at_an_address) {
  Engine e(build(kValves, kSymbols));
  image::Packets p;
  p.set_bit(kSymbols[0].place, true);
  for (int i = 0; i < 3; ++i) e.scan(p, i);
  EXPECT_TRUE(p.bit(kSymbols[7].place));
  EXPECT_FALSE(p.bit(kSymbols[8].place));
  EXPECT_EQ(p.number({Packet::k, Format::li, 10, 1}), 8);
  EXPECT_EQ(e.read(*e.find("Main.v[1].coil")), "true");
  EXPECT_EQ(e.read(*e.find("v[2].coil")), "false");
  EXPECT_EQ(e.read(*e.find("clamp")), "true") << "the name of VAR_ACCESS";
  EXPECT_TRUE(e.force(*e.find("Main.v[1].coil"), "FALSE"));
  EXPECT_TRUE(e.force(*e.find("v[2].coil"), "TRUE"));
  e.scan(p, 3);
  EXPECT_FALSE(p.bit(kSymbols[7].place)) << "a force reaches the address";
  EXPECT_TRUE(p.bit(kSymbols[8].place));
  e.release_all();
  EXPECT_EQ(e.retained(),
            (std::vector<Retained>{{"Main.v[1].strokes", "DINT", "9"}, {"Main.v[2].strokes", "DINT", "0"}}));
  Engine later(build(kValves, kSymbols));
  image::Packets fresh;
  EXPECT_EQ(later.restore(e.retained()), 2u);
  later.scan(fresh, 0);
  EXPECT_EQ(later.read(*later.find("v[1].strokes")), "9") << "not the initial value";
}

TEST(Transfer, of_an_online_change_gives_an_instance_its_new_address) {
  Engine first(build(kValves, kSymbols));
  image::Packets p;
  p.set_bit(kSymbols[0].place, true);
  for (int i = 0; i < 3; ++i) first.scan(p, i);
  std::string text = kValves;
  const auto change = [&](std::string_view from, std::string_view to) {
    text.replace(text.find(from), from.size(), to);
  };
  change("coil AT bit_out", "coil AT %QX2.0");
  change("strokes AT %MD10", "strokes AT %MD12");
  change("v : ARRAY", "n : LINT; v : ARRAY");
  Engine second(build(text, kSymbols));
  const Transfer transfer = plan_transfer(first.image(), second.image(), true);
  second.prepare_transfer(transfer);
  second.take_over(first, transfer);
  second.scan(p, 3);
  EXPECT_TRUE(p.bit({Packet::a, Format::bl, 514 * 8, 1}));
  EXPECT_EQ(second.read(*second.find("v[1].strokes")), "9") << "kept by its name";
  EXPECT_EQ(p.number({Packet::k, Format::li, 12, 1}), 9);
}

TEST(Transfer, gives_references_their_initial_value_because_variables_move) {
  Engine first(build(R"(PROGRAM Main
VAR x, y : INT; set, lost : REF_TO INT; begun : REF_TO INT := REF(x); END_VAR
set := REF(y); lost := set; begun^ := 5;
END_PROGRAM)"));
  image::Packets p;
  first.scan(p, 0);
  EXPECT_EQ(first.read(*first.find("set")), "\"Main.y\"");
  Engine second(build(R"(PROGRAM Main
VAR more : LREAL; y, x : INT; set : REF_TO INT; begun : REF_TO INT := REF(x); END_VAR
IF set = NULL THEN begun^ := begun^ + 1; END_IF; more := 0.0; set := REF(y);
END_PROGRAM)"));
  const Transfer transfer = plan_transfer(first.image(), second.image(), true);
  EXPECT_EQ(transfer.fresh, (std::vector<std::string>{"Main.more", "Main.set", "Main.begun"}));
  EXPECT_EQ(transfer.given_up, std::vector<std::string>{"Main.lost"});
  second.prepare_transfer(transfer);
  second.take_over(first, transfer);
  EXPECT_EQ(second.read(*second.find("set")), "\"NULL\"");
  EXPECT_EQ(second.read(*second.find("begun")), "\"Main.x\"");
  EXPECT_EQ(second.scan(p, 1).fault, Fault::none);
  EXPECT_EQ(second.number(*second.find("x")), 6);
}

}  // namespace
}  // namespace servogate::plc
