// SPDX-License-Identifier: Apache-2.0
// A device of memory alone: what is saved of it and compared with it.
#include "firmware_if/canopen/inspect/object_walk.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/inspect/moving_objects.hpp"
#include "tests/property_seed.hpp"

namespace servogate::canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Objects without sub-indices, and what was never asked.
class Memory final : public SdoAccess {
 public:
  std::map<std::uint16_t, Bytes> objects;

  SdoOutcome read(NodeId, std::uint16_t index, std::uint8_t subindex) override {
    const auto found = objects.find(index);
    if (found == objects.end()) return {SdoStatus::aborted, AbortCode::object_does_not_exist, {}};
    if (subindex != 0) return {SdoStatus::aborted, AbortCode::subindex_does_not_exist, {}};
    return {SdoStatus::done, AbortCode::none, found->second};
  }
  SdoOutcome write(NodeId, std::uint16_t, std::uint8_t, std::span<const std::uint8_t>) override {
    ADD_FAILURE() << "nothing is written to a device that is looked at";
    return {};
  }
};

constexpr auto kNever = [] { return false; };

/// A data sheet with these objects.
Eds sheet_of(const std::map<std::uint16_t, std::uint16_t>& types) {
  Eds eds;
  for (const auto& [index, type] : types) {
    EdsEntry& e = eds.objects[index].entry;
    e.name = "own";
    e.data_type = type;
    e.access = EdsAccess::rw;
  }
  return eds;
}

Bytes random_value(std::uint16_t type, std::mt19937_64& random) {
  const int bits = eds_type_bits(type);
  for (;;) {
    Bytes value(bits > 0 ? static_cast<std::size_t>(std::max(1, bits / 8)) : 1 + random() % 40);
    for (auto& b : value) b = static_cast<std::uint8_t>(random());
    if (type == 0x01) value[0] &= 1;
    if (type == 0x09)
      for (auto& b : value) b = static_cast<std::uint8_t>(0x20 + random() % 0x5F);
    if (!eds_type_real(type) || !std::isnan(real_of(value))) return value;
  }
}

/// A device whose objects have sub-indices.
class Records final : public SdoAccess {
 public:
  std::map<std::uint32_t, Bytes> objects;  ///< by index << 8 | subindex

  SdoOutcome read(NodeId, std::uint16_t index, std::uint8_t subindex) override {
    const auto found = objects.find(std::uint32_t{index} << 8 | subindex);
    if (found != objects.end()) return {SdoStatus::done, AbortCode::none, found->second};
    const bool there = objects.contains(std::uint32_t{index} << 8);
    return {SdoStatus::aborted,
            there ? AbortCode::subindex_does_not_exist : AbortCode::object_does_not_exist,
            {}};
  }
  SdoOutcome write(NodeId, std::uint16_t, std::uint8_t, std::span<const std::uint8_t>) override { return {}; }
};

TEST(ObjectWalk, saves_mapping_entries_that_are_not_in_use_for_whoever_maps_anew) {
  Records device;
  device.objects[0x1A00'00] = {1};
  for (std::uint32_t sub = 1; sub <= 8; ++sub)
    device.objects[0x1A00'00 | sub] = sub == 1 ? Bytes{0x10, 0, 0x41, 0x60} : Bytes(4);
  std::vector<std::string> not_saved;
  const Eds saved =
      saved_configuration(walk(device, 5, {{0x1A00, 0x1A00}}, kNever), nullptr, 5, 500'000, not_saved);
  const Eds read_back = read_eds(write_dcf(saved), "saved.dcf").eds;
  ASSERT_TRUE(read_back.objects.contains(0x1A00));
  EXPECT_EQ(read_back.objects.at(0x1A00).subs.size(), 9u);
  EXPECT_NE(read_back.find(0x1A00, 8), nullptr);
}

TEST(ObjectWalk, saves_an_error_history_as_the_array_that_it_is_even_an_empty_one) {
  Records device;
  device.objects[0x1003'00] = {0};
  std::vector<std::string> not_saved;
  const Eds saved =
      saved_configuration(walk(device, 5, {{0x1003, 0x1003}}, kNever), nullptr, 5, 500'000, not_saved);
  EXPECT_EQ(saved.objects.at(0x1003).entry.type, EdsObjectType::array);
  EXPECT_EQ(read_eds(write_dcf(saved), "saved.dcf").eds.objects.at(0x1003).entry.type, EdsObjectType::array);
  EXPECT_NE(saved.find(0x1003, 0), nullptr);
}

TEST(ObjectWalk, finds_no_difference_to_what_it_saved_whatever_the_objects_hold) {
  std::mt19937_64 random(test::property_seed());
  int compared_ever = 0;
  for (int round = 0; round < 300; ++round) {
    Memory device;
    std::map<std::uint16_t, std::uint16_t> types;
    for (std::uint16_t index = 0x2000; index < 0x2020; ++index) {
      std::uint16_t type = 0;
      do type = static_cast<std::uint16_t>(1 + random() % 0x1B);
      while (!eds_type_known(type) || type == 0x0F);  // domains are not read
      types[index] = type;
      device.objects[index] = random_value(type, random);
    }
    const Eds sheet = sheet_of(types);
    std::vector<std::string> not_saved;
    const Eds saved =
        saved_configuration(read_listed(device, 5, sheet, kNever), &sheet, 5, 500'000, not_saved);
    const Eds read_back = read_eds(write_dcf(saved), "saved.dcf").eds;
    int compared = 0;
    for (const Difference& d : differences(device, 5, read_back, compared, kNever))
      ADD_FAILURE() << address_text(d.index, d.subindex) << " of type " << types[d.index] << ": "
                    << hex_text(d.outcome.data) << " saved as " << d.wanted;
    EXPECT_EQ(compared + static_cast<int>(not_saved.size()), 32) << "each is compared, or named";
    compared_ever += compared;
  }
  EXPECT_GT(compared_ever, 9000);
}

TEST(ObjectWalk, tells_a_value_that_was_changed_since) {
  Memory device;
  device.objects[0x2000] = {1, 2, 3, 4};
  const Eds sheet = sheet_of({{0x2000, 0x07}});
  std::vector<std::string> not_saved;
  const Eds saved = saved_configuration(read_listed(device, 5, sheet, kNever), &sheet, 5, 500'000, not_saved);
  device.objects[0x2000] = {1, 2, 3, 5};
  int compared = 0;
  const auto found = differences(device, 5, saved, compared, kNever);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].wanted, "67305985 (04030201h)");
}

TEST(MovingObjects, are_the_set_points_of_every_axis_and_outputs_and_a_quick_stop_is_none) {
  for (const int index : {0x6040, 0x6840, 0x60FF, 0x607A, 0x60FE, 0x6200, 0x6411, 0x1F82})
    EXPECT_TRUE(can_move(static_cast<std::uint16_t>(index))) << index;
  for (const int index : {0x1017, 0x6041, 0x6083, 0x2040})
    EXPECT_FALSE(can_move(static_cast<std::uint16_t>(index))) << index;
  EXPECT_TRUE(takes_energy_away(0x6040, 0, Bytes{0x02, 0x00}));
  EXPECT_TRUE(takes_energy_away(0x6840, 0, Bytes{0x00, 0x00}));
  EXPECT_FALSE(takes_energy_away(0x6040, 0, Bytes{0x0F, 0x00}));
  EXPECT_FALSE(takes_energy_away(0x6040, 0, Bytes{0x80, 0x00})) << "the reset of a fault";
}

}  // namespace
}  // namespace servogate::canopen
