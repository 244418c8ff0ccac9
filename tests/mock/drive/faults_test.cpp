// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

using image::DriveState;
using image::kMillisecond;

struct DriveFaults : testing::Test {
  DriveBench b;
  void SetUp() override {
    b.write(0x1017, 0, 10, 2);
    b.start_cyclic_position();
    for (const int word : {0x06, 0x07, 0x0F})
      for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
    b.seen.clear();
  }
  void cycles(int n) {
    for (int i = 0; i < n; ++i) b.cycle(0x0F, 0);
  }
};

TEST_F(DriveFaults, names_and_kinds_belong_together) {
  for (std::size_t i = 0; i < fault::kKinds; ++i) {
    const auto kind = static_cast<fault::Kind>(i);
    EXPECT_EQ(fault::row(kind).kind, kind) << "the rows stand in the order of the enumeration";
    ASSERT_NE(fault::find_kind(fault::name_of(kind)), nullptr);
    EXPECT_EQ(fault::find_kind(fault::name_of(kind))->kind, kind);
    EXPECT_EQ(fault::lasts(kind), fault::row(kind).takes(fault::Parameter::duration));
  }
  for (std::size_t i = 0; i < fault::parameters().size(); ++i)
    EXPECT_EQ(static_cast<std::size_t>(fault::parameters()[i].parameter), i);
  EXPECT_EQ(fault::find_kind("gremlins"), nullptr);
}

TEST_F(DriveFaults, silent_sends_nothing_until_its_time_is_over) {
  b.drive.inject({.kind = fault::Kind::silent, .duration_ns = 50 * kMillisecond});
  cycles(45);
  EXPECT_TRUE(b.seen.empty());
  cycles(20);
  EXPECT_GT(b.count(0x185), 10);
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled) << "it worked on";
}

TEST_F(DriveFaults, deaf_hears_nothing) {
  b.drive.inject({.kind = fault::Kind::deaf});
  cycles(10);
  EXPECT_EQ(b.count(0x185), 0);
  b.nmt(0x02);
  EXPECT_EQ(b.drive.nmt_state(), canopen::NmtState::operational);
  b.drive.clear_faults();
  cycles(10);
  EXPECT_EQ(b.count(0x185), 10);
}

TEST_F(DriveFaults, a_lost_heartbeat_takes_nothing_else_away) {
  b.drive.inject({.kind = fault::Kind::heartbeat_lost});
  cycles(100);
  EXPECT_EQ(b.count(0x705), 0);
  EXPECT_EQ(b.count(0x185), 100);
  b.drive.clear(fault::Kind::heartbeat_lost);
  cycles(100);
  EXPECT_NEAR(b.count(0x705), 10, 1);
}

