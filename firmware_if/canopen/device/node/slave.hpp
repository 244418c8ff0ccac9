// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/301/time_of_day.hpp"
#include "firmware_if/canopen/305/lss_slave.hpp"
#include "firmware_if/canopen/device/dictionary/object_dictionary.hpp"
#include "firmware_if/canopen/device/node/emcy_producer.hpp"
#include "firmware_if/canopen/device/node/node_monitor.hpp"
#include "firmware_if/canopen/device/node/pdo_channel.hpp"
#include "firmware_if/canopen/device/node/program_store.hpp"
#include "firmware_if/canopen/device/sdo/sdo_server.hpp"

namespace servogate::canopen {

/// What stands behind the objects 2000h-FFFFh of a device: its device profile. All are called from within the
/// slave's functions and must be real-time safe.
class DeviceProfile {
 public:
  virtual ~DeviceProfile() = default;
  /// May this object take this value now? The type's and the row's range have been checked.
  virtual AbortCode before_write(ObjectDictionary::Slot, std::int64_t) noexcept { return AbortCode::none; }
  /// An SDO or a PDO has written it.
  virtual void after_write(ObjectDictionary::Slot) noexcept {}
  /// A mapped object of an event-driven TPDO was sent as `sent` and is `now`: is that an event?
  virtual bool is_event(ObjectDictionary::Slot, std::int64_t sent, std::int64_t now) noexcept {
    return sent != now;
  }
  /// Live values are about to be read: bring them up to date.
  virtual void refresh() noexcept {}
  /// A SYNC has come; synchronous RPDOs are applied and TPDOs sampled.
  virtual void on_sync(image::Nanoseconds) noexcept {}
  /// The connection to the master is broken: heartbeat, life guarding, RPDO deadline or bus-off (`error_code`
  /// 8130h, 8250h, 8140h), or an NMT command took it away (0).
  virtual void on_abort_connection(std::uint16_t /*error_code*/) noexcept {}
  /// The connection is back.
  virtual void on_connection_restored() noexcept {}
  /// Layer setting services. Whether the device can do this bit rate.
  virtual bool supports_bit_rate(std::uint32_t /*bit_s*/) noexcept { return false; }
  /// Keeps node-ID and bit rate (0: as it is) over power-off. False: it cannot.
  virtual bool store_node(NodeId, std::uint32_t /*bit_s*/) noexcept { return false; }
  /// The bus changes over: be silent (0), or run at this bit rate.
  virtual void bit_rate_changed(std::uint32_t /*bit_s*/) noexcept {}
  /// 2000h-FFFFh were stored (1010h): what is a command and no parameter is to be forgotten again.
  virtual void on_store() noexcept {}
  /// 2000h-FFFFh have their defaults or stored values again.
  virtual void on_reset() noexcept {}
};

/// A CiA 301 device without a profile: NMT slave with boot-up, heartbeat and guarding, SDO server, EMCY, SYNC
/// consumer, four PDOs of each direction with variable mapping, store and restore. A pure state machine on
/// frames and time: the owner passes in frames and calls tick() every millisecond.
class Slave final : private SdoObjects, private PdoSink, private PdoEvents, private LssDevice {
 public:
  /// `dictionary` holds communication_objects() of this node and the profile's. With kUnconfiguredNode (their
  /// node is 0 then) the device hears layer setting services only, until one of them gives it a node-ID. Not
  /// real-time safe.
  Slave(NodeId node, ObjectDictionary& dictionary, DeviceProfile& profile);

  /// Which of its PDO maps a master may change; at first all.
  void let_change_maps(MapAccess access) noexcept { map_access_ = access; }
  /// A program memory, for a dictionary with program_objects(); to be called before power_on().
  void use(ProgramStore& programs) noexcept { programs_ = &programs; }

  NodeId node() const noexcept { return node_; }
  /// Everything below is real-time safe.
  NmtState state() const noexcept { return state_; }
  EmcyProducer& emcy() noexcept { return emcy_; }
  /// Time of day as the TIME producer said it, gone on since; nullopt before its first message. Source: CiA
  /// 301, 7.2.6.
  std::optional<TimeOfDay> time_of_day(image::Nanoseconds now) const noexcept {
    if (!time_known_) return std::nullopt;
    return time_.after(now - time_at_);
  }

  /// Power-on: the boot-up message comes after boot_time.
  void power_on(image::CanBus& bus, image::Nanoseconds now, image::Nanoseconds boot_time) noexcept;
  /// Whether a frame can mean anything to this device; false lets the owner skip it.
  bool concerned(const image::CanFrame& frame) const noexcept;
  /// Data frames for which concerned() may be true, a bit for each identifier: what the device sets its
  /// controller's acceptance filter to.
  const std::bitset<0x800>& filter() const noexcept { return filter_; }
  /// Whether a frame takes effect at once, so that the profile must be brought to its time first. A PDO that
  /// waits for SYNC does not.
  bool immediate(const image::CanFrame& frame) const noexcept;
  /// Which RPDO, 1-4, this frame is to the device; 0: none.
  int receive_pdo_of(const image::CanFrame& frame) const noexcept;
  /// Which TPDO of the device, 1-4, has this identifier now; 0: none.
  int transmit_pdo_of(std::uint32_t id) const noexcept;
  void on_frame(const image::CanFrame& frame, image::Nanoseconds now) noexcept;
  /// Timers; call every millisecond.
  void tick(image::Nanoseconds now) noexcept;
  /// The device's own restart (a firmware reset), as NMT "reset node".
  void reset_node(image::Nanoseconds now) noexcept;

