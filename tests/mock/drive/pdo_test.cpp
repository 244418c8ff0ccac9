// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/mock/drive/drive_bench.hpp"

namespace servogate::mock {
namespace {

struct DrivePdo : testing::Test {
  DriveBench b;
  void switch_off_first_pdos() {
    ASSERT_EQ(b.write(0x1400, 1, 0x80000205, 4), 0u);
    ASSERT_EQ(b.write(0x1800, 1, 0xC0000185, 4), 0u);
  }
};

TEST_F(DrivePdo, a_mapping_cannot_be_changed_while_the_pdo_is_valid) {
  EXPECT_EQ(b.write(0x1600, 0, 0, 1), 0x06010000u);
  EXPECT_EQ(b.write(0x1A00, 1, 0x60640020, 4), 0x06010000u);
}

TEST_F(DrivePdo, an_entry_cannot_be_changed_while_the_count_is_not_zero) {
  switch_off_first_pdos();
  EXPECT_EQ(b.write(0x1600, 1, 0x60400010, 4), 0x06010000u);
  EXPECT_EQ(b.write(0x1600, 0, 0, 1), 0u);
  EXPECT_EQ(b.write(0x1600, 1, 0x60400010, 4), 0u);
}

TEST_F(DrivePdo, wrong_mappings_are_refused_each_with_its_code) {
  switch_off_first_pdos();
  b.write(0x1600, 0, 0, 1);
  b.write(0x1A00, 0, 0, 1);
  EXPECT_EQ(b.write(0x1600, 1, 0x55550010, 4), 0x06020000u) << "no object";
  EXPECT_EQ(b.write(0x1600, 1, 0x607A0120, 4), 0x06090011u) << "no sub-index";
  EXPECT_EQ(b.write(0x1600, 1, 0x60410010, 4), 0x06040041u) << "statusword cannot be received";
  EXPECT_EQ(b.write(0x1A00, 1, 0x60850020, 4), 0x06040041u) << "quick stop deceleration is in no PDO";
  EXPECT_EQ(b.write(0x1600, 1, 0x607A0010, 4), 0x06070010u) << "32 bits mapped as 16";
  EXPECT_EQ(b.write(0x1600, 0, 9, 1), 0x06040042u) << "nine objects";
  EXPECT_EQ(b.write(0x1600, 0, 1, 1), 0u) << "the entry of the default mapping is still there";
  b.write(0x1600, 0, 0, 1);
  for (std::uint8_t i = 1; i <= 2; ++i) EXPECT_EQ(b.write(0x1600, i, 0x607A0020, 4), 0u);
  EXPECT_EQ(b.write(0x1600, 3, 0x60400010, 4), 0u);
  EXPECT_EQ(b.write(0x1600, 0, 3, 1), 0x06040042u) << "80 bits";
  EXPECT_EQ(b.write(0x1600, 0, 2, 1), 0u);
}

TEST_F(DrivePdo, counting_an_entry_that_names_nothing_is_refused) {
  switch_off_first_pdos();
  b.write(0x1600, 0, 0, 1);
  b.write(0x1600, 2, 0, 4);
  EXPECT_EQ(b.write(0x1600, 0, 2, 1), 0x06020000u);
}

TEST_F(DrivePdo, the_identifier_changes_only_while_invalid_and_never_to_a_restricted_one) {
  EXPECT_EQ(b.write(0x1400, 1, 0x206, 4), 0x06090030u);
  switch_off_first_pdos();
  for (const std::uint32_t id : {0x000u, 0x07Fu, 0x101u, 0x180u, 0x581u, 0x601u, 0x6E0u, 0x701u, 0x7FFu})
    EXPECT_EQ(b.write(0x1400, 1, id, 4), 0x06090030u) << std::hex << id;
  EXPECT_EQ(b.write(0x1400, 1, 0x20000205, 4), 0x06090030u) << "29-bit identifiers";
  EXPECT_EQ(b.write(0x1400, 1, 0x80000333, 4), 0u);
  EXPECT_EQ(b.write(0x1400, 1, 0x333, 4), 0u);
}

TEST_F(DrivePdo, reserved_transmission_types_are_refused) {
  for (const int type : {241, 251, 252, 253}) EXPECT_EQ(b.write(0x1400, 2, type, 1), 0x06090030u) << type;
  for (const int type : {241, 251}) EXPECT_EQ(b.write(0x1800, 2, type, 1), 0x06090030u) << type;
  for (const int type : {0, 1, 240, 252, 253, 254, 255}) EXPECT_EQ(b.write(0x1800, 2, type, 1), 0u) << type;
}

TEST_F(DrivePdo, the_inhibit_time_changes_only_while_the_pdo_is_invalid) {
  EXPECT_EQ(b.write(0x1800, 3, 100, 2), 0x06090030u);
  switch_off_first_pdos();
  EXPECT_EQ(b.write(0x1800, 3, 100, 2), 0u);
}

TEST_F(DrivePdo, pdos_live_only_in_operational) {
  b.write(0x1800, 2, 1, 1);
  b.send(0x205, {0x06, 0x00});
  b.send(0x080, {});
  b.run(5);
  EXPECT_EQ(b.count(0x185), 0);
  EXPECT_EQ(b.status() & 0x6F, 0x40) << "the control word did not act";
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.send(0x080, {});
  b.run(5);
  EXPECT_EQ(b.count(0x185), 1);
  EXPECT_EQ(b.status() & 0x6F, 0x21);
}

TEST_F(DrivePdo, a_synchronous_rpdo_waits_for_the_next_sync) {
  b.write(0x1400, 2, 1, 1);
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.run(10);
  EXPECT_EQ(b.read(0x6040), 0u);
  b.send(0x080, {});
  b.run(1);
  EXPECT_EQ(b.read(0x6040), 6u);
}

TEST_F(DrivePdo, an_event_driven_rpdo_acts_at_once) {
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.run(1);
  EXPECT_EQ(b.read(0x6040), 6u);
}

TEST_F(DrivePdo, identifiers_of_sync_and_rpdo_written_by_sdo_are_heard_and_the_old_ones_no_more) {
  ASSERT_EQ(b.write(0x1005, 0, 0x081, 4), 0u);
  ASSERT_EQ(b.write(0x1800, 2, 1, 1), 0u);
  switch_off_first_pdos();
  ASSERT_EQ(b.write(0x1400, 1, 0x206, 4), 0u);
  ASSERT_EQ(b.write(0x1800, 1, 0x185, 4), 0u);
  b.nmt(0x01);
  b.send(0x080, {});
  b.send(0x205, {0x06, 0x00});
  b.run(2);
  EXPECT_EQ(b.count(0x185), 0);
  EXPECT_EQ(b.read(0x6040), 0u);
  b.send(0x081, {});
  b.send(0x206, {0x06, 0x00});
  b.run(2);
  EXPECT_EQ(b.count(0x185), 1);
  EXPECT_EQ(b.read(0x6040), 6u);
}

TEST_F(DrivePdo, every_nth_sync_samples_a_cyclic_tpdo) {
  b.write(0x1800, 2, 3, 1);
  b.nmt(0x01);
  for (int i = 0; i < 9; ++i) {
    b.send(0x080, {});
    b.run(1);
  }
  EXPECT_EQ(b.count(0x185), 3);
}

TEST_F(DrivePdo, an_acyclic_synchronous_tpdo_comes_at_sync_only_after_a_change) {
  b.write(0x1800, 2, 0, 1);
  b.nmt(0x01);
  const auto sync = [this] {
    b.send(0x080, {});
    b.run(2);
    const int n = b.count(0x185);
    b.seen.clear();
    return n;
  };
  EXPECT_EQ(sync(), 1);
  EXPECT_EQ(sync(), 0);
  b.control(0x0006);
  b.seen.clear();
  EXPECT_EQ(sync(), 1);
  EXPECT_EQ(sync(), 0);
}

TEST_F(DrivePdo, an_event_driven_tpdo_comes_on_entering_operational_and_on_change) {
  b.nmt(0x01);
  b.run(50);
  EXPECT_EQ(b.count(0x185), 1);
  b.control(0x0006);
  EXPECT_EQ(b.count(0x185), 2);
}

TEST_F(DrivePdo, the_event_timer_repeats_and_the_inhibit_time_holds_back) {
  switch_off_first_pdos();
  b.write(0x1800, 5, 10, 2);
  b.write(0x1800, 1, 0x40000185, 4);
  b.nmt(0x01);
  b.run(100);
  EXPECT_NEAR(b.count(0x185), 10, 1);
  b.nmt(0x80);
  switch_off_first_pdos();
  b.write(0x1800, 5, 0, 2);
  b.write(0x1800, 3, 500, 2);  // 50 ms
  b.write(0x1800, 1, 0x40000185, 4);
  b.write(0x1400, 1, 0x205, 4);
  b.nmt(0x01);
  b.seen.clear();
  b.send(0x205, {0x06, 0x00});
  b.run(20);
  b.send(0x205, {0x07, 0x00});
  b.run(20);
  EXPECT_EQ(b.count(0x185), 0);
  b.run(20);
  EXPECT_EQ(b.count(0x185), 1);
}

TEST_F(DrivePdo, a_tpdo_holds_what_was_true_at_sync_and_little_endian) {
  b.start_cyclic_position();
  b.cycle(0, 0);
  const auto f = b.take(0x185);
  ASSERT_TRUE(f);
  EXPECT_EQ(f->length, 6);
  EXPECT_EQ(f->data[0] | f->data[1] << 8, 0x0250);
}

TEST_F(DrivePdo, an_rpdo_that_is_too_short_is_not_processed_and_told_by_emcy_8210) {
  b.nmt(0x01);
  b.seen.clear();
  b.send(0x205, {0x06});
  b.run(2);
  EXPECT_EQ(b.read(0x6040), 0u);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8210);
  EXPECT_EQ(emcy->data[2], 0x11);
  b.send(0x205, {0x06, 0x00, 0x55});
  b.run(2);
  EXPECT_EQ(b.read(0x6040), 6u) << "a longer one is processed";
  const auto reset = b.take(0x085);
  ASSERT_TRUE(reset);
  EXPECT_EQ(reset->data[0] | reset->data[1] << 8, 0x0000);
  EXPECT_EQ(reset->data[2], 0x00);
}

TEST_F(DrivePdo, an_rpdo_past_its_deadline_is_an_abort_of_the_connection) {
  b.write(0x1400, 5, 20, 2);
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.run(15);
  EXPECT_EQ(b.count(0x085), 0);
  b.run(10);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8250);
  EXPECT_EQ(b.drive.state(), image::DriveState::fault) << "6007h = 1";
}

