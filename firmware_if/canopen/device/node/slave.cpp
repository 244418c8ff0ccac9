// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/device/node/slave.hpp"

#include <algorithm>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/device/node/communication_objects.hpp"

namespace servogate::canopen {
namespace {

constexpr std::uint16_t kHeartbeatLost = 0x8130, kBusOff = 0x8140, kPdoTooShort = 0x8210,
                        kRpdoTimeout = 0x8250;
constexpr int kSegmentsPerTick = 2;
constexpr ObjectDictionary::Range kCommunication{0x1000, 0x1FFF}, kApplication{0x2000, 0xFFFF};

// The identifiers that hold the node-ID in their low bits. Source: CiA 301, 7.3.5.
constexpr std::pair<std::uint16_t, std::uint8_t> kOfNode[] = {
    {0x1014, 0}, {0x1200, 1}, {0x1200, 2}, {0x1400, 1}, {0x1401, 1}, {0x1402, 1},
    {0x1403, 1}, {0x1800, 1}, {0x1801, 1}, {0x1802, 1}, {0x1803, 1}};

LssIdentity identity_of(const ObjectDictionary& dictionary) noexcept {
  LssIdentity identity;
  for (std::uint8_t i = 0; i < 4; ++i)
    identity.part[i] =
        static_cast<std::uint32_t>(dictionary.get(object::kIdentity, static_cast<std::uint8_t>(i + 1)));
  return identity;
}

}  // namespace

Slave::Slave(NodeId node, ObjectDictionary& dictionary, DeviceProfile& profile)
    : node_(node),
      stored_node_(node),
      dictionary_(dictionary),
      profile_(profile),
      sdo_(*this),
      emcy_(dictionary),
      monitor_(dictionary, node),
      lss_(*this, identity_of(dictionary), node),
      cob_id_sync_(dictionary.variable(object::kCobIdSync)),
      cob_id_time_(dictionary.variable(object::kCobIdTime)),
      sync_overflow_(dictionary.variable(object::kSyncCounterOverflow)),
      sync_window_(dictionary.variable(object::kSynchronousWindowLength)) {
  configure_pdos();
}

void Slave::power_on(image::CanBus& bus, image::Nanoseconds now, image::Nanoseconds boot_time) noexcept {
  bus_ = &bus;
  now_ = now;
  if (stored_node_ != node_) take_node(stored_node_);
  lss_.power_on(stored_node_, identity_of(dictionary_));
  emcy_.connect(&bus);
  monitor_.connect(&bus);
  boot_at_ = now + boot_time;
  booting_ = true;
  enter(NmtState::boot_up);
}

bool Slave::concerned(const image::CanFrame& frame) const noexcept {
  if (frame.extended || frame.error) return false;
  const std::uint32_t id = frame.id;
  if (id == cob::kLssMaster) return true;
  if (booting_ || node_ == kUnconfiguredNode) return false;
  if (id < filter_.size() && filter_[id]) return true;
  if (!frame.remote) return false;
  return std::any_of(transmit_.begin(), transmit_.end(), [id](const TransmitPdo& p) { return p.id() == id; });
}

bool Slave::immediate(const image::CanFrame& frame) const noexcept {
  if ((frame.id & 0x780) == 0x700) return false;
  for (const ReceivePdo& p : receive_)
    if (p.valid() && p.id() == frame.id) return !p.synchronous();
  return true;
}

int Slave::receive_pdo_of(const image::CanFrame& frame) const noexcept {
  if (frame.extended || frame.remote || frame.error) return 0;
  for (int n = 0; n < kPdos; ++n) {
    const ReceivePdo& p = receive_[static_cast<std::size_t>(n)];
    if (p.valid() && p.id() == frame.id) return n + 1;
  }
  return 0;
}

int Slave::transmit_pdo_of(std::uint32_t id) const noexcept {
  for (int n = 0; n < kPdos; ++n) {
    const TransmitPdo& p = transmit_[static_cast<std::size_t>(n)];
    if (p.valid() && p.id() == id) return n + 1;
  }
  return 0;
}

void Slave::on_frame(const image::CanFrame& frame, image::Nanoseconds now) noexcept {
  if (!concerned(frame)) return;
  now_ = now;
  if (frame.id == cob::kLssMaster) return on_lss(frame);
  if (frame.id == sync_id() && !frame.remote) return on_sync(frame);
  if (frame.id == cob::kNmt) {
    const auto request = parse_nmt(frame);
    if (request && (request->node == 0 || request->node == node_)) command(request->command);
    return;
  }
  if ((frame.id & 0x780) == 0x700) return monitor_.on_frame(frame, state_, now);
  if (frame.id == cob::sdo_request(node_)) return on_sdo(frame);
  if (frame.remote) return answer_remote(frame);
  if (consumes_time() && frame.id == time_id()) return on_time(frame);
  on_pdo_frame(frame);
}

void Slave::on_lss(const image::CanFrame& frame) noexcept {
  LssBytes answer{};
  if (bus_ && lss_.on_frame(frame, now_, answer)) bus_->send(make_frame(cob::kLssSlave, answer));
}

void Slave::take_node(NodeId node) noexcept {
  const NodeId old = node_ == kUnconfiguredNode ? NodeId{0} : node_;
  const NodeId now = node == kUnconfiguredNode ? NodeId{0} : node;
  for (const auto& [index, subindex] : kOfNode) {
    const auto slot = dictionary_.find(index, subindex);
    if (slot != ObjectDictionary::kNone && (dictionary_.spec(slot).value & kMaxNode) == old)
      dictionary_.set_default(index, subindex, dictionary_.spec(slot).value - old + now);
  }
  node_ = node;
  monitor_.set_node(node);
  set_filter();
}

bool Slave::store(NodeId node, std::uint32_t bit_s) noexcept {
  if (!profile_.store_node(node, bit_s)) return false;
  stored_node_ = node;
  return true;
}

void Slave::node_assigned() noexcept { reset_communication(); }

void Slave::on_time(const image::CanFrame& frame) noexcept {
  const auto time = parse_time(frame);
  if (!time) return;
  time_ = *time;
  time_at_ = now_;
  time_known_ = true;
}

void Slave::on_sdo(const image::CanFrame& frame) noexcept {
  if (!alive() || frame.remote) return;
  SdoBytes answer{};
  if (sdo_.handle(std::span(frame.data).first(frame.length), now_, answer))
    bus_->send(make_frame(cob::sdo_response(node_), answer));
}

// Segments of a block upload leave the bus to what has a deadline: a few in a millisecond, and none that
// would wait behind a full queue.
void Slave::serve_sdo() noexcept {
  SdoBytes bytes{};
  if (sdo_.tick(now_, bytes)) bus_->send(make_frame(cob::sdo_response(node_), bytes));
  for (int n = 0; n < kSegmentsPerTick && sdo_.segment(bytes); ++n) {
    if (!bus_->send(make_frame(cob::sdo_response(node_), bytes))) return;
    sdo_.segment_sent();
  }
}

void Slave::on_pdo_frame(const image::CanFrame& frame) noexcept {
  if (state_ != NmtState::operational) return;
  for (ReceivePdo& p : receive_) {
    if (!p.valid() || p.id() != frame.id) continue;
    // After the synchronous window 1007h it is too late for this cycle, and the next has its own.
    if (p.synchronous() && window_closed()) continue;
    switch (p.accept(frame, now_)) {
      case ReceivePdo::Result::too_short:
        emcy_.raise(kPdoTooShort, error_register::kCommunication, frame.length);
        return;
      case ReceivePdo::Result::apply_now:
        p.apply(dictionary_, *this);
        break;
      case ReceivePdo::Result::kept:
        break;
    }
    if (emcy_.any()) clear_pdo_errors();
  }
}

// An error is over when no RPDO has it any more.
void Slave::clear_pdo_errors() noexcept {
  const auto any = [this](auto has) { return std::any_of(receive_.begin(), receive_.end(), has); };
  if (!any([](const ReceivePdo& p) { return p.valid() && p.was_short(); })) emcy_.clear(kPdoTooShort);
  if (!any([](const ReceivePdo& p) { return p.valid() && p.overdue(); })) emcy_.clear(kRpdoTimeout);
}

void Slave::answer_remote(const image::CanFrame& frame) noexcept {
  if (state_ != NmtState::operational) return;
  for (TransmitPdo& p : transmit_) {
    if (!p.valid() || p.id() != frame.id || !p.remote_allowed()) continue;
    profile_.refresh();
    p.send(dictionary_, *bus_, now_);
  }
}

void Slave::on_sync(const image::CanFrame& frame) noexcept {
  // With a counter the message has one byte, without one none. Source: CiA 301, 7.2.5.
  if (frame.length != (sync_overflow_ ? 1 : 0))
    return emcy_.raise(kUnexpectedSyncLength, error_register::kCommunication);
  emcy_.clear(kUnexpectedSyncLength);
  window_end_ = now_ + sync_window_ * image::kMicrosecond;
  if (state_ == NmtState::operational) {
    const std::uint8_t counter = frame.length == 1 ? frame.data[0] : 0;
    // Actual values are latched before the new set-points act, so that both belong to this SYNC.
    profile_.refresh();
    for (TransmitPdo& p : transmit_)
      if (p.due_at_sync(dictionary_, counter)) p.send(dictionary_, *bus_, now_);
    for (ReceivePdo& p : receive_)
      if (p.pending()) p.apply(dictionary_, *this);
  }
  if (alive()) profile_.on_sync(now_);
}

void Slave::tick(image::Nanoseconds now) noexcept {
  now_ = now;
  lss_.tick(now);
  if (programs_) programs_->tick(now);
  if (restart_due_) {
    restart_due_ = false;
    return reset_communication();
  }
  if (booting_) {
    if (now < boot_at_ || node_ == kUnconfiguredNode) return;
    booting_ = false;
    monitor_.start(now);
    enter(NmtState::pre_operational);
    return;
  }
  monitor_.tick(state_, now);
  emcy_.tick(now);
  if (alive()) serve_sdo();
  watch_connection();
  if (state_ != NmtState::operational || !any_event_driven_) return;
  profile_.refresh();
  for (TransmitPdo& p : transmit_)
    if (p.due_by_event(dictionary_, *this, now)) p.send(dictionary_, *bus_, now);
}

void Slave::watch_connection() noexcept {
  const bool bus_off = bus_->state() == image::CanState::bus_off;
  const bool lost = monitor_.lost() || bus_off;
  if (lost && !lost_) connection_lost(bus_off ? kBusOff : kHeartbeatLost);
  if (!lost && lost_) {
    emcy_.clear(kHeartbeatLost);
    emcy_.clear(kBusOff);
    profile_.on_connection_restored();
  }
  lost_ = lost;
  if (state_ == NmtState::operational) watch_receive_pdos();
}

// Deadline monitoring 1400h:05. The profile reacts as to a lost connection (6007h); 1029h does not speak of
// it, so that the node stays as it is. Source: CiA 301, 7.2.2.5.2 and 7.5.2.31.
void Slave::watch_receive_pdos() noexcept {
  for (ReceivePdo& p : receive_) {
    if (!p.valid() || !p.late(now_)) continue;
    p.note_late();
    emcy_.raise(kRpdoTimeout, error_register::kCommunication);
    profile_.on_abort_connection(kRpdoTimeout);
  }
}

void Slave::connection_lost(std::uint16_t error_code) noexcept {
  emcy_.raise(error_code, error_register::kCommunication);
  profile_.on_abort_connection(error_code);
  // Error behaviour 1029h:01. Source: CiA 301, 7.5.2.31.
  switch (dictionary_.get(object::kErrorBehaviour, 1)) {
    case 0:
      if (state_ == NmtState::operational) enter(NmtState::pre_operational);
      break;
    case 2:
      enter(NmtState::stopped);
      break;
    default:
      break;
  }
}

void Slave::command(NmtCommand command) noexcept {
  switch (command) {
    case NmtCommand::start:
      return enter(NmtState::operational);
    case NmtCommand::stop:
      if (state_ == NmtState::stopped) return;
      enter(NmtState::stopped);  // what the profile has to tell waits: no EMCY in Stopped (CiA 301, table 39)
      return profile_.on_abort_connection(0);
    case NmtCommand::enter_pre_operational:
      return enter(NmtState::pre_operational);
    case NmtCommand::reset_node:
      return reset_node(now_);
    case NmtCommand::reset_communication:
      profile_.on_abort_connection(0);
      return reset_communication();
  }
}

void Slave::enter(NmtState state) noexcept {
  if (state == NmtState::operational && state_ != NmtState::operational) {
    for (TransmitPdo& p : transmit_) p.start(now_);
    for (ReceivePdo& p : receive_) p.start();
  }
  if (state == NmtState::stopped) sdo_.reset();
  state_ = state;
  emcy_.set_allowed(alive());
}

void Slave::reset_node(image::Nanoseconds now) noexcept {
  now_ = now;
  profile_.on_abort_connection(0);
  dictionary_.reset(kApplication);
  profile_.on_reset();
  reset_communication();
}

void Slave::reset_communication() noexcept {
  if (lss_.activate_node() != node_) take_node(lss_.active_node());
  dictionary_.reset(kCommunication);
  sdo_.reset();
  emcy_.reset();
  monitor_.stop();
  configure_pdos();
  lost_ = false;
  booting_ = true;
  boot_at_ = now_ + image::kMillisecond;
  enter(NmtState::boot_up);
}

void Slave::configure_pdos() noexcept {
  for (int n = 0; n < kPdos; ++n) {
    receive_[static_cast<std::size_t>(n)].configure(dictionary_, n);
    transmit_[static_cast<std::size_t>(n)].configure(dictionary_, n, now_);
  }
  pdos_changed();
}

// One PDO; the others go on with their counters, timers and deadlines.
void Slave::configure_pdo(std::uint16_t parameter) noexcept {
  const int n = parameter & 0x1FF;
  if (n >= kPdos) return;
  if (parameter < object::kTpdoParameter)
    receive_[static_cast<std::size_t>(n)].configure(dictionary_, n);
  else
    transmit_[static_cast<std::size_t>(n)].configure(dictionary_, n, now_);
  pdos_changed();
}

void Slave::pdos_changed() noexcept {
  any_event_driven_ =
      std::any_of(transmit_.begin(), transmit_.end(), [](const TransmitPdo& p) { return p.event_driven(); });
  set_filter();
}

void Slave::set_filter() noexcept {
  filter_.reset();
  filter_.set(cob::kNmt).set(cob::kLssMaster).set(sync_id());
  if (node_ != kUnconfiguredNode) filter_.set(cob::sdo_request(node_));
  if (consumes_time()) filter_.set(time_id());
  for (std::uint32_t id = 0x700; id < 0x780; ++id) filter_.set(id);
  for (const ReceivePdo& p : receive_)
    if (p.valid()) filter_.set(p.id());
}

}  // namespace servogate::canopen
