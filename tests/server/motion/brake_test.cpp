// SPDX-License-Identifier: Apache-2.0
// The vertical axis of the example mill: its brake is an output of its drive, ordered by the control. The
// place of the head in the world is judged, not what the drive reports.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "gateway/control/run/running_machine.hpp"
#include "tests/places/places.hpp"

namespace servogate::gateway {
namespace {

using image::RequestKind;

class Brake : public ::testing::Test {
 protected:
  void SetUp() override {
    loaded_ = machine::load(tests::source_dir() + "/examples/mill/machine.toml");
    std::vector<text::Finding> findings;
    machine_ = RunningMachine::compose(loaded_, nullptr, {}, findings);
    ASSERT_NE(machine_, nullptr);
    z_ = loaded_.machine.axis_index("Z");
    slip_ = loaded_.machine.axes[static_cast<std::size_t>(z_)].brake.slip_window;
    step(1500);
    ASSERT_TRUE(drive().object(0x60FE, 2) == 1) << "the brake belongs to the output";
    EXPECT_FALSE(drive().brake_released());
    mark_ = place();
  }

  mock::SimulatedDrive& drive() { return *machine_->control().world().drive("can.z"); }
  double place() { return machine_->control().world().axis_position(z_); }
  bool enabled() { return machine_->image().axes[static_cast<std::size_t>(z_)].enabled; }

  void step(int cycles) {
    for (int n = 0; n < cycles; ++n) {
      machine_->step();
      if (mark_) dropped_ = std::max(dropped_, std::abs(place() - *mark_));
    }
  }
  void post(RequestKind kind, double value = 0.0) {
    image::Request r;
    r.kind = kind;
    r.value = value;
    ASSERT_TRUE(machine_->post(r));
  }
  void power(bool on) {
    post(RequestKind::power, on ? 1.0 : 0.0);
    step(1500);
    ASSERT_EQ(enabled(), on);
    ASSERT_EQ(drive().brake_released(), on);
  }

  machine::LoadResult loaded_;
  std::unique_ptr<RunningMachine> machine_;
  int z_ = -1;
  double slip_ = 0.0;
  std::optional<double> mark_;
  double dropped_ = 0.0;  ///< farthest from the mark, mm
};

TEST_F(Brake, holds_the_head_while_the_drives_go_on_and_off) {
  for (int n = 0; n < 3; ++n) {
    power(true);
    power(false);
  }
  std::printf("moved by at most %.4f mm, slip window %.2f mm\n", dropped_, slip_);
  EXPECT_LT(dropped_, slip_);
}

TEST_F(Brake, holds_the_head_through_an_emergency_stop) {
  power(true);
  ASSERT_TRUE(machine_->control().world().set_input("estop_chain_ok", false));
  step(3000);
  EXPECT_FALSE(enabled());
  EXPECT_FALSE(drive().brake_released());
  std::printf("moved by at most %.4f mm, slip window %.2f mm\n", dropped_, slip_);
  EXPECT_LT(dropped_, slip_);
}

TEST_F(Brake, catches_the_head_when_the_torque_is_cut_off_under_the_control) {
  power(true);
  drive().set_safe_torque_off(false);
  step(1000);
  EXPECT_FALSE(drive().brake_released());
  std::printf("fell by %.4f mm\n", dropped_);
  EXPECT_GT(dropped_, 0.01) << "nothing held it for a moment: the test sees gravity";
  const double closing_s = loaded_.machine.axes[static_cast<std::size_t>(z_)].brake.engage_delay;
  EXPECT_LT(dropped_, 0.5 * 9810.0 * closing_s * closing_s) << "free fall while the brake closes";
}

}  // namespace
}  // namespace servogate::gateway
