// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/executive.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <random>
#include <string>
#include <thread>

#include "firmware_if/image/interface_map.hpp"
#include "tests/alarms.hpp"

namespace servogate::cycle {
namespace {

using image::Format;
using image::Packet;
using image::Place;
using image::Request;
using image::RequestKind;

/// An input and an output of packet A; says what was done in which order.
class Io final : public image::CycleDevice {
 public:
  explicit Io(std::string& order) : order_(order) {}
  void receive(image::ProcessImage& image, image::Notices&) noexcept override {
    order_ += 'r';
    image.packets.set_bit({Packet::a, Format::bl, 0, 1}, input);
  }
  void send(image::ProcessImage& image) noexcept override {
    order_ += 's';
    output = image.packets.bit({Packet::a, Format::bl, 8, 1});
  }
  bool input = false, output = false;

 private:
  std::string& order_;
};

/// Copies the input to the output; permits everything.
class CopyLogic final : public image::Logic {
 public:
  explicit CopyLogic(std::string& order) : order_(order) {}
  void scan(image::ProcessImage& image, Notices&) noexcept override {
    order_ += 'l';
    seen = image.packets.bit({Packet::a, Format::bl, 0, 1});
    image.packets.set_bit({Packet::a, Format::bl, 8, 1}, seen);
    image.packets.set_bit(image::field(image::kMachineFields, "estop_ok", image::kMachineBase), estop_ok);
  }
  bool seen = false, estop_ok = true;

 private:
  std::string& order_;
};

/// A process with nothing to do.
class IdleProcess final : public ProcessInCycle {
 public:
  void published(std::span<std::uint64_t>) const noexcept override {}
  void interpolate(ProcessContext&) noexcept override {}
  bool order(const Request&, ProcessContext&) noexcept override { return true; }
  bool loaded() const noexcept override { return false; }
};

class Bench {
 public:
  explicit Bench(bool with_process = true) : io(order), logic(order) {
    CycleParts parts;
    parts.alarms = &tests::alarm_table();
    parts.devices = {&io};
    parts.logic = &logic;
    if (with_process) parts.processes = {&process};
    cycle = std::make_unique<Cycle>(std::move(parts));
  }
  image::Answer ask(Request r) {
    EXPECT_TRUE(cycle->post(r));
    cycle->step();
    image::Answer answer;
    EXPECT_TRUE(cycle->take_answer(answer));
    EXPECT_EQ(answer.id, r.id);
    return answer;
  }
  static Request place_request(RequestKind kind, Place place, double value, image::Asker asker) {
    Request r;
    r.id = 77;
    r.kind = kind;
    r.asker = asker;
    r.packet = static_cast<std::uint8_t>(place.packet);
    r.format = static_cast<std::uint8_t>(place.format);
    r.index = place.index;
    r.length = place.length;
    r.value = value;
    return r;
  }
  int alarms(image::AlarmNumber number) const {
    const auto history = cycle->alarms().history();
    return static_cast<int>(std::count_if(history.begin(), history.end(),
                                          [&](const image::AlarmRecord& r) { return r.number == number; }));
  }
  std::string order;
  Io io;
  CopyLogic logic;
  IdleProcess process;
  std::unique_ptr<Cycle> cycle;
};

constexpr Place kInput{Packet::a, Format::bl, 0, 1};
constexpr Place kOutput{Packet::a, Format::bl, 8, 1};
constexpr Place kWord{Packet::k, Format::in, 10, 1};

/// A microsecond passes with every look at it.
class LookedAt final : public image::Clock {
 public:
  image::Nanoseconds now_ns() const noexcept override { return ++looks * image::kMicrosecond; }
  mutable int looks = 0;
};

TEST(Cycle, measures_each_phase_of_every_nth_cycle_and_asks_no_clock_in_between) {
  LookedAt clock;
  CycleParts parts;
  parts.alarms = &tests::alarm_table();
  parts.stopwatch = &clock;
  Cycle cycle(std::move(parts));
  cycle.measure_every(3);
  std::string measured;
  for (int i = 0; i < 7; ++i) {
    cycle.step();
    measured += cycle.measured() ? 'm' : '.';
  }
  EXPECT_EQ(measured, "m..m..m");
  EXPECT_EQ(clock.looks, 3 * (kPhases + 1));
  EXPECT_EQ(cycle.duration_ns(), kPhases * image::kMicrosecond);
  for (const image::Nanoseconds ns : cycle.phase_ns()) EXPECT_EQ(ns, image::kMicrosecond);
}

TEST(Cycle, receives_then_runs_the_logic_then_sends_and_counts_its_time) {
  Bench b;
  b.io.input = true;
  ASSERT_TRUE(b.cycle->step());
  EXPECT_EQ(b.order, "rls");
  EXPECT_TRUE(b.io.output) << "the input reaches the output in the same cycle";
  ASSERT_TRUE(b.cycle->step());
  EXPECT_EQ(b.cycle->count(), 2);
  EXPECT_EQ(b.cycle->image().now.number, 1);
  EXPECT_EQ(b.cycle->image().now.t_ns, image::kMillisecond);
}

TEST(Cycle, forces_an_input_before_the_logic_and_an_output_after_it_until_released) {
  Bench b;
  const auto scenario = image::Asker::scenario;
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::force, kInput, 1.0, scenario)).refusal, 0);
  b.cycle->step();
  EXPECT_TRUE(b.logic.seen) << "forced on although the input is off";
  EXPECT_TRUE(b.io.output);
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::force, kOutput, 0.0, scenario)).refusal, 0);
  b.cycle->step();
  EXPECT_TRUE(b.logic.seen);
  EXPECT_FALSE(b.io.output) << "forced off although the logic sets it";
  // A second force of the same place replaces the first.
  b.ask(Bench::place_request(RequestKind::force, kInput, 0.0, scenario));
  b.io.input = true;
  b.cycle->step();
  EXPECT_FALSE(b.logic.seen);
  b.ask(Bench::place_request(RequestKind::release_force, kInput, 0.0, scenario));
  b.ask(Bench::place_request(RequestKind::release_force, kOutput, 0.0, scenario));
  b.cycle->step();
  EXPECT_TRUE(b.logic.seen);
  EXPECT_TRUE(b.io.output);
}