TEST_F(DrivePdo, one_rpdo_in_time_does_not_end_the_error_of_another) {
  b.write(0x6007, 0, 0, 2);
  b.write(0x1400, 5, 20, 2);
  b.write(0x1401, 1, 0x305, 4);
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.run(30);
  EXPECT_EQ(b.read(0x1001), 0x11u);
  b.send(0x305, {0x06, 0x00, 0x00});
  b.run(2);
  EXPECT_EQ(b.read(0x1001), 0x11u) << "8250h is still that of RPDO1";
  b.send(0x205, {0x06, 0x00});
  b.run(2);
  EXPECT_EQ(b.read(0x1001), 0x00u);
}

TEST_F(DrivePdo, a_pdo_that_is_changed_while_operational_leaves_the_others_alone) {
  b.write(0x6007, 0, 0, 2);
  b.write(0x1400, 5, 20, 2);
  b.write(0x1801, 1, 0x80000285, 4);
  b.write(0x1801, 2, 10, 1);
  b.write(0x1801, 1, 0x40000285, 4);
  b.nmt(0x01);
  b.send(0x205, {0x06, 0x00});
  b.seen.clear();
  for (int i = 0; i < 10; ++i) {
    b.write(0x1402, 1, 0x80000405, 4);  // another RPDO and another TPDO
    b.write(0x1802, 1, 0xC0000385, 4);
    b.send(0x080, {});
  }
  b.run(5);
  EXPECT_EQ(b.count(0x285), 1) << "every tenth SYNC";
  EXPECT_EQ(b.count(0x085), 1) << "the deadline of RPDO1 went on";
}