 private:
  std::span<std::uint8_t> room(std::uint16_t index, std::uint8_t subindex) noexcept override;
  std::span<const std::uint8_t> content(std::uint16_t index, std::uint8_t subindex) noexcept override;
  bool supports(std::uint32_t bit_s) noexcept override { return profile_.supports_bit_rate(bit_s); }
  bool store(NodeId node, std::uint32_t bit_s) noexcept override;
  void node_assigned() noexcept override;
  void bit_rate_changed(std::uint32_t bit_s) noexcept override { profile_.bit_rate_changed(bit_s); }
  void take_node(NodeId node) noexcept;
  void on_lss(const image::CanFrame& frame) noexcept;

  AbortCode read(std::uint16_t index, std::uint8_t subindex, std::span<std::uint8_t> bytes,
                 std::size_t& size) noexcept override;
  AbortCode write(std::uint16_t index, std::uint8_t subindex,
                  std::span<const std::uint8_t> bytes) noexcept override;
  AbortCode may_write(std::uint16_t index, std::uint8_t subindex, std::size_t& size) noexcept override;
  void pdo_wrote(ObjectDictionary::Slot slot) noexcept override { profile_.after_write(slot); }
  bool is_event(ObjectDictionary::Slot slot, std::int64_t sent, std::int64_t now) noexcept override {
    return profile_.is_event(slot, sent, now);
  }

  AbortCode check_communication_write(std::uint16_t index, std::uint8_t subindex,
                                      std::int64_t value) const noexcept;
  void communication_written(std::uint16_t index, std::uint8_t subindex, std::int64_t value) noexcept;
  void store_or_restore(std::uint16_t index, std::uint8_t subindex) noexcept;
  void command(NmtCommand command) noexcept;
  void enter(NmtState state) noexcept;
  void reset_communication() noexcept;
  void configure_pdos() noexcept;
  void configure_pdo(std::uint16_t parameter) noexcept;
  void pdos_changed() noexcept;
  void clear_pdo_errors() noexcept;
  void set_filter() noexcept;
  void on_sync(const image::CanFrame& frame) noexcept;
  void on_pdo_frame(const image::CanFrame& frame) noexcept;
  void answer_remote(const image::CanFrame& frame) noexcept;
  void serve_sdo() noexcept;
  void on_sdo(const image::CanFrame& frame) noexcept;
  void watch_connection() noexcept;
  void connection_lost(std::uint16_t error_code) noexcept;
  void watch_receive_pdos() noexcept;
  std::uint32_t sync_id() const noexcept { return static_cast<std::uint32_t>(cob_id_sync_) & 0x7FF; }
  bool consumes_time() const noexcept { return static_cast<std::uint32_t>(cob_id_time_) & cob::kInvalid; }
  std::uint32_t time_id() const noexcept { return static_cast<std::uint32_t>(cob_id_time_) & 0x7FF; }
  void on_time(const image::CanFrame& frame) noexcept;
  bool window_closed() const noexcept { return sync_window_ > 0 && now_ > window_end_; }
  bool alive() const noexcept {
    return state_ == NmtState::operational || state_ == NmtState::pre_operational;
  }

  NodeId node_;
  NodeId stored_node_;  ///< that of the next power-on
  ObjectDictionary& dictionary_;
  DeviceProfile& profile_;
  SdoServer sdo_;
  EmcyProducer emcy_;
  NodeMonitor monitor_;
  LssSlave lss_;
  ProgramStore* programs_ = nullptr;
  MapAccess map_access_ = MapAccess::variable;
  std::array<ReceivePdo, kPdos> receive_;
  std::array<TransmitPdo, kPdos> transmit_;
  bool any_event_driven_ = false;
  std::bitset<0x800> filter_;
  std::int64_t &cob_id_sync_, &cob_id_time_;
  std::int64_t &sync_overflow_, &sync_window_;  ///< 1019h; 1007h in us
  image::Nanoseconds window_end_ = 0;
  TimeOfDay time_;
  image::Nanoseconds time_at_ = 0;
  bool time_known_ = false;
  image::CanBus* bus_ = nullptr;
  NmtState state_ = NmtState::boot_up;
  image::Nanoseconds now_ = 0;
  image::Nanoseconds boot_at_ = 0;
  bool booting_ = false;
  bool restart_due_ = false;  ///< a program was started; first its confirmation goes out
  bool lost_ = false;
};

}  // namespace servogate::canopen
