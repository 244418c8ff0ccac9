// SPDX-License-Identifier: Apache-2.0
// In virtual time programs are read and planned beside the cycles: who does that and how long it takes makes
// no difference to a byte of the trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <stdexcept>
#include <thread>

#include "gateway/control/run/operator_script.hpp"
#include "gateway/control/run/running_machine.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/property_seed.hpp"

namespace servogate::machine_run {
namespace {

using gateway::RoundWorker;
using Workers = std::function<std::unique_ptr<RoundWorker>()>;

/// On a thread that sometimes begins late, and sometimes ends late.
class Dawdles final : public RoundWorker {
 public:
  Dawdles(std::uint64_t seed, int& rounds) : random_(seed), rounds_(rounds) {}
  void start(const std::function<void()>& work) override {
    ++rounds_;
    const int before = pause(), after = pause();
    delayed_ = [&work, before, after] {
      std::this_thread::sleep_for(std::chrono::microseconds(before));
      work();
      std::this_thread::sleep_for(std::chrono::microseconds(after));
    };
    beside_.start(delayed_);
  }
  void wait() override { beside_.wait(); }

 private:
  int pause() { return random_() % 3 == 0 ? static_cast<int>(random_() % 2000) : 0; }

  std::mt19937_64 random_;
  int& rounds_;
  std::function<void()> delayed_;
  gateway::WorksBeside beside_;
};

/// Somebody at the panel: another override or a hold now and then, always in the same cycles.
void interfere(gateway::RunningMachine& machine, std::mt19937_64& random) {
  static constexpr double kOverrides[] = {1.0, 0.3, 1.5, 0.8, 0.0};
  image::Request request;
  request.id = 1'000'000 + random() % 1'000'000;
  const auto what = random() % 4;
  if (what < 2) {
    request.kind = image::RequestKind::override_feed;
    request.value = kOverrides[random() % std::size(kOverrides)];
  } else {
    request.kind = what == 2 ? image::RequestKind::hold : image::RequestKind::resume;
  }
  EXPECT_TRUE(machine.post(request));
}

/// Runs the example mill from drives on to drives off; writes the trace.
void run(const Workers& worker, const std::string& trace) {
  std::vector<text::Finding> findings;
  const auto machine =
      gateway::RunningMachine::compose(machine::load(mill_file()), nullptr, {.worker = worker}, findings);
  ASSERT_NE(machine, nullptr);
  ASSERT_TRUE(machine->load(source("examples/mill/bracket.nc"), findings));
  machine->watch({trace, {}, {}});
  gateway::OperatorScript::Wishes wishes;
  for (const machine::AxisConfig& axis : machine->machine().axes) {
    wishes.letters.push_back(axis.letter);
    wishes.needs_homing.push_back(true);
  }
  wishes.fault = [&] { return gateway::fault_stands(machine->alarms()); };
  gateway::OperatorScript script(wishes, [&](const image::Request& r) { return machine->post(r); });
  std::mt19937_64 random(1);
  constexpr std::int64_t kLongest = 400'000;
  for (std::int64_t cycle = 0; !script.done() && cycle < kLongest; ++cycle) {
    machine->step();
    image::Answer answer;
    while (machine->take(answer))
      if (answer.id < 1'000'000) script.take(answer);
    script.poll(machine->image());
    if (script.stage() != gateway::OperatorScript::Stage::running) continue;
    constexpr std::int64_t kLeftAlone = 60'000;
    if (cycle < kLeftAlone && cycle % 701 == 0) interfere(*machine, random);
    if (cycle == kLeftAlone) {
      image::Request request{.id = 2'000'000, .kind = image::RequestKind::override_feed, .value = 1.0};
      EXPECT_TRUE(machine->post(request));
      request.kind = image::RequestKind::resume;
      EXPECT_TRUE(machine->post(request));
    }
  }
  machine->stop();
  EXPECT_TRUE(script.outcome() == gateway::OperatorScript::Outcome::finished);
  for (const auto& lost : machine->close_files()) ADD_FAILURE() << lost.path << ": " << lost.why;
}

TEST(WorksBeside, hands_what_a_round_throws_to_its_owner_and_does_the_next_one) {
  gateway::WorksBeside worker;
  int done = 0;
  const std::function<void()> fails = [] { throw std::runtime_error("no such subprogram"); };
  const std::function<void()> works = [&] { ++done; };
  worker.start(fails);
  worker.wait();
  EXPECT_THROW(worker.rethrow(), std::runtime_error);
  EXPECT_NO_THROW(worker.rethrow());
  worker.start(works);
  worker.wait();
  EXPECT_NO_THROW(worker.rethrow());
  EXPECT_EQ(done, 1);
}

TEST(ReadingBeside, gives_a_trace_of_the_same_bytes_whoever_reads_and_however_long_it_takes) {
  const Scratch scratch;
  const std::string expected = scratch.path("at_once.csv"), path = scratch.path("beside.csv");
  run([] { return std::make_unique<gateway::WorksAtOnce>(); }, expected);
  const std::string bytes = read_all(expected);
  ASSERT_GT(std::count(bytes.begin(), bytes.end(), '\n'), 100'000);
  const std::uint64_t seed = test::property_seed();
  for (std::uint64_t n = 0; n < 3; ++n) {
    int rounds = 0;
    run([&] { return std::make_unique<Dawdles>(seed + n, rounds); }, path);
    EXPECT_GT(rounds, 20) << "nothing was read beside the cycles";
    EXPECT_TRUE(read_all(path) == bytes) << "seed " << seed + n;
  }
}

}  // namespace
}  // namespace servogate::machine_run
