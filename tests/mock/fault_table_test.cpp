// SPDX-License-Identifier: Apache-2.0
// The table of faults and the page that is made from it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "firmware_if/fault/fault.hpp"
#include "tests/places/places.hpp"

namespace servogate::fault {
namespace {

constexpr std::pair<Device, const char*> kDevices[] = {{Device::drive, "drive"},
                                                       {Device::encoder, "encoder"},
                                                       {Device::station, "Modbus station"},
                                                       {Device::chip, "GPIO chip"},
                                                       {Device::input, "input"},
                                                       {Device::bus, "bus"},
                                                       {Device::node, "node"},
                                                       {Device::module, "I/O module"},
                                                       {Device::control, "control"},
                                                       {Device::pendant, "pendant"},
                                                       {Device::button, "button of a pendant"}};

void append(std::string& list, const std::string& word) { list += (list.empty() ? "" : ", ") + word; }

std::string page() {
  std::string out =
      "# Faults\n\nMade from the table of faults (`firmware_if/fault/fault.cpp`); do not edit. The drives of "
      "`servogate "
      "drive` and\n`servogate sim` take those of drives, `sim` all of them with `device=NAME`: "
      "[drive-simulator.md](drive-simulator.md).\n\n| fault | of | parameters | what happens "
      "|\n|---|---|---|---|\n";
  for (const KindRow& row : kinds()) {
    std::string devices, taken;
    for (const auto& [device, name] : kDevices)
      if (row.happens_to(device)) append(devices, name);
    for (const ParameterRow& p : parameters())
      if (row.takes(p.parameter)) append(taken, "`" + std::string(p.name) + "`");
    out += "| `" + std::string(row.name) + "` | " + devices + " | " + taken + " | " +
           std::string(row.meaning) + " |\n";
  }
  out +=
      "\nA fault that takes `for` lasts until its time is over or it is cleared; the others happen once.\n\n"
      "| parameter | value |\n|---|---|\n";
  for (const ParameterRow& p : parameters())
    out += "| `" + std::string(p.name) + "` | " + std::string(p.unit) + " |\n";
  return out;
}

TEST(FaultTable, the_page_of_the_faults_is_the_table) {
  const std::string path = tests::source_dir() + "/docs/faults.md";
  if (std::getenv("SERVOGATE_UPDATE") != nullptr) std::ofstream(path, std::ios::binary) << page();
  std::ifstream file(path, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), page())
      << "SERVOGATE_UPDATE=1 writes docs/faults.md anew";
}

TEST(FaultTable, a_parameter_is_read_with_its_unit_and_refused_out_of_range) {
  Fault f;
  const auto set = [&](const char* name, const char* value) { return find_parameter(name)->set(value, f); };
  EXPECT_TRUE(set("for", "20 ms"));
  EXPECT_EQ(f.duration_ns, 20 * image::kMillisecond);
  EXPECT_TRUE(set("delay", "1.5"));
  EXPECT_EQ(f.delay_ns, 1500 * image::kMillisecond);
  EXPECT_TRUE(set("id", "0x181"));
  EXPECT_NE(f.mask, 0u) << "an identifier alone means that one";
  EXPECT_TRUE(set("state", "quick_stop_active"));
  EXPECT_EQ(f.state, image::DriveState::quick_stop_active);
  for (const auto& [name, value] : {std::pair{"for", "-1"},
                                    {"number", "5"},
                                    {"sender", "128"},
                                    {"exception", "0"},
                                    {"level", "2"},
                                    {"state", "asleep"},
                                    {"count", "x"},
                                    {"every", "0"}})
    EXPECT_FALSE(set(name, value)) << name;
}

}  // namespace
}  // namespace servogate::fault
