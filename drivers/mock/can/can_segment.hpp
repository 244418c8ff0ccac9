// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/frames/can_wire.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/simulated.hpp"

namespace servogate::mock {

using image::CanFrame;
using image::Nanoseconds;

/// Acceptance filter of a controller: a bit for each identifier of 11 bits.
inline constexpr std::uint32_t kFilterSize = 0x800;
using CanFilter = std::bitset<kFilterSize>;

/// Something that lives on a segment and acts in the very moment a frame ends or its own time has come.
class CanNode {
 public:
  virtual ~CanNode() = default;
  /// Called once when the node is attached: its access to the bus, and the time of day.
  virtual void connect(image::CanBus& bus, Nanoseconds now) = 0;
  /// Data frames with an identifier of 11 bits that it does not let through are kept from the node; asked for
  /// once, when the node is attached, and looked at for every frame. nullptr: everything comes.
  virtual const CanFilter* filter() const noexcept { return nullptr; }
  /// A frame of somebody else has ended; frame.timestamp_ns is now. real-time safe.
  virtual void on_frame(const CanFrame& frame) noexcept = 0;
  /// Brings the node to time t. real-time safe.
  virtual void advance_to(Nanoseconds t) noexcept = 0;
  /// Earliest time at which the node wants to be advanced although no frame comes. real-time safe.
  virtual Nanoseconds next_action_ns() const noexcept = 0;
  /// False: without supply it takes no part in the traffic, and acknowledges nothing. real-time safe.
  virtual bool alive() const noexcept { return true; }
};

class ForeignSender;

/// Sizes and rate of a segment. Memory is taken in the constructor and in attach(), never later.
struct CanSegmentConfig {
  std::uint32_t bit_rate = 1'000'000;  ///< bit/s
  std::size_t send_queue = 64;         ///< frames an endpoint can have pending
  std::size_t receive_queue = 256;     ///< frames an endpoint without a node keeps
  /// An endpoint offers its pending frames by identifier, as a controller with priority mailboxes does;
  /// false: in the order of send().
  bool priority_mailboxes = true;
  /// A bus-off endpoint returns by itself after 128 times 11 recessive bits; false: only by restart().
  bool automatic_restart = false;
};

/// Sees everything that happens on the wire, for records and tests. Called from advance_to().
class CanMonitor {
 public:
  enum class Outcome : std::uint8_t { received, dropped, error };
  virtual ~CanMonitor() = default;
  /// One frame or broken-off attempt that occupied the bus from start to end.
  virtual void on_wire(const CanFrame& frame, int sender, Nanoseconds start, Nanoseconds end,
                       Outcome outcome) noexcept = 0;
};

/// Running totals of a segment since its construction.
struct CanStatistics {
  std::uint64_t frames = 0;   ///< received by somebody or dropped by a fault
  std::uint64_t bits = 0;     ///< on the wire, intermissions and error frames included
  std::uint64_t errors = 0;   ///< error frames
  std::uint64_t lost = 0;     ///< frames that a full receive queue could not take
  std::uint64_t refused = 0;  ///< frames that a full send queue did not take
};

/// A CAN segment in simulated time: every endpoint is an image::CanBus. Frames compete by identifier in the
/// moment the bus falls idle, occupy it for exactly their stuffed length, and arrive at the end of frame with
/// that time as time stamp. Same calls, same bytes: nothing depends on the host's time. Classic frames only:
/// FD frames are refused. Not thread-safe: endpoints belong to the thread that calls advance_to().
class CanSegment final : public image::Simulated {
 public:
  explicit CanSegment(CanSegmentConfig config = {});
  ~CanSegment() override;
  CanSegment(const CanSegment&) = delete;
  CanSegment& operator=(const CanSegment&) = delete;

  /// Adds a polled endpoint (a master, a test); the segment owns it. Not real-time safe.
  image::CanBus& add_endpoint(std::string name = {});
  /// Adds a node that reacts by itself; the node must outlive the segment's use. Returns its endpoint number.
  int attach(CanNode& node, std::string name = {});
  /// Number of an endpoint that add_endpoint() returned.
  int number_of(const image::CanBus& endpoint) const noexcept;
  int endpoints() const noexcept { return static_cast<int>(endpoints_.size()); }