TEST_F(DriveFaults, a_dead_drive_has_no_torque_and_comes_back_with_its_power_on_state) {
  b.write(0x6083, 0, 4711, 4);
  ASSERT_EQ(b.read(0x6083), 4711u);
  for (int i = 1; i <= 40; ++i) b.cycle(0x0F, 300 * i);
  ASSERT_EQ(b.drive.state(), DriveState::operation_enabled);
  const double speed = b.drive.velocity_counts_s();
  ASSERT_GT(speed, 200'000.0);
  b.seen.clear();
  b.drive.inject({.kind = fault::Kind::kill, .duration_ns = 100 * kMillisecond});
  for (int i = 41; i <= 130; ++i) b.cycle(0x0F, 300 * i);
  EXPECT_TRUE(b.seen.empty());
  EXPECT_NEAR(b.drive.torque_permille(), 0.0, 1e-6);
  EXPECT_LT(b.drive.velocity_counts_s(), speed) << "it coasts";
  b.run(30);
  const auto boot_up = b.take(0x705);
  ASSERT_TRUE(boot_up);
  EXPECT_EQ(boot_up->data[0], 0) << "the boot-up message comes before anything else";
  EXPECT_EQ(b.drive.nmt_state(), canopen::NmtState::pre_operational);
  EXPECT_EQ(b.drive.state(), DriveState::switch_on_disabled);
  EXPECT_NE(b.read(0x6083), 4711u) << "what was not stored is gone";
  EXPECT_EQ(b.read(0x1017), 0u);
}

TEST_F(DriveFaults, nobody_acknowledges_what_is_sent_to_a_dead_drive_that_is_alone) {
  b.drive.inject({.kind = fault::Kind::kill});
  b.send(0x080, {});
  b.run(10);
  EXPECT_EQ(b.master.state(), image::CanState::error_passive);
  b.drive.clear(fault::Kind::kill);
  b.run(50);
  EXPECT_EQ(b.count(0x705), 1) << "its boot-up message";
}

TEST_F(DriveFaults, a_swapped_drive_boots_as_another_product_until_the_right_one_is_back) {
  const std::uint32_t own = b.read(0x1018, 2);
  b.drive.inject({.kind = fault::Kind::swapped});
  b.run(30);
  EXPECT_EQ(b.count(0x705), 1);
  EXPECT_EQ(b.drive.nmt_state(), canopen::NmtState::pre_operational) << "and has to be configured anew";
  EXPECT_EQ(b.read(0x1018, 2), own + 1);
  EXPECT_EQ(b.read(0x1018, 1), 0u);
  b.drive.inject({.kind = fault::Kind::swapped, .value = 0xCAFE});
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), 0xCAFEu);
  b.nmt(0x82);
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), 0xCAFEu) << "a reset makes no other device of it";
  b.drive.clear_faults();
  b.run(30);
  EXPECT_EQ(b.read(0x1018, 2), own);
}

TEST_F(DriveFaults, every_nth_pdo_can_be_dropped) {
  b.drive.inject({.kind = fault::Kind::pdo_dropped, .every = 4});
  cycles(100);
  EXPECT_EQ(b.count(0x185), 75);
}

TEST_F(DriveFaults, late_pdos_come_in_the_next_cycle_with_the_old_content) {
  b.drive.inject({.kind = fault::Kind::pdo_late, .delay_ns = 1500 * image::kMicrosecond});
  cycles(10);
  EXPECT_GE(b.count(0x185), 7);
  EXPECT_LT(b.count(0x185), 10);
}

TEST_F(DriveFaults, corrupted_and_repeated_pdos) {
  b.drive.inject({.kind = fault::Kind::pdo_corrupted, .value = 0xFF});
  cycles(1);
  const auto good = static_cast<std::uint8_t>(b.drive.statusword());
  EXPECT_EQ(b.take(0x185)->data[0], good ^ 0xFF);
  b.drive.clear_faults();
  cycles(1);
  b.drive.inject({.kind = fault::Kind::pdo_corrupted, .number = 2, .value = 0xFF});
  cycles(1);
  EXPECT_EQ(b.take(0x185)->data[0], good) << "TPDO1 is not TPDO2";
  b.drive.clear_faults();
  b.drive.inject({.kind = fault::Kind::pdo_repeated});
  const auto before = b.take(0x185);
  for (int i = 1; i < 20; ++i) b.cycle(0x0F, 500 * i);
  while (const auto f = b.take(0x185)) EXPECT_EQ(f->data, before->data);
}

// ---- TPDOs that their master has moved ----

struct MovedPdos : DriveFaults {
  static constexpr std::uint32_t kFirst = 0x3A5, kSecond = 0x1C0;  // neither is anybody's predefined TPDO
  void SetUp() override {
    DriveFaults::SetUp();
    b.write(0x1800, 1, 0xC0000185, 4);
    b.write(0x1800, 1, 0xC0000000 | kFirst, 4);
    b.write(0x1800, 1, 0x40000000 | kFirst, 4);
    b.write(0x1801, 2, 1, 1);
    b.write(0x1801, 1, 0xC0000000 | kSecond, 4);
    b.write(0x1801, 1, 0x40000000 | kSecond, 4);
    cycles(2);
    b.seen.clear();
  }
};

