// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/node_boot.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>

#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "tests/canopen/fake_drive.hpp"

namespace servogate::canopen {
namespace {

using testing::FakeDrive;
using testing::FakeNetwork;
using testing::frame;

constexpr image::Nanoseconds kMs = image::kMillisecond;

/// Node 5 and the boot of it, one millisecond a step.
struct NodeBootTest : ::testing::Test {
  NodeBootTest() : drive(network.add(5)) {
    config.node = 5;
    use_short_position_map(config.profile);
  }

  void run(int limit_ms = 20'000) {
    NodeBoot fresh(5, boot_plan(config, segment), segment.boot_timeout_ms * kMs);
    boot = std::make_unique<NodeBoot>(fresh);
    boot->begin(sdo);
    for (int i = 0; i < limit_ms && boot->state() == NodeBoot::State::running; ++i) step();
  }
  void step() {
    now += kMs;
    image::CanFrame f;
    while (network.receive(f)) {
      if (f.id == 0x585) sdo.on_frame(f);
      if (f.id != 0x705) continue;
      if (f.data[0] == 0) {
        boot->on_boot_up();
      } else {
        boot->on_heartbeat(*parse_heartbeat(f));
      }
    }
    boot->poll(now, sdo, network);
    network.transfer(now);
  }
  void expect_failure(BootStep step, BootProblem problem, std::uint16_t index, std::uint8_t subindex) {
    ASSERT_EQ(boot->state(), NodeBoot::State::failed);
    EXPECT_EQ(boot->report().step, step) << boot_step_text(boot->report().step).english;
    EXPECT_EQ(boot->report().problem, problem);
    EXPECT_EQ(boot->report().index, index);
    EXPECT_EQ(boot->report().subindex, subindex);
  }