TEST_F(DrivePdo, dummy_entries_leave_gaps_in_an_rpdo) {
  switch_off_first_pdos();
  b.write(0x1600, 0, 0, 1);
  EXPECT_EQ(b.write(0x1600, 1, 0x00070020, 4), 0u);
  EXPECT_EQ(b.write(0x1600, 2, 0x60400010, 4), 0u);
  EXPECT_EQ(b.write(0x1600, 3, 0x00060020, 4), 0x06070010u) << "UNSIGNED16 is not 32 bits";
  EXPECT_EQ(b.write(0x1600, 0, 2, 1), 0u);
  b.write(0x1A00, 0, 0, 1);
  EXPECT_EQ(b.write(0x1A00, 1, 0x00070020, 4), 0x06040041u) << "nothing to send there";
  b.write(0x1400, 1, 0x205, 4);
  b.nmt(0x01);
  b.send(0x205, {0xAA, 0xAA, 0xAA, 0xAA, 0x06, 0x00});
  b.run(1);
  EXPECT_EQ(b.read(0x6040), 6u);
}

TEST_F(DrivePdo, a_remote_request_is_answered_only_where_bit_30_allows_it) {
  b.nmt(0x01);
  b.seen.clear();
  CanFrame request;
  request.id = 0x185;
  request.remote = true;
  b.master.send(request);
  b.run(2);
  EXPECT_EQ(b.count(0x185), 0);
  b.write(0x1800, 1, 0xC0000185, 4);
  b.write(0x1800, 1, 0x00000185, 4);
  b.run(5);
  b.seen.clear();
  b.master.send(request);
  b.run(2);
  EXPECT_EQ(b.count(0x185), 1);
}

