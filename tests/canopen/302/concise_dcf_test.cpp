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
}

TEST(ConciseDcf, an_entry_without_data_is_an_empty_string) {
  const std::vector<ConfigurationEntry> entries{{0x2100, 0, {}}, {0x1017, 0, {1, 0}}};
  const Bytes bytes{2, 0, 0, 0, 0x00, 0x21, 0, 0, 0, 0, 0, 0x17, 0x10, 0, 2, 0, 0, 0, 1, 0};
  EXPECT_EQ(write_concise_dcf(entries), bytes);
  EXPECT_EQ(parse_concise_dcf(bytes), entries);
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

/// A DCF with one object 2000h of this type and value.
EdsResult with_value(const char* type, const std::string& value, const char* more = "AccessType=rw\n") {
  return read_eds(std::string("[2000]\nParameterName=a\nObjectType=7\n") + more + "DataType=" + type +
                      "\nParameterValue=" + value + "\n",
                  "x.dcf");
}

TEST(Configuration, an_empty_value_is_the_empty_string_of_strings_and_none_of_others) {
  for (const char* type : {"9", "10", "11"}) {
    const EdsResult r = with_value(type, "");
    EXPECT_TRUE(r.findings.empty()) << type;
    EXPECT_EQ(configuration_of(r.eds, 5), (std::vector<ConfigurationEntry>{{0x2000, 0, {}}})) << type;
    EXPECT_TRUE(configuration_of(with_value(type, "", "AccessType=ro\n").eds, 5).empty());
    EXPECT_EQ(configuration_of(with_value(type, "", "AccessType=rw\nDefaultValue=4142\n").eds, 5).size(), 1u)
        << "another value than the default";
  }
  for (const char* type : {"1", "3", "7", "8", "12", "13", "15", "17", "27"}) {
    const EdsResult r = with_value(type, "");
    EXPECT_TRUE(r.findings.empty()) << type;
    EXPECT_TRUE(configuration_of(r.eds, 5).empty()) << type;
  }
}

TEST(Configuration, a_value_that_is_not_of_its_type_of_bytes_is_an_error_with_its_line) {
  const struct {
    const char *type, *value, *id;
  } rows[] = {{"10", "hello", "eds-not-bytes"},      {"10", "123", "eds-not-bytes"},
              {"11", "Ось", "eds-not-bytes"},        {"15", "firmware.bin", "eds-not-bytes"},
              {"12", "4711", "eds-not-six-bytes"},   {"13", "noon", "eds-not-bytes"},
              {"0x21", "5", "eds-no-bytes-of-type"}, {"12", "0011223344556", "eds-not-bytes"}};
  for (const auto& row : rows) {
    const EdsResult r = with_value(row.type, row.value);
    EXPECT_FALSE(r.ok()) << row.value;
    ASSERT_FALSE(r.findings.empty()) << row.value;
    const text::Finding& last = r.findings.back();
    EXPECT_EQ(last.severity, text::Severity::error) << row.value;
    EXPECT_EQ(last.entry->id, row.id) << row.value;
    EXPECT_EQ(last.line, 6) << row.value;
    for (const char* other : {"AccessType=ro\n", "AccessType=rw\nObjFlags=1\n"})
      EXPECT_TRUE(with_value(row.type, row.value, other).ok()) << "it is not written";
    EXPECT_TRUE(with_value(row.type, row.value,
                           (std::string("AccessType=rw\nDefaultValue=") + row.value + "\n").c_str())
                    .ok())
        << "nor is the default";
  }
}

TEST(Configuration, an_error_is_told_however_much_is_odd_before) {
  std::string text;
  for (int i = 0; i < 2000; ++i) text += "# odd\n";
  text += "[2000]\nParameterName=a\nObjectType=7\nDataType=10\nAccessType=rw\nParameterValue=hello\n";
  EXPECT_FALSE(read_eds(text, "x.dcf").ok());
}

}  // namespace
}  // namespace servogate::canopen