TEST(Cycle, lets_an_operator_set_a_free_word_but_not_the_interface_nor_a_signal) {
  Bench b;
  const auto operator_ = image::Asker::command_line;
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::set_place, kWord, 123.0, operator_)).refusal, 0);
  EXPECT_EQ(b.cycle->image().packets.number(kWord), 123.0);
  const Place interface = image::field(image::kMachineFields, "estop_ok", image::kMachineBase);
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::set_place, interface, 1.0, operator_)).refusal,
            static_cast<int>(Refusal::place_not_writable));
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::set_place, kInput, 1.0, operator_)).refusal,
            static_cast<int>(Refusal::place_not_writable));
  const Place outside{Packet::k, Format::in, 0x7fffffff, 1};
  EXPECT_EQ(b.ask(Bench::place_request(RequestKind::set_place, outside, 1.0, operator_)).refusal,
            static_cast<int>(Refusal::place_outside));
}

TEST(Cycle, takes_a_bounded_number_of_requests_each_cycle_and_answers_all_in_order) {
  Bench b;
  Request r;
  r.kind = RequestKind::acknowledge;
  int posted = 0;
  for (r.id = 1; b.cycle->post(r) && r.id < 100000; ++r.id) ++posted;
  EXPECT_GE(posted, 256) << "the queue holds what its contract says";
  EXPECT_LT(posted, 100000) << "and is bounded: post() says no";
  std::uint64_t next = 1;
  for (int i = 0; i < posted; ++i) {
    b.cycle->step();
    image::Answer answer;
    int answers = 0;
    for (; b.cycle->take_answer(answer); ++answers) ASSERT_EQ(answer.id, next++);
    ASSERT_LE(answers, kRequestsPerCycle);
  }
  EXPECT_EQ(next, static_cast<std::uint64_t>(posted) + 1);
}

