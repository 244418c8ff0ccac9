// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/pdo_mapping.hpp"
#include "firmware_if/canopen/inspect/object_catalogue.hpp"
#include "firmware_if/image/can_bus.hpp"

namespace servogate::gateway::command {

/// An object that is recorded by PDO every cycle.
struct RecordedObject {
  canopen::MappingEntry entry;
  bool is_signed = false, is_real = false;
  std::string name;  ///< "606Ch:00 Velocity actual value"
};

/// The objects that words of the command line name (`bench record`, --record), which fit into TPDO 3 and 4.
/// nullopt: one is unknown, has no type, cannot be mapped, or they are too many, which has been said. Not
/// real-time safe.
std::optional<std::vector<RecordedObject>> recorded_objects(const std::vector<std::string>& words,
                                                            const canopen::ObjectCatalogue& catalogue);

/// Takes the recorded objects out of the frames that pass.
class ObjectRecorder {
 public:
  static constexpr int kFirstPdo = 2;  ///< TPDO 3, counted from 0

  ObjectRecorder(canopen::NodeId node, std::vector<RecordedObject> objects);

  /// Of TPDO 3 and 4; nothing mapped: not used.
  const canopen::PdoMapping& mapping(int pdo) const { return mappings_[static_cast<std::size_t>(pdo)]; }
  const std::vector<RecordedObject>& objects() const noexcept { return objects_; }
  void on_frame(const image::CanFrame& frame);
  /// Ends a cycle: what the objects are now becomes a row.
  void end_cycle();
  std::size_t rows() const noexcept { return objects_.empty() ? 0 : values_.size() / objects_.size(); }
  /// Values of one row, in the order of the objects; of an object that has not come yet a NaN.
  std::span<const double> row(std::size_t n) const {
    return std::span(values_).subspan(n * objects_.size(), objects_.size());
  }

 private:
  canopen::NodeId node_;
  std::vector<RecordedObject> objects_;
  std::array<canopen::PdoMapping, 2> mappings_;
  std::vector<double> now_, values_;
};

}  // namespace servogate::gateway::command
