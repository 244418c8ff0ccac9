// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/segment.hpp"

#include <algorithm>
#include <bitset>
#include <stdexcept>
#include <vector>

#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/master/bus_lead.hpp"
#include "firmware_if/canopen/master/bus_meter.hpp"
#include "firmware_if/canopen/master/bus_node.hpp"
#include "firmware_if/canopen/master/sdo_budget.hpp"
#include "firmware_if/image/frames/counted_frames.hpp"

namespace servogate::canopen {
namespace {

using image::ProcessImage;

/// More than a bus of 1 Mbit/s carries in 10 ms; what is left over waits for the next cycle.
constexpr int kMaxFramesPerCycle = 256;
/// The same trouble is said again after so long.
constexpr image::Nanoseconds kRepeatNs = image::kSecond;
constexpr int kServices = static_cast<int>(Service::other) + 1;

/// Lets one event in a second through.
class Throttle {
 public:
  bool pass(image::Nanoseconds now) noexcept {
    if (armed_ && now - last_ < kRepeatNs) return false;
    armed_ = true;
    last_ = now;
    return true;
  }

 private:
  bool armed_ = false;
  image::Nanoseconds last_ = 0;
};

void require(bool condition, const char* what) {
  if (!condition) throw std::invalid_argument(what);
}

void check_io(const NodeConfig& node) {
  const DriveProfile& profile = node.profile;
  for (const IoPoint& p : node.io.points) {
    const PdoField field = find_field(p.rule.input ? profile.tpdo : profile.rpdo, p.index, p.subindex);
    require(field.mapped() && p.bit < field.bits, "a point is in no PDO");
    require(p.rule.scale != 0.0, "the scale of a point is zero");
  }
  for (const PdoWanted& pdo : profile.tpdo)
    require(!pdo.used() || cycles_between(pdo, image::kMillisecond) > 0, "a TPDO that need never come");
  const bool speaks = std::ranges::any_of(profile.rpdo, &PdoWanted::used);
  require(!speaks || notices_silence(profile) || node.unsupervised,
          "the module would not notice the death of the control, and nobody has waived that");
}

bool sends_or_takes_pdos(const DriveProfile& profile) {
  return std::ranges::any_of(profile.rpdo, &PdoWanted::used) ||
         std::ranges::any_of(profile.tpdo, &PdoWanted::used);
}

/// The drive forms its motion to each set-point, which may therefore come when it comes.
bool moves_by_itself(const NodeConfig& node) {
  if (node.target == DriveTarget::axis) return node.profile.position_mode == OperationMode::profile_position;
  return node.profile.velocity_mode == OperationMode::profile_velocity ||
         node.profile.velocity_mode == OperationMode::velocity;
}

void check_drive(const NodeConfig& node) {
  const DriveProfile& profile = node.profile;
  if (profile.sdo_only) {
    require(!sends_or_takes_pdos(profile), "a drive that only answers SDO has process data");
    require(moves_by_itself(node), "a drive that only answers SDO needs mode pp, pv or vl");
  } else {
    require(find_field(profile.rpdo, object::kControlword).mapped(), "6040h is not mapped");
    require(find_field(profile.tpdo, object::kStatusword).mapped(), "6041h is not mapped");
  }
  require(profile.vl_unit_counts_s != 0.0, "a unit is zero");
  require(profile.velocity_unit_counts_s != 0.0 && profile.torque_unit_permille != 0.0, "a unit is zero");
  require(profile.brake_bit < 32, "no such bit in 60FEh");
  require(profile.brake_bit < 0 || find_field(profile.rpdo, object::kDigitalOutputs, 1).mapped(),
          "60FEh:01 is not mapped for the brake");
  require(stops_by_itself(profile) || node.unsupervised,
          "the drive would not notice the death of the control, and nobody has waived that");
  if (node.target == DriveTarget::spindle || profile.sdo_only) return;
  require(find_field(profile.rpdo, object::kTargetPosition).mapped() ||
              find_field(profile.rpdo, object::kInterpolationData, profile.ip_position_entry).mapped(),
          "neither 607Ah nor 60C1h:01 is mapped");
  require(find_field(profile.tpdo, object::kPositionActual).mapped(), "6064h is not mapped");
}

void check_node(const NodeConfig& node) {
  static constexpr int kTargets[] = {image::kMaxAxes, image::kMaxSpindles, image::kMaxSources};
  require(node.node >= 1 && node.node <= kMaxNode, "node-ID outside 1-127");
  require(node.target_index >= 0 && node.target_index < kTargets[static_cast<int>(node.target)],
          "target of a node out of range");
  node.target == DriveTarget::io ? check_io(node) : check_drive(node);
}

SegmentConfig checked(SegmentConfig config) {
  require(config.index >= 0 && config.index < image::kMaxSegments, "segment index out of range");
  require(config.cycle_ns > 0, "cycle time is not positive");
  require(config.heartbeat_ms > 0 && config.heartbeat_timeout_ms > config.heartbeat_ms, "heartbeat times");
  require(config.sync_counter_overflow != 1 && config.sync_counter_overflow <= 240, "SYNC counter");
  require(config.own_node >= 1 && config.own_node <= kMaxNode, "own node-ID outside 1-127");
  std::bitset<128> used;
  used.set(config.own_node);
  for (const NodeConfig& node : config.nodes) {
    check_node(node);
    require(!used.test(node.node), "two nodes with one ID");
    used.set(node.node);
  }
  return config;
}

}  // namespace

struct Segment::Impl {
  Impl(image::CanBus& can, SegmentConfig segment)
      : config(checked(std::move(segment))),
        bus(can),
        lead(config.own_node, config.cycle_ns),
        sdo(config, can.bit_rate()) {
    nodes.reserve(config.nodes.size());
    index_of.fill(-1);
    for (const NodeConfig& node : config.nodes) {
      index_of[node.node] = static_cast<std::int8_t>(nodes.size());
      nodes.emplace_back(node, config);
    }
  }