/// TPDO1 on remote request: 6041h and 6064h by transmission type 252 or 253.
struct DriveRemotePdo : testing::Test {
  DriveBench b;
  void start(int type) {
    b.write(0x1800, 1, 0xC0000185, 4);
    b.write(0x1A00, 0, 0, 1);
    b.write(0x1A00, 1, 0x60FD0020, 4);
    b.write(0x1A00, 0, 1, 1);
    b.write(0x1800, 2, type, 1);
    b.write(0x1800, 1, 0x00000185, 4);
    b.nmt(0x01);
    b.seen.clear();
  }
  std::optional<CanFrame> ask() {
    CanFrame request;
    request.id = 0x185;
    request.remote = true;
    b.master.send(request);
    b.run(2);
    return b.take(0x185);
  }
};

TEST_F(DriveRemotePdo, type_253_answers_with_the_values_of_now_and_with_nothing_else) {
  start(253);
  b.drive.set_general_inputs(0x0001);
  b.send(0x080, {});
  b.run(5);
  EXPECT_EQ(b.count(0x185), 0) << "neither SYNC nor a change sends it";
  const auto answer = ask();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->data[2], 0x01);
}

TEST_F(DriveRemotePdo, type_252_answers_with_what_the_last_sync_found) {
  start(252);
  EXPECT_FALSE(ask()) << "there was no SYNC yet";
  b.drive.set_general_inputs(0x0001);
  b.run(2);
  b.send(0x080, {});
  b.run(2);
  b.drive.set_general_inputs(0x0002);
  b.run(2);
  const auto answer = ask();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->data[2], 0x01);
  EXPECT_EQ(b.count(0x185), 0);
}

TEST(DriveSync, a_message_of_the_wrong_length_is_told_by_emcy_8240_and_not_used) {
  DriveBench b;
  b.start_cyclic_position();
  b.seen.clear();
  b.send(0x080, {1});
  b.run(2);
  EXPECT_EQ(b.count(0x185), 0);
  const auto emcy = b.take(0x085);
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->data[0] | emcy->data[1] << 8, 0x8240);
  b.send(0x080, {});
  b.run(2);
  EXPECT_EQ(b.count(0x185), 1);
}

TEST(DriveSync, with_a_counter_the_message_has_one_byte_and_1800_06_names_the_first_one) {
  DriveBench b;
  b.start_cyclic_position();
  b.nmt(0x80);
  ASSERT_EQ(b.write(0x1019, 0, 4, 1), 0u);
  b.write(0x1800, 1, 0xC0000185, 4);
  b.write(0x1800, 2, 4, 1);
  ASSERT_EQ(b.write(0x1800, 6, 2, 1), 0u);
  b.write(0x1800, 1, 0x40000185, 4);
  b.nmt(0x01);
  b.seen.clear();
  std::string sent;
  for (int i = 0; i < 12; ++i) {
    b.send(0x080, {static_cast<std::uint8_t>(i % 4 + 1)});
    b.run(2);
    sent += b.take(0x185) ? '1' : '0';
  }
  EXPECT_EQ(sent, "010001000100");
}

