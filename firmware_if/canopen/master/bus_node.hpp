// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "firmware_if/canopen/301/cob_id.hpp"
#include "firmware_if/canopen/301/emcy.hpp"
#include "firmware_if/canopen/301/node_guard.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/302/node_boot.hpp"
#include "firmware_if/canopen/302/segment_config.hpp"
#include "firmware_if/canopen/master/drive/drive_link.hpp"
#include "firmware_if/canopen/master/events/bus_event.hpp"
#include "firmware_if/canopen/master/io/io_link.hpp"
#include "firmware_if/canopen/master/object_question.hpp"
#include "firmware_if/canopen/master/sdo/error_history.hpp"

namespace servogate::canopen {

/// What a node needs of its surroundings in one cycle.
struct NodeContext {
  std::int16_t segment = 0;
  std::int64_t cycle = 0;
  image::Nanoseconds now = 0;
  image::CanBus& bus;
  BusEventRing& events;
  ObjectQuestion& question;  ///< of somebody outside the cycle, to any node of the segment
  bool sync_runs = true;     ///< see Segment: SYNC with a counter waits for those who must know of it
};

/// One configured node through its life: boot, operation under supervision, loss, boot again. All but the
/// constructor is real-time safe.
class BusNode {
 public:
  BusNode(const NodeConfig& config, const SegmentConfig& segment);

  NodeId id() const noexcept { return config_.node; }
  const NodeConfig& config() const noexcept { return config_; }
  bool online() const noexcept { return online_; }
  /// NMT state as last heard; nullopt: nothing has been heard of it, or no more.
  std::optional<NmtState> nmt_state() const noexcept { return nmt_state_; }
  const BootReport& boot_report() const noexcept { return boot_.report(); }
  const NodeIdentity& identity() const noexcept { return boot_.identity(); }
  const EmcyHistory& emcy_history() const noexcept { return emcy_; }

  /// A SYNC with a counter does not meet it unprepared: it has been told of the counter, or does not answer.
  bool ready_for_sync() const noexcept;

  /// A frame of this node: TPDO, SDO answer, heartbeat or emergency.
  void on_frame(Service service, const image::CanFrame& frame, const NodeContext& context) noexcept;
  /// After all frames of the cycle: supervision, then the feedback or the inputs.
  void evaluate(image::ProcessImage& image, const NodeContext& context) noexcept;
  /// Sends the RPDOs; a drive that was lost while it ran is told to quick-stop until it is heard again,
  /// outputs to go where their loss leads them. Returns the number of frames the bus did not take; `dropped`
  /// is the last of them.
  int send_process_data(const image::ProcessImage& image, const NodeContext& context,
                        image::CanFrame& dropped) noexcept;
  /// Sends at most one frame of boot or SDO. True when it did.
  bool send_acyclic(const NodeContext& context) noexcept;
  /// Behind the last cycle, see Segment::leave(): at most one frame. True: nothing is left to say.
  bool leave(const NodeContext& context) noexcept;

 private:
  enum class Phase : std::uint8_t {
    booting,
    pausing,  ///< between two attempts to boot
    refused,  ///< the node answered, and not as it should: waits until it restarts
    running,
    lost,  ///< silent: waits for a sign of life
    leaving,
  };

  void on_heartbeat(const image::CanFrame& frame, const NodeContext& context) noexcept;
  void on_boot_up(const NodeContext& context) noexcept;
  void on_emcy(const image::CanFrame& frame, const NodeContext& context) noexcept;
  void take_emcy(const Emcy& emcy, const NodeContext& context) noexcept;
  void judge_sync_length(const NodeContext& context) noexcept;
  void on_tpdo(int number, const image::CanFrame& frame, const NodeContext& context) noexcept;
  void start_boot() noexcept;
  void follow_boot(const NodeContext& context) noexcept;
  void start_operation(const NodeContext& context) noexcept;
  void go_offline() noexcept;
  bool send_guarding(const NodeContext& context) noexcept;
  void supervise(bool on_time, const NodeContext& context) noexcept;
  void report_link(const NodeContext& context) noexcept;
  void fill(image::DriveFeedback& feedback) const noexcept;
  bool apply(const image::ProcessImage& image, const NodeContext& context) noexcept;
  bool begin_leave(const NodeContext& context) noexcept;
  void finish_access(const NodeContext& context) noexcept;
  void finish_history(const NodeContext& context) noexcept;
  bool told(std::uint16_t error_code) const noexcept;
  BusEvent event(BusEventKind kind, const NodeContext& context) const noexcept;

  NodeConfig config_;
  image::Nanoseconds heartbeat_timeout_ns_, boot_pause_ns_;
  std::int64_t first_limit_;
  std::int32_t boot_attempts_;
  bool sync_counter_;
  std::optional<NodeGuard> guard_;  ///< of a node without heartbeat

  SdoClient sdo_;
  NodeBoot boot_;
  std::unique_ptr<NodeLink> link_;
  DriveLink* drive_ = nullptr;  ///< link_, or nullptr
  IoLink* io_ = nullptr;        ///< the same
  EmcyHistory emcy_;
  struct SyncLength {
    Emcy emcy;
    std::int64_t cycle = 0;
  };
  std::optional<SyncLength> sync_length_;  ///< 8240h of this cycle
  ErrorHistory history_;
  bool faulty_ = false;  ///< the drive shows a fault

  Phase phase_ = Phase::booting;
  std::int32_t attempts_ = 0;
  BootReport reported_;  ///< failure said last, so that a repetition is not said again
  image::Nanoseconds pause_until_ns_ = 0;
  image::Nanoseconds heartbeat_deadline_ns_ = 0;
  bool online_ = false;
  std::optional<NmtState> nmt_state_;
  bool seen_status_ = false;
  std::int64_t missed_ = 0;
  bool missing_said_ = false;
  std::uint8_t short_said_ = 0;  ///< a bit for each TPDO
  bool blocked_ = false;         ///< lost while it ran: power must be withdrawn once before it is given again
  std::uint8_t restarts_ = 0;
  bool refusal_said_ = false;
  bool handover_said_ = false;
  bool interpolation_said_ = false;
  std::uint8_t leave_said_ = 0;  ///< so many of the objects that make it miss us
  bool questioned_ = false;      ///< the transfer under way answers a question from outside
};

}  // namespace servogate::canopen