  NodeContext context(const ProcessImage& image) noexcept {
    return {static_cast<std::int16_t>(config.index),
            image.now.number,
            image.now.t_ns,
            bus,
            ring,
            question,
            sync_runs};
  }
  BusEvent event(BusEventKind kind, const ProcessImage& image, NodeId node = 0) const noexcept;
  void say_frame(BusEventKind kind, const ProcessImage& image, const image::CanFrame& frame, NodeId node,
                 std::int64_t got = 0) noexcept;
  void say_send_failed(const ProcessImage& image, const image::CanFrame& frame, NodeId node) noexcept;
  bool send_own(const ProcessImage& image, const image::CanFrame& frame) noexcept;
  void dispatch(const image::CanFrame& frame, const ProcessImage& image) noexcept;
  bool concerns_us(const CobId& cob) const noexcept;
  void on_leading(const CobId& cob, const image::CanFrame& frame, const ProcessImage& image) noexcept;
  void on_request(const CobId& cob, const image::CanFrame& frame, const ProcessImage& image) noexcept;
  void watch_lead(const ProcessImage& image) noexcept;
  void watch_bus(const ProcessImage& image) noexcept;
  void drain(ProcessImage& image) noexcept;
  image::CanFrame next_sync() noexcept;
  bool sync_may_run() const noexcept;
  void send_time(const ProcessImage& image) noexcept;
  void send_heartbeat(const ProcessImage& image) noexcept;
  void send_acyclic(const ProcessImage& image) noexcept;
  void fill_status(image::SegmentStatus& status) const noexcept;

  // Everything sent is counted where it is sent.
  class CountingBus final : public image::CanBus {
   public:
    explicit CountingBus(image::CanBus& bus) : bus_(bus) {}
    bool send(const image::CanFrame& frame) noexcept override {
      image::CanFrame counted = frame;
      counted.wire_bits = lengths.bits(frame);
      if (!bus_.send(counted)) return false;
      ++sent;
      meter.add(counted);
      return true;
    }
    bool receive(image::CanFrame& frame) noexcept override {
      if (!bus_.receive(frame)) return false;
      if (frame.error) {
        ++errors;
      } else {
        ++received;
        meter.add(frame);
      }
      return true;
    }
    image::CanState state() const noexcept override { return bus_.state(); }
    std::uint32_t bit_rate() const noexcept override { return bus_.bit_rate(); }

    std::uint64_t sent = 0, received = 0, errors = 0;
    BusMeter meter;
    image::CountedFrames lengths;

