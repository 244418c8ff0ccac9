// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/canopen/301/nmt.hpp"
#include "tests/canopen/scripted_bus.hpp"

namespace servogate::canopen {
namespace {

using testing::frame;
using testing::show;

TEST(CobId, follows_the_predefined_connection_set) {
  EXPECT_EQ(cob::emcy(5), 0x085u);
  EXPECT_EQ(cob::tpdo(1, 5), 0x185u);
  EXPECT_EQ(cob::rpdo(1, 5), 0x205u);
  EXPECT_EQ(cob::tpdo(4, 127), 0x4FFu);
  EXPECT_EQ(cob::rpdo(4, 127), 0x57Fu);
  EXPECT_EQ(cob::sdo_response(1), 0x581u);
  EXPECT_EQ(cob::sdo_request(1), 0x601u);
  EXPECT_EQ(cob::heartbeat(1), 0x701u);
}

TEST(CobId, classify_is_the_inverse_for_every_node_and_service) {
  for (int n = 1; n <= kMaxNode; ++n) {
    const auto node = static_cast<NodeId>(n);
    EXPECT_EQ(classify(cob::emcy(node)), (CobId{Service::emcy, node}));
    EXPECT_EQ(classify(cob::sdo_request(node)), (CobId{Service::sdo_request, node}));
    EXPECT_EQ(classify(cob::sdo_response(node)), (CobId{Service::sdo_response, node}));
    EXPECT_EQ(classify(cob::heartbeat(node)), (CobId{Service::heartbeat, node}));
    constexpr Service tpdo[] = {Service::tpdo1, Service::tpdo2, Service::tpdo3, Service::tpdo4};
    constexpr Service rpdo[] = {Service::rpdo1, Service::rpdo2, Service::rpdo3, Service::rpdo4};
    for (int i = 0; i < 4; ++i) {
      EXPECT_EQ(classify(cob::tpdo(i + 1, node)), (CobId{tpdo[i], node}));
      EXPECT_EQ(classify(cob::rpdo(i + 1, node)), (CobId{rpdo[i], node}));
    }
  }
}

TEST(CobId, broadcast_and_reserved_identifiers_belong_to_no_node) {
  EXPECT_EQ(classify(0x000).service, Service::nmt);
  EXPECT_EQ(classify(0x080).service, Service::sync);
  EXPECT_EQ(classify(0x100).service, Service::time);
  EXPECT_EQ(classify(0x7E4).service, Service::lss);
  EXPECT_EQ(classify(0x7E5).service, Service::lss);
  for (const std::uint32_t id :
       {0x001u, 0x07Fu, 0x101u, 0x180u, 0x200u, 0x580u, 0x600u, 0x681u, 0x700u, 0x780u, 0x7FFu})
    EXPECT_EQ(classify(id), (CobId{Service::other, 0})) << id;
  EXPECT_EQ(classify(0x181, true).service, Service::other) << "29-bit identifiers are not CANopen's set";
  EXPECT_EQ(classify(0x1181).service, Service::other);
}

TEST(Nmt, commands_have_two_bytes_and_the_identifier_zero) {
  EXPECT_EQ(show(nmt_frame(NmtCommand::start, 5)), "000 01 05");
  EXPECT_EQ(show(nmt_frame(NmtCommand::reset_communication, 0)), "000 82 00");
}

TEST(Nmt, a_command_is_read_back_and_anything_else_is_not) {
  for (const auto command : {NmtCommand::start, NmtCommand::stop, NmtCommand::enter_pre_operational,
                             NmtCommand::reset_node, NmtCommand::reset_communication}) {
    const auto request = parse_nmt(nmt_frame(command, 9));
    ASSERT_TRUE(request);
    EXPECT_EQ(request->command, command);
    EXPECT_EQ(request->node, 9);
  }
  EXPECT_FALSE(parse_nmt(frame(0, {0x01})));
  EXPECT_FALSE(parse_nmt(frame(0, {0x01, 5, 0})));
  EXPECT_FALSE(parse_nmt(frame(0, {0x03, 5})));
  EXPECT_FALSE(parse_nmt(frame(0x80, {0x01, 5})));
}

TEST(Heartbeat, has_the_state_in_one_byte_and_ignores_the_guarding_toggle) {
  EXPECT_EQ(show(heartbeat_frame(3, NmtState::operational)), "703 05");
  EXPECT_EQ(parse_heartbeat(frame(0x703, {0x85})), NmtState::operational);
  EXPECT_EQ(parse_heartbeat(frame(0x703, {0x00})), NmtState::boot_up);
  EXPECT_FALSE(parse_heartbeat(frame(0x703, {0x06})));
  EXPECT_FALSE(parse_heartbeat(frame(0x703, {})));
  EXPECT_FALSE(parse_heartbeat(frame(0x703, {5, 5})));
}

TEST(Emcy, has_code_register_and_five_bytes) {
  const Emcy emcy{0x8611, 0x21, {1, 2, 3, 4, 5}};
  EXPECT_EQ(show(emcy_frame(2, emcy)), "082 11 86 21 01 02 03 04 05");
  EXPECT_EQ(parse_emcy(emcy_frame(2, emcy)), emcy);
  EXPECT_FALSE(parse_emcy(frame(0x82, {0x11, 0x86, 0x21})));
}

TEST(EmcyHistory, keeps_the_newest_first_and_forgets_the_oldest) {
  EmcyHistory history;
  EXPECT_EQ(history.size(), 0u);
  for (std::uint16_t i = 1; i <= 20; ++i) history.add({i, 0, {}}, i * image::kSecond);
  EXPECT_EQ(history.count(), 20u);
  ASSERT_EQ(history.size(), EmcyHistory::kSize);
  for (std::size_t i = 0; i < history.size(); ++i) {
    EXPECT_EQ(history[i].emcy.error_code, 20 - i);
    EXPECT_EQ(history[i].t_ns, static_cast<image::Nanoseconds>(20 - i) * image::kSecond);
  }
}

TEST(ErrorCode, is_named_exactly_or_by_its_group) {
  EXPECT_EQ(error_code_text(0x8611).english, "following error");
  EXPECT_EQ(error_code_text(0x8619).english, "positioning") << "8610h is not in the table, 8600h is";
  EXPECT_EQ(error_code_text(0x8699).id, "emcy-8600");
  EXPECT_EQ(error_code_text(0x3211).id, "emcy-3210") << "DC link number 1";
  EXPECT_EQ(error_code_text(0x8F00).id, "emcy-8000");
  EXPECT_EQ(error_code_text(0xFF55).id, "emcy-FF00");
  EXPECT_EQ(error_code_text(0x0000).id, "emcy-0000");
  EXPECT_EQ(error_code_text(0x0042).id, "emcy-unknown");
  EXPECT_EQ(error_code_text(0xB001).id, "emcy-unknown");
}

TEST(ErrorCode, every_code_has_words_in_both_languages) {
  for (unsigned code = 0; code <= 0xFFFF; ++code) {
    const text::Entry& entry = error_code_text(static_cast<std::uint16_t>(code));
    ASSERT_FALSE(entry.english.empty()) << code;
    ASSERT_FALSE(entry.russian.empty()) << code;
  }
}

}  // namespace
}  // namespace servogate::canopen