  FakeNetwork network;
  FakeDrive& drive;
  NodeConfig config;
  SegmentConfig segment;
  SdoClient sdo{5, 50 * kMs, 2};
  std::unique_ptr<NodeBoot> boot;
  image::Nanoseconds now = 0;
};

TEST_F(NodeBootTest, brings_a_good_drive_to_operational_with_everything_written) {
  run();
  ASSERT_EQ(boot->state(), NodeBoot::State::done) << boot_step_text(boot->report().step).english;
  EXPECT_EQ(drive.nmt_state, 5);
  EXPECT_EQ(drive.get(0x1600, 0), 2u);
  EXPECT_EQ(drive.get(0x1600, 1), 0x60400010u);
  EXPECT_EQ(drive.get(0x1600, 2), 0x607A0020u);
  EXPECT_EQ(drive.get(0x1400, 1), 0x205u);
  EXPECT_EQ(drive.get(0x1400, 2), 1u);
  EXPECT_EQ(drive.get(0x1A00, 2), 0x60640020u);
  EXPECT_EQ(drive.get(0x1800, 1), 0x40000185u);
  EXPECT_EQ(drive.get(0x1016, 1), 0x007F012Cu);
  EXPECT_EQ(drive.get(0x1017, 0), 100u);
  EXPECT_EQ(drive.get(0x6007, 0), 1u);
  EXPECT_EQ(drive.get(0x6060, 0), 8u);
  EXPECT_EQ(boot->report().step, BootStep::done);
  EXPECT_EQ(boot->identity().device_type, 0x00020192u);
  EXPECT_EQ(boot->identity().vendor_id, 0x11u);
  EXPECT_EQ(boot->identity().serial, 1005u);
}

TEST_F(NodeBootTest, an_absent_node_is_named_at_the_reset) {
  drive.powered = false;
  run();
  expect_failure(BootStep::reset, BootProblem::no_answer, 0, 0);
  EXPECT_GE(now, segment.boot_timeout_ms * kMs);
}

TEST_F(NodeBootTest, an_old_boot_up_message_does_not_stand_for_the_answer) {
  NodeBoot fresh(5, boot_plan(config, segment), 100 * kMs);
  boot = std::make_unique<NodeBoot>(fresh);
  boot->begin(sdo);
  boot->on_boot_up();
  drive.powered = false;
  for (int i = 0; i < 200; ++i) step();
  expect_failure(BootStep::reset, BootProblem::no_answer, 0, 0);
}

TEST_F(NodeBootTest, a_device_of_another_profile_is_not_touched) {
  drive.set(0x1000, 0, 4, 0x00030191);
  run();
  expect_failure(BootStep::device_type, BootProblem::wrong_value, 0x1000, 0);
  EXPECT_EQ(boot->report().expected, 0x192u);
  EXPECT_EQ(boot->report().got, 0x00030191u);
  EXPECT_TRUE(drive.writes.empty());
}

TEST_F(NodeBootTest, another_product_is_named_with_what_was_expected_and_what_came) {
  config.profile.product_code = 0x23;
  run();
  expect_failure(BootStep::identity, BootProblem::wrong_value, 0x1018, 2);
  EXPECT_EQ(boot->report().expected, 0x23u);
  EXPECT_EQ(boot->report().got, 0x22u);
  EXPECT_TRUE(drive.writes.empty());
}

TEST_F(NodeBootTest, an_identity_with_only_the_vendor_is_enough_unless_more_is_wanted) {
  for (const std::uint8_t sub : {2, 3, 4}) drive.erase(0x1018, sub);
  run();
  EXPECT_EQ(boot->state(), NodeBoot::State::done);
  config.profile.revision = 1;
  run();
  expect_failure(BootStep::identity, BootProblem::aborted, 0x1018, 3);
  EXPECT_EQ(boot->report().abort, AbortCode::subindex_does_not_exist);
}

TEST_F(NodeBootTest, a_drive_without_the_mode_is_refused) {
  drive.set(0x6502, 0, 4, 0x25);
  run();
  expect_failure(BootStep::supported_modes, BootProblem::wrong_value, 0x6502, 0);
}

TEST_F(NodeBootTest, a_refused_mapping_entry_is_named_with_its_abort_code) {
  drive.aborts[0x1A0002] = 0x06040041;
  run();
  expect_failure(BootStep::tpdo, BootProblem::aborted, 0x1A00, 2);
  EXPECT_EQ(boot->report().abort, AbortCode::cannot_be_mapped);
  EXPECT_TRUE(boot->report().writing);
}

TEST_F(NodeBootTest, a_value_that_does_not_stay_is_found_when_read_back) {
  drive.stuck[0x140002] = 255;
  run();
  expect_failure(BootStep::rpdo, BootProblem::wrong_value, 0x1400, 2);
  EXPECT_EQ(boot->report().expected, 1u);
  EXPECT_EQ(boot->report().got, 255u);
  EXPECT_FALSE(boot->report().writing);
}

TEST_F(NodeBootTest, a_shorter_object_than_expected_is_named) {
  drive.set(0x1018, 1, 2, 0x11);
  run();
  expect_failure(BootStep::identity, BootProblem::wrong_length, 0x1018, 1);
  EXPECT_EQ(boot->report().expected, 4u);
  EXPECT_EQ(boot->report().got, 2u);
}

TEST_F(NodeBootTest, objects_that_may_be_missing_are_passed_over) {
  drive.erase(0x1005, 0);
  for (const std::uint16_t index : {0x1402, 0x1403, 0x1802, 0x1803}) drive.erase(index, 1);
  run();
  EXPECT_EQ(boot->state(), NodeBoot::State::done);
}

TEST_F(NodeBootTest, a_missing_object_that_is_needed_is_named) {
  drive.erase(0x6007, 0);
  run();
  expect_failure(BootStep::abort_connection, BootProblem::aborted, 0x6007, 0);
  EXPECT_EQ(boot->report().abort, AbortCode::object_does_not_exist);
}

TEST_F(NodeBootTest, a_drive_that_stops_answering_is_named_with_the_object) {
  network.fate = [](const image::CanFrame& f) { return f.id == 0x605 && f.data[1] == 0xC2 ? 0 : 1; };
  run();
  expect_failure(BootStep::interpolation_time, BootProblem::no_answer, 0x60C2, 2);
}

TEST_F(NodeBootTest, a_drive_that_does_not_become_operational_is_named_at_the_start) {
  drive.silent_heartbeat = true;
  run();
  expect_failure(BootStep::start, BootProblem::no_answer, 0, 0);
}

TEST_F(NodeBootTest, a_full_transmit_queue_delays_and_loses_nothing) {
  NodeBoot fresh(5, boot_plan(config, segment), 2000 * kMs);
  boot = std::make_unique<NodeBoot>(fresh);
  boot->begin(sdo);
  for (int i = 0; i < 20'000 && boot->state() == NodeBoot::State::running; ++i) {
    network.refuse_sending = i % 3 != 0;
    step();
  }
  EXPECT_EQ(boot->state(), NodeBoot::State::done);
}

TEST(NodeBootOnABadWire, boots_or_names_a_time_out_but_never_configures_wrongly) {
  constexpr unsigned kSeed = 301;
  std::mt19937 random(kSeed);
  int booted = 0;
  constexpr int kCases = 300;
  for (int i = 0; i < kCases; ++i) {
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << " case " << i);
    FakeNetwork network;
    FakeDrive& drive = network.add(5);
    network.fate = [&random](const image::CanFrame&) {
      const auto n = random() % 50;
      return n == 0 ? 0 : n == 1 ? 2 : 1;
    };
    NodeConfig config;
    config.node = 5;
    use_full_position_map(config.profile);
    SdoClient sdo(5, 20 * kMs, 3);
    NodeBoot boot(5, boot_plan(config, {}), 200 * kMs);
    boot.begin(sdo);
    image::Nanoseconds now = 0;
    while (boot.state() == NodeBoot::State::running && now < 60'000 * kMs) {
      now += kMs;
      image::CanFrame f;
      while (network.receive(f)) {
        if (f.id == 0x585) sdo.on_frame(f);
        if (f.id == 0x705 && f.data[0] == 0) boot.on_boot_up();
        if (f.id == 0x705 && f.data[0] != 0) boot.on_heartbeat(*parse_heartbeat(f));
      }
      boot.poll(now, sdo, network);
      network.transfer(now);
    }
    if (boot.state() != NodeBoot::State::done) {
      ASSERT_EQ(boot.report().problem, BootProblem::no_answer);
      continue;
    }
    ++booted;
    ASSERT_EQ(drive.get(0x1600, 3), 0x60600008u);
    ASSERT_EQ(drive.get(0x1A01, 2), 0x60BA0020u);
    ASSERT_EQ(drive.get(0x1802, 1), 0x40000385u);
    ASSERT_EQ(drive.nmt_state, 5);
  }
  EXPECT_GT(booted, kCases / 2);
}

TEST_F(NodeBootTest, a_configuration_of_the_right_date_is_not_written_again) {
  drive.set(0x1020, 1, 4, 15'000);
  drive.set(0x1020, 2, 4, 7);
  drive.set(0x2000, 0, 2, 0);
  config.setup.concise_dcf = write_concise_dcf(std::vector<ConfigurationEntry>{{0x2000, 0, {0x34, 0x12}}});
  config.setup.configuration_date = ConfigurationDate{15'000, 7};
  run();
  ASSERT_EQ(boot->state(), NodeBoot::State::done);
  EXPECT_EQ(drive.get(0x2000, 0), 0u);
  config.setup.configuration_date = ConfigurationDate{15'000, 8};
  run();
  ASSERT_EQ(boot->state(), NodeBoot::State::done);
  EXPECT_EQ(drive.get(0x2000, 0), 0x1234u);
  EXPECT_EQ(drive.get(0x1020, 2), 8u);
}

TEST_F(NodeBootTest, a_configuration_is_written_to_a_node_that_knows_no_date_and_its_failure_is_named) {
  drive.set(0x2000, 0, 2, 0);
  config.setup.concise_dcf = write_concise_dcf(std::vector<ConfigurationEntry>{{0x2000, 0, {0x34, 0x12}}});
  config.setup.configuration_date = ConfigurationDate{15'000, 7};
  run();
  EXPECT_EQ(drive.get(0x2000, 0), 0x1234u);
  expect_failure(BootStep::configuration, BootProblem::aborted, 0x1020, 1);
}

TEST_F(NodeBootTest, a_program_that_may_not_be_replaced_is_a_wrong_value) {
  drive.set(0x1F56, 1, 4, 0x1111);
  config.setup.program = NodeProgram{{}, 0x2222, 1};
  run();
  expect_failure(BootStep::program, BootProblem::wrong_value, 0x1F56, 1);
  EXPECT_EQ(boot->report().expected, 0x2222u);
  EXPECT_EQ(boot->report().got, 0x1111u);
}

TEST_F(NodeBootTest, a_concise_dcf_that_is_cut_off_is_refused_before_anything_is_sent) {
  config.setup.concise_dcf = {1, 0, 0, 0, 0x17};
  EXPECT_THROW(boot_plan(config, segment), std::invalid_argument);
}

}  // namespace
}  // namespace servogate::canopen
