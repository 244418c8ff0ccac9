// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/301/words/frame_words.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/text/finding.hpp"

namespace servogate::canopen {
namespace {

image::CanFrame frame(std::uint32_t id, std::vector<std::uint8_t> bytes = {}) {
  return make_frame(id, bytes);
}

std::string words(const image::CanFrame& f, text::Language language = text::Language::english) {
  return text::render({"", "{0}", "{0}"}, std::vector<std::string>{frame_words(f)}, language);
}

TEST(FrameWords, say_the_service_the_node_and_what_is_asked) {
  EXPECT_EQ(words(frame(0x080)), "SYNC (080h)");
  EXPECT_EQ(words(nmt_frame(NmtCommand::stop, 2)), "NMT command stop to node 2 (000h)");
  EXPECT_EQ(words(nmt_frame(NmtCommand::reset_communication, 0)),
            "NMT command reset communication to all nodes (000h)");
  EXPECT_EQ(words(frame(0x205, {6, 0})), "RPDO 1 of node 5 (205h)");
  EXPECT_EQ(words(frame(0x605, {0x40, 0x41, 0x60, 0, 0, 0, 0, 0})),
            "SDO request of node 5, read 6041h:00 (605h)");
  EXPECT_EQ(words(frame(0x605, {0x2B, 0x40, 0x60, 0, 6, 0, 0, 0})),
            "SDO request of node 5, write 6040h:00 (605h)");
  EXPECT_EQ(words(frame(0x605, {0xC2, 0x50, 0x1F, 1, 6, 0, 0, 0})),
            "SDO request of node 5, write 1F50h:01 (605h)");
  EXPECT_EQ(words(frame(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0})), "SDO request of node 5 (605h)") << "a segment";
  EXPECT_EQ(words(nmt_frame(NmtCommand::enter_pre_operational, 3), text::Language::russian),
            "команда NMT enter pre-operational узлу 3 (000h)");
}

TEST(FrameWords, know_what_they_can_where_the_frame_says_no_more) {
  EXPECT_EQ(words(frame(0x000)), "NMT command (000h)") << "only the identifier is known";
  EXPECT_EQ(words(frame(0x605)), "SDO request of node 5 (605h)");
  image::CanFrame other = frame(0x12345);
  other.extended = true;
  EXPECT_EQ(words(other), "(00012345h)");
  image::CanFrame guarding = frame(0x705);
  guarding.remote = true;
  EXPECT_EQ(words(guarding), "node guarding of node 5 (705h)");
}

TEST(FrameWords, tell_masters_from_devices) {
  for (const std::uint32_t id : {0x000u, 0x080u, 0x100u, 0x201u, 0x57Fu, 0x601u, 0x7E5u})
    EXPECT_TRUE(sent_by_masters(frame(id))) << id;
  for (const std::uint32_t id : {0x081u, 0x181u, 0x4FFu, 0x581u, 0x701u, 0x7E4u, 0x7FFu})
    EXPECT_FALSE(sent_by_masters(frame(id))) << id;
  image::CanFrame f = frame(0x705);
  f.remote = true;
  EXPECT_TRUE(sent_by_masters(f)) << "guarding";
  f.id = 0x185;
  EXPECT_FALSE(sent_by_masters(f)) << "a PDO that is asked for";
  f = frame(0x080);
  f.error = true;
  EXPECT_FALSE(sent_by_masters(f));
}

TEST(FrameWords, tell_who_leads_nodes_from_nodes_that_were_left_behind) {
  constexpr NodeId kMaster = 127;
  for (const std::uint32_t id : {0x000u, 0x080u, 0x201u, 0x57Fu, 0x77Fu})
    EXPECT_TRUE(leads_nodes(frame(id), kMaster)) << id;
  for (const std::uint32_t id : {0x081u, 0x181u, 0x4FFu, 0x581u, 0x701u, 0x100u, 0x7E5u})
    EXPECT_FALSE(leads_nodes(frame(id), kMaster)) << id;
  image::CanFrame guarding = frame(0x705);
  guarding.remote = true;
  EXPECT_TRUE(leads_nodes(guarding, kMaster));
  EXPECT_TRUE(leads_nodes(frame(0x605, {0x2B, 0x40, 0x60, 0, 6, 0, 0, 0}), kMaster)) << "a controlword";
  EXPECT_TRUE(leads_nodes(frame(0x605, {0x2B, 0x40, 0x68, 0, 6, 0, 0, 0}), kMaster)) << "of its second axis";
  EXPECT_FALSE(leads_nodes(frame(0x605, {0x40, 0x40, 0x60, 0, 0, 0, 0, 0}), kMaster)) << "somebody reads";
  image::CanFrame far = frame(0x77F);
  far.extended = true;
  EXPECT_FALSE(leads_nodes(far, kMaster));
}

}  // namespace
}  // namespace servogate::canopen
