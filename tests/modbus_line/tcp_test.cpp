// SPDX-License-Identifier: Apache-2.0
// A Modbus TCP line against units whose answers are bent on the way.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "tests/comes.hpp"
#include "tests/modbus_line/rig/cycles.hpp"

namespace servogate::modbus_line {
namespace {

using image::kMillisecond;
using image::kSecond;
using image::Quality;
using modbus::Heard;

constexpr std::uint8_t kReadInputs = 2, kReadRegisters = 4, kWriteCoils = 15;

TEST(ModbusTcp, brings_inputs_into_the_image_and_outputs_to_the_unit) {
  Units units(Units::Wire::tcp);
  units.with(1, [](mock::ModbusStation& s) {
    s.set_input(3, true);
    s.set_analog_input(2, 4711);
  });
  Cycles cycles(tcp(units), {1});
  cycles.set_coil(0, 5, true);
  cycles.set_analog(0, 1, 1234);
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.input(0, 3); }));
  EXPECT_TRUE(cycles.until([&] { return cycles.analog(0, 2) == 4711; }));
  EXPECT_TRUE(cycles.until([&] { return units.output(1, 5); }));
  double register_1 = 0;
  EXPECT_TRUE(cycles.until([&] {
    units.with(1, [&](const mock::ModbusStation& s) { register_1 = s.analog_output(1); });
    return register_1 == 1234;
  }));
  cycles.set_coil(0, 5, false);
  EXPECT_TRUE(cycles.until([&] { return !units.output(1, 5); }));
  const modbus::LineCounters c = cycles.counters();
  EXPECT_EQ(c.openings, 1u);
  EXPECT_GE(c.of(Heard::answer) + 1, c.requests) << "all but one that is under way";
  EXPECT_EQ(cycles.image().sources[0].errors, 0u);
}

TEST(ModbusTcp, asks_nothing_before_the_first_cycle_and_stops_when_no_cycle_comes_any_more) {
  Units units(Units::Wire::tcp);
  Cycles cycles(tcp(units), {1});
  ASSERT_TRUE(cycles.until([&] { return cycles.good(0); }));
  // Silent is who asks nothing in the time of 200 periods, whenever that begins.
  std::uint64_t requests = 0;
  EXPECT_TRUE(tests::comes(
      [&] { return std::exchange(requests, cycles.counters().requests) == cycles.counters().requests; },
      std::chrono::microseconds(modbus::ModbusLine::kSilentCycle / image::kMicrosecond)));
  const std::size_t asked = units.asked().size();
  EXPECT_TRUE(cycles.until([&] { return units.asked().size() > asked && cycles.good(0); }));
}

TEST(ModbusTcp, a_line_that_never_had_a_cycle_never_said_anything) {
  Units units(Units::Wire::tcp);
  { const Cycles cycles(tcp(units), {1}); }
  EXPECT_TRUE(units.asked().empty());
}

TEST(ModbusTcp, an_answer_with_another_transaction_is_not_taken_and_the_link_is_opened_anew) {
  Units units(Units::Wire::tcp);
  units.bend([&](const Asked& asked, const Bytes& good) {
    Asked other = asked;
    if (asked.connection == 0 && asked.function() == kReadInputs) {
      other.transaction = static_cast<std::uint16_t>(asked.transaction - 1);
      return Reply{units.frame(other, {kReadInputs, 2, 0xFF, 0xFF})};
    }
    return Reply{units.frame(asked, good)};
  });
  Cycles cycles(tcp(units), {1});
  cycles.watch = [&] { EXPECT_FALSE(cycles.input(0, 0)); };
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0); }));
  EXPECT_EQ(cycles.counters().of(Heard::wrong_transaction), 1u);
  EXPECT_EQ(cycles.counters().openings, 2u);
  EXPECT_EQ(cycles.image().sources[0].errors, 1u);
}

