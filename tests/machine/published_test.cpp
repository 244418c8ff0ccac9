// SPDX-License-Identifier: Apache-2.0
// The published schema and reference are made from the table of keys. SERVOGATE_UPDATE=1 writes them into
// docs/.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>

#include "machine/keys/reader.hpp"
#include "machine/keys/sections.hpp"
#include "machine/load.hpp"
#include "machine/published/published.hpp"
#include "tests/machine/files.hpp"

namespace servogate::machine {
namespace {

void published(const std::string& path, const std::string& text) {
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) test::write_text(test::source(path), text);
  EXPECT_TRUE(test::read_text(test::source(path)) == text)
      << path << " is not what the table of keys says: run this test with SERVOGATE_UPDATE=1";
}

TEST(PublishedFiles, schema_is_what_the_reader_reads) {
  published("docs/machine.schema.json", json_schema());
}
TEST(PublishedFiles, reference_is_what_the_reader_reads) {
  published("docs/machine-file.md", reference_markdown(text::Language::english));
  published("docs/ru/machine-file.md", reference_markdown(text::Language::russian));
}

/// Calls for every key of every nested section.
void each_key(const Section& section, const std::function<void(const Section&, const Key&)>& visit) {
  for (const Key& key : section.keys) {
    visit(section, key);
    if (key.child != nullptr) each_key(key.child(), visit);
  }
}

void both_files(const std::function<void(const Section&, const Key&)>& visit) {
  each_key(section_of<MachineConfig>(), visit);
  each_key(section_of<DeviceConfig>(), visit);
}

TEST(TableOfKeys, every_key_is_explained_in_both_languages) {
  int count = 0;
  both_files([&](const Section&, const Key& key) {
    ++count;
    EXPECT_GE(key.english.size(), 3u) << key.name;
    EXPECT_GE(key.russian.size(), 3u) << key.name;
    EXPECT_NE(key.english, key.russian) << key.name;
    for (const char c : key.english) EXPECT_LT(static_cast<unsigned char>(c), 0x80) << key.name;
  });
  EXPECT_GT(count, 150);
}

TEST(TableOfKeys, defaults_lie_inside_their_ranges) {
  both_files([](const Section& section, const Key& key) {
    if (key.rule.required) return;
    void* member = key.member(section.defaults());
    double value = 0.0;
    if (key.kind == KeyKind::number)
      value = *static_cast<double*>(member);
    else if (key.kind == KeyKind::integer)
      value = *static_cast<int*>(member);
    else if (key.kind == KeyKind::long_integer)
      value = static_cast<double>(*static_cast<std::int64_t*>(member));
    else
      return;
    if (!std::isfinite(value)) return;
    EXPECT_GE(value, key.rule.min) << key.name;
    EXPECT_LE(value, key.rule.max) << key.name;
    if (key.rule.above_min) {
      EXPECT_GT(value, key.rule.min) << key.name;
    }
  });
}

TEST(TableOfKeys, names_of_a_section_are_different) {
  both_files([](const Section& section, const Key& key) {
    int same = 0;
    for (const Key& other : section.keys) same += other.name == key.name ? 1 : 0;
    EXPECT_EQ(same, 1) << key.name;
  });
}

TEST(TableOfKeys, every_unit_reads_its_own_name) {
  for (int u = static_cast<int>(Unit::none) + 1; u <= static_cast<int>(Unit::bytes); ++u)
    for (const AxisUnits axis : {AxisUnits::linear, AxisUnits::rotary}) {
      const auto unit = static_cast<Unit>(u);
      const std::string name = unit_name(unit, axis);
      if (name.empty()) continue;  // mm of a tolerance has no rotary form
      const Quantity q = parse_quantity("2.5 " + name, unit, axis);
      EXPECT_EQ(q.error, QuantityError::none) << name;
      EXPECT_EQ(q.value, 2.5) << name;
      EXPECT_EQ(parse_quantity("2.5", unit, axis).error, QuantityError::no_unit) << name;
      EXPECT_EQ(parse_quantity("2.5 furlong", unit, axis).error, QuantityError::wrong_unit) << name;
      if (unit == Unit::per_s) continue;  // "1/s" begins with a number
      EXPECT_EQ(parse_quantity(name, unit, axis).error, QuantityError::not_a_number) << name;
    }
}

}  // namespace
}  // namespace servogate::machine