  /// Moves the wire and all nodes on to t; times before now() are ignored. real-time safe.
  void advance_to(Nanoseconds t) override;
  Nanoseconds now() const noexcept { return now_; }
  /// Earliest time at which something happens on the wire or in a node although nobody sends; the largest
  /// number when nothing will. For whoever waits between two calls of advance_to(). real-time safe.
  Nanoseconds next_event_ns() const noexcept;
  /// A frame is on the wire: the next event is its end. real-time safe.
  bool busy() const noexcept { return busy_; }
  /// Time of so many bits, rounded down. real-time safe.
  Nanoseconds bit_time(std::uint64_t bits) const noexcept {
    return static_cast<Nanoseconds>(bit_ns_ != 0 ? bits * bit_ns_ : bits * 1'000'000'000u / config_.bit_rate);
  }

  const CanStatistics& statistics() const noexcept { return statistics_; }
  /// Share of time that the wire was busy, 0-1, over the last completed second (before that: since the
  /// start).
  double load() const noexcept;

  /// Puts a fault on the wire: drop (the frame occupies the bus, and nobody receives it), delay (it is
  /// offered for arbitration later), corrupt (a bit error at three quarters of the frame: error frame, error
  /// counters, retransmission), repeat (it is received twice), foreign (a device that is attached for it
  /// sends frames). Faults work in the order of injection, at most 16 at a time. False: no place, or no fault
  /// of a wire. Not real-time safe for foreign.
  bool inject(const fault::Fault& fault);
  void clear_faults() noexcept;
  /// Takes away the oldest fault that is equal to this one.
  void clear(const fault::Fault& fault) noexcept;
  /// Takes an endpoint off the bus as 256 transmit errors do; its pending frames are lost.
  void force_bus_off(int endpoint) noexcept;
  /// Lets a bus-off endpoint return after 128 times 11 recessive bits.
  void restart(int endpoint) noexcept;
  /// Unplugs an endpoint (false) or plugs it in again; it neither sends, receives nor acknowledges meanwhile.
  /// A polled one is an interface that goes down: what waits in it is thrown away, and it takes nothing.
  void set_connected(int endpoint, bool connected) noexcept;
  /// One observer; nullptr: none.
  void set_monitor(CanMonitor* monitor) noexcept { monitor_ = monitor; }

 private:
  class Endpoint;
  struct ActiveFault {
    fault::Fault fault;
    std::uint32_t passed = 0;
    std::uint32_t hit = 0;
  };
  /// The attempt on the wire.
  struct Attempt {
    CanFrame frame;
    std::uint32_t key = 0;      ///< arbitration_key() of the frame
    std::uint64_t senders = 0;  ///< bit per endpoint; more than one only for equal identifiers
    int sender = -1;
    Nanoseconds start = 0;
    Nanoseconds end = 0;
    std::uint32_t bits = 0;
    bool error = false;
    bool unacknowledged = false;
    bool drop = false;
    bool duplicate = false;
  };

  /// The first endpoint of a set, a bit each.
  Endpoint& endpoint_of(std::uint64_t set) const noexcept;
  Nanoseconds earliest_start() const noexcept;
  Nanoseconds earliest_node() const noexcept;
  void run_due_nodes() noexcept;
  /// The node has something to do earlier than it said.
  bool replan(const CanNode& node) noexcept;
  void start_frame() noexcept;
  void finish_attempt() noexcept;
  void finish_error() noexcept;
  void deliver(const CanFrame& frame, std::uint64_t senders) noexcept;
  void account(std::uint32_t bits) noexcept;
  bool acknowledged(std::uint64_t senders) const noexcept;
  /// Next fault for a frame: the delaying kind when it is queued, the others when it is on the wire.
  const fault::Fault* fault_for(const CanFrame& frame, int sender, bool queued) noexcept;

  CanSegmentConfig config_;
  std::uint64_t bit_ns_;  ///< length of a bit where that is a whole number, otherwise 0
  std::vector<std::unique_ptr<Endpoint>> endpoints_;
  std::uint64_t waiting_ = 0;            ///< bit per endpoint that has a frame in its mailboxes
  mutable Nanoseconds node_due_ = 0;     ///< earliest_node() ...
  mutable bool node_due_known_ = false;  ///< ... since no node has planned anew
  CanMonitor* monitor_ = nullptr;
  std::vector<ActiveFault> faults_;
  std::unique_ptr<ForeignSender> foreign_;  ///< on the wire since the first fault of its kind
  CanStatistics statistics_;
  Nanoseconds now_ = 0;
  Nanoseconds bus_free_ = 0;  ///< end of the intermission
  bool busy_ = false;
  Attempt attempt_;
  // Load over the last completed second.
  Nanoseconds window_start_ = 0;
  std::uint64_t window_bits_ = 0;
  double last_load_ = -1.0;
};

}  // namespace servogate::mock
