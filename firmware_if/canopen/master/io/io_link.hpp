// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "firmware_if/canopen/302/io_station.hpp"
#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/master/pdo/node_link.hpp"
#include "firmware_if/image/points/point_stage.hpp"

namespace servogate::canopen {

/// Carries the points of a station between packet A and the PDOs of its node. All but the constructor is
/// real-time safe.
class IoLink final : public NodeLink {
 public:
  IoLink(const NodeConfig& node, const SegmentConfig& segment);

  ProcessData& process_data() noexcept override { return data_; }
  void restart() noexcept override;
  bool update() noexcept override;
  PdoWatch::Overdue overdue() const noexcept override { return watch_.overdue(); }

  /// Inputs into packet A, and the health of their source. While the node is not online they have what is
  /// declared for its loss.
  void fill(image::ProcessImage& image, bool online) noexcept;
  /// Outputs out of packet A. While the node is not online, and may hear all the same, they go to what is
  /// declared for its loss.
  void apply(const image::Packets& packets, bool online) noexcept;

 private:
  PdoWatch watch_;
  ProcessData data_;
  image::PointStage stage_;
  std::vector<PdoField> fields_;  ///< of each point of the stage
};

}  // namespace servogate::canopen
