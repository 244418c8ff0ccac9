// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/bus_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "drivers/candump/candump_line.hpp"
#include "drivers/clock.hpp"
#include "firmware_if/canopen/306/value_text.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/control/run/exit_code.hpp"

namespace servogate::gateway::command {
namespace {

namespace object = canopen::object;
using canopen::MappingEntry;
using canopen::OperationMode;

const text::Entry kNoScale{"bench.no-scale", "node {0} does not say its {1}: give it with {2}",
                           "узел {0} не сообщает {1}: задайте ключом {2}"};
const text::Entry kNoBoot{"bench.no-boot", "node {0} did not come into operation within {1} s; {2}",
                          "узел {0} не начал работу за {1} с; {2}"};
const text::Entry kNotSet{"bench.not-set", "{0} of node {1} cannot be set: {2}",
                          "{0} узла {1} не записывается: {2}"};
const text::Entry kTorqueCapped{"bench.torque-capped",
                                "6072h of node {0} allows {1} N m, less than --torque. If that is not meant, "
                                "write its value anew: a run that "
                                "was cut off may have left it",
                                "6072h узла {0} допускает {1} Н·м, меньше --torque. Если так не задумано, "
                                "запишите значение заново: его мог "
                                "оставить оборванный прогон"};
const text::Entry kNoQuickStop{"bench.no-quick-stop",
                               "node {0} does not say how hard its quick stop brakes ({1}): --travel is "
                               "where a stop begins, not where it ends",
                               "узел {0} не сообщает, как тормозит его быстрый останов ({1}): --travel — где "
                               "останов начинается, а не где "
                               "кончается"};

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kBootSeconds = 15;
constexpr std::uint16_t kRatedTorque = 0x6076;

std::optional<std::int64_t> number(ToolBus& bus, int node, std::uint16_t index, std::uint8_t sub = 0) {
  const SdoOutcome outcome = bus.read(static_cast<canopen::NodeId>(node), index, sub);
  if (!outcome.ok() || outcome.data.empty() || outcome.data.size() > 4) return std::nullopt;
  std::int64_t value = 0;
  for (std::size_t i = 0; i < outcome.data.size(); ++i) value |= std::int64_t{outcome.data[i]} << (8 * i);
  return value;
}

/// One unit of 60FFh and 6081h in counts/s.
double velocity_unit(const BenchOptions& options, const DriveFacts& facts) {
  const double rpm = facts.counts_per_rev / 60.0;
  return options.velocity_unit == "rpm" ? rpm : options.velocity_unit == "0.1rpm" ? 0.1 * rpm : 1.0;
}

/// One unit of 6042h in counts/s: a turn a minute, times 604Bh, times 604Ch.
double vl_unit(ToolBus& bus, const BenchOptions& options, const DriveFacts& facts) {
  double unit = facts.counts_per_rev / 60.0;
  for (const std::uint16_t factor : {object::kVlSetpointFactor, object::kVlDimensionFactor}) {
    const auto over = number(bus, options.node, factor, 1), under = number(bus, options.node, factor, 2);
    if (over && under && *over != 0 && *under != 0)
      unit *= static_cast<double>(*over) / static_cast<double>(*under);
  }
  return unit;
}

/// Where the deceleration of its quick stop stands. Source: CiA 402-2, 605Ah: 1 and 5 take the slow down
/// ramp, 2 and 6 the quick stop ramp, 3, 4, 7 and 8 all the torque there is, and 0 lets the motor coast.
std::uint16_t quick_stop_ramp(ToolBus& bus, int node) {
  switch (number(bus, node, object::kQuickStopOption).value_or(2)) {
    case 1:
    case 5:
      return object::kProfileDeceleration;
    case 2:
    case 6:
      return object::kQuickStopDeceleration;
    default:
      return 0;
  }
}

/// rev/s2; 0: it does not say.
double quick_stop_of(ToolBus& bus, const BenchOptions& options, const DriveUse& use,
                     const DriveFacts& facts) {
  if (use.velocity == OperationMode::velocity) {
    const auto speed = number(bus, options.node, object::kVlQuickStop, 1);
    const auto time = number(bus, options.node, object::kVlQuickStop, 2);
    if (!speed || !time || *time <= 0) return 0.0;
    return static_cast<double>(*speed) / static_cast<double>(*time) * vl_unit(bus, options, facts) /
           facts.counts_per_rev;
  }
  const std::uint16_t ramp = quick_stop_ramp(bus, options.node);
  const auto value = ramp != 0 ? number(bus, options.node, ramp) : std::nullopt;
  return value && *value > 0
             ? static_cast<double>(*value) * velocity_unit(options, facts) / facts.counts_per_rev
             : 0.0;
}

DriveFacts read_facts(ToolBus& bus, const BenchOptions& options) {
  DriveFacts f;
  const int node = options.node;
  f.counts_per_rev = options.counts_per_rev;
  f.rated_torque_nm = options.rated_torque_nm;
  if (f.counts_per_rev == 0.0) {
    const auto counts = number(bus, node, object::kPositionEncoderResolution, 1);
    const auto turns = number(bus, node, object::kPositionEncoderResolution, 2);
    if (counts && *counts > 0)
      f.counts_per_rev =
          static_cast<double>(*counts) / static_cast<double>(std::max<std::int64_t>(1, turns.value_or(1)));
  }
  if (f.rated_torque_nm == 0.0)
    f.rated_torque_nm = static_cast<double>(number(bus, node, kRatedTorque).value_or(0)) / 1000.0;
  const SdoOutcome name = bus.read(static_cast<canopen::NodeId>(node), object::kDeviceName, 0);
  if (name.ok()) f.name.assign(name.data.begin(), name.data.end());
  f.vendor = number(bus, node, object::kIdentity, 1);
  f.product = number(bus, node, object::kIdentity, 2);
  f.revision = number(bus, node, object::kIdentity, 3);
  f.serial = number(bus, node, object::kIdentity, 4);
  f.dc_link_mv = number(bus, node, object::kDcLinkVoltage);
  return f;
}

canopen::PdoWanted pdo(std::initializer_list<MappingEntry> entries) {
  canopen::PdoWanted wanted;
  for (const MappingEntry& e : entries) wanted.mapping.add(e);
  return wanted;
}
MappingEntry entry(std::uint16_t index, std::uint8_t bits) { return {index, 0, bits}; }

canopen::NodeConfig node_of(ToolBus& bus, const BenchOptions& options, const DriveUse& use,
                            const DriveFacts& facts, const ObjectRecorder& recorder) {
  canopen::NodeConfig node;
  node.node = static_cast<canopen::NodeId>(options.node);
  node.name = "bench";
  canopen::DriveProfile& p = node.profile;
  p.counts_per_rev = std::max<std::int64_t>(4, std::llround(facts.counts_per_rev));
  p.velocity_unit_counts_s = velocity_unit(options, facts);
  p.position_mode = use.position;
  p.velocity_mode = use.velocity;
  p.torque_mode = use.torque;
  p.rpdo[0] = pdo({entry(object::kControlword, 16), entry(object::kTargetTorque, 16),
                   entry(object::kModesOfOperation, 8)});
  p.rpdo[1] = pdo({entry(object::kTargetPosition, 32), entry(object::kTargetVelocity, 32)});
  if (use.velocity == OperationMode::velocity) {
    p.rpdo[2] = pdo({entry(object::kVlTargetVelocity, 16)});
    p.vl_unit_counts_s = vl_unit(bus, options, facts);
  }
  p.tpdo[0] = pdo(
      {entry(object::kStatusword, 16), entry(object::kPositionActual, 32), entry(object::kTorqueActual, 16)});
  p.tpdo[1] = pdo({entry(object::kModesOfOperationDisplay, 8), entry(object::kErrorCode, 16)});
  for (int i = 0; i < 2; ++i)
    p.tpdo[static_cast<std::size_t>(ObjectRecorder::kFirstPdo + i)].mapping = recorder.mapping(i);
  p.modes = use.modes;
  p.check_modes = use.modes != 0;
  return node;
}

}  // namespace

/// Sees what passes and writes it down.
class BusDrive::Tap final : public image::CanBus {
 public:
  Tap(ToolBus& tool, const std::vector<Axis>& axes, const std::string& file)
      : tool_(tool), bus_(*tool.transport().bus), axes_(axes) {
    if (!file.empty()) log_.open(file);
  }
  bool send(const image::CanFrame& frame) noexcept override {
    if (frame.id == canopen::cob::kSync && !frame.extended) {
      sync_ns = tool_.now();
      if (times) times->sync.add(sync_ns - due_ns);
      answered_ = false;
    }
    const bool taken = bus_.send(frame);
    if (taken) write(frame);
    return taken;
  }
  bool receive(image::CanFrame& frame) noexcept override {
    const bool came = bus_.receive(frame);
    if (came) {
      for (const Axis& axis : axes_) axis.recorder->on_frame(frame);
      // Its own time of arrival: it may be read a cycle later.
      if (times && !answered_ && frame.id == 0x180u + node && !frame.extended) {
        answered_ = true;
        times->round_trip.add(frame.timestamp_ns - sync_ns);
      }
      write(frame);
    }
    return came;
  }
  image::CanState state() const noexcept override { return bus_.state(); }
  std::uint32_t bit_rate() const noexcept override { return tool_.bit_rate(); }
  std::uint64_t lost() const noexcept override { return bus_.lost(); }