TEST(ModbusTcp, a_late_answer_is_never_taken_for_the_next_one) {
  Units units(Units::Wire::tcp);
  // Every answer comes twice; the second one says what is not so.
  units.bend([&](const Asked& asked, const Bytes& good) {
    Bytes bytes = units.frame(asked, good);
    if (asked.function() == kReadInputs) {
      const Bytes again = units.frame(asked, {kReadInputs, 2, 0xFF, 0xFF});
      bytes.insert(bytes.end(), again.begin(), again.end());
    }
    return Reply{bytes};
  });
  units.with(1, [](mock::ModbusStation& s) { s.set_input(1, true); });
  Cycles cycles(tcp(units), {1});
  cycles.watch = [&] { EXPECT_FALSE(cycles.input(0, 0)); };
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().of(Heard::wrong_transaction) > 20; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.input(0, 1); }));
}

TEST(ModbusTcp, an_answer_of_another_unit_is_not_taken) {
  Units units(Units::Wire::tcp, {1, 2});
  units.bend([&](const Asked& asked, const Bytes& good) {
    Asked other = asked;
    if (asked.connection == 0 && asked.unit == 1 && asked.function() == kReadInputs) {
      other.unit = 2;
      return Reply{units.frame(other, {kReadInputs, 2, 0xFF, 0xFF})};
    }
    return Reply{units.frame(asked, good)};
  });
  Cycles cycles(tcp(units), {1, 2});
  cycles.watch = [&] {
    EXPECT_FALSE(cycles.input(0, 0));
    EXPECT_FALSE(cycles.input(1, 0));
  };
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(1); }));
  EXPECT_EQ(cycles.counters().of(Heard::wrong_unit), 1u);
}

TEST(ModbusTcp, answers_that_do_not_fit_the_request_are_not_taken) {
  for (const Bytes& wrong :
       {Bytes{kReadRegisters, 2, 0xFF, 0xFF}, Bytes{kReadInputs, 4, 0xFF, 0xFF, 0xFF, 0xFF},
        Bytes{kReadInputs, 1, 0xFF}, Bytes{0x55, 0xFF}}) {
    Units units(Units::Wire::tcp);
    units.bend([&](const Asked& asked, const Bytes& good) {
      const bool bent = asked.connection == 0 && asked.function() == kReadInputs;
      return Reply{units.frame(asked, bent ? wrong : good)};
    });
    Cycles cycles(tcp(units, 200 * kMillisecond), {1});
    cycles.watch = [&] { EXPECT_FALSE(cycles.input(0, 0)); };
    EXPECT_TRUE(cycles.until([&] { return cycles.counters().openings > 1 && cycles.good(0); }));
    EXPECT_GE(cycles.counters().of(Heard::malformed) + cycles.counters().of(Heard::half), 1u);
  }
}

TEST(ModbusTcp, half_an_answer_is_none_and_its_rest_finds_nobody) {
  Units units(Units::Wire::tcp);
  units.bend([&](const Asked& asked, const Bytes& good) {
    Reply reply{units.frame(asked, good)};
    if (asked.connection == 0 && asked.function() == kReadInputs) reply.bytes.resize(9);
    return reply;
  });
  Cycles cycles(tcp(units, kShort), {1});
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().of(Heard::half) > 0; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0); }));
}

TEST(ModbusTcp, a_slow_unit_is_silent_for_the_line_and_its_late_answers_do_not_count) {
  Units units(Units::Wire::tcp, {1, 2});
  units.bend([&](const Asked& asked, const Bytes& good) {
    // So late that the line has given it up on any computer, and early enough for the test to see it come.
    if (asked.unit == 1) return Reply{units.frame(asked, good), 100 * kShort};
    return Reply{units.frame(asked, good)};
  });
  units.with(1, [](mock::ModbusStation& s) { s.set_input(0, true); });
  Cycles cycles(tcp(units, kShort), {1, 2});
  cycles.watch = [&] { EXPECT_FALSE(cycles.input(0, 0)); };
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == Quality::bad; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().of(Heard::silence) >= 12; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.good(1); }));
  EXPECT_GE(cycles.image().sources[0].errors, 1u);
  units.straighten();
  cycles.watch = nullptr;
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.input(0, 0); })) << "it comes back";
}

