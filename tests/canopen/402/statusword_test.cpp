// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/402/statusword.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "firmware_if/canopen/402/controlword.hpp"
#include "firmware_if/canopen/402/mode.hpp"
#include "firmware_if/canopen/402/objects.hpp"

namespace servogate::canopen {
namespace {

using image::DriveState;

TEST(Statusword, is_decoded_by_the_masks_of_the_standard) {
  // Typical words of real drives, with voltage, remote and target bits set.
  EXPECT_EQ(decode_state(0x0250), DriveState::switch_on_disabled);
  EXPECT_EQ(decode_state(0x0231), DriveState::ready_to_switch_on);
  EXPECT_EQ(decode_state(0x0233), DriveState::switched_on);
  EXPECT_EQ(decode_state(0x1637), DriveState::operation_enabled);
  EXPECT_EQ(decode_state(0x0217), DriveState::quick_stop_active);
  EXPECT_EQ(decode_state(0x021F), DriveState::fault_reaction_active);
  EXPECT_EQ(decode_state(0x0218), DriveState::fault);
  EXPECT_EQ(decode_state(0x0238), DriveState::fault) << "the quick stop bit means nothing in Fault";
  EXPECT_EQ(decode_state(0x0000), DriveState::not_ready_to_switch_on);
}

TEST(Statusword, a_pattern_outside_the_table_is_no_state) {
  EXPECT_FALSE(decode_state(0x0001)) << "Ready to switch on has the quick stop bit";
  EXPECT_FALSE(decode_state(0x0022));
  EXPECT_FALSE(decode_state(0x0067));
}

TEST(Statusword, the_other_bits_never_change_the_state) {
  constexpr DriveState kStates[] = {DriveState::switch_on_disabled, DriveState::ready_to_switch_on,
                                    DriveState::switched_on,        DriveState::fault,
                                    DriveState::operation_enabled,  DriveState::fault_reaction_active,
                                    DriveState::quick_stop_active};
  constexpr unsigned kOthers = 0xFFFF & ~0x6Fu;
  for (const DriveState state : kStates)
    for (unsigned word = 0; word <= 0xFFFF; ++word)
      ASSERT_EQ(decode_state(static_cast<std::uint16_t>(encode_state(state) | (word & kOthers))), state);
}

TEST(Statusword, is_told_in_words) {
  EXPECT_EQ(describe_statusword(0x0237, text::Language::english), "Operation enabled");
  EXPECT_EQ(describe_statusword(0x0240, text::Language::english), "Switch on disabled; no main voltage");
  EXPECT_EQ(describe_statusword(0x0EB7, text::Language::english),
            "Operation enabled; warning, target reached, internal limit active");
  EXPECT_EQ(describe_statusword(0x0018, text::Language::russian),
            "Неисправность; не под управлением по шине");
  EXPECT_EQ(describe_statusword(0x0211, text::Language::english), "undefined state 0211h");
}

TEST(Controlword, commands_decode_to_themselves) {
  using namespace controlword;
  EXPECT_EQ(decode_command(kCommandShutdown), ControlCommand::shutdown);
  EXPECT_EQ(decode_command(kCommandSwitchOn), ControlCommand::switch_on);
  EXPECT_EQ(decode_command(kCommandEnableOperation), ControlCommand::enable_operation);
  EXPECT_EQ(decode_command(kCommandQuickStop), ControlCommand::quick_stop);
  EXPECT_EQ(decode_command(kCommandDisableVoltage), ControlCommand::disable_voltage);
  EXPECT_EQ(decode_command(kCommandEnableOperation & ~kEnableVoltage), ControlCommand::disable_voltage);
  EXPECT_EQ(decode_command(kCommandEnableOperation & ~kQuickStop), ControlCommand::quick_stop);
}

TEST(OperationMode, has_its_bit_in_the_supported_modes) {
  EXPECT_EQ(supported_bit(OperationMode::profile_position), 0x01u);
  EXPECT_EQ(supported_bit(OperationMode::homing), 0x20u);
  EXPECT_EQ(supported_bit(OperationMode::cyclic_sync_position), 0x80u);
  EXPECT_EQ(supported_bit(OperationMode::none), 0u);
  EXPECT_STREQ(short_name(OperationMode::cyclic_sync_velocity), "csv");
  EXPECT_STREQ(short_name(static_cast<OperationMode>(-1)), "manufacturer");
}

TEST(StandardObjects, are_in_order_and_found_by_index) {
  const auto objects = standard_objects();
  ASSERT_TRUE(std::ranges::is_sorted(objects, {}, &ObjectInfo::index));
  for (const ObjectInfo& info : objects) {
    EXPECT_EQ(find_object(info.index), &info);
    EXPECT_FALSE(info.name.empty());
  }
  EXPECT_EQ(object_name(0x6064), "Position actual value");
  EXPECT_EQ(object_name(0x1402), "RPDO communication parameter");
  EXPECT_EQ(object_name(0x1A03), "TPDO mapping parameter");
  EXPECT_EQ(object_name(0x2000), "");
  EXPECT_EQ(find_object(0xFFFF), nullptr);
}

}  // namespace
}  // namespace servogate::canopen