  struct Times {
    report::Histogram sync, round_trip;
  };
  std::optional<Times> times;
  image::Nanoseconds due_ns = 0, sync_ns = 0;
  canopen::NodeId node = 0;

 private:
  void write(const image::CanFrame& frame) {
    if (log_.is_open()) log_ << candump::format(frame, tool_.now(), "bench") << '\n';
  }
  ToolBus& tool_;
  image::CanBus& bus_;
  const std::vector<Axis>& axes_;
  std::ofstream log_;
  bool answered_ = true;
};

BusDrive::BusDrive(ToolBus& bus, const BenchOptions& options, const DriveUse& use, std::vector<Axis> axes,
                   const std::string& log)
    : bus_(bus),
      period_ns_(std::llround(options.cycle_us * 1e3)),
      use_(use),
      axes_(std::move(axes)),
      tap_(std::make_unique<Tap>(bus, axes_, log)),
      image_(std::make_unique<image::ProcessImage>()),
      begin_ns_(bus.now()),
      start_ns_(begin_ns_) {
  canopen::SegmentConfig config;
  config.name = "bench";
  config.cycle_ns = period_ns_;
  for (const Axis& axis : axes_) {
    config.nodes.push_back(node_of(bus, axis.options, use, axis.facts, *axis.recorder));
    config.nodes.back().target_index = static_cast<int>(config.nodes.size()) - 1;
  }
  segment_ = std::make_unique<canopen::Segment>(*tap_, config);
  image_->axis_count = static_cast<int>(axes_.size());
  image_->now.period_ns = period_ns_;
}

bool BusDrive::put_right(ToolBus& bus, const BenchOptions& options) {
  bool all = true;
  for (const BenchOptions& one : each_drive(options)) {
    const DriveMark mark{one.bus, static_cast<canopen::NodeId>(one.node),
                         number(bus, one.node, object::kIdentity, 2),
                         number(bus, one.node, object::kIdentity, 4)};
    all = command::put_right(bus, mark, options.out) && all;
  }
  return all;
}

bool BusDrive::prepare(Axis& axis) {
  const BenchOptions& options = axis.options;
  const DriveFacts& f = axis.facts;
  const std::string node = std::to_string(options.node);
  std::vector<std::pair<std::uint16_t, double>> wanted;
  if (use_.moves) {
    axis.facts.quick_stop_rev_s2 = quick_stop_of(bus_, options, use_, f);
    if (f.quick_stop_rev_s2 == 0.0) complain(kNoQuickStop, {node, "605Ah, 6085h"});
    const double most = static_cast<double>(number(bus_, options.node, object::kMaxTorque).value_or(65535));
    const double torque = options.torque_nm / f.rated_torque_nm * 1000.0;
    if (most < std::floor(torque))
      complain(kTorqueCapped, {node, text::number(most * f.rated_torque_nm / 1000.0, 4)});
    wanted.emplace_back(object::kMaxTorque, std::min(torque, most));
  }
  if (use_.profile_speed_rev_s > 0.0)
    wanted.emplace_back(object::kProfileVelocity,
                        use_.profile_speed_rev_s * f.counts_per_rev / velocity_unit(options, f));
  if (use_.profile_acceleration > 0.0)
    for (const std::uint16_t index : {object::kProfileAcceleration, object::kProfileDeceleration})
      wanted.emplace_back(index, use_.profile_acceleration * f.counts_per_rev / velocity_unit(options, f));
  for (const auto& [index, value] : wanted)
    if (const std::string why = axis.changed->change(index, std::llround(value)); !why.empty()) {
      complain(kNotSet, {canopen::address_text(index, 0), node, why});
      return false;
    }
  return true;
}

std::vector<BenchOptions> each_drive(const BenchOptions& options) {
  std::vector<BenchOptions> out{options};
  for (const int node : options.with) {
    out.push_back(options);
    out.back().node = node;
    out.back().out += "/node" + std::to_string(node);
  }
  return out;
}

std::unique_ptr<BusDrive> BusDrive::open(ToolBus& bus, const BenchOptions& options, const DriveUse& use,
                                         const std::string& log, int& code) {
  code = kAlarm;
  std::vector<Axis> axes;
  for (const BenchOptions& one : each_drive(options)) {
    DriveFacts facts = read_facts(bus, one);
    const std::string node = std::to_string(one.node);
    if (use.moves && !(facts.counts_per_rev >= 4.0)) {
      complain(kNoScale, {node, "608Fh", "--counts"});
      return nullptr;
    }
    if (use.moves && !(facts.rated_torque_nm > 0.0)) {
      complain(kNoScale, {node, "6076h", "--rated-torque"});
      return nullptr;
    }
    const auto id = static_cast<canopen::NodeId>(one.node);
    axes.push_back(
        {one,
         facts,
         std::make_unique<ObjectRecorder>(id, use.record),
         std::make_unique<ChangedObjects>(bus, DriveMark{one.bus, id, facts.product, facts.serial}, one.out),
         {}});
  }
  std::unique_ptr<BusDrive> drive(new BusDrive(bus, options, use, std::move(axes), log));
  for (Axis& axis : drive->axes_)
    if (!drive->prepare(axis)) return nullptr;
  drive->begin_ns_ = drive->start_ns_ = bus.now();
  if (drive->boot()) return drive;
  complain(kNoBoot, {std::to_string(options.node), std::to_string(kBootSeconds), drive->said_});
  return nullptr;
}

BusDrive::~BusDrive() { leave(); }

void BusDrive::leave() {
  if (std::exchange(left_, true)) return;
  bus_.ignore_signals();
  for (int i = 0; i < 1000 && !segment_->leave(image_->now.t_ns); ++i) {
    image_->now.t_ns += period_ns_;
    if (!bus_.wait_until(start_ns_ + image_->now.t_ns)) return;
  }
  for (Axis& axis : axes_) axis.changed->restore();
}

bool BusDrive::boot() {
  const std::vector<bench::DriveAsk> asks(axes_.size());
  std::vector<bench::DriveAnswer> answers(axes_.size());
  for (double t = 0.0; t < kBootSeconds && !bus_.over(); t += period_s()) {
    if (!cycle_all(asks, answers)) return false;
    if (std::all_of(answers.begin(), answers.end(), [](const auto& a) { return a.online; })) return true;
  }
  return false;
}

double BusDrive::period_s() const noexcept { return static_cast<double>(period_ns_) * 1e-9; }

bool BusDrive::cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) {
  return cycle_all(std::span(&ask, 1), std::span(&answer, 1));
}

