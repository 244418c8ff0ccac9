// SPDX-License-Identifier: Apache-2.0
// What is saved in a DCF is read back from it to the byte, whatever the value is.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/302/concise_dcf.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "tests/property_seed.hpp"

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes little_endian(std::uint64_t value, std::size_t size) {
  Bytes out(size);
  store_le(value, out);
  return out;
}
Bytes of(float value) { return little_endian(std::bit_cast<std::uint32_t>(value), 4); }
Bytes of(double value) { return little_endian(std::bit_cast<std::uint64_t>(value), 8); }
Bytes of(std::string_view text) { return {text.begin(), text.end()}; }

/// The value of 2000h as a whole DCF brings it back; nullopt: it was not saved.
std::optional<Bytes> through_a_file(const Bytes& value, std::uint16_t data_type) {
  const auto text = eds_value_text(value, data_type);
  if (!text) return std::nullopt;
  Eds dcf;
  EdsObject& object = dcf.objects[0x2000];
  object.entry.name = "value";
  object.entry.data_type = data_type;
  object.entry.access = EdsAccess::rw;
  object.entry.parameter_value = EdsValue{*text, std::nullopt};
  const auto entries = configuration_of(read_eds(write_dcf(dcf), "saved.dcf").eds, 5);
  if (entries.size() != 1) return Bytes{};
  return entries[0].data;
}

TEST(SavedValue, of_a_real_comes_back_with_all_its_digits) {
  for (const double x : {1e-20, 0.1, 1.0 / 3.0, 6.02214076e23, -0.0, std::numeric_limits<double>::min(),
                         std::numeric_limits<double>::max(), std::numeric_limits<double>::denorm_min()}) {
    EXPECT_EQ(through_a_file(of(x), 0x11), of(x)) << x;
    EXPECT_EQ(through_a_file(of(static_cast<float>(x)), 0x08), of(static_cast<float>(x))) << x;
  }
}

TEST(SavedValue, of_a_text_is_not_encoded_twice) {
  EXPECT_EQ(through_a_file(of("Привод оси X"), 0x09), of("Привод оси X"));
  EXPECT_EQ(through_a_file(of(std::string_view("X\0\0", 3)), 0x09), of("X"))
      << "zeros at the end are none of it";
}

TEST(SavedValue, that_a_line_cannot_hold_is_not_saved_as_another_one) {
  for (const std::string_view text : {" leading", "trailing ", "two\nlines", "\"quoted\"", "\xE9t\xE9"})
    EXPECT_EQ(through_a_file(of(text), 0x09), std::nullopt) << text;
  EXPECT_EQ(through_a_file({}, 0x0F), std::nullopt) << "DOMAIN: nothing said";
}

TEST(SavedValue, of_an_empty_string_is_empty) {
  for (const std::uint16_t type : {0x09, 0x0A, 0x0B}) EXPECT_EQ(through_a_file({}, type), Bytes{}) << type;
}

TEST(SavedValue, of_bytes_unicode_and_times_comes_back_as_bytes) {
  const Bytes bytes{0x41, 0x04, 0x00, 0xFF, 0x12, 0x34};
  for (const std::uint16_t type : {0x0A, 0x0B, 0x0C, 0x0D, 0x0F})
    EXPECT_EQ(through_a_file(bytes, type), bytes) << type;
}

TEST(SavedValue, of_any_type_comes_back_or_is_not_saved) {
  std::mt19937_64 random(test::property_seed());
  int saved = 0;
  for (int n = 0; n < 20'000; ++n) {
    const auto type = static_cast<std::uint16_t>(1 + random() % 0x1B);
    if (!eds_type_known(type)) continue;
    const int bits = eds_type_bits(type);
    Bytes value(bits > 0 ? static_cast<std::size_t>(std::max(1, bits / 8)) : random() % 20);
    for (auto& b : value) b = static_cast<std::uint8_t>(random());
    if (type == 0x01) value[0] &= 1;
    if (type == 0x09)
      for (auto& b : value) b = static_cast<std::uint8_t>(0x20 + random() % 0x60);
    // Of all that is no number there are millions of ways to write it.
    if (eds_type_real(type) && std::isnan(real_of(value))) continue;
    const auto back = through_a_file(value, type);
    if (!back) continue;
    ++saved;
    EXPECT_EQ(*back, value) << "type " << type << ": " << *eds_value_text(value, type);
  }
  EXPECT_GT(saved, 10'000);
}

}  // namespace
}  // namespace servogate::canopen
