// SPDX-License-Identifier: Apache-2.0
#include "report/decimal.hpp"
#include "tests/property_seed.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <random>
#include <string>

namespace servogate::report {
namespace {

std::string fixed(double v, int decimals = 12) {
  char buffer[kFixedMax];
  return {buffer, write_fixed(buffer, v, decimals)};
}

/// What printf makes of it, without the sign of a zero.
std::string by_printf(double v, int decimals = 12) {
  char buffer[400];
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, v);
  std::string out = buffer;
  if (out[0] == '-' && out.find_first_of("123456789") == std::string::npos) out.erase(0, 1);
  return out;
}

TEST(Decimal, writes_what_a_person_expects) {
  EXPECT_EQ(fixed(0.0), "0.000000000000");
  EXPECT_EQ(fixed(-0.0), "0.000000000000");
  EXPECT_EQ(fixed(-1e-15), "0.000000000000");
  EXPECT_EQ(fixed(1.0 / 3.0), "0.333333333333");
  EXPECT_EQ(fixed(-299.9999999999995), "-299.999999999999");
  EXPECT_EQ(fixed(0.5, 0), "0");
  EXPECT_EQ(fixed(1.5, 0), "2");
  EXPECT_EQ(fixed(999999.9999999999), "999999.999999999884");
  EXPECT_EQ(fixed(2.5e6, 3), "2500000.000");
  EXPECT_EQ(fixed(std::nan("")), "nan");
  EXPECT_EQ(fixed(-std::numeric_limits<double>::infinity()), "-inf");
}

TEST(Decimal, agrees_with_printf_on_every_random_double) {
  const std::uint64_t seed = servogate::test::property_seed();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> place(-400.0, 400.0), exponent(-15.0, 6.5);
  for (int i = 0; i < 400000; ++i) {
    const int decimals = static_cast<int>(random() % 13);
    double v = place(random);
    if (i % 4 == 1) v = std::pow(10.0, exponent(random)) * (random() % 2 ? 1 : -1);
    if (i % 4 == 2)
      v = static_cast<double>(static_cast<std::int64_t>(random() % 2'000'001) - 1'000'000) / 1024.0;  // ties
    if (i % 4 == 3) v = std::bit_cast<double>(random());
    if (!std::isfinite(v) || std::fabs(v) > 1e300) continue;
    ASSERT_EQ(fixed(v, decimals), by_printf(v, decimals)) << "decimals " << decimals;
  }
}

TEST(Decimal, agrees_with_printf_at_the_edges) {
  for (const double edge :
       {1e6, 1e-12, 5e-13, 0.5e-12, 1.0, 10.0, 99.9999999999995, std::numeric_limits<double>::min(),
        std::numeric_limits<double>::denorm_min(), 1e17, 1e22})
    for (const double v : {edge, std::nextafter(edge, 0.0), std::nextafter(edge, 1e300), -edge})
      for (int decimals = 0; decimals <= 12; ++decimals)
        ASSERT_EQ(fixed(v, decimals), by_printf(v, decimals));
}

TEST(Decimal, writes_integers_and_seconds) {
  const auto integer = [](std::int64_t v) {
    char buffer[24];
    return std::string(buffer, write_integer(buffer, v));
  };
  for (const std::int64_t v :
       {std::int64_t{0}, std::int64_t{7}, std::int64_t{10}, std::int64_t{99}, std::int64_t{100},
        std::int64_t{-12345}, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()})
    EXPECT_EQ(integer(v), std::to_string(v));
  const auto seconds = [](std::int64_t ns, bool fine) {
    char buffer[24];
    return std::string(buffer, write_seconds(buffer, ns, fine));
  };
  EXPECT_EQ(seconds(0, false), "0.000000");
  EXPECT_EQ(seconds(1'000'000, false), "0.001000");
  EXPECT_EQ(seconds(61'250'125'500, false), "61.250125");
  EXPECT_EQ(seconds(61'250'125'500, true), "61.250125500");
  EXPECT_EQ(seconds(-500'000'000, true), "-0.500000000");
}

TEST(Decimal, says_what_a_number_costs) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-400.0, 400.0);
  std::vector<double> values(1000);
  for (double& v : values) v = place(random);
  char buffer[kFixedMax];
  std::size_t bytes = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int round = 0; round < 1000; ++round)
    for (const double v : values) bytes += static_cast<std::size_t>(write_fixed(buffer, v, 12) - buffer);
  const double ns =
      std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() / 1e6;
  std::cout << "write_fixed: " << ns << " ns a number\n";
  EXPECT_GT(bytes, 12'000'000u);
}

}  // namespace
}  // namespace servogate::report