bool BusDrive::cycle_all(std::span<const bench::DriveAsk> asks, std::span<bench::DriveAnswer> answers) {
  image::Nanoseconds due = start_ns_ + image_->now.t_ns;
  if (!bus_.wait_until(due)) return false;
  // SYNCs that make up for a computer that stood still would come faster than the drive can answer.
  if (const image::Nanoseconds late = bus_.now() - due; late > period_ns_) {
    start_ns_ += late;
    due += late;
    ++late_;
  }
  exchange(due, asks, answers);
  return true;
}

bool BusDrive::cycle_at(image::Nanoseconds due, const bench::DriveAsk& ask, bench::DriveAnswer& answer) {
  exchange(due, std::span(&ask, 1), std::span(&answer, 1));
  return !bus_.gone();
}

void BusDrive::begin_times() {
  tap_->node = static_cast<canopen::NodeId>(axes_.front().options.node);
  tap_->times.emplace();
}
const report::Histogram& BusDrive::sync_lateness() const { return tap_->times->sync; }
const report::Histogram& BusDrive::round_trip() const { return tap_->times->round_trip; }

void BusDrive::read_answer(Axis& axis, const image::DriveFeedback& feedback,
                           bench::DriveAnswer& answer) const {
  answer.online = feedback.online && feedback.missed == 0;
  answer.faulted = feedback.state == image::DriveState::fault ||
                   feedback.state == image::DriveState::fault_reaction_active;
  answer.enabled = feedback.state == image::DriveState::operation_enabled;
  answer.statusword = feedback.statusword;
  answer.error_code = feedback.error_code;
  if (!feedback.online) return;
  if (!axis.zero_counts) axis.zero_counts = feedback.position_counts;
  answer.position_rad =
      static_cast<double>(feedback.position_counts - *axis.zero_counts) * kTurn / axis.facts.counts_per_rev;
  answer.torque_nm = feedback.torque_permille * axis.facts.rated_torque_nm / 1000.0;
}

