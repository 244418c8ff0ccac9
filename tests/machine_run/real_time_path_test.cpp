// SPDX-License-Identifier: Apache-2.0
// Cycle::step() of a whole machine allocates nothing, locks nothing and makes no system call. The simulated
// world is no part of step(); its buses answer without system calls.
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <mutex>
#include <thread>

#include "gateway/control/run/record_file.hpp"
#include "gateway/control/run/session.hpp"
#include "tests/machine_run/rig/mill.hpp"
#include "tests/machine_run/rig/program.hpp"
#include "tests/machine_run/rig/programs.hpp"
#include "tests/machine_run/rig/watch.hpp"

namespace servogate::machine_run {
namespace {

using image::RequestKind;

/// A mill whose every step() is watched; publishing is on, as in real time.
class WatchedMill : public Mill {
 public:
  explicit WatchedMill(std::string_view program) : Mill(program) {
    Watch::forget();
    control().cycle().publish_every(5);
    step_cycle = [this](cycle::Cycle& c) {
      {
        const Watch watch;
        c.step();
      }
      ++cycles_;
      if (!Watch::offences().none() && first_ < 0) first_ = c.count() - 1;
    };
  }
  std::string verdict() const {
    if (Watch::offences().none()) return {};
    return "first in cycle " + std::to_string(first_) + " of " + std::to_string(cycles_) + ": " +
           Watch::offences().words();
  }
  long cycles() const { return cycles_; }

 private:
  long cycles_ = 0;
  std::int64_t first_ = -1;
};

TEST(Watch, sees_allocation_locks_and_system_calls) {
  if (!Watch::no_allocations().empty()) GTEST_SKIP() << Watch::no_allocations();
  Watch::forget();
  std::mutex mutex;
  void* volatile memory = nullptr;
  {
    const Watch watch;
    memory = std::malloc(10);
    delete new int(3);
    const std::scoped_lock lock(mutex);
  }
  std::free(memory);
  EXPECT_GE(Watch::offences().allocations, 1);
  EXPECT_EQ(Watch::offences().locks, 1);
  EXPECT_EQ(Watch::offences().system_calls, 0);
  if (!Watch::no_system_calls().empty()) GTEST_SKIP() << Watch::no_system_calls();
  {
    const Watch watch;
    syscall(SYS_getppid);
  }
  EXPECT_EQ(Watch::offences().system_calls, 1);
  EXPECT_EQ(Watch::offences().first_system_call, SYS_getppid);
  Watch::forget();
  EXPECT_TRUE(Watch::offences().none());
}

TEST(RealTimePath, of_the_whole_mill_from_boot_to_power_off_allocates_locks_and_calls_nothing) {
  WatchedMill mill(kShortProgram);
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  EXPECT_EQ(mill.verdict(), "") << "boot and homing";
  ASSERT_EQ(mill.ask(RequestKind::start), cycle::Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().line == 6; })) << mill.alarm_list();
  ASSERT_EQ(mill.ask(RequestKind::hold), cycle::Refusal::none);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::held; }));
  mill.run(0.1);
  mill.ask(RequestKind::override_feed, 1.3);
  ASSERT_EQ(mill.ask(RequestKind::resume), cycle::Refusal::none);
  mill.run(0.05);
  mill.ask(RequestKind::override_feed, 0.4);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }))
      << mill.alarm_list();
  EXPECT_EQ(mill.verdict(), "") << "program with M, S, T, synchronised SK, hold and override";

  mill.ask(RequestKind::mode, static_cast<double>(image::Mode::manual));
  EXPECT_EQ(mill.ask(RequestKind::jog_increment, 3.0, 0), cycle::Refusal::none);
  mill.run(1.0);
  mill.ask(RequestKind::jog_continuous, 1.0, 1);
  mill.run(0.5);
  mill.ask(RequestKind::mode, static_cast<double>(image::Mode::automatic));
  mill.ask(RequestKind::start);
  mill.run(0.2);
  EXPECT_EQ(mill.verdict(), "") << "jogging and a second start";
  mill.inject("can.y", fault::Kind::over_current);
  mill.run(1.0);
  EXPECT_GT(mill.alarms(axis::alarm::kDriveFault), 0) << mill.alarm_list();
  mill.control().world().set_input("estop_chain_ok", false);
  mill.run(0.5);
  EXPECT_GT(mill.alarms(cycle::alarm::kEmergencyStop), 0) << mill.alarm_list();
  mill.ask(RequestKind::reset);
  mill.run(0.1);
  EXPECT_EQ(mill.verdict(), "") << "drive fault, emergency stop, reset";
  mill.inject("can.x", fault::Kind::silent);
  mill.run(1.0);
  EXPECT_EQ(mill.verdict(), "") << "a node falls silent";
  EXPECT_GT(mill.cycles(), 5000);
  if (!Watch::no_system_calls().empty())
    GTEST_SKIP() << "system calls were not counted: " << Watch::no_system_calls();
  if (!Watch::no_allocations().empty())
    GTEST_SKIP() << "allocations and locks were not counted: " << Watch::no_allocations();
}

TEST(RealTimePath, of_recording_and_tracing_a_cycle_allocates_nothing) {
  const Scratch scratch;
  WatchedMill mill("N10 G0 X5\nN20 M30\n");
  gateway::Session session(mill.control(), {scratch.path("t.csv"), {}, scratch.path("h.html")}, true);
  gateway::RecordWriter record(scratch.path("record"), {});
  mill.control().cycle().attach(&record);
  mill.after_cycle = [&] {
    {
      const Watch watch;
      session.after_cycle(0);
    }
    session.wait_for_room();
    record.wait_for_room();
  };
  ASSERT_TRUE(mill.make_ready()) << mill.alarm_list();
  mill.ask(RequestKind::start);
  ASSERT_TRUE(mill.until([&] { return mill.process().state == image::ProcessState::ended; }));
  EXPECT_EQ(mill.verdict(), "");
  EXPECT_EQ(session.close(), "");
  EXPECT_EQ(record.close(), "");
  mill.control().cycle().attach(static_cast<cycle::InputTap*>(nullptr));
}

}  // namespace
}  // namespace servogate::machine_run