TEST_F(MovedPdos, are_dropped_by_their_number) {
  b.drive.inject({.kind = fault::Kind::pdo_dropped, .number = 1});
  cycles(20);
  EXPECT_EQ(b.count(kFirst), 0);
  EXPECT_EQ(b.count(kSecond), 20);
  b.drive.clear_faults();
  b.drive.inject({.kind = fault::Kind::pdo_dropped, .every = 4, .number = 2});
  b.seen.clear();
  cycles(20);
  EXPECT_EQ(b.count(kFirst), 20);
  EXPECT_EQ(b.count(kSecond), 15);
}

TEST_F(MovedPdos, are_late_by_their_number) {
  b.drive.inject({.kind = fault::Kind::pdo_late, .delay_ns = 5 * kMillisecond, .number = 1});
  cycles(20);
  EXPECT_NEAR(b.count(kFirst), 15, 1);
  EXPECT_EQ(b.count(kSecond), 20);
}

TEST_F(MovedPdos, are_corrupted_by_their_number) {
  b.drive.inject({.kind = fault::Kind::pdo_corrupted, .number = 1, .value = 0xFF});
  cycles(1);
  const auto good = static_cast<std::uint8_t>(b.drive.statusword());
  EXPECT_EQ(b.take(kFirst)->data[0], good ^ 0xFF);
  EXPECT_EQ(b.take(kSecond)->data[0], good);
}

TEST_F(MovedPdos, are_repeated_by_their_number_under_the_identifier_that_they_have_now) {
  b.drive.inject({.kind = fault::Kind::pdo_repeated, .number = 1});
  cycles(1);
  const auto before = b.take(kFirst);
  b.write(0x1800, 1, 0xC0000000 | kFirst, 4);
  b.write(0x1800, 1, 0xC0000185, 4);
  b.write(0x1800, 1, 0x40000185, 4);
  for (int i = 1; i < 10; ++i) b.cycle(0x0F, 500 * i);
  EXPECT_EQ(b.count(kFirst), 0);
  ASSERT_GE(b.count(0x185), 8);
  while (const auto f = b.take(0x185)) EXPECT_EQ(f->data, before->data);
}

TEST_F(MovedPdos, leave_what_is_no_pdo_alone_although_it_has_the_identifier_of_one) {
  // EMCY moved to where TPDO1 is by default, which nobody uses now.
  b.write(0x1014, 0, 0x80000085, 4);
  ASSERT_EQ(b.write(0x1014, 0, 0x80000185, 4), 0u);
  ASSERT_EQ(b.write(0x1014, 0, 0x00000185, 4), 0u);
  b.drive.inject({.kind = fault::Kind::pdo_dropped});
  b.seen.clear();
  b.drive.inject({.kind = fault::Kind::emcy_only, .error_code = 0x4210});
  cycles(5);
  EXPECT_EQ(b.count(0x185), 1);
  EXPECT_EQ(b.count(kFirst), 0);
}

// ---- what the drive hears ----

TEST_F(DriveFaults, an_rpdo_that_does_not_come_leaves_the_drive_where_it_is) {
  b.drive.inject({.kind = fault::Kind::rpdo_dropped});
  for (int i = 1; i < 50; ++i) b.cycle(0x0F, 500 * i);
  EXPECT_EQ(b.drive.object(0x607A), 0);
  EXPECT_NEAR(static_cast<double>(b.drive.reported_position()), 0, 20);
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled) << "1400h:05 is 0: nobody watches";
  EXPECT_EQ(b.count(0x185), 49) << "its own PDOs are not concerned";
  b.drive.clear_faults();
  b.cycle(0x0F, 100);
  b.cycle(0x0F, 100);
  EXPECT_EQ(b.drive.object(0x607A), 100);
}

