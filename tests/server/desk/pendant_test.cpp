// SPDX-License-Identifier: Apache-2.0
// A pendant at the desk of a control that is up, with its own threads: the way that a real one goes, with a
// simulated one.
#include <gtest/gtest.h>

#include <cmath>
#include <mutex>

#include "gateway/control/run/running_machine.hpp"
#include "gateway/control/server/pendant/pendant_client.hpp"
#include "gateway/control/server/resident/resident.hpp"
#include "tests/comes.hpp"
#include "tests/places/places.hpp"
#include "tests/server/rig/shell.hpp"

namespace servogate::gateway::testing {
namespace {

using namespace std::chrono_literals;

machine::LoadResult retrofit() { return machine::load(Shell::example("retrofit/machine.toml")); }

class PendantAtTheDesk : public ::testing::Test {
 protected:
  PendantAtTheDesk()
      : running_(RunningMachine::compose(retrofit(), nullptr, {.clock = ClockKind::virtual_time, .pace = 2.0},
                                         findings_)),
        resident_(running_->control(), machine::MachineState{}, std::string(), 2.0) {}
  void SetUp() override {
    std::vector<drivers::Notice> refusals;
    ASSERT_TRUE(running_->begin(refusals));
    desk_.start();
    drivers::Notice why;
    pendant_ = PendantClient::open(
        running_->control(), running_->machine().pendants.at(0), desk_,
        [this](const text::Entry& entry, const std::vector<std::string>& arguments) {
          const std::scoped_lock lock(mutex_);
          said_ += text::render(entry, arguments, text::Language::english) + "\n";
        },
        why);
    ASSERT_NE(pendant_, nullptr) << why.str();
    ASSERT_TRUE(client_.ask(ask::Input{"estop_chain_ok", true}, 60s)->ok);
    ASSERT_TRUE(until(
        [](const StatusReport& s) { return s.axes.at(0).axis.drive.state != image::DriveState::offline; }));
    ASSERT_TRUE(tests::comes([&] { return client_.ask(ask::Power{true}, 60s)->ok; }));
    ASSERT_TRUE(until([](const StatusReport& s) { return s.axes.at(0).axis.enabled; }));
  }
  ~PendantAtTheDesk() override {
    pendant_.reset();
    desk_.stop();
    running_->stop();
  }
  StatusReport status() { return std::get<StatusReport>(client_.ask(ask::Status{}, 60s)->content); }
  bool until(const std::function<bool(const StatusReport&)>& good) {
    return tests::comes([&] {
      const StatusReport now = status();
      return !now.axes.empty() && good(now);  // none before the first cycle
    });
  }
  bool said(const std::string& words) {
    return tests::comes([&] {
      const std::scoped_lock lock(mutex_);
      return said_.find(words) != std::string::npos;
    });
  }
  void play(const std::string& control, double value) {
    ASSERT_EQ(mock().play(control, value), mock::MockPendant::Played::done) << control;
  }
  mock::MockPendant& mock() { return *running_->control().world().pendant("pendant"); }

  std::vector<text::Finding> findings_;
  std::unique_ptr<RunningMachine> running_;
  Resident resident_;
  Desk desk_{resident_};
  DeskClient client_{desk_, image::Asker::page, "the page", text::Language::english};
  std::mutex mutex_;
  std::string said_;
  std::unique_ptr<PendantClient> pendant_;
};

TEST_F(PendantAtTheDesk, moves_an_axis_shows_where_it_is_and_is_named_when_it_goes) {
  EXPECT_TRUE(said("pendant 'pendant' is here"));
  const double begin = status().axes[0].position;
  play("axis", 1);
  play("step", 3);
  // Counts before the client has seen the drive on are dropped, as they should be: one after the other until
  // it follows.
  int turned = 0;
  EXPECT_TRUE(until([&](const StatusReport& s) {
    play("wheel", ++turned);
    return std::abs(s.axes[0].position - begin) > 0.45;
  }));
  double whole_counts = 0.0;
  EXPECT_TRUE(until([&](const StatusReport& s) {
    whole_counts = std::abs(s.axes[0].position - begin) / 0.1;
    return !s.axes[0].axis.moving && std::abs(whole_counts - std::round(whole_counts)) < 0.05;
  })) << whole_counts
      << " counts";
  EXPECT_LE(whole_counts, turned + 0.05);
  const auto whole = static_cast<unsigned>(std::abs(status().axes[0].work));
  EXPECT_TRUE(tests::comes([&] {
    const auto shown = mock().shown();
    return shown.size() == 3 && shown[0][5] + shown[0][6] * 256u == whole;
  }));
  mock().plug(false);
  EXPECT_TRUE(said("pendant 'pendant' is unplugged"));
  mock().plug(true);
  EXPECT_TRUE(said("is here (mock)\n"));
}

TEST_F(PendantAtTheDesk, is_told_what_the_gate_refuses) {
  play("fn", 1);
  play("start", 1);
  play("start", 0);
  play("fn", 0);
  play("start", 1);
  EXPECT_TRUE(said("pendant 'pendant': ")) << "there is no program to start";
}

TEST_F(PendantAtTheDesk, whose_reports_are_garbage_is_named_with_its_file) {
  mock().garble(true);
  for (int n = 1; n < 30; ++n) play("wheel", n);
  EXPECT_TRUE(said("sends reports that device file 'xhc-whb04b-6' does not know"));
}

}  // namespace
}  // namespace servogate::gateway::testing