   private:
    image::CanBus& bus_;
  };

  SegmentConfig config;
  CountingBus bus;
  BusLead lead;
  std::vector<BusNode> nodes;
  std::array<std::int8_t, 128> index_of{};
  BusEventRing ring;
  ObjectQuestion question;
  image::CanState bus_state = image::CanState::error_active;
  image::Nanoseconds heartbeat_due_ns = 0, time_due_ns = 0;
  std::uint8_t sync_counter = 0;
  bool sync_runs = false;
  bool started = false;
  bool heard = false;  ///< what waited on the bus before the first cycle has been taken
  std::size_t next_acyclic = 0;
  SdoBudget sdo;
  std::uint64_t send_failures = 0, send_failures_said = 0;
  Throttle send_failed, foreign_request, lead_lost;
  std::int64_t foreign_cycle = -1;      ///< in which a foreign frame was said last ...
  std::bitset<kServices> foreign_said;  ///< ... and of which services
  std::bitset<128> unknown_said;
};

BusEvent Segment::Impl::event(BusEventKind kind, const ProcessImage& image, NodeId node) const noexcept {
  BusEvent e;
  e.kind = kind;
  e.segment = static_cast<std::int16_t>(config.index);
  e.node = node;
  e.cycle = image.now.number;
  e.t_ns = image.now.t_ns;
  return e;
}

void Segment::Impl::say_frame(BusEventKind kind, const ProcessImage& image, const image::CanFrame& frame,
                              NodeId node, std::int64_t got) noexcept {
  BusEvent e = event(kind, image, node);
  e.got = got;
  e.frame.id = frame.id;
  e.frame.length = frame.length;
  for (std::size_t i = 0; i < frame.length && i < e.frame.data.size(); ++i) e.frame.data[i] = frame.data[i];
  ring.push(e);
}

bool Segment::Impl::send_own(const ProcessImage& image, const image::CanFrame& frame) noexcept {
  if (bus.send(frame)) return true;
  ++send_failures;
  say_send_failed(image, frame, 0);
  return false;
}

void Segment::Impl::say_send_failed(const ProcessImage& image, const image::CanFrame& frame,
                                    NodeId node) noexcept {
  // That a bus is off or down is said in its own words, and why nothing goes out.
  const image::CanState state = bus.state();
  if (state == image::CanState::bus_off || state == image::CanState::down) return;
  if (!send_failed.pass(image.now.t_ns)) return;
  say_frame(BusEventKind::send_failed, image, frame, node,
            static_cast<std::int64_t>(send_failures - send_failures_said));
  send_failures_said = send_failures;
}

/// One of each service in a cycle.
void Segment::Impl::on_leading(const CobId& cob, const image::CanFrame& frame,
                               const ProcessImage& image) noexcept {
  if (foreign_cycle != image.now.number) foreign_said.reset();
  foreign_cycle = image.now.number;
  if (foreign_said.test(static_cast<std::size_t>(cob.service))) return;
  foreign_said.set(static_cast<std::size_t>(cob.service));
  say_frame(BusEventKind::foreign_frame, image, frame, cob.node);
}

/// Of somebody else's nodes nothing is said; but to whoever has just come back they tell of another control.
bool Segment::Impl::concerns_us(const CobId& cob) const noexcept {
  return lead.silent() || cob.service == Service::nmt || cob.service == Service::sync ||
         cob.node == config.own_node || index_of[cob.node] >= 0;
}

void Segment::Impl::on_request(const CobId& cob, const image::CanFrame& frame,
                               const ProcessImage& image) noexcept {
  if (foreign_request.pass(image.now.t_ns)) say_frame(BusEventKind::foreign_request, image, frame, cob.node);
}

/// Behind the frames of a cycle. Somebody who leads the bus counts until it has been silent for a while, so
/// that no power comes on between two of its frames.
void Segment::Impl::watch_lead(const ProcessImage& image) noexcept {
  if (lead.lost()) {
    if (lead_lost.pass(image.now.t_ns))
      say_frame(BusEventKind::lead_lost, image, lead.other(), 0, lead.away() / image::kMillisecond);
    return;
  }
  if (!lead.other_there(image.now.t_ns) || foreign_cycle == image.now.number) return;
  const image::CanFrame& frame = lead.other();
  say_frame(BusEventKind::foreign_frame, image, frame, classify(frame.id, frame.extended).node);
}

void Segment::Impl::dispatch(const image::CanFrame& frame, const ProcessImage& image) noexcept {
  if (frame.error || frame.fd || lead.lost()) return;
  const CobId cob = classify(frame.id, frame.extended);
  // What was said before the control began is nothing against it.
  if ((heard || lead.silent()) && concerns_us(cob) && lead.on_frame(frame, image.now.t_ns)) {
    if (!lead.lost()) on_leading(cob, frame, image);
    return;
  }
  if (frame.remote) return;
  switch (cob.service) {
    case Service::sdo_request:
      if (heard && index_of[cob.node] >= 0) on_request(cob, frame, image);
      return;
    case Service::tpdo1:
    case Service::tpdo2:
    case Service::tpdo3:
    case Service::tpdo4:
    case Service::sdo_response:
    case Service::emcy:
    case Service::heartbeat:
      break;
    default:
      return;
  }
  if (const int i = index_of[cob.node]; i >= 0)
    return nodes[static_cast<std::size_t>(i)].on_frame(cob.service, frame, context(image));
  if (cob.service != Service::emcy && cob.service != Service::heartbeat) return;
  if (cob.node == config.own_node) return heard ? on_request(cob, frame, image) : void();
  if (unknown_said.test(cob.node)) return;
  unknown_said.set(cob.node);
  say_frame(BusEventKind::unknown_node, image, frame, cob.node);
}

void Segment::Impl::watch_bus(const ProcessImage& image) noexcept {
  const image::CanState now = bus.state();
  if (now == bus_state) return;
  bus_state = now;
  BusEvent e = event(BusEventKind::bus_state, image);
  e.bus_state = now;
  ring.push(e);
}

void Segment::Impl::drain(ProcessImage& image) noexcept {
  image::CanFrame frame;
  int n = 0;
  while (n < kMaxFramesPerCycle && bus.receive(frame)) ++n, dispatch(frame, image);
  heard = heard || n < kMaxFramesPerCycle;
  lead.look_on(n < kMaxFramesPerCycle);
  watch_lead(image);
  for (BusNode& node : nodes) node.evaluate(image, context(image));
}

void Segment::Impl::send_heartbeat(const ProcessImage& image) noexcept {
  if (image.now.t_ns < heartbeat_due_ns) return;
  if (!send_own(image, heartbeat_frame(config.own_node, NmtState::operational))) return;
  const image::Nanoseconds period = config.heartbeat_ms * image::kMillisecond;
  heartbeat_due_ns += period;
  // After a gap in time the rhythm starts anew instead of catching up.
  if (heartbeat_due_ns <= image.now.t_ns) heartbeat_due_ns = image.now.t_ns + period;
}

// Source: CiA 301, 7.2.5: the counter begins with 1 and goes to the overflow value.
image::CanFrame Segment::Impl::next_sync() noexcept {
  if (config.sync_counter_overflow == 0) return make_frame(cob::kSync, {});
  sync_counter = static_cast<std::uint8_t>(sync_counter % config.sync_counter_overflow + 1);
  return make_frame(cob::kSync, {&sync_counter, 1});
}

// Before 1019h is written a counter is an error for the node (8240h), so the first one waits for all that
// answer.
bool Segment::Impl::sync_may_run() const noexcept {
  return config.sync_counter_overflow == 0 || std::ranges::all_of(nodes, &BusNode::ready_for_sync);
}

void Segment::Impl::send_time(const ProcessImage& image) noexcept {
  if (config.time_ms <= 0 || image.now.t_ns < time_due_ns) return;
  if (!send_own(image, time_frame(config.time_at_start.after(image.now.t_ns)))) return;
  time_due_ns = image.now.t_ns + config.time_ms * image::kMillisecond;
}

void Segment::Impl::send_acyclic(const ProcessImage& image) noexcept {
  int budget = config.sdo_frames_per_cycle;
  sdo.refill(nodes);
  const std::size_t count = nodes.size();
  for (std::size_t i = 0; i < count && budget > 0 && sdo.enough(); ++i) {
    const std::size_t turn = (next_acyclic + i) % count;
    if (!nodes[turn].send_acyclic(context(image))) continue;
    --budget;
    sdo.take();
    // Whoever did not come to its turn is first in the next cycle.
    if (budget == 0 || !sdo.enough()) next_acyclic = (turn + 1) % count;
  }
}

void Segment::Impl::fill_status(image::SegmentStatus& status) const noexcept {
  status.load = bus.meter.load();
  status.load_worst_cycle = bus.meter.worst_cycle();
  status.frames_sent = bus.sent;
  status.frames_received = bus.received;
  status.errors = bus.errors + send_failures;
  status.operational = !nodes.empty();
  for (const BusNode& node : nodes) {
    status.operational = status.operational && node.online();
    image::BusNodeStatus& told = status.nodes[node.id()];
    told.online = node.online();
    const auto state = node.nmt_state();
    told.nmt_state = state ? static_cast<std::uint8_t>(*state) : image::BusNodeStatus::kSilent;
  }
}

Segment::Segment(image::CanBus& bus, SegmentConfig config)
    : impl_(std::make_unique<Impl>(bus, std::move(config))) {}
Segment::~Segment() = default;

void Segment::came_back(image::Nanoseconds away) noexcept { impl_->lead.came_back(away); }
void Segment::listened() noexcept { impl_->heard = true; }

void Segment::open_cycle(ProcessImage& image) noexcept {
  Impl& my = *impl_;
  if (my.started) my.bus.meter.close_cycle(image.now.period_ns, my.bus.bit_rate());
  if (!my.started) my.heartbeat_due_ns = image.now.t_ns;
  my.started = true;
  my.watch_bus(image);
  my.sync_runs = my.sync_runs || my.sync_may_run();
  if (my.sync_runs && !my.lead.silent()) my.send_own(image, my.next_sync());
}

void Segment::receive(ProcessImage& image) noexcept {
  Impl& my = *impl_;
  my.drain(image);
  my.fill_status(image.segments[static_cast<std::size_t>(my.config.index)]);
}

void Segment::send(ProcessImage& image) noexcept {
  Impl& my = *impl_;
  if (my.lead.silent()) return;
  for (BusNode& node : my.nodes) {
    image::CanFrame dropped;
    const int lost = node.send_process_data(image, my.context(image), dropped);
    my.send_failures += static_cast<std::uint64_t>(lost);
    if (lost > 0) my.say_send_failed(image, dropped, node.id());
  }
  my.send_heartbeat(image);
  my.send_time(image);
  my.send_acyclic(image);
}

bool Segment::leave(image::Nanoseconds now) noexcept {
  Impl& my = *impl_;
  if (my.lead.silent() || my.lead.other_there(now)) return true;
  const NodeContext context{static_cast<std::int16_t>(my.config.index), 0, now, my.bus, my.ring, my.question};
  image::CanFrame frame;
  for (int n = 0; n < kMaxFramesPerCycle && my.bus.receive(frame); ++n) {
    const CobId cob = classify(frame.id, frame.extended);
    const bool answer = cob.service == Service::sdo_response && !frame.error && !frame.remote && !frame.fd;
    if (const int i = answer ? my.index_of[cob.node] : -1; i >= 0)
      my.nodes[static_cast<std::size_t>(i)].on_frame(cob.service, frame, context);
  }
  if (now >= my.heartbeat_due_ns && my.bus.send(heartbeat_frame(my.config.own_node, NmtState::operational)))
    my.heartbeat_due_ns = now + my.config.heartbeat_ms * image::kMillisecond;
  bool done = true;
  for (BusNode& node : my.nodes) done = node.leave(context) && done;
  return done;
}

ObjectQuestion& Segment::question() noexcept { return impl_->question; }
BusEventRing& Segment::events() noexcept { return impl_->ring; }
const SegmentConfig& Segment::config() const noexcept { return impl_->config; }

NodeStatus Segment::node_status(std::size_t i) const noexcept {
  const BusNode& node = impl_->nodes[i];
  const NodeIdentity& identity = node.identity();
  return {node.id(),
          node.online(),
          node.boot_report(),
          identity.device_type,
          identity.vendor_id,
          identity.product_code,
          identity.revision,
          identity.serial,
          node.emcy_history().count()};
}

}  // namespace servogate::canopen