TEST_F(DriveFaults, every_nth_rpdo_can_be_dropped) {
  b.drive.inject({.kind = fault::Kind::rpdo_dropped, .every = 3});
  int missed = 0;
  for (int i = 1; i <= 30; ++i) {
    b.cycle(0x0F, i);
    b.send(0x080, {});
    b.run(1);
    missed += b.drive.object(0x607A) != i;
  }
  EXPECT_EQ(missed, 10);
}

TEST_F(DriveFaults, another_rpdo_than_the_one_that_is_named_comes_through) {
  b.drive.inject({.kind = fault::Kind::rpdo_dropped, .number = 2});
  b.cycle(0x0F, 77);
  b.cycle(0x0F, 77);
  EXPECT_EQ(b.drive.object(0x607A), 77);
}

TEST_F(DriveFaults, a_late_rpdo_acts_with_the_sync_behind_it) {
  b.drive.inject({.kind = fault::Kind::rpdo_late, .delay_ns = 2500 * image::kMicrosecond});
  for (int i = 1; i <= 20; ++i) b.cycle(0x0F, i);
  // Without the fault a SYNC makes the target of the cycle before it act: 19.
  EXPECT_NEAR(static_cast<double>(b.drive.object(0x607A)), 17, 1);
}

TEST_F(DriveFaults, a_corrupted_rpdo_acts_as_it_came) {
  // Bit 4 of the second byte of the target.
  b.drive.inject({.kind = fault::Kind::rpdo_corrupted, .value = 0x1000'0000});
  b.cycle(0x0F, 5);
  b.cycle(0x0F, 5);
  EXPECT_EQ(b.drive.object(0x607A), 0x1005);
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled);
}

TEST_F(DriveFaults, the_deadline_1400_05_ends_what_dropped_or_late_rpdos_began) {
  for (const auto kind : {fault::Kind::rpdo_dropped, fault::Kind::rpdo_late}) {
    for (const int option : {0, 1, 2, 3}) {
      b.write(0x6007, 0, option, 2);
      b.write(0x605A, 0, 6, 2);
      b.write(0x1400, 5, 20, 2);
      for (const int word : {0x00, 0x80, 0x06, 0x07, 0x0F})
        for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
      ASSERT_EQ(b.drive.state(), DriveState::operation_enabled);
      b.seen.clear();
      b.drive.inject({.kind = kind, .delay_ns = 50 * kMillisecond});
      cycles(19);
      EXPECT_EQ(b.count(0x085), 0) << "the deadline is not over";
      cycles(20);
      const auto emcy = b.take(0x085);
      ASSERT_TRUE(emcy) << name_of(kind) << " " << option;
      EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8250);
      EXPECT_EQ(emcy->data[2], 0x11);
      constexpr DriveState kAfter[] = {DriveState::operation_enabled, DriveState::fault,
                                       DriveState::switch_on_disabled, DriveState::quick_stop_active};
      EXPECT_EQ(b.drive.state(), kAfter[option]) << option;
      EXPECT_EQ(b.drive.nmt_state(), canopen::NmtState::operational) << "1029h does not speak of it";
      b.drive.clear_faults();
      cycles(60);
      const auto over = b.take(0x085);
      ASSERT_TRUE(over) << name_of(kind) << " " << option;
      EXPECT_EQ(over->data[0] | over->data[1] << 8, 0x0000);
      b.write(0x1400, 5, 0, 2);
    }
  }
}

TEST_F(DriveFaults, sdo_requests_can_be_refused_or_left_without_an_answer) {
  b.drive.inject(
      {.kind = fault::Kind::sdo_abort, .index = 0x6085, .abort = canopen::AbortCode::hardware_error});
  EXPECT_EQ(b.write(0x6085, 0, 1000, 4), 0x06060000u);
  EXPECT_EQ(b.write(0x6084, 0, 1000, 4), 0u) << "another object";
  b.drive.clear_faults();
  b.drive.inject({.kind = fault::Kind::sdo_late, .delay_ns = 20 * image::kMillisecond});
  EXPECT_TRUE(b.sdo({0x40, 0, 0x10, 0, 0, 0, 0, 0}).empty());
  int waited = 0;
  while (!b.take(0x585) && waited < 100) cycles(1), ++waited;
  EXPECT_GE(waited, 8);
  EXPECT_LE(waited, 21) << "20 ms behind the request";
  b.drive.clear_faults();
  b.drive.inject({.kind = fault::Kind::sdo_silent});
  EXPECT_TRUE(b.sdo({0x40, 0, 0x10, 0, 0, 0, 0, 0}).empty());
}

