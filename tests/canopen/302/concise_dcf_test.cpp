// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/302/concise_dcf.hpp"

#include <gtest/gtest.h>

#include <random>

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(ConciseDcf, is_a_count_and_then_index_subindex_size_and_data) {
  const std::vector<ConfigurationEntry> entries{{0x1017, 0, {0xE8, 0x03}}, {0x6065, 2, {1, 2, 3, 4}}};
  const Bytes bytes{2, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 0xE8, 0x03, 0x65, 0x60, 2, 4, 0, 0, 0, 1, 2, 3, 4};
  EXPECT_EQ(write_concise_dcf(entries), bytes);
  EXPECT_EQ(parse_concise_dcf(bytes), entries);
}

TEST(ConciseDcf, cut_off_or_with_an_impossible_size_is_none) {
  const Bytes bytes = write_concise_dcf(std::vector<ConfigurationEntry>{{0x1017, 0, {0xE8, 0x03}}});
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(parse_concise_dcf(std::span(bytes).first(n))) << n;
  Bytes wrong = bytes;
  wrong[10] = 0xFF;
  EXPECT_FALSE(parse_concise_dcf(wrong)) << "a size of 4 GB";
  wrong = bytes;
  wrong[7] = 0;
  EXPECT_FALSE(parse_concise_dcf(wrong)) << "an entry without data";
}

TEST(ConciseDcf, survives_any_bytes) {
  std::mt19937 random(302);
  for (int i = 0; i < 50'000; ++i) {
    Bytes bytes(random() % 40);
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random() % 4 ? random() % 3 : random());
    if (const auto entries = parse_concise_dcf(bytes)) {
      const Bytes again = write_concise_dcf(*entries);
      ASSERT_TRUE(std::equal(again.begin(), again.end(), bytes.begin()));
    }
  }
}

TEST(Configuration, of_a_dcf_is_what_differs_from_the_defaults_and_may_be_written) {
  const Eds dcf =
      read_eds(
          "[1017]\nParameterName=a\nObjectType=7\nDataType=6\nAccessType=rw\nDefaultValue=0\nParameterValue="
          "100\n"
          "[1018]\nParameterName=b\nObjectType=7\nDataType=7\nAccessType=ro\nParameterValue=5\n"
          "[1400]\nParameterName=c\nObjectType=7\nDataType=7\nAccessType=rw\nParameterValue=5\n"
          "[2000]\nParameterName=d\nObjectType=7\nDataType=4\nAccessType=rw\nDefaultValue=-1\nParameterValue="
          "0xFFFFFFFF\n"
          "[2001]\nParameterName=e\nObjectType=7\nDataType=7\nAccessType=rw\nParameterValue=$NODEID+0x80\n"
          "[2002]\nParameterName=f\nObjectType=7\nDataType=9\nAccessType=rw\nParameterValue=X axis\n"
          "[2003]\nParameterName=g\nObjectType=7\nDataType=5\nAccessType=rw\nObjFlags=1\nParameterValue=1\n",
          "x.dcf")
          .eds;
  EXPECT_EQ(
      configuration_of(dcf, 5),
      (std::vector<ConfigurationEntry>{
          {0x1017, 0, {100, 0}}, {0x2001, 0, {0x85, 0, 0, 0}}, {0x2002, 0, {'X', ' ', 'a', 'x', 'i', 's'}}}));
}

}  // namespace
}  // namespace servogate::canopen
