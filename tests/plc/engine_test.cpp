// SPDX-License-Identifier: Apache-2.0
#include "plc/engine/engine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "plc/compile/compile.hpp"
#include "plc/vm/image.hpp"
#include "tests/counting/allocations.hpp"
#include "tests/plc/built.hpp"

namespace servogate::plc {
namespace {

using image::Format;
using image::Packet;

TEST(Engine, carries_every_format_of_a_place_in_and_out) {
  Engine e(build(R"(PROGRAM Main
VAR n : INT; t : STRING; END_VAR
bit_out := bit_in AND NOT never_written;
word := word + PANEL.BYTE + 1;
long := long * 2;
real := real / 2;
wide := wide + 0.25;
t := text;
text := CONCAT(LEFT(text, 2), '!');
n := LEN(t);
END_PROGRAM)",
                 kSymbols));
  image::Packets p;
  p.set_bit(kSymbols[0].place, true);
  p.set_number(kSymbols[1].place, 200);
  p.set_number(kSymbols[2].place, -5);
  p.set_number(kSymbols[3].place, -70000);
  p.set_number(kSymbols[4].place, 3);
  p.set_number(kSymbols[5].place, 1.5);
  p.set_characters(kSymbols[6].place, "abcd");
  EXPECT_EQ(e.scan(p, 0).fault, Fault::none);
  EXPECT_TRUE(p.bit(kSymbols[7].place));
  EXPECT_EQ(p.number(kSymbols[2].place), 196);
  EXPECT_EQ(p.number(kSymbols[3].place), -140000);
  EXPECT_EQ(p.number(kSymbols[4].place), 1.5);
  EXPECT_EQ(p.number(kSymbols[5].place), 1.75);
  EXPECT_EQ(p.characters(kSymbols[6].place), "ab!   ");
  EXPECT_EQ(e.read(*e.find("n")), "4");
  EXPECT_EQ(e.read(*e.find("panel.byte")), "200");
}

TEST(Engine, leaves_neighbouring_bits_alone) {
  Engine e(build("PROGRAM Main\nbit_out := TRUE;\nEND_PROGRAM", kSymbols));
  image::Packets p;
  p.data(Packet::a)[8] = 0xAA;
  e.scan(p, 0);
  EXPECT_EQ(p.data(Packet::a)[8], 0xAB);
}

TEST(Engine, drops_everything_the_program_writes_at_a_fault_until_it_is_started_again) {
  Engine e(build(
      "PROGRAM Main\nVAR d : INT := 1; END_VAR\nbit_out := TRUE;\nlong := 7;\nlong := 10 / d;\nEND_PROGRAM",
      kSymbols));
  image::Packets p;
  e.scan(p, 0);
  EXPECT_TRUE(p.bit(kSymbols[7].place));
  EXPECT_TRUE(e.write(p, *e.find("Main.d"), "0"));
  const ScanResult r = e.scan(p, 1);
  EXPECT_EQ(r.fault, Fault::division_by_zero);
  EXPECT_EQ(r.line, 5);
  EXPECT_EQ(e.describe(r).str(text::Language::english),
            "t.st:5:1: error: task cycle divided by zero [plc-fault-division]");
  EXPECT_FALSE(p.bit(kSymbols[7].place));
  EXPECT_EQ(p.number(kSymbols[3].place), 0);
  p.set_bit(kSymbols[7].place, true);
  EXPECT_EQ(e.scan(p, 2).fault, Fault::division_by_zero);
  EXPECT_FALSE(p.bit(kSymbols[7].place)) << "held while the fault stands";
  e.restart();
  EXPECT_EQ(e.scan(p, 3).fault, Fault::none);
  EXPECT_TRUE(p.bit(kSymbols[7].place));
}

TEST(Engine, stops_an_endless_loop_at_its_budget_and_names_task_and_line) {
  Options options;
  options.instruction_budget = 5000;
  Engine e(build("PROGRAM Main\nVAR n : DINT; END_VAR\nWHILE TRUE DO\nn := n + 1;\nEND_WHILE;\nEND_PROGRAM",
                 {}, options));
  image::Packets p;
  const ScanResult r = e.scan(p, 0);
  EXPECT_EQ(r.fault, Fault::budget);
  EXPECT_EQ(e.task_name(r.task), "cycle");
  EXPECT_EQ(e.file_name(r.file), "t.st");
  EXPECT_EQ(r.line, 3);
  EXPECT_LE(e.number(*e.find("n")), 5000);
  EXPECT_GT(e.number(*e.find("n")), 1000);
}

TEST(Engine, refuses_packets_smaller_than_it_was_compiled_for) {
  Engine e(build("PROGRAM Main\nword := 1;\nEND_PROGRAM", kSymbols));
  image::Packets p;
  p.resize(64, 200);
  EXPECT_EQ(e.scan(p, 0).fault, Fault::packet_size);
}

TEST(Engine, writes_by_name_until_logic_writes_again) {
  Engine e(build(R"(TYPE C : (Red, Green); R : STRUCT a : ARRAY[1..3] OF INT; END_STRUCT; END_TYPE
PROGRAM Main
VAR c : C; r : R; s : STRING[5]; t : TIME; w : WORD; f : LREAL; k : INT; END_VAR
k := 5;
END_PROGRAM)"));
  image::Packets p;
  const auto put = [&](const char* name, const char* value) { return e.write(p, *e.find(name), value); };
  EXPECT_TRUE(put("c", "green"));
  EXPECT_TRUE(put("Main.R.A[2]", "-7"));
  EXPECT_TRUE(put("s", "hello"));
  EXPECT_TRUE(put("t", "T#1m"));
  EXPECT_TRUE(put("w", "16#8001"));
  EXPECT_TRUE(put("w.3", "TRUE"));
  EXPECT_TRUE(put("f", "1e3"));
  EXPECT_TRUE(put("k", "9"));
  EXPECT_FALSE(put("s", "longer than five"));
  EXPECT_FALSE(put("c", "Blue"));
  EXPECT_FALSE(put("k", "40000"));
  EXPECT_FALSE(put("k", "TRUE"));
  EXPECT_FALSE(put("t", "5"));
  EXPECT_FALSE(put("r", "1"));
  EXPECT_EQ(e.find("Main.nothing"), std::nullopt);
  EXPECT_EQ(e.find("r.a[4]"), std::nullopt);
  EXPECT_EQ(e.find("k.16"), std::nullopt);
  e.scan(p, 0);
  EXPECT_EQ(e.read(*e.find("c")), "\"Green\"");
  EXPECT_EQ(e.read(*e.find("r")), "{\"a\":[0,-7,0]}");
  EXPECT_EQ(e.read(*e.find("s")), "\"hello\"");
  EXPECT_EQ(e.read(*e.find("t")), "\"T#1m\"");
  EXPECT_EQ(e.read(*e.find("w")), "32777");
  EXPECT_EQ(e.number(*e.find("f")), 1000.0);
  EXPECT_TRUE(std::isnan(e.number(*e.find("s"))));
  EXPECT_EQ(e.read(*e.find("k")), "5");
  EXPECT_TRUE(e.set_number(p, *e.find("r.a[3]"), 12));
  EXPECT_FALSE(e.set_number(p, *e.find("r.a[3]"), 40000));
  EXPECT_EQ(e.number(*e.find("r.a[3]")), 12);
}

TEST(Engine, forces_variables_and_places_against_logic_and_machine) {
  Engine e(build(
      "PROGRAM Main\nVAR n, seen : INT; END_VAR\nseen := n;\nn := n + 1;\nbit_out := bit_in;\nEND_PROGRAM",
      kSymbols));
  image::Packets p;
  EXPECT_TRUE(e.force(*e.find("n"), "100"));
  EXPECT_TRUE(e.force(*e.find("bit_in"), "TRUE"));
  EXPECT_FALSE(e.force(*e.find("n"), "x"));
  for (int i = 0; i < 3; ++i) e.scan(p, i);
  EXPECT_EQ(e.read(*e.find("seen")), "100");
  EXPECT_EQ(e.read(*e.find("n")), "100");
  EXPECT_TRUE(p.bit(kSymbols[7].place));
  EXPECT_EQ(e.forced(),
            (std::vector<std::pair<std::string, std::string>>{{"Main.n", "100"}, {"bit_in", "TRUE"}}));
  e.release(*e.find("n"));
  e.scan(p, 3);
  EXPECT_EQ(e.read(*e.find("n")), "101");
  e.release_all();
  e.scan(p, 4);
  EXPECT_FALSE(p.bit(kSymbols[7].place));
  EXPECT_TRUE(e.force(*e.find("bit_out"), "TRUE"));
  e.scan(p, 5);
  EXPECT_TRUE(p.bit(kSymbols[7].place)) << "a forced output reaches the packet";
}

TEST(Engine, keeps_retained_values_by_name_and_type_over_a_changed_program) {
  Engine first(build(R"(VAR_GLOBAL RETAIN total : LREAL; END_VAR
PROGRAM Main
VAR RETAIN n : DINT; kind : INT; list : ARRAY[0..1] OF INT; name : STRING; when : TIME; END_VAR
VAR lost : DINT; END_VAR
n := n + 1; lost := n; list[1] := 5; name := 'it$'s'; kind := 3; total := 1.0 / 3; when := T#90s;
END_PROGRAM)"));
  image::Packets p;
  for (int i = 0; i < 4; ++i) first.scan(p, i);
  std::vector<std::uint8_t> snapshot(first.retain_bytes());
  ASSERT_TRUE(first.snapshot_retained(snapshot));
  EXPECT_FALSE(first.snapshot_retained(std::span(snapshot).first(3)));
  const std::vector<Retained> kept = first.retained(snapshot);
  EXPECT_EQ(kept, first.retained());
  EXPECT_EQ(kept.size(), 7u);
  Engine second(build(R"(VAR_GLOBAL RETAIN total : LREAL; END_VAR
PROGRAM Main
VAR fresh : INT; END_VAR
VAR RETAIN kind : LREAL; name : STRING; n : DINT; when : TIME; list : ARRAY[0..1] OF INT; END_VAR
fresh := 1;
END_PROGRAM)"));
  EXPECT_EQ(second.restore(kept), 6u) << "kind has another type now";
  EXPECT_EQ(second.read(*second.find("n")), "4");
  EXPECT_EQ(second.read(*second.find("name")), "\"it's\"");
  EXPECT_EQ(second.read(*second.find("list")), "[0,5]");
  EXPECT_EQ(second.read(*second.find("when")), "\"T#1m30s\"");
  EXPECT_EQ(second.number(*second.find("total")), 1.0 / 3);
  EXPECT_EQ(second.number(*second.find("kind")), 0);
}

TEST(Engine, forces_and_keeps_wide_strings_with_every_character) {
  const std::string source = R"(PROGRAM Main
VAR RETAIN name : WSTRING[254]; mark : WCHAR; half : WSTRING[4]; list : ARRAY[0..1] OF WSTRING[3]; END_VAR
VAR part : WSTRING; END_VAR
part := RIGHT(name, 3);
END_PROGRAM)";
  Engine first(build(source));
  image::Packets p;
  const std::string longest = std::string(248, 'x') + "Ж\"$\n😀";  // 254 units of 16 bits
  EXPECT_TRUE(first.write(p, *first.find("name"), longest));
  EXPECT_FALSE(first.write(p, *first.find("name"), longest + "y"));
  EXPECT_TRUE(first.write(p, *first.find("half"), "\"a$D83D\""));
  EXPECT_TRUE(first.force(*first.find("mark"), "Ж"));
  EXPECT_FALSE(first.force(*first.find("mark"), "😀")) << "two units";
  EXPECT_TRUE(first.force(*first.find("list[1]"), "\"абв\""));
  first.scan(p, 0);
  EXPECT_EQ(first.read(*first.find("part")), "\"\\u000a😀\"");
  EXPECT_EQ(first.read(*first.find("half")), "\"a$D83D\"");
  EXPECT_EQ(first.forced()[0].second, "\"Ж\"");
  Engine second(build(source));
  EXPECT_EQ(second.restore(first.retained()), 5u);
  for (const char* name : {"name", "mark", "half", "list"})
    EXPECT_EQ(second.read(*second.find(name)), first.read(*first.find(name)));
  EXPECT_EQ(second.read(*second.find("list")), "[\"\",\"абв\"]");
}

TEST(Engine, keeps_all_of_an_instance_that_is_retained_and_what_is_persistent) {
  const std::string source = R"(VAR_GLOBAL PERSISTENT total : INT; END_VAR
FUNCTION_BLOCK Count
VAR CONSTANT step : INT := 2; END_VAR
VAR n : INT; END_VAR
n := n + step;
END_FUNCTION_BLOCK
PROGRAM Work
VAR c : Count; k : INT; END_VAR
VAR PERSISTENT p : INT; END_VAR
c(); k := k + 1; p := p + 3; total := k;
END_PROGRAM
CONFIGURATION Plant
TASK t(INTERVAL := T#1ms, PRIORITY := 1);
PROGRAM RETAIN kept WITH t : Work;
PROGRAM lost WITH t : Work;
END_CONFIGURATION)";
  Engine first(build(source));
  image::Packets p;
  for (int i = 0; i < 2; ++i) first.scan(p, i * 1'000'000);
  Engine second(build(source));
  const std::vector<Retained> kept = first.retained();
  EXPECT_EQ(kept.size(), 5u) << "total, kept.c.n, kept.k, kept.p, lost.p; no constant";
  second.restore(kept);
  EXPECT_EQ(second.read(*second.find("total")), "2");
  EXPECT_EQ(second.read(*second.find("kept.c.n")), "4");
  EXPECT_EQ(second.read(*second.find("kept.k")), "2");
  EXPECT_EQ(second.read(*second.find("lost.p")), "6");
  EXPECT_EQ(second.read(*second.find("lost.k")), "0");
}

TEST(Engine, keeps_nothing_of_a_retained_instance_that_is_declared_NON_RETAIN) {
  Engine first(build(
      R"(FUNCTION_BLOCK Inner VAR a : INT; END_VAR VAR NON_RETAIN b : INT; END_VAR a := a + 1; b := b + 1; END_FUNCTION_BLOCK
FUNCTION_BLOCK Outer VAR_INPUT NON_RETAIN in : INT; END_VAR VAR_OUTPUT out : INT; END_VAR VAR kept, list : Inner; END_VAR
VAR NON_RETAIN cold : Inner; t : TON; END_VAR VAR RETAIN deep : INT; END_VAR
kept(); cold(); list(); deep := deep + 1; out := in; END_FUNCTION_BLOCK
FUNCTION_BLOCK Own VAR RETAIN always : INT; END_VAR VAR plain : INT; END_VAR always := 1; plain := 1; END_FUNCTION_BLOCK
VAR_GLOBAL RETAIN g : Inner; END_VAR
PROGRAM Main
VAR RETAIN o : Outer; END_VAR
VAR NON_RETAIN n : Own; END_VAR
o(in := 5); n(); g();
END_PROGRAM)"));
  std::vector<std::string> names;
  for (const Retained& r : first.retained()) names.push_back(r.name);
  EXPECT_EQ(names, (std::vector<std::string>{"g.a", "Main.o.out", "Main.o.kept.a", "Main.o.list.a",
                                             "Main.o.deep", "Main.n.always"}));
}

TEST(Engine, keeps_retained_places_of_a_packet_too) {
  const std::string source = R"(VAR_GLOBAL RETAIN counter AT %MD10 : DINT := 7; END_VAR
PROGRAM Main
VAR RETAIN hours AT SYVAR2.LR : LREAL; END_VAR
counter := counter + 1; hours := hours + 0.5;
END_PROGRAM)";
  Engine first(build(source));
  image::Packets p;
  for (int i = 0; i < 3; ++i) first.scan(p, i);
  const std::vector<Retained> kept = first.retained();
  EXPECT_EQ(kept, (std::vector<Retained>{{"counter", "DINT", "10"}, {"Main.hours", "LREAL", "1.5"}}));
  Engine second(build(source));
  image::Packets fresh;
  EXPECT_EQ(second.restore(kept), 2u);
  second.scan(fresh, 0);
  EXPECT_EQ(second.read(*second.find("counter")), "11") << "not the initial value";
  EXPECT_EQ(second.read(*second.find("Main.hours")), "2");
}

/// A clock that goes on by a microsecond whenever somebody looks.
struct Ticks final : image::Clock {
  mutable image::Nanoseconds t = 0;
  image::Nanoseconds now_ns() const noexcept override { return t += 1000; }
};

TEST(Engine, neither_writes_nor_forces_a_reference) {
  Engine e(build("PROGRAM Main\nVAR x : INT; r : REF_TO INT; END_VAR\nr := REF(x);\nEND_PROGRAM"));
  image::Packets p;
  for (const char* value : {"NULL", "0", "16", "x"}) {
    EXPECT_FALSE(e.write(p, *e.find("r"), value)) << value;
    EXPECT_FALSE(e.force(*e.find("r"), value)) << value;
  }
}

TEST(Engine, measures_tasks_always_and_blocks_when_somebody_looks) {
  Engine e(build(R"(FUNCTION_BLOCK Inner VAR n : INT; END_VAR n := n + 1; END_FUNCTION_BLOCK
FUNCTION_BLOCK Outer VAR i : Inner; END_VAR i(); i(); END_FUNCTION_BLOCK
PROGRAM Main VAR o : Outer; END_VAR o(); END_PROGRAM)"));
  const Ticks clock;
  e.measure(&clock);
  image::Packets p;
  e.scan(p, 0);
  ASSERT_EQ(e.task_times().size(), 1u);
  EXPECT_EQ(e.task_times()[0].count, 1);
  EXPECT_EQ(e.task_times()[0].last, 1000);
  std::vector<Times> blocks(e.image().units.size());
  e.profile(blocks.data());
  e.scan(p, 1);
  e.profile(nullptr);
  e.scan(p, 2);
  for (std::size_t u = 0; u < blocks.size(); ++u) {
    const std::string& name = e.image().units[u].name;
    if (name != "Inner" && name != "Outer") continue;
    EXPECT_EQ(blocks[u].count, name == "Inner" ? 2 : 1) << name;
    EXPECT_EQ(blocks[u].last, name == "Inner" ? 1000 : 5000) << name;
  }
  EXPECT_EQ(e.task_times()[0].count, 3);
}

TEST(Engine, knows_where_variables_are_read_and_written) {
  const auto image = build(R"(FUNCTION_BLOCK Lamp VAR_INPUT on : BOOL; END_VAR VAR_OUTPUT lit : BOOL; END_VAR
lit := on;
END_FUNCTION_BLOCK
PROGRAM Main VAR lamp : Lamp; list : ARRAY[1..3] OF INT; i : INT; END_VAR
lamp(on := bit_in);
FOR i := 1 TO 3 DO list[i] := i; END_FOR;
bit_out := lamp.lit AND list[2] > 1;
END_PROGRAM)",
                           kSymbols);
  std::string all;
  for (const Image::Reference& r : image->references)
    all += std::to_string(r.line) + (r.write ? " w " : " r ") + r.name + "\n";
  for (const char* line :
       {"2 w Lamp.lit\n", "2 r Lamp.on\n", "5 w Main.lamp.on\n", "5 r bit_in\n", "6 w Main.i\n",
        "6 w Main.list\n", "6 r Main.i\n", "7 w bit_out\n", "7 r Main.lamp.lit\n", "7 r Main.list[2]\n"})
    EXPECT_NE(all.find(line), std::string::npos) << line << "in\n" << all;
}

TEST(Engine, scans_without_allocating) {
  Engine e(build(R"(FUNCTION f : DINT VAR_INPUT x : DINT; END_VAR f := x * 2; END_FUNCTION
PROGRAM Main
VAR t : TON; c : CTU; s : STRING; a : ARRAY[0..9] OF LREAL; i : INT; r : LREAL; d : DINT; END_VAR
t(IN := NOT t.Q, PT := T#5ms);
c(CU := t.Q, PV := 10);
FOR i := 0 TO 9 DO a[i] := SIN(a[i] + 0.1); END_FOR;
s := CONCAT(INT_TO_STRING(i), LREAL_TO_STRING(a[3]), TIME_TO_STRING(t.ET));
r := STRING_TO_LREAL(LREAL_TO_STRING(a[4]));
d := f(f(d)) + LEN(s) + FIND(s, 'T#');
bit_out := t.Q; text := s;
END_PROGRAM)",
                 kSymbols));
  image::Packets p;
  ASSERT_TRUE(e.force(*e.find("i"), "3"));
  e.scan(p, 0);
  const Handle h = *e.find("d");
  const std::uint64_t before = counting::allocations();
  double sum = 0;
  for (int i = 1; i < 1000; ++i) {
    EXPECT_EQ(e.scan(p, i * image::kMillisecond).fault, Fault::none);
    sum += e.number(h);
  }
  EXPECT_EQ(counting::allocations(), before);
  EXPECT_NE(sum, 0);
  std::vector<int> probe(10);
  EXPECT_GT(counting::allocations(), before) << "the count counts";
}

TEST(Engine, faults_without_allocating) {
  Engine e(build("PROGRAM Main\nVAR d : INT; END_VAR\nbit_out := 1 / d = 0;\nEND_PROGRAM", kSymbols));
  image::Packets p;
  const std::uint64_t before = counting::allocations();
  EXPECT_EQ(e.scan(p, 0).fault, Fault::division_by_zero);
  EXPECT_EQ(e.scan(p, 1).fault, Fault::division_by_zero);
  EXPECT_EQ(counting::allocations(), before);
}

TEST(Engine, runs_two_engines_of_one_image_apart) {
  const auto image = build("PROGRAM Main\nVAR n : INT; END_VAR\nn := n + 1;\nEND_PROGRAM");
  Engine a(image), b(image);
  image::Packets p;
  a.scan(p, 0);
  a.scan(p, 1);
  b.scan(p, 0);
  EXPECT_EQ(a.number(*a.find("n")), 2);
  EXPECT_EQ(b.number(*b.find("n")), 1);
}

TEST(Engine, resolves_bare_names_only_where_one_program_runs) {
  const auto one = build("PROGRAM A\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM");
  const auto two = build(
      "PROGRAM A\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\nPROGRAM B\nVAR x : INT; END_VAR\nx := "
      "2;\nEND_PROGRAM");
  EXPECT_TRUE(Engine(one).find("X"));
  EXPECT_FALSE(Engine(two).find("x"));
  EXPECT_TRUE(Engine(two).find("b.X"));
}

TEST(Engine, a_loop_costs_what_it_repeats_and_at_least_one_instruction) {
  const auto spent = [](const std::string& text) {
    Engine e(build("PROGRAM Main VAR i : DINT; END_VAR " + text + " END_PROGRAM"));
    image::Packets p;
    return e.scan(p, 0).instructions;
  };
  const std::int64_t few = spent("FOR i := 1 TO 10 DO ; END_FOR;");
  EXPECT_EQ(spent("FOR i := 1 TO 1010 DO ; END_FOR;") - few, 1000);
}

}  // namespace
}  // namespace servogate::plc
