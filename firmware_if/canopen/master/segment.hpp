// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/master/events/bus_event.hpp"
#include "firmware_if/canopen/master/object_question.hpp"
#include "firmware_if/image/can_bus.hpp"
#include "firmware_if/image/process_image.hpp"

namespace servogate::canopen {

/// What is known of a node, for pages and reports.
struct NodeStatus {
  NodeId node = 0;
  bool online = false;
  BootReport boot;  ///< step `done` once it runs
  std::uint32_t device_type = 0;
  std::uint32_t vendor_id = 0, product_code = 0, revision = 0, serial = 0;
  std::uint32_t emcy_count = 0;
};

/// CANopen master of one CAN bus with its drives (CiA 402), I/O modules (CiA 401) and encoders (CiA 406), for
/// a device of the cycle to carry.
///
/// SYNC k opens cycle k: it is the first frame of the cycle, and of several segments all SYNCs leave before
/// any is received from. A drive latches its actual values and applies the RPDO it got before at SYNC; the
/// TPDOs it answers after SYNC k are read in cycle k + 1. Nodes boot, are lost and come back while the cycle
/// runs; everything that is not process data goes over SDO in a bounded number of frames per cycle.
///
/// A bus has one master: frames of somebody else that lead nodes are told in every cycle in which they come,
/// and for a second behind the last.
class Segment final {
 public:
  /// The bus must live longer. Copies and prepares everything; allocates here and never again. Throws
  /// std::invalid_argument for a configuration that cannot run (two nodes with one ID, a target out of range,
  /// a statusword or controlword that is not mapped); the machine file's check says that earlier and better.
  Segment(image::CanBus& bus, SegmentConfig config);
  ~Segment();
  Segment(const Segment&) = delete;
  Segment& operator=(const Segment&) = delete;

  /// This control did not run for `away`, and another one may have taken its place: until all that waited on
  /// the bus has been heard, and for BusLead::kLook, nothing is sent. If somebody else leads the bus it stays
  /// so for good (lead_lost). real-time safe.
  void came_back(image::Nanoseconds away) noexcept;
  /// The bus has been listened to until now: what comes before the first cycle counts, too.
  void listened() noexcept;

  /// SYNC. real-time safe.
  void open_cycle(image::ProcessImage& image) noexcept;
  /// All received frames, then AxisImage::drive, SpindleImage::drive, inputs into packet A; behind
  /// open_cycle() of the same cycle. real-time safe.
  void receive(image::ProcessImage& image) noexcept;
  /// RPDOs of drive_command and of outputs in packet A, then heartbeat, NMT and SDO. real-time safe.
  void send(image::ProcessImage& image) noexcept;

  /// Behind the last cycle, again and again with the time that goes on, until it is true: drives without
  /// torque go to Pre-operational and no longer miss the heartbeat of the control (1016h or life guarding),
  /// so that its end is no fault to them. A drive with torque and an I/O module go on watching: their own
  /// reaction is what is wanted of them. Where somebody else leads the bus nothing is said. real-time safe.
  bool leave(image::Nanoseconds now) noexcept;

  /// Reading an object of a node that runs, from outside the cycle; one asker. real-time safe.
  ObjectQuestion& question() noexcept;
  /// What happened; one reader. real-time safe.
  BusEventRing& events() noexcept;
  const SegmentConfig& config() const noexcept;
  /// Status of the i-th configured node. Written by the cycle: read it from the cycle's thread or between
  /// cycles.
  NodeStatus node_status(std::size_t i) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::canopen
