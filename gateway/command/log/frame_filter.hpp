// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "gateway/cli/bus_options.hpp"

namespace servogate::gateway::command {

/// Which frames of a log are played: by node, by sender, by identifier; what is not asked for passes.
/// Counts what it leaves out. Not real-time safe.
class FrameFilter {
 public:
  /// What `options` ask for. An identifier that is none is said, and false.
  bool set(const PlayOptions& options);

  /// Whether the frame is played. A node's frames are those of the pre-defined connection set with its
  /// node-ID and NMT commands to it alone; SYNC and TIME concern every node and pass. NMT commands to all
  /// nodes and layer setting reach others as well: with nodes asked for they stay out.
  /// Source: CiA 301, 7.3.5 "Pre-defined connection set".
  bool passes(const image::CanFrame& frame) const noexcept;

 private:
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  bool of_nodes(const image::CanFrame& frame) const noexcept;
  bool of_ids(std::uint32_t id) const noexcept;

  std::vector<canopen::NodeId> nodes_;
  std::vector<Range> ids_;
  std::string sender_;
};

/// Frames by identifier, for "181 (12), 701 (3)": at most eight of them, then how many more there are.
class FrameCount {
 public:
  void add(const image::CanFrame& frame);
  bool has(const image::CanFrame& frame) const;
  std::int64_t frames() const noexcept { return frames_; }
  /// In both languages (text::both); empty: none.
  std::string words() const;
  /// All of them, identifier as in words() to number.
  std::map<std::string, std::int64_t> counts() const;

 private:
  struct Id {
    bool extended = false;
    std::uint32_t id = 0;
    auto operator<=>(const Id&) const = default;
    std::string text() const;  ///< "181", "18FF0001"
  };
  std::map<Id, std::int64_t> by_id_;
  std::int64_t frames_ = 0;
};

}  // namespace servogate::gateway::command
