// SPDX-License-Identifier: Apache-2.0
#include "bench/drive/measurement/guard.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <thread>

#include "tests/bench/plant_on_bench.hpp"

namespace servogate::bench {
namespace {

constexpr Envelope kEnvelope{-10.0, 10.0, 20.0, 1.0, 5.0, 0.5};

struct Rig {
  explicit Rig(Envelope envelope = kEnvelope) : drive(mock::PlantConfig{}), guard(drive, envelope) {}
  PlantOnBench drive;
  Guard guard;
};

/// The drive stands and has no torque.
void expect_off(const Rig& rig) {
  EXPECT_FALSE(rig.drive.asked.power);
  EXPECT_LT(std::abs(rig.drive.plant().velocity_rad_s()), 0.1);
}

TEST(Guard, refuses_set_points_outside_of_the_envelope_before_the_drive_has_power) {
  const std::vector<double> far = {0.0, 0.01, 11.0}, fast = {0.0, 0.1}, strong = {0.5, 1.1};
  const std::vector<double> endless(6000, 0.0), senseless = {std::numeric_limits<double>::quiet_NaN()};
  const auto refusal = [](Loop loop, const std::vector<double>& values) {
    Rig rig;
    EXPECT_FALSE(rig.guard.accepts(loop, values));
    EXPECT_FALSE(rig.guard.enable(loop)) << "a refused run reaches the drive";
    EXPECT_FALSE(rig.drive.asked.power);
    return rig.guard.trip();
  };
  EXPECT_EQ(refusal(Loop::position, far), Trip::travel);
  EXPECT_EQ(refusal(Loop::position, fast), Trip::speed) << "0.1 rad in a cycle is 100 rad/s";
  EXPECT_EQ(refusal(Loop::torque, strong), Trip::torque);
  EXPECT_EQ(refusal(Loop::velocity, endless), Trip::time);
  EXPECT_NE(refusal(Loop::velocity, senseless), Trip::none);
}

TEST(Guard, looks_at_where_speeds_and_torques_would_lead_before_the_drive_has_power) {
  const std::vector<double> two_seconds(2000, 4.0), six_seconds(3000, 4.0), push(400, 0.05);
  const auto trip_of = [](const std::function<bool(Guard&)>& accepts, double quick_stop = 0.0) {
    Envelope envelope = kEnvelope;
    envelope.quick_stop_rad_s2 = quick_stop;
    Rig rig(envelope);
    const bool accepted = accepts(rig.guard);
    EXPECT_EQ(accepted, rig.guard.trip() == Trip::none);
    return rig.guard.trip();
  };
  const auto speed = [&](Guard& g) { return g.accepts(Loop::velocity, two_seconds); };
  EXPECT_EQ(trip_of(speed), Trip::none) << "8 rad of 10";
  EXPECT_EQ(trip_of(speed, 10.0), Trip::none) << "and 0.8 rad to brake";
  EXPECT_EQ(trip_of(speed, 3.0), Trip::travel) << "but 2.7 rad to brake";
  EXPECT_EQ(trip_of([&](Guard& g) { return g.accepts(Loop::velocity, six_seconds); }), Trip::travel);
  // 0.05 N m on 1e-3 kg m2: 50 rad/s2, in 0.4 s 20 rad/s and 4 rad.
  const auto torque = [&](double inertia, double friction) {
    return [&, inertia, friction](Guard& g) { return g.accepts_torque(push, {inertia, friction}); };
  };
  EXPECT_EQ(trip_of(torque(1.1e-3, 0.0)), Trip::none);
  EXPECT_EQ(trip_of(torque(1.1e-3, 0.0), 20.0), Trip::travel) << "8.3 rad to brake";
  EXPECT_EQ(trip_of(torque(5e-4, 0.0)), Trip::speed);
  EXPECT_EQ(trip_of(torque(5e-4, 0.03)), Trip::none) << "friction takes more than half";
  EXPECT_EQ(trip_of(torque(1e-6, 0.05)), Trip::none) << "it does not come loose";
}

TEST(Guard, begins_its_stop_so_early_that_the_travel_is_kept_behind_it) {
  Envelope envelope = kEnvelope;
  envelope.quick_stop_rad_s2 = 40.0;
  Rig rig(envelope);
  ASSERT_TRUE(rig.guard.enable(Loop::velocity));
  EXPECT_FALSE(rig.guard.run_at(15.0, 100.0, 3.0));
  EXPECT_EQ(rig.guard.trip(), Trip::travel);
  EXPECT_NEAR(rig.guard.answer().position_rad, 10.0 - 15.0 * 15.0 / 80.0, 0.5);
}

TEST(Guard, a_run_that_needs_more_travel_does_not_begin) {
  Rig rig;
  EXPECT_TRUE(rig.guard.accepts_travel(-10.0, 10.0));
  EXPECT_FALSE(rig.guard.accepts_travel(-1.0, 10.5));
  EXPECT_EQ(rig.guard.trip(), Trip::travel);
  EXPECT_FALSE(rig.guard.enable(Loop::velocity));
}

TEST(Guard, stops_at_the_end_of_the_travel_and_takes_the_torque) {
  Rig rig;
  ASSERT_TRUE(rig.guard.enable(Loop::velocity));
  EXPECT_FALSE(rig.guard.run_at(15.0, 100.0, 3.0));
  EXPECT_EQ(rig.guard.trip(), Trip::travel);
  EXPECT_FALSE(rig.guard.step(Loop::velocity, 0.0)) << "a run goes on behind its trip";
  EXPECT_TRUE(rig.guard.release());
  expect_off(rig);
  EXPECT_LT(rig.guard.answer().position_rad, 10.5);
}

TEST(Guard, stops_a_drive_that_runs_away_from_its_torque) {
  Rig rig({-1000.0, 1000.0, 20.0, 1.0, 5.0, 0.5});
  ASSERT_TRUE(rig.guard.enable(Loop::torque));
  while (rig.guard.step(Loop::torque, 0.9)) {
  }
  EXPECT_EQ(rig.guard.trip(), Trip::speed);
  rig.guard.release();
  expect_off(rig);
}

TEST(Guard, stops_when_the_position_is_not_followed) {
  Rig rig({-10.0, 10.0, 20.0, 7.2, 5.0, 0.05});
  ASSERT_TRUE(rig.guard.enable(Loop::position));
  double at = 0.0;
  while (rig.guard.step(Loop::position, at)) at += 0.019;
  EXPECT_EQ(rig.guard.trip(), Trip::following);
  rig.guard.release();
  expect_off(rig);
}

TEST(Guard, a_fault_a_silent_drive_the_operator_and_the_time_end_a_run) {
  const auto trip_of = [](const std::function<void(PlantOnBench&)>& happens) {
    Rig rig;
    EXPECT_TRUE(rig.guard.enable(Loop::velocity));
    EXPECT_TRUE(rig.guard.run_at(1.0, 100.0, 0.2));
    happens(rig.drive);
    rig.guard.run_at(1.0, 100.0, 8.0);
    rig.guard.release();
    EXPECT_FALSE(rig.drive.asked.power);
    return rig.guard.trip();
  };
  EXPECT_EQ(trip_of([](PlantOnBench& d) { d.faulted = true; }), Trip::fault);
  EXPECT_EQ(trip_of([](PlantOnBench& d) { d.online = false; }), Trip::offline);
  EXPECT_EQ(trip_of([](PlantOnBench& d) { d.drops = true; }), Trip::not_enabled)
      << "it left Operation enabled";
  EXPECT_EQ(trip_of([](PlantOnBench& d) { d.ends = true; }), Trip::ended);
  EXPECT_EQ(trip_of([](PlantOnBench& d) { d.gone = true; }), Trip::gone);
  EXPECT_EQ(trip_of([](PlantOnBench&) {}), Trip::time);
}

TEST(Guard, leaves_the_drive_without_torque_when_it_goes_out_of_scope_in_motion) {
  PlantOnBench drive((mock::PlantConfig()));
  {
    Guard guard(drive, kEnvelope);
    ASSERT_TRUE(guard.enable(Loop::velocity));
    ASSERT_TRUE(guard.run_at(10.0, 100.0, 0.1));
  }
  EXPECT_FALSE(drive.asked.power);
  EXPECT_LT(std::abs(drive.plant().velocity_rad_s()), 0.1);
}

TEST(Guard, a_cycle_that_comes_late_and_those_that_crowd_behind_it_are_no_runaway) {
  // An even motion at the limit of the speed, seen by a computer that stands still for 20 ms and then catches
  // up.
  class Even final : public BenchDrive {
   public:
    double period_s() const noexcept override { return 1e-3; }
    bool ended() const override { return false; }
    bool cycle(const DriveAsk& ask, DriveAnswer& answer) override {
      ++cycles_;
      time_ += cycles_ == 500 ? 0.020 : cycles_ > 500 && cycles_ < 520 ? 0.00005 : 0.001;
      answer.online = true;
      answer.enabled = ask.power;
      answer.time_s = time_;
      answer.position_rad = 20.0 * time_;
      return true;
    }

   private:
    int cycles_ = 0;
    double time_ = 0.0;
  } drive;
  Guard guard(drive, {-1.0, 1000.0, 20.0, 1.0, 5.0, 0.5});
  ASSERT_TRUE(guard.enable(Loop::velocity));
  for (int i = 0; i < 1000; ++i)
    ASSERT_TRUE(guard.step(Loop::velocity, 20.0)) << i << ": " << guard.trip_value();
}

TEST(Guard, a_drive_that_leads_itself_to_a_target_may_take_its_time_and_not_leave_the_travel) {
  Rig rig;
  ASSERT_TRUE(rig.guard.enable(Loop::position));
  EXPECT_TRUE(rig.guard.lead_to(0.4)) << "further than the following error, and at once";
  EXPECT_FALSE(rig.guard.lead_to(10.5));
  EXPECT_EQ(rig.guard.trip(), Trip::travel);
  rig.guard.release();
  EXPECT_FALSE(rig.drive.asked.power);
}

TEST(Guard, keeps_every_cycle_with_its_stage) {
  Rig rig;
  ASSERT_TRUE(rig.guard.enable(Loop::velocity));
  rig.guard.stage("even");
  ASSERT_TRUE(rig.guard.run_at(2.0, 1000.0, 0.1));
  const Sample& last = rig.guard.samples().back();
  EXPECT_EQ(rig.guard.stages()[last.stage], "even");
  EXPECT_EQ(last.set_point, 2.0);
  EXPECT_NEAR(rig.guard.speed_rad_s(), 2.0, 0.2);
}

/// A computation that ends when the drive has seen so many cycles more.
std::function<void()> as_long_as(const PlantOnBench& drive, int cycles) {
  return [&drive, end = drive.cycles + cycles] {
    while (drive.cycles < end) std::this_thread::yield();
  };
}

TEST(Guard, keeps_a_drive_in_its_cycles_at_rest_or_without_power_while_something_is_computed) {
  PlantOnBench drive((mock::PlantConfig()));
  drive.alive = true;
  Guard guard(drive, {-10.0, 10.0, 20.0, 1.0, 1e9, 0.5});
  ASSERT_TRUE(guard.enable(Loop::velocity));
  EXPECT_TRUE(guard.meanwhile(as_long_as(drive, 200)));
  EXPECT_TRUE(drive.asked.power);
  EXPECT_EQ(drive.asked.value, 0.0);
  ASSERT_TRUE(guard.release());
  EXPECT_TRUE(guard.meanwhile(as_long_as(drive, 200)));
  EXPECT_FALSE(drive.asked.power);
}

TEST(Guard, takes_the_power_when_the_operator_ends_a_run_that_computes) {
  PlantOnBench drive((mock::PlantConfig()));
  drive.alive = true;
  Guard guard(drive, {-10.0, 10.0, 20.0, 1.0, 1e9, 0.5});
  ASSERT_TRUE(guard.enable(Loop::velocity));
  drive.ends = true;
  EXPECT_FALSE(guard.meanwhile(as_long_as(drive, 200)));
  EXPECT_EQ(guard.trip(), Trip::ended);
  EXPECT_FALSE(drive.asked.power);
}

}  // namespace
}  // namespace servogate::bench
