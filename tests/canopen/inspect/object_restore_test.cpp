// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/inspect/object_restore.hpp"

#include <gtest/gtest.h>

#include <map>

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// A device that takes PDO maps as CiA 301 says: an entry only while the map is empty, the map only while the
/// PDO is not valid.
class Device final : public SdoAccess {
 public:
  std::map<std::uint32_t, Bytes> objects;
  std::vector<std::uint32_t> order;
  std::uint32_t refuses = 0;
  bool dead = false;

  static std::uint32_t place(std::uint16_t index, std::uint8_t subindex) {
    return std::uint32_t{index} << 8 | subindex;
  }
  SdoOutcome read(NodeId, std::uint16_t index, std::uint8_t subindex) override {
    const auto found = objects.find(place(index, subindex));
    if (found == objects.end()) return {SdoStatus::aborted, AbortCode::object_does_not_exist, {}};
    return {SdoStatus::done, AbortCode::none, found->second};
  }
  SdoOutcome write(NodeId, std::uint16_t index, std::uint8_t subindex,
                   std::span<const std::uint8_t> data) override {
    if (dead) return {};
    order.push_back(place(index, subindex));
    const bool map = index == 0x1A00;
    const bool valid = (objects[0x1800'01][3] & 0x80) == 0;
    const bool mapped = map && subindex != 0 && objects[0x1A00'00][0] != 0;
    if (place(index, subindex) == refuses || (map && (valid || mapped)))
      return {SdoStatus::aborted, AbortCode::unsupported_access, {}};
    objects[place(index, subindex)].assign(data.begin(), data.end());
    return {SdoStatus::done, AbortCode::none, {}};
  }
};

constexpr auto kNever = [] { return false; };

Device device() {
  Device d;
  d.objects[0x1018'00] = {4};
  d.objects[0x1800'00] = {2};
  d.objects[0x1800'01] = {0x85, 0x01, 0, 0x40};
  d.objects[0x1800'02] = {1};
  d.objects[0x1A00'00] = {2};
  d.objects[0x1A00'01] = {0x10, 0, 0x41, 0x60};
  d.objects[0x1A00'02] = {0x20, 0, 0x64, 0x60};
  d.objects[0x6083'00] = {0x10, 0x27, 0, 0};
  d.objects[0x6084'00] = {0x10, 0x27, 0, 0};
  return d;
}

Eds saved(Device& d) {
  std::vector<std::string> not_saved;
  return saved_configuration(
      walk(d, 5, {{0x1018, 0x1018}, {0x1800, 0x1800}, {0x1A00, 0x1A00}, {0x6083, 0x6084}}, kNever), nullptr,
      5, 500'000, not_saved);
}

std::vector<Difference> differing(Device& d, const Eds& file) {
  int compared = 0;
  return differences(d, 5, file, compared, kNever);
}

TEST(ObjectRestore, writes_back_what_was_changed_and_nothing_else) {
  Device d = device();
  const Eds file = saved(d);
  d.objects[0x6083'00] = {1, 0, 0, 0};
  std::vector<FailedWrite> failed;
  EXPECT_EQ(restore(d, 5, file, differing(d, file), failed, kNever), 1);
  EXPECT_TRUE(failed.empty());
  EXPECT_EQ(d.order, std::vector<std::uint32_t>{0x6083'00});
  EXPECT_TRUE(differing(d, file).empty());
}

TEST(ObjectRestore, maps_a_pdo_in_the_order_that_a_device_takes) {
  Device d = device();
  const Eds file = saved(d);
  d.objects[0x1A00'00] = {1};
  d.objects[0x1A00'01] = {0x20, 0, 0x6C, 0x60};
  std::vector<FailedWrite> failed;
  restore(d, 5, file, differing(d, file), failed, kNever);
  EXPECT_TRUE(failed.empty()) << "an entry was written into a map in use";
  EXPECT_TRUE(differing(d, file).empty());
  EXPECT_EQ(d.order.front(), 0x1800'01u) << "not valid first";
  EXPECT_EQ(d.order.back(), 0x1800'01u) << "valid at the end";
}

TEST(ObjectRestore, goes_on_behind_a_parameter_that_is_refused) {
  Device d = device();
  const Eds file = saved(d);
  d.objects[0x6083'00] = d.objects[0x6084'00] = {1, 0, 0, 0};
  d.refuses = 0x6083'00;
  std::vector<FailedWrite> failed;
  EXPECT_EQ(restore(d, 5, file, differing(d, file), failed, kNever), 1);
  ASSERT_EQ(failed.size(), 1u);
  EXPECT_EQ(failed[0].index, 0x6083);
  EXPECT_EQ(differing(d, file).size(), 1u);
}

TEST(ObjectRestore, ends_at_a_device_that_does_not_answer) {
  Device d = device();
  const Eds file = saved(d);
  d.objects[0x6083'00] = d.objects[0x6084'00] = {1, 0, 0, 0};
  const auto before = differing(d, file);
  d.dead = true;
  std::vector<FailedWrite> failed;
  EXPECT_EQ(restore(d, 5, file, before, failed, kNever), 0);
  EXPECT_EQ(failed.size(), 1u) << "it is not asked again for each parameter";
}

}  // namespace
}  // namespace servogate::canopen