TEST(Cycle, goes_on_when_nobody_takes_its_answers) {
  Bench b;
  Request r;
  r.kind = RequestKind::acknowledge;
  for (int i = 0; i < 5000; ++i) {
    r.id = static_cast<std::uint64_t>(i);
    b.cycle->post(r);
    ASSERT_TRUE(b.cycle->step());
  }
  EXPECT_EQ(b.cycle->count(), 5000);
}

TEST(Cycle, makes_an_alarm_of_a_long_overrun_and_none_of_a_short_one) {
  Bench b;
  b.cycle->step();
  b.cycle->note_overrun(3 * image::kMillisecond / 2);
  b.cycle->step();
  EXPECT_EQ(b.alarms(alarm::kOverrunLimit), 0);
  b.cycle->note_overrun(5 * image::kMillisecond);
  b.cycle->step();
  ASSERT_EQ(b.alarms(alarm::kOverrunLimit), 1);
  const image::AlarmRecord r = b.cycle->alarms().history().back();
  EXPECT_DOUBLE_EQ(r.value, 5.0);
  EXPECT_DOUBLE_EQ(r.limit, 2.0);
}

TEST(Cycle, toggles_the_alive_output_as_long_as_it_keeps_its_time) {
  std::string order;
  Io io(order);
  CopyLogic logic(order);
  IdleProcess process;
  CycleParts parts;
  parts.alarms = &tests::alarm_table();
  parts.devices = {&io};
  parts.logic = &logic;
  parts.processes = {&process};
  constexpr Place kAlive{Packet::a, Format::bl, 70, 1};
  parts.alive_place = kAlive;
  Cycle cycle(std::move(parts));
  const auto changes = [&](int cycles) {
    int n = 0;
    for (bool was = cycle.image().packets.bit(kAlive); cycles-- > 0;) {
      cycle.step();
      const bool is = cycle.image().packets.bit(kAlive);
      n += is != was;
      was = is;
    }
    return n;
  };
  changes(10);
  EXPECT_EQ(changes(1000), 20) << "each 50 cycles";
  logic.estop_ok = false;
  EXPECT_EQ(changes(1000), 20) << "an open chain has to find a living control when it is closed again";
  logic.estop_ok = true;
  cycle.note_overrun(5 * image::kMillisecond);
  EXPECT_LE(changes(10), 1);
  EXPECT_FALSE(cycle.image().packets.bit(kAlive));
  EXPECT_EQ(changes(1000), 0) << "until somebody has read why";
  Request reset;
  reset.kind = RequestKind::reset;
  reset.id = 1;
  ASSERT_TRUE(cycle.post(reset));
  EXPECT_GE(changes(1000), 19);
}

TEST(Cycle, says_once_that_the_emergency_stop_opened_and_takes_it_back_only_when_closed) {
  Bench b;
  b.cycle->step();
  b.logic.estop_ok = false;
  for (int i = 0; i < 10; ++i) b.cycle->step();
  EXPECT_EQ(b.alarms(alarm::kEmergencyStop), 1);
  Request reset;
  reset.id = 5;
  reset.kind = RequestKind::reset;
  b.ask(reset);
  EXPECT_GT(b.cycle->alarms().active_count(), 0);
  b.logic.estop_ok = true;
  b.cycle->step();
  b.ask(reset);
  EXPECT_EQ(b.cycle->alarms().active_count(), 0);
}

TEST(Cycle, replays_recorded_inputs_to_the_same_image) {
  struct Tape final : InputTap, InputSource {
    std::vector<CycleInputs> cycles;
    std::size_t at = 0;
    void take(const CycleInputs& inputs) noexcept override { cycles.push_back(inputs); }
    bool give(CycleInputs& inputs) noexcept override {
      if (at == cycles.size()) return false;
      inputs = cycles[at++];
      return true;
    }
  } tape;
  std::mt19937 random(3);
  std::vector<std::pair<bool, double>> live, replayed;
  {
    Bench b;
    b.cycle->attach(static_cast<InputTap*>(&tape));
    for (int i = 0; i < 500; ++i) {
      b.io.input = random() % 2 == 0;
      b.cycle->post(Bench::place_request(RequestKind::set_place, kWord, static_cast<double>(random() % 1000),
                                         image::Asker::page));
      if (random() % 10 == 0) b.cycle->note_overrun(7 * image::kMillisecond);
      b.cycle->step();
      live.emplace_back(b.logic.seen, b.cycle->image().packets.number(kWord));
      image::Answer answer;
      while (b.cycle->take_answer(answer)) {
      }
    }
    EXPECT_GT(b.alarms(alarm::kOverrunLimit), 0);
  }
  Bench b;
  b.cycle->attach(static_cast<InputSource*>(&tape));
  while (b.cycle->step()) replayed.emplace_back(b.logic.seen, b.cycle->image().packets.number(kWord));
  EXPECT_EQ(live, replayed);
  EXPECT_GT(live.back().second, 0.0);
  EXPECT_GT(b.alarms(alarm::kOverrunLimit), 0) << "late cycles are inputs too";
  EXPECT_EQ(b.order.find('r'), std::string::npos) << "no device is asked in a replay";
}