TEST_F(DriveFaults, each_fault_of_the_drive_has_its_error_code_and_register_bit) {
  struct Case {
    fault::Kind kind;
    int code, bits;
  };
  for (const Case c : {Case{fault::Kind::over_current, 0x2310, 0x03},
                       {fault::Kind::encoder_fault, 0x7305, 0x21},
                       {fault::Kind::following_error, 0x8611, 0x21},
                       {fault::Kind::over_temperature, 0x4310, 0x09},
                       {fault::Kind::under_voltage, 0x3220, 0x05}}) {
    b.seen.clear();
    b.drive.inject({.kind = c.kind});
    for (int i = 0; i < 50; ++i) b.cycle(0x0F, 0);
    const auto emcy = b.take(0x085);
    ASSERT_TRUE(emcy);
    EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, c.code);
    EXPECT_EQ(emcy->data[2], c.bits) << std::hex << c.code;
    EXPECT_EQ(b.drive.state(), DriveState::fault);
    EXPECT_EQ(b.drive.error_code(), c.code);
    for (const int word : {0x80, 0x06, 0x07, 0x0F})
      for (int i = 0; i < 5; ++i) b.cycle(static_cast<std::uint16_t>(word), 0);
    EXPECT_EQ(b.drive.state(), DriveState::operation_enabled);
    const auto cleared = b.take(0x085);
    ASSERT_TRUE(cleared);
    EXPECT_EQ(cleared->data[0] | cleared->data[1] << 8, 0);
  }
}

