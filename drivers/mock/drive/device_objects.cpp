// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/drive/device_objects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "drivers/mock/drive/servo_loops.hpp"
#include "firmware_if/canopen/305/lss_frame.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/drive/drive_objects.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"
#include "firmware_if/canopen/device/node/program_store.hpp"

namespace servogate::mock {
namespace {

using canopen::ObjectSpec;
namespace object = canopen::object;

constexpr std::uint16_t kFirstApplication = 0x2000;

canopen::DriveRatings ratings_of(const SimulatedDriveConfig& c) {
  canopen::DriveRatings r;
  r.quirks = c.quirks;
  r.counts_per_rev = static_cast<std::uint32_t>(c.plant.counts_per_rev);
  r.rated_torque_mnm = static_cast<std::uint32_t>(std::lround(c.plant.rated_torque_nm * 1000.0));
  r.peak_torque_permille =
      static_cast<std::uint16_t>(std::lround(c.plant.peak_torque_nm / c.plant.rated_torque_nm * 1000.0));
  r.max_speed_rpm =
      static_cast<std::uint32_t>(std::lround(c.plant.max_speed_rad_s * 60.0 / (2.0 * std::numbers::pi)));
  return r;
}

canopen::NodeId node_of(const SimulatedDriveConfig& c) {
  return c.node_id == canopen::kUnconfiguredNode ? canopen::NodeId{0} : c.node_id;
}

std::vector<ObjectSpec> tuning_rows(const PlantConfig& c) {
  using enum canopen::DataType;
  constexpr auto kNo = canopen::Mappable::no;
  constexpr auto kRw = canopen::Access::rw, kConstant = canopen::Access::constant;
  const auto in = [](double value, double unit) { return std::llround(value / unit); };
  return {{tuning_object::kVelocityLoop, 0, unsigned8, kConstant, kNo, 4},
          {tuning_object::kVelocityLoop, 1, unsigned32, kRw, kNo, in(velocity_gain_of(c), 1e-6)},
          {tuning_object::kVelocityLoop, 2, unsigned32, kRw, kNo, in(c.velocity_integral, 1e-3)},
          {tuning_object::kVelocityLoop, 3, unsigned32, kRw, kNo, 0},
          {tuning_object::kVelocityLoop, 4, unsigned32, kRw, kNo, 1000},
          {tuning_object::kPositionLoop, 0, unsigned8, kConstant, kNo, 1},
          {tuning_object::kPositionLoop, 1, unsigned32, kRw, kNo, in(c.position_gain, 1e-3)}};
}

std::vector<ObjectSpec> own_rows(const SimulatedDriveConfig& c) {
  const canopen::DeviceIdentity identity{c.device_type, c.vendor_id,     c.product_code,
                                         c.revision,    c.serial_number, c.name};
  std::vector<ObjectSpec> rows = canopen::communication_objects(node_of(c), identity);
  const auto drive = canopen::drive_objects(ratings_of(c));
  rows.insert(rows.end(), drive.begin(), drive.end());
  const auto tuning = tuning_rows(c.plant);
  rows.insert(rows.end(), tuning.begin(), tuning.end());
  if (c.program_memory > 0) {
    const auto program = canopen::program_objects(c.program_identification);
    rows.insert(rows.end(), program.begin(), program.end());
  }
  for (ObjectSpec& row : rows) {
    if (row.index == object::kSupportedDriveModes && c.modes != 0) row.value = c.modes;
  }
  return rows;
}

using Place = std::pair<std::uint16_t, std::uint8_t>;
Place place_of(const ObjectSpec& s) { return {s.index, s.subindex}; }

/// The simulation's services work on tables of their own size; beyond them there is nothing to serve an
/// object.
bool can_have(const ObjectSpec& row, const std::vector<ObjectSpec>& own) {
  if (row.index >= kFirstApplication) return true;
  const auto same = [&](const ObjectSpec& s) { return s.index == row.index; };
  if (std::any_of(own.begin(), own.end(), same))
    return std::any_of(own.begin(), own.end(),
                       [&](const ObjectSpec& s) { return place_of(s) == place_of(row); });
  const bool served = row.index >= 0x1200 && row.index < 0x1C00;
  return !served && (row.index < 0x1F50 || row.index > 0x1F57);
}

bool says_value(const canopen::Eds& sheet, const ObjectSpec& row) {
  const canopen::EdsEntry* entry = sheet.find(row.index, row.subindex);
  return entry != nullptr && entry->value() != nullptr &&
         (entry->value()->number.has_value() || canopen::size_of(row.type) == 0 ||
          !entry->value()->octets.empty());
}

std::vector<ObjectPlace> all_but(const canopen::Eds& sheet, const std::set<Place>& shown) {
  std::vector<ObjectPlace> places;
  const auto look = [&](std::uint16_t index, std::uint8_t subindex) {
    if (!shown.contains({index, subindex})) places.push_back({index, subindex});
  };
  for (const auto& [index, whole] : sheet.objects) {
    if (whole.subs.empty()) look(index, 0);
    for (const auto& [subindex, entry] : whole.subs) look(index, subindex);
  }
  return places;
}

bool is_map(const ObjectSpec& row) {
  return (row.index >= object::kRpdoMapping && row.index < object::kRpdoMapping + canopen::kPdos) ||
         (row.index >= object::kTpdoMapping && row.index < object::kTpdoMapping + canopen::kPdos);
}

/// Maps that come with the device, because nobody can write them.
void put_maps(const SimulatedDriveConfig& config, std::vector<ObjectSpec>& rows) {
  if (config.map_access == canopen::MapAccess::variable || config.maps.empty()) return;
  for (ObjectSpec& row : rows) {
    if (!is_map(row)) continue;
    row.value = 0;
    for (const SimulatedDriveConfig::PdoMap& map : config.maps) {
      const std::uint16_t first = map.transmit ? object::kTpdoMapping : object::kRpdoMapping;
      if (row.index != first + map.number - 1 || row.subindex > map.mapping.count) continue;
      row.value = row.subindex == 0 ? map.mapping.count : map.mapping.entries[row.subindex - 1u].word();
    }
  }
}

}  // namespace

DeviceObjects device_objects(const SimulatedDriveConfig& config) {
  DeviceObjects out;
  const std::vector<ObjectSpec> own = own_rows(config);
  out.rows = own;
  if (config.data_sheet == nullptr) {
    put_maps(config, out.rows);
    return out;
  }
  const canopen::Eds& sheet = *config.data_sheet;
  std::set<Place> shown;
  for (ObjectSpec row : canopen::object_specs(sheet, node_of(config))) {
    if (!can_have(row, own)) continue;
    shown.insert(place_of(row));
    const auto mine = std::find_if(own.begin(), own.end(),
                                   [&](const ObjectSpec& s) { return place_of(s) == place_of(row); });
    if (mine != own.end()) {
      const bool count = row.subindex == 0 && row.index < kFirstApplication;
      if (!says_value(sheet, row)) {
        row.value = mine->value;
        row.text = mine->text;
      } else if (count && mine->value > 0 && mine->access == canopen::Access::constant) {
        row.value = std::min(row.value, mine->value);
      }
    }
    out.rows.push_back(row);
  }
  for (const ObjectSpec& row : own)
    if (shown.count(place_of(row)) == 0) out.hidden.push_back(row);
  put_maps(config, out.rows);
  out.left_out = all_but(sheet, shown);
  return out;
}

}  // namespace servogate::mock