TEST(Snapshot, is_never_torn_while_one_thread_writes_and_others_read) {
  struct Value {
    std::array<std::uint64_t, 201> words;
    std::uint16_t odd;  // a size that is no multiple of a word
  };
  Snapshot<Value> snapshot;
  std::atomic<bool> stop{false};
  std::atomic<long> torn{0}, backwards{0}, reads{0};
  const auto value = [](std::uint64_t n) {
    Value v{};
    v.words.fill(n);
    v.odd = static_cast<std::uint16_t>(n);
    return v;
  };
  snapshot.publish(value(0));
  std::vector<std::thread> readers;
  for (int t = 0; t < 3; ++t)
    readers.emplace_back([&] {
      Value v{};
      std::uint64_t last = 0;
      while (!stop.load(std::memory_order_relaxed)) {
        snapshot.read(v);
        const std::uint64_t n = v.words[0];
        const bool whole =
            std::all_of(v.words.begin(), v.words.end(), [&](std::uint64_t w) { return w == n; });
        torn += !whole || v.odd != static_cast<std::uint16_t>(n);
        backwards += n < last;
        last = n;
        ++reads;
      }
    });
  // Until all have read enough, however rarely a busy computer lets them.
  for (std::uint64_t n = 1; n <= 300000 || reads.load() < 1000; ++n) {
    snapshot.publish(value(n));
    if (n > 300000) std::this_thread::yield();
  }
  stop = true;
  for (std::thread& t : readers) t.join();
  EXPECT_EQ(torn.load(), 0);
  EXPECT_EQ(backwards.load(), 0);
  EXPECT_GT(reads.load(), 100);
}

TEST(Cycle, publishes_whole_cycles_to_readers_on_other_threads) {
  Bench b;
  b.cycle->publish_every(1);
  b.cycle->step();
  std::atomic<bool> stop{false};
  std::atomic<long> wrong{0}, reads{0};
  std::thread reader([&] {
    auto image = std::make_unique<image::ProcessImage>();
    auto alarms = std::make_unique<AlarmSnapshot>();
    while (!stop.load()) {
      b.cycle->read(*image);
      b.cycle->read(*alarms);
      wrong += image->now.t_ns != image->now.number * image::kMillisecond;
      wrong += image->packets.bit(kInput) != image->packets.bit(kOutput);
      ++reads;
    }
  });
  for (int i = 0; i < 3000 || reads.load() < 20; ++i) {
    b.io.input = i % 2 == 0;
    b.cycle->step();
  }
  stop = true;
  reader.join();
  EXPECT_EQ(wrong.load(), 0);
}

TEST(Executive, without_a_process_carries_out_all_that_speaks_to_none) {
  Bench bench(false);
  const auto ask = [&](RequestKind kind) {
    Request r;
    r.id = 5;
    r.kind = kind;
    return static_cast<Refusal>(bench.ask(r).refusal);
  };
  EXPECT_EQ(bench.ask(Bench::place_request(RequestKind::set_place, kWord, 12.0, image::Asker::command_line))
                .refusal,
            0);
  EXPECT_EQ(bench.cycle->image().packets.number(kWord), 12.0);
  EXPECT_EQ(bench.ask(Bench::place_request(RequestKind::force, kInput, 1.0, image::Asker::scenario)).refusal,
            0);
  for (const RequestKind kind : {RequestKind::power, RequestKind::stop, RequestKind::quick_stop,
                                 RequestKind::reset, RequestKind::acknowledge, RequestKind::jog_stop})
    EXPECT_EQ(ask(kind), Refusal::none) << static_cast<int>(kind);
  for (const RequestKind kind : {RequestKind::start, RequestKind::step, RequestKind::hold,
                                 RequestKind::resume, RequestKind::mode, RequestKind::override_feed})
    EXPECT_EQ(ask(kind), Refusal::no_such_process) << static_cast<int>(kind);
}