TEST_F(DriveFaults, an_encoder_jump_beyond_the_window_is_a_following_error) {
  b.write(0x6065, 0, 5000, 4);
  b.drive.inject({.kind = fault::Kind::encoder_jump, .value = 400'000});
  cycles(200);
  EXPECT_EQ(b.drive.error_code(), 0x8611);
}

TEST_F(DriveFaults, a_small_encoder_jump_moves_the_shaft_unnoticed) {
  const auto true_position = b.drive.position_counts();
  b.drive.inject({.kind = fault::Kind::encoder_jump, .value = 300});
  cycles(500);
  EXPECT_EQ(b.drive.state(), DriveState::operation_enabled);
  EXPECT_NEAR(static_cast<double>(b.drive.position_counts() - true_position), -300, 3);
}

TEST_F(DriveFaults, a_frozen_drive_stands_still_in_every_respect_and_goes_on_afterwards) {
  for (int i = 1; i < 100; ++i) b.cycle(0x0F, 1000 * i);
  b.drive.inject({.kind = fault::Kind::freeze, .duration_ns = 100 * kMillisecond});
  const auto held = b.drive.position_counts();
  b.seen.clear();
  b.run(90);
  EXPECT_EQ(b.drive.position_counts(), held);
  EXPECT_TRUE(b.seen.empty());
  b.run(50);
  EXPECT_GT(b.count(0x705), 0);
}

TEST_F(DriveFaults, a_reset_boots_again_and_an_incremental_encoder_begins_at_zero) {
  for (int i = 1; i < 100; ++i) b.cycle(0x0F, 1000 * i);
  const auto there = b.drive.position_counts();
  b.drive.inject({.kind = fault::Kind::reset});
  b.seen.clear();
  b.run(100);
  EXPECT_EQ(b.take(0x705)->data[0], 0x00);
  EXPECT_EQ(b.drive.nmt_state(), canopen::NmtState::pre_operational);
  EXPECT_EQ(b.drive.state(), DriveState::switch_on_disabled);
  EXPECT_GT(b.drive.position_counts(), 90'000);
  EXPECT_EQ(b.drive.reported_position(), b.drive.position_counts() - there) << "what it coasted since";
}

TEST(DriveBusOff, a_drive_off_the_bus_falls_into_a_fault_by_itself) {
  DriveBench b;
  b.enable();
  b.segment.force_bus_off(1);
  b.run(50);
  EXPECT_EQ(b.drive.state(), DriveState::fault);
  EXPECT_EQ(b.drive.error_code(), 0x8140);
}

// A polled endpoint, as a socket is: the drive must be the same device there.
TEST(DrivePolled, a_drive_on_a_polled_bus_answers_and_keeps_its_heartbeat) {
  CanSegment segment;
  auto& master = segment.add_endpoint();
  auto& socket = segment.add_endpoint();
  SimulatedDriveConfig config;
  config.node_id = 3;
  SimulatedDrive drive(config);
  PolledDrive polled(drive, socket, 0);
  CanFrame request;
  request.id = 0x603;
  request.length = 8;
  request.data = {0x2B, 0x17, 0x10, 0x00, 0x0A, 0x00};
  int beats = 0, answers = 0;
  for (Nanoseconds t = 0; t < 300 * kMillisecond; t += 250'000) {
    segment.advance_to(t);
    polled.advance_to(t);
    if (t == 50 * kMillisecond) master.send(request);
    CanFrame f;
    while (master.receive(f)) {
      answers += f.id == 0x583;
      beats += f.id == 0x703;
    }
  }
  EXPECT_EQ(answers, 1);
  EXPECT_NEAR(beats, 1 + 25, 2);
}

// Everything that happens on the wire of a segment with eight moving drives.
struct Recorder final : CanMonitor {
  std::vector<std::uint8_t> bytes;
  void on_wire(const CanFrame& f, int sender, Nanoseconds start, Nanoseconds end,
               Outcome outcome) noexcept override {
    const auto put = [this](std::int64_t x) {
      for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::uint8_t>(x >> (8 * i)));
    };
    put(start);
    put(end);
    put(f.id | static_cast<std::int64_t>(sender) << 32 | static_cast<std::int64_t>(outcome) << 48);
    bytes.insert(bytes.end(), f.data.begin(), f.data.begin() + f.length);
  }
};

struct Eight {
  explicit Eight(int count, CanMonitor* monitor = nullptr) {
    segment.set_monitor(monitor);
    for (int n = 1; n <= count; ++n) {
      SimulatedDriveConfig config;
      config.node_id = static_cast<canopen::NodeId>(n);
      config.plant.start_rev = 0.37 * n;
      drives.push_back(std::make_unique<SimulatedDrive>(config));
      segment.attach(*drives.back());
    }
    run(20);
    for (int n = 1; n <= count; ++n) configure(n);
    send(0x000, {0x01, 0x00});
    for (const int word : {0x06, 0x07, 0x0F})
      for (int i = 0; i < 5; ++i) cycle(word, 0);
  }
  void send(std::uint32_t id, std::initializer_list<std::int64_t> bytes) {
    CanFrame f;
    f.id = id;
    for (const std::int64_t x : bytes) f.data[f.length++] = static_cast<std::uint8_t>(x);
    master.send(f);
  }
  void run(int ms) {
    for (int i = 0; i < ms; ++i) {
      segment.advance_to(now += kMillisecond);
      CanFrame f;
      while (master.receive(f)) received += f.id >= 0x181 && f.id <= 0x1FF;
    }
  }
  void write(int n, int index, int sub, std::uint32_t v, int size) {
    send(static_cast<std::uint32_t>(0x600 + n), {0x23 | (4 - size) << 2, index & 255, index >> 8, sub,
                                                 v & 255, v >> 8 & 255, v >> 16 & 255, v >> 24});
    run(2);
  }
  // Short PDOs, or eight drives do not fit into 1 ms: six bytes there (6040 + 607A), four back (6064).
  void configure(int n) {
    const auto id = static_cast<std::uint32_t>(n);
    write(n, 0x1400, 1, 0x80000200 + id, 4);
    write(n, 0x1800, 1, 0xC0000180 + id, 4);
    write(n, 0x1600, 0, 0, 1);
    write(n, 0x1600, 1, 0x60400010, 4);
    write(n, 0x1600, 2, 0x607A0020, 4);
    write(n, 0x1600, 0, 2, 1);
    write(n, 0x1A00, 0, 0, 1);
    write(n, 0x1A00, 1, 0x60640020, 4);
    write(n, 0x1A00, 0, 1, 1);
    write(n, 0x1400, 2, 1, 1);
    write(n, 0x1800, 2, 1, 1);
    write(n, 0x1400, 1, 0x200 + id, 4);
    write(n, 0x1800, 1, 0x40000180 + id, 4);
    write(n, 0x6060, 0, 8, 1);
  }
  void cycle(int word, std::int64_t p) {
    send(0x080, {});
    for (std::size_t n = 1; n <= drives.size(); ++n)
      send(static_cast<std::uint32_t>(0x200 + n),
           {word & 255, word >> 8, p & 255, p >> 8 & 255, p >> 16 & 255, p >> 24});
    run(1);
  }
  CanSegment segment;
  image::CanBus& master = segment.add_endpoint();
  std::vector<std::unique_ptr<SimulatedDrive>> drives;
  Nanoseconds now = 0;
  int received = 0;
};

TEST(DriveFleet, four_drives_hold_a_sync_of_1_ms_at_1_mbit_with_every_pdo_in_its_cycle) {
  Eight e(4);
  e.received = 0;
  for (int i = 0; i < 500; ++i) e.cycle(0x0F, 200 * i);
  EXPECT_EQ(e.received, 4 * 500);
  EXPECT_EQ(e.segment.statistics().refused, 0u);
  for (auto& d : e.drives) EXPECT_EQ(d->state(), DriveState::operation_enabled);
}

TEST(DriveFleet, eight_drives_run_in_one_process_at_a_sync_of_1_ms_on_two_segments) {
  Eight a(4), b(4);
  for (int i = 0; i < 500; ++i) {
    a.cycle(0x0F, 200 * i);
    b.cycle(0x0F, -200 * i);
  }
  for (auto& d : a.drives) EXPECT_NEAR(static_cast<double>(d->reported_position()), 200 * 498, 300);
  for (auto& d : b.drives) EXPECT_NEAR(static_cast<double>(d->reported_position()), -200 * 498, 300);
}

TEST(DriveFleet, two_runs_are_equal_to_the_byte) {
  Recorder first, second;
  for (Recorder* r : {&first, &second}) {
    Eight e(3, r);
    e.segment.inject({.kind = fault::Kind::corrupt, .skip = 100, .count = 3});
    for (int i = 0; i < 400; ++i) {
      if (i == 200) e.drives[1]->inject({.kind = fault::Kind::over_current});
      e.cycle(0x0F, static_cast<std::int64_t>(5'000.0 * i));
    }
  }
  ASSERT_GT(first.bytes.size(), 50'000u);
  EXPECT_EQ(first.bytes, second.bytes);
}

TEST(DriveFleet, says_how_much_faster_than_real_time_three_drives_and_their_bus_run) {
  Eight e(3);
  e.received = 0;
  double best = 1e9;
  for (int round = 0; round < 5; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 2000; ++i) e.cycle(0x0F, 1000 * i);
    const std::chrono::duration<double> d = std::chrono::steady_clock::now() - start;
    best = std::min(best, d.count() / 2000);
  }
  std::printf("           3 drives, 7 frames: %.2f us a millisecond, %.0f x real time\n", best * 1e6,
              1e-3 / best);
  EXPECT_EQ(e.received, 5 * 2000 * 3) << "all of them answered each time";
}

}  // namespace
}  // namespace servogate::mock
