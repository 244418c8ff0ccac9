// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_catalogue.hpp"

#include <gtest/gtest.h>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/inspect/value_meaning.hpp"

namespace servogate::canopen {
namespace {

int index_of(const ObjectCatalogue& catalogue, std::string_view word) {
  const auto at = catalogue.address(word);
  return at ? at->index : -1;
}

TEST(ObjectNames, of_the_standards_are_found_however_they_are_written) {
  const ObjectCatalogue catalogue;
  for (const char* word : {"statusword", "Statusword", "STATUS-WORD", "6041", "0x6041", "6041h"})
    EXPECT_EQ(index_of(catalogue, word), 0x6041) << word;
  EXPECT_EQ(index_of(catalogue, "position_actual_value"), 0x6064);
  EXPECT_EQ(index_of(catalogue, "position_actual"), 0x6064) << "not 6063h, whose name goes on otherwise";
  EXPECT_EQ(index_of(catalogue, "dc_link"), 0x6079) << "the beginning of one name alone";
  EXPECT_EQ(index_of(catalogue, "torque actual value"), 0x6077);
}

TEST(ObjectNames, all_of_them_lead_back_to_their_objects) {
  const ObjectCatalogue catalogue;
  for (const ObjectInfo& o : standard_objects()) EXPECT_EQ(index_of(catalogue, o.name), o.index) << o.name;
}

TEST(ObjectNames, take_a_sub_index_behind_a_colon) {
  const auto at = ObjectCatalogue().address("software_position_limit:2");
  ASSERT_TRUE(at);
  EXPECT_EQ(at->index, 0x607D);
  EXPECT_EQ(at->subindex, 2);
}

TEST(ObjectNames, that_are_none_or_several_are_refused_with_those_that_are_near) {
  const ObjectCatalogue catalogue;
  std::vector<std::string> similar;
  EXPECT_FALSE(catalogue.address("position", &similar));
  EXPECT_GE(similar.size(), 3u);
  similar.clear();
  EXPECT_FALSE(catalogue.address("flux capacitor", &similar));
  EXPECT_TRUE(similar.empty());
  EXPECT_FALSE(catalogue.address("", &similar));
  EXPECT_FALSE(catalogue.address("x:y:z", &similar));
}

TEST(ObjectNames, are_those_of_the_data_sheet_where_there_is_one) {
  Eds eds;
  eds.objects[0x2100].entry.name = "Gain";
  eds.objects[0x2101].entry.name = "Loops";
  eds.objects[0x2101].subs[2].name = "Integral time";
  const ObjectCatalogue catalogue(&eds);
  EXPECT_EQ(index_of(catalogue, "gain"), 0x2100);
  const auto sub = catalogue.address("loops: integral time");
  ASSERT_TRUE(sub);
  EXPECT_EQ(sub->index, 0x2101);
  EXPECT_EQ(sub->subindex, 2);
}

std::string meaning(std::uint16_t index, std::vector<std::uint8_t> bytes) {
  return meaning_of(index, 0, bytes, text::Language::english);
}

TEST(ObjectMeanings, say_states_modes_and_errors_in_words) {
  EXPECT_EQ(meaning(0x6041, {0x37, 0x02}), "Operation enabled");
  EXPECT_EQ(meaning(0x6841, {0x37, 0x02}), "Operation enabled") << "of the second axis";
  EXPECT_EQ(meaning(0x6061, {8}), "csp");
  EXPECT_EQ(meaning(0x6502, {0x81, 0, 0, 0}), "pp csp");
  EXPECT_EQ(meaning(0x1000, {0x92, 0x01, 0x02, 0x00}), "servo drive (CiA 402)");
  EXPECT_FALSE(meaning(0x603F, {0x10, 0x32}).empty());
  EXPECT_TRUE(meaning(0x603F, {0, 0}).empty()) << "no error";
  EXPECT_TRUE(meaning(0x6041, {0x37}).empty()) << "of another length it is another object";
  EXPECT_TRUE(meaning(0x6064, {1, 0, 0, 0}).empty());
}

}  // namespace
}  // namespace servogate::canopen