/// Remembers what it was ordered.
class OrderedProcess final : public ProcessInCycle {
 public:
  void published(std::span<std::uint64_t>) const noexcept override {}
  void interpolate(ProcessContext&) noexcept override {}
  bool order(const Request& request, ProcessContext&) noexcept override {
    last = request.kind;
    return true;
  }
  bool loaded() const noexcept override { return false; }
  RequestKind last = RequestKind::none;
};

TEST(Cycle, stops_and_holds_every_process_when_none_is_named) {
  OrderedProcess first, second;
  CycleParts parts;
  parts.alarms = &tests::alarm_table();
  parts.processes = {&first, &second};
  Cycle cycle(std::move(parts));
  const auto ask = [&](RequestKind kind, int process) {
    first.last = second.last = RequestKind::none;
    Request r;
    r.kind = kind;
    r.process = static_cast<std::int8_t>(process);
    EXPECT_TRUE(cycle.post(r));
    cycle.step();
    image::Answer answer;
    EXPECT_TRUE(cycle.take_answer(answer));
    return static_cast<Refusal>(answer.refusal);
  };
  for (const RequestKind kind : {RequestKind::stop, RequestKind::hold}) {
    EXPECT_EQ(ask(kind, -1), Refusal::none);
    EXPECT_EQ(first.last, kind);
    EXPECT_EQ(second.last, kind);
    EXPECT_EQ(ask(kind, 1), Refusal::none);
    EXPECT_EQ(first.last, RequestKind::none);
    EXPECT_EQ(second.last, kind);
    EXPECT_EQ(ask(kind, 2), Refusal::no_such_process);
  }
  EXPECT_EQ(ask(RequestKind::resume, -1), Refusal::no_such_process);
}

/// A clock that stands unless the logic takes its time.
class HandClock final : public image::Clock {
 public:
  image::Nanoseconds now_ns() const noexcept override { return now; }
  image::Nanoseconds now = 0;
};
class SlowLogic final : public image::Logic {
 public:
  explicit SlowLogic(HandClock& clock) : clock_(clock) {}
  void scan(image::ProcessImage&, Notices&) noexcept override { clock_.now += takes; }
  image::Nanoseconds takes = 0;

 private:
  HandClock& clock_;
};

TEST(Cycle, raises_the_watchdog_of_the_logic_in_the_cycle_behind_the_slow_one) {
  HandClock clock;
  SlowLogic logic(clock);
  CycleParts parts;
  parts.alarms = &tests::alarm_table();
  parts.logic = &logic;
  parts.stopwatch = &clock;
  Cycle cycle(std::move(parts));
  const auto step = [&](image::Nanoseconds takes, image::Nanoseconds limit) {
    logic.takes = takes;
    cycle.step();
    cycle.watch_logic(limit);
    return cycle.alarms().active(alarm::kPlcWatchdog);
  };
  EXPECT_FALSE(step(500'000, 500'000));
  EXPECT_FALSE(step(900'000, 0)) << "not watched";
  EXPECT_FALSE(step(500'001, 500'000)) << "it is an input of the next cycle, so that a record holds it";
  EXPECT_TRUE(step(0, 500'000));
  const image::AlarmRecord& r = *cycle.alarms().first();
  EXPECT_EQ(r.number, alarm::kPlcWatchdog);
  EXPECT_NEAR(r.value, 0.500001, 1e-9);
  EXPECT_EQ(r.limit, 0.5);
  EXPECT_EQ(r.reaction, image::Reaction::stop_and_power_off);
}

}  // namespace
}  // namespace servogate::cycle