TEST(ModbusTcp, a_dead_unit_does_not_slow_its_neighbours) {
  Units units(Units::Wire::tcp, {1, 3});
  Cycles cycles(tcp(units, kShort), {1, 2, 3});
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  EXPECT_TRUE(cycles.until([&] { return units.asked_of(1) > 300 && units.asked_of(3) > 300; }));
  const std::size_t asked = units.asked_of(2);  // before the time is taken
  const double took = static_cast<double>(drivers::clock_ns(CLOCK_MONOTONIC) - start) * 1e-9;
  EXPECT_LE(asked, 2 + static_cast<std::size_t>(took / 0.5) + 1) << "twice, and then every half second";
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(1) == Quality::bad; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(2); }));
}

TEST(ModbusTcp, an_exception_is_counted_and_the_link_stays) {
  Units units(Units::Wire::tcp);
  units.bend([&](const Asked& asked, const Bytes& good) {
    if (asked.function() == kReadRegisters) return Reply{units.frame(asked, {kReadRegisters | 0x80, 6})};
    return Reply{units.frame(asked, good)};
  });
  Cycles cycles(tcp(units), {1});
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().exceptions > 5; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == Quality::bad; })) << "its registers never came";
  EXPECT_EQ(cycles.counters().openings, 1u);
  EXPECT_GE(cycles.image().sources[0].errors, 5u);
}

TEST(ModbusTcp, a_link_that_is_cut_is_opened_again_and_outputs_that_changed_meanwhile_are_written) {
  Units units(Units::Wire::tcp);
  Cycles cycles(tcp(units), {1});
  cycles.set_coil(0, 1, true);
  ASSERT_TRUE(cycles.until([&] { return cycles.good(0) && units.output(1, 1); }));
  units.unplug();
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == Quality::bad; }));
  cycles.set_coil(0, 1, false);
  cycles.set_coil(0, 2, true);
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().failed_openings >= 3; }));
  EXPECT_TRUE(units.output(1, 1)) << "nothing has come";
  units.plug();
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0) && !units.output(1, 1) && units.output(1, 2); }));
  EXPECT_GE(cycles.counters().openings, 2u);
}

TEST(ModbusTcp, a_peer_that_is_not_there_is_no_refusal_and_is_tried_ever_more_rarely) {
  Units units(Units::Wire::tcp);
  units.unplug();
  const image::Nanoseconds start = drivers::clock_ns(CLOCK_MONOTONIC);
  Cycles cycles(tcp(units), {1});
  EXPECT_TRUE(cycles.until([&] { return cycles.quality(0) == Quality::bad; }));
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().failed_openings >= 4; }));
  // Pauses of 0.1, 0.2 and 0.4 s.
  EXPECT_GE(drivers::clock_ns(CLOCK_MONOTONIC) - start, 700 * kMillisecond);
  units.plug();
  EXPECT_TRUE(cycles.until([&] { return cycles.good(0); }));
}

TEST(ModbusTcp, a_peer_that_hangs_up_behind_each_answer_is_still_heard) {
  Units units(Units::Wire::tcp);
  units.bend([&](const Asked& asked, const Bytes& good) { return Reply{units.frame(asked, good), 0, true}; });
  units.with(1, [](mock::ModbusStation& s) { s.set_input(7, true); });
  Cycles cycles(tcp(units), {1});
  EXPECT_TRUE(cycles.until([&] { return cycles.counters().openings > 10 && cycles.input(0, 7); }));
}