TEST(DriveSync, an_rpdo_after_the_synchronous_window_is_dropped) {
  DriveBench b;
  b.start_cyclic_position();
  ASSERT_EQ(b.write(0x1007, 0, 3000, 4), 0u);
  b.send(0x080, {});
  b.run(1);
  b.send(0x205, {0x06, 0, 0x10, 0, 0, 0});
  b.run(5);
  b.send(0x080, {});
  b.run(5);
  EXPECT_EQ(b.read(0x607A), 0x10u) << "it came within the window";
  b.send(0x205, {0x06, 0, 0x20, 0, 0, 0});
  b.run(1);
  b.send(0x080, {});
  b.run(2);
  EXPECT_EQ(b.read(0x607A), 0x10u) << "this one came 5 ms after SYNC";
}

// ---- maps that nobody can change ----

SimulatedDriveConfig with_maps(canopen::MapAccess access) {
  SimulatedDriveConfig c;
  c.map_access = access;
  return c;
}

TEST(DrivePdoMap, a_fixed_one_refuses_every_write_as_read_only_and_can_be_read) {
  DriveBench b(with_maps(canopen::MapAccess::fixed));
  for (const std::uint16_t map : {0x1600, 0x1603, 0x1A00, 0x1A03})
    for (const auto& [sub, value, size] : {std::tuple{0, 0, 1}, {0, 1, 1}, {1, 0x60400010, 4}})
      EXPECT_EQ(b.write(map, static_cast<std::uint8_t>(sub), value, size), 0x06010002u) << std::hex << map;
  EXPECT_EQ(b.write(0x1400, 1, 0x80000205, 4), 0u) << "the COB-ID is another matter";
  EXPECT_EQ(b.write(0x1600, 0, 0, 1), 0x06010002u) << "nor while the PDO is invalid";
  EXPECT_EQ(b.write(0x1400, 2, 1, 1), 0u);
  EXPECT_EQ(b.read(0x1600), 1u);
  EXPECT_EQ(b.read(0x1600, 1), 0x60400010u);
}

TEST(DrivePdoMap, that_is_switched_as_a_whole_goes_off_and_on_while_its_pdo_is_invalid) {
  DriveBench b(with_maps(canopen::MapAccess::whole));
  EXPECT_EQ(b.write(0x1602, 1, 0x60400010, 4), 0x06010000u) << "its own entry, but :00 is not 0";
  EXPECT_EQ(b.write(0x1600, 0, 0, 1), 0x06010000u) << "RPDO1 is valid";
  EXPECT_EQ(b.write(0x1602, 0, 0, 1), 0u);
  EXPECT_EQ(b.write(0x1602, 1, 0x60400010, 4), 0u) << "its own entry";
  EXPECT_EQ(b.write(0x1602, 2, 0x60FF0020, 4), 0x06040041u) << "another one";
  EXPECT_EQ(b.write(0x1602, 3, 0x60FF0020, 4), 0x06040041u) << "one more";
  EXPECT_EQ(b.write(0x1602, 0, 1, 1), 0x06040041u) << "half of it";
  EXPECT_EQ(b.write(0x1602, 0, 2, 1), 0u);
  EXPECT_EQ(b.read(0x1602, 2), 0x607A0020u);
}

TEST(DrivePdoMap, of_a_device_is_there_from_power_on_and_nothing_else_is_mapped) {
  SimulatedDriveConfig c = with_maps(canopen::MapAccess::fixed);
  SimulatedDriveConfig::PdoMap map{true, 1, {}};
  map.mapping.add(canopen::MappingEntry::from_word(0x60410010));
  map.mapping.add(canopen::MappingEntry::from_word(0x60640020));
  c.maps = {map};
  DriveBench b(c);
  EXPECT_EQ(b.read(0x1A00), 2u);
  EXPECT_EQ(b.read(0x1A00, 2), 0x60640020u);
  EXPECT_EQ(b.read(0x1600), 0u);
  EXPECT_EQ(b.read(0x1A01, 1), 0u);
  b.nmt(0x01);
  b.run(5);
  ASSERT_GE(b.count(0x185), 1);
  EXPECT_EQ(b.take(0x185)->length, 6);
  b.nmt(0x82);
  b.run(20);
  EXPECT_EQ(b.read(0x1A00, 2), 0x60640020u) << "and after a reset";
}

}  // namespace
}  // namespace servogate::mock
