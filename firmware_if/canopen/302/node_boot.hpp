// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/301/sdo_client.hpp"
#include "firmware_if/canopen/302/boot_plan.hpp"

namespace servogate::canopen {

/// Identity as read at boot.
struct NodeIdentity {
  std::uint32_t device_type = 0;
  std::uint32_t vendor_id = 0, product_code = 0, revision = 0, serial = 0;
};

/// Carries out a boot plan for one node, one action after another. All but the constructor is real-time safe.
class NodeBoot {
 public:
  enum class State : std::uint8_t { idle, running, done, failed };

  /// `timeout`: of a boot-up message and of Operational; `flash_timeout`: until the flash is at rest.
  NodeBoot(NodeId node, std::vector<BootAction> plan, image::Nanoseconds timeout_ns,
           image::Nanoseconds flash_timeout_ns = 60 * image::kSecond)
      : node_(node), plan_(std::move(plan)), timeout_ns_(timeout_ns), flash_timeout_ns_(flash_timeout_ns) {}

  /// Starts from the first action (NMT reset communication).
  void begin(SdoClient& sdo) noexcept;
  /// The node has just said by itself that it is up: starts behind the reset.
  void begin_after_boot_up(SdoClient& sdo) noexcept;

  void on_boot_up() noexcept { boot_up_seen_ = true; }
  /// A boot-up message is part of the step in hand and does not begin the boot anew.
  bool boot_up_belongs() const noexcept {
    return report_.step == BootStep::reset || report_.step == BootStep::program;
  }
  void on_heartbeat(NmtState state) noexcept { nmt_state_ = state; }

  /// Goes on as far as it can without waiting; sends at most one frame. True when it sent one. `sdo` is the
  /// node's client, which nobody else may use meanwhile.
  bool poll(image::Nanoseconds now, SdoClient& sdo, image::CanBus& bus, bool sync_runs = true) noexcept;

  State state() const noexcept { return state_; }
  /// The action in hand; after a failure the one that failed, with what was expected and what came.
  const BootReport& report() const noexcept { return report_; }
  const NodeIdentity& identity() const noexcept { return identity_; }
  /// 603Fh as it was before the start; 0: no error, or no such object.
  std::uint16_t error_code() const noexcept { return error_code_; }
  /// The node is not yet told what SYNC looks like.
  bool before_sync() const noexcept { return state_ == State::running && report_.step <= BootStep::sync; }
  /// Everything is written, and only SYNC is missing.
  bool awaits_sync() const noexcept {
    return state_ == State::running && plan_[action_].kind == BootAction::Kind::await_sync;
  }

 private:
  void restart_at(std::size_t action, SdoClient& sdo) noexcept;
  bool command_and_wait(image::Nanoseconds now, image::CanBus& bus, NmtCommand command,
                        bool arrived) noexcept;
  bool access(image::Nanoseconds now, SdoClient& sdo, image::CanBus& bus) noexcept;
  void on_result(const SdoClient& sdo) noexcept;
  void judge_value(const SdoClient& sdo) noexcept;
  void judge_text(const SdoClient& sdo) noexcept;
  void judge_flash(const SdoClient& sdo) noexcept;
  void judge_list(std::uint32_t value) noexcept;
  void jump(bool equal) noexcept;
  bool start_transfer(SdoClient& sdo) noexcept;
  image::Nanoseconds writing_time(std::uint16_t index) const noexcept;
  bool await_boot_up(image::Nanoseconds now) noexcept;
  void keep(std::uint32_t value) noexcept;
  void next() noexcept;
  void fail(BootProblem problem) noexcept;
  void describe_action() noexcept;

  NodeId node_;
  std::vector<BootAction> plan_;
  image::Nanoseconds timeout_ns_, flash_timeout_ns_;
  image::Nanoseconds now_ = 0, flash_deadline_ns_ = 0, poll_again_ns_ = 0;
  State state_ = State::idle;
  std::size_t action_ = 0;
  std::uint8_t list_size_ = 0, list_entry_ = 0;  ///< of find_in_list; entry 0: the size is asked for
  bool entered_ = false;                         ///< the action has begun: command sent or transfer started
  image::Nanoseconds deadline_ns_ = 0;
  bool boot_up_seen_ = false;
  NmtState nmt_state_ = NmtState::boot_up;
  BootReport report_;
  NodeIdentity identity_;
  std::uint16_t error_code_ = 0;
};

}  // namespace servogate::canopen