TEST(ModbusTcp, writes_changes_at_once_and_repeats_them_at_the_period) {
  Units units(Units::Wire::tcp);
  Cycles cycles(tcp(units), {1}, 10 * kSecond);
  ASSERT_TRUE(cycles.until([&] { return cycles.counters().of(Heard::answer) >= 4; }));
  for (int n = 0; n < 5; ++n) {
    cycles.set_coil(0, 0, n % 2 == 0);
    ASSERT_TRUE(cycles.until([&] { return units.output(1, 0) == (n % 2 == 0); }));
  }
  Units others(Units::Wire::tcp);
  Cycles cyclic(tcp(others), {1});
  EXPECT_TRUE(cyclic.until([&] {
    const auto asked = others.asked();
    return std::ranges::count_if(asked, [](const Asked& a) { return a.function() == kWriteCoils; }) > 10;
  })) << "without any change";
}

TEST(ModbusTcp, leaves_outputs_at_their_values_of_loss_but_for_those_that_hold) {
  Units units(Units::Wire::tcp);
  Cycles cycles(tcp(units), {1});
  cycles.set_coil(0, 0, true);
  cycles.set_coil(0, 15, true);
  ASSERT_TRUE(cycles.until([&] { return units.output(1, 0) && units.output(1, 15); }));
  cycles.end();
  EXPECT_FALSE(units.output(1, 0));
  EXPECT_TRUE(units.output(1, 15));
}

TEST(ModbusTcp, ends_at_once_although_a_unit_does_not_answer) {
  Units units(Units::Wire::tcp);
  units.bend([](const Asked&, const Bytes&) { return Reply{}; });
  auto settings = tcp(units, 3600 * kSecond);
  settings.poll.retries = 0;
  {
    // Nothing has been written, so that there is nothing to leave behind.
    drivers::Notice why;
    modbus::Map map;
    map.blocks = {{1, modbus::Function::read_discrete_inputs, 0, 16}};
    const auto line = modbus::ModbusLine::open(settings, map, {{1, 0}}, why);
    auto image = std::make_unique<image::ProcessImage>();
    image::Notices notices;
    line->receive(*image, notices);
    ASSERT_TRUE(tests::comes([&] { return !units.asked().empty(); }));
  }
  SUCCEED() << "an hour has not passed";
}

TEST(ModbusTcp, writes_at_its_end_what_the_poller_held_behind_a_unit_that_does_not_answer) {
  Units units(Units::Wire::tcp, {1, 2});
  Cycles cycles(tcp(units), {1, 2}, 10 * kSecond);
  ASSERT_TRUE(cycles.until([&] { return cycles.good(0) && cycles.good(1); }));
  std::atomic<bool> first{true}, asked{false};
  units.bend([&](const Asked& request, const Bytes& good) {
    if (request.function() != kWriteCoils || !first.exchange(false)) return Reply{units.frame(request, good)};
    asked = true;
    return Reply{};  // for as long as the control waits: a minute
  });
  // Both change in one cycle, and both hold their values at a loss: nothing is written anew at the end for
  // them.
  cycles.set_coil(0, 15, true);
  cycles.set_coil(1, 15, true);
  ASSERT_TRUE(cycles.until([&] { return asked.load(); }));
  cycles.end();
  EXPECT_TRUE(units.output(1, 15));
  EXPECT_TRUE(units.output(2, 15));
}

TEST(ModbusTcp, fifty_units_on_a_line_are_all_served) {
  std::vector<std::uint8_t> all;
  for (std::uint8_t u = 1; u <= 50; ++u) all.push_back(u);
  Units units(Units::Wire::tcp, all);
  for (const std::uint8_t u : all)
    units.with(u, [u](mock::ModbusStation& s) { s.set_analog_input(1, 100u + u); });
  Cycles cycles(tcp(units), all, 50 * kMillisecond);
  for (std::size_t u = 0; u < all.size(); ++u) {
    cycles.set_coil(u, static_cast<int>(u % 16), true);
    EXPECT_TRUE(cycles.until([&] { return cycles.analog(u, 1) == 100.0 + all[u]; })) << u;
    EXPECT_TRUE(cycles.until([&] { return units.output(all[u], static_cast<std::uint16_t>(u % 16)); })) << u;
  }
}

}  // namespace
}  // namespace servogate::modbus_line