void BusDrive::write_command(const Axis& axis, const bench::DriveAsk& ask, image::AxisImage& image) const {
  const double counts_per_rad = axis.facts.counts_per_rev / kTurn;
  constexpr image::DriveMode kModes[] = {image::DriveMode::csp, image::DriveMode::csv, image::DriveMode::cst};
  image::DriveCommand& command = image.drive_command;
  command.power = ask.power;
  command.quick_stop = ask.quick_stop;
  command.mode = kModes[static_cast<int>(ask.loop)];
  command.position_counts = ask.loop == bench::Loop::position && axis.zero_counts
                                ? *axis.zero_counts + std::llround(ask.value * counts_per_rad)
                                : image.drive.position_counts;
  command.velocity_counts_s = ask.loop == bench::Loop::velocity ? ask.value * counts_per_rad : 0.0;
  command.torque_permille =
      ask.loop == bench::Loop::torque ? ask.value / axis.facts.rated_torque_nm * 1000.0 : 0.0;
}

void BusDrive::exchange(image::Nanoseconds due, std::span<const bench::DriveAsk> asks,
                        std::span<bench::DriveAnswer> answers) {
  if (bus_.now() - due > period_ns_ / 2) ++late_;
  tap_->due_ns = due;
  const double latched_s =
      static_cast<double>(opened_ns_) * 1e-9;  // what comes now was latched by the SYNC before
  opened_ns_ = bus_.now() - begin_ns_;
  segment_->open_cycle(*image_);
  segment_->receive(*image_);
  for (const Axis& axis : axes_) axis.recorder->end_cycle();
  canopen::BusEvent event;
  while (segment_->events().pop(event))
    said_ = canopen::describe(event, "bench", nullptr, text::user_language());
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    answers[k].time_s = latched_s;
    read_answer(axes_[k], image_->axes[k].drive, answers[k]);
    write_command(axes_[k], asks[k], image_->axes[k]);
  }
  segment_->send(*image_);
  ++image_->now.number;
  image_->now.t_ns += period_ns_;
}

}  // namespace servogate::gateway::command
