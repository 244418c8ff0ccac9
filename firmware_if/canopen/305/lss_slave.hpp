// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "firmware_if/canopen/305/lss_frame.hpp"
#include "firmware_if/image/time.hpp"

namespace servogate::canopen {

/// What the services of layer setting act on in a device. All are called from LssSlave::on_frame and tick,
/// and must be real-time safe.
class LssDevice {
 public:
  virtual ~LssDevice() = default;
  /// Whether the device can do this bit rate.
  virtual bool supports(std::uint32_t /*bit_s*/) noexcept { return false; }
  /// Keeps node-ID and bit rate (0: as it is) over power-off. False: the memory failed.
  virtual bool store(NodeId, std::uint32_t /*bit_s*/) noexcept { return false; }
  /// A device without node-ID has got one: it begins with its boot-up.
  virtual void node_assigned() noexcept {}
  /// The bus changes over: silent from now on (`bit_s` 0), then at the new bit rate, then allowed to speak.
  virtual void bit_rate_changed(std::uint32_t /*bit_s*/) noexcept {}
};

/// LSS slave. A node-ID that it got becomes active with the next NMT reset communication, or at once where
/// the device had none. Source: CiA 305. real-time safe.
class LssSlave {
 public:
  LssSlave(LssDevice& device, const LssIdentity& identity, NodeId node) noexcept
      : device_(device), identity_(identity), active_(node), pending_(node) {}

  LssMode mode() const noexcept { return mode_; }
  NodeId active_node() const noexcept { return active_; }
  /// Power-on with the stored node-ID and what the device is.
  void power_on(NodeId node, const LssIdentity& identity) noexcept {
    identity_ = identity;
    active_ = pending_ = node;
    mode_ = LssMode::waiting;
    change_ = Change::none;
  }
  /// Takes the pending node-ID over: NMT reset communication. Returns it.
  NodeId activate_node() noexcept { return active_ = pending_; }

  /// A frame with the identifier 7E5h. True: `answer` is to be sent with 7E4h.
  bool on_frame(const image::CanFrame& frame, image::Nanoseconds now, LssBytes& answer) noexcept;
  /// Carries out an activated change of bit rate.
  void tick(image::Nanoseconds now) noexcept;

 private:
  bool select(int part, std::uint32_t value, LssBytes& answer) noexcept;
  bool identify(int field, std::uint32_t value, LssBytes& answer) noexcept;
  bool fastscan(const LssBytes& request, LssBytes& answer) noexcept;
  bool configure(const LssBytes& request, image::Nanoseconds now, LssBytes& answer) noexcept;
  void leave_configuration() noexcept;

  LssDevice& device_;
  LssIdentity identity_;
  NodeId active_, pending_;
  std::uint32_t pending_bit_s_ = 0;
  LssMode mode_ = LssMode::waiting;
  int selected_ = 0;    ///< parts of the identity that matched in a row
  int identified_ = 0;  ///< fields of an identification that matched in a row
  std::uint8_t scan_position_ = 0;
  image::Nanoseconds switch_at_ = 0, speak_at_ = 0;
  enum class Change : std::uint8_t { none, silent, listening } change_ = Change::none;
};

}  // namespace servogate::canopen
