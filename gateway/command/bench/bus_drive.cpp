// SPDX-License-Identifier: Apache-2.0
#include "gateway/command/bench/bus_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/candump/candump_line.hpp"
#include "drivers/clock.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/control/run/exit_code.hpp"

namespace servogate::gateway::command {
namespace {

namespace object = canopen::object;
using canopen::MappingEntry;
using canopen::OperationMode;
using canopen::supported_bit;

const text::Entry kNoScale{"bench.no-scale", "node {0} does not say its {1}: give it with {2}",
                           "узел {0} не сообщает {1}: задайте ключом {2}"};
const text::Entry kNoBoot{"bench.no-boot", "node {0} did not come into operation within {1} s; {2}",
                          "узел {0} не начал работу за {1} с; {2}"};
const text::Entry kNoLimit{"bench.no-limit", "the torque limit 6072h of node {0} cannot be set: {1}",
                           "предел момента 6072h узла {0} не записывается: {1}"};
const text::Entry kNotRestored{"bench.not-restored",
                               "the torque limit 6072h of node {0} is still {1}, it was {2}",
                               "предел момента 6072h узла {0} остался {1}, а был {2}"};

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

SdoOutcome write_word(ToolBus& bus, canopen::NodeId node, std::uint16_t index, std::int64_t value) {
  const std::uint8_t bytes[] = {static_cast<std::uint8_t>(value & 0xFF),
                                static_cast<std::uint8_t>(value >> 8 & 0xFF)};
  return bus.write(node, index, 0, bytes);
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

canopen::SegmentConfig segment_of(const BenchOptions& options, const DriveFacts& facts) {
  canopen::NodeConfig node;
  node.node = static_cast<canopen::NodeId>(options.node);
  node.name = "bench";
  canopen::DriveProfile& p = node.profile;
  p.counts_per_rev = std::llround(facts.counts_per_rev);
  p.rpdo[0] = pdo({entry(object::kControlword, 16), entry(object::kTargetTorque, 16),
                   entry(object::kModesOfOperation, 8)});
  p.rpdo[1] = pdo({entry(object::kTargetPosition, 32), entry(object::kTargetVelocity, 32)});
  p.tpdo[0] = pdo(
      {entry(object::kStatusword, 16), entry(object::kPositionActual, 32), entry(object::kTorqueActual, 16)});
  p.tpdo[1] = pdo({entry(object::kModesOfOperationDisplay, 8), entry(object::kErrorCode, 16)});
  p.modes = supported_bit(OperationMode::cyclic_sync_position) |
            supported_bit(OperationMode::cyclic_sync_velocity) |
            supported_bit(OperationMode::cyclic_sync_torque);
  canopen::SegmentConfig config;
  config.name = "bench";
  config.cycle_ns = std::llround(options.cycle_us * 1e3);
  config.nodes.push_back(node);
  return config;
}

}  // namespace

/// Sees what passes and writes it down.
class BusDrive::Tap final : public image::CanBus {
 public:
  Tap(ToolBus& tool, const std::string& file) : tool_(tool), bus_(*tool.transport().bus) {
    if (!file.empty()) log_.open(file);
  }
  bool send(const image::CanFrame& frame) noexcept override {
    const bool taken = bus_.send(frame);
    if (taken) write(frame);
    return taken;
  }
  bool receive(image::CanFrame& frame) noexcept override {
    const bool came = bus_.receive(frame);
    if (came) write(frame);
    return came;
  }
  image::CanState state() const noexcept override { return bus_.state(); }
  std::uint32_t bit_rate() const noexcept override { return tool_.bit_rate(); }
  std::uint64_t lost() const noexcept override { return bus_.lost(); }

 private:
  void write(const image::CanFrame& frame) {
    if (log_.is_open()) log_ << candump::format(frame, tool_.now(), "bench") << '\n';
  }
  ToolBus& tool_;
  image::CanBus& bus_;
  std::ofstream log_;
};

BusDrive::BusDrive(ToolBus& bus, const BenchOptions& options, DriveFacts facts, const std::string& log)
    : bus_(bus),
      node_(static_cast<canopen::NodeId>(options.node)),
      period_ns_(std::llround(options.cycle_us * 1e3)),
      facts_(std::move(facts)),
      tap_(std::make_unique<Tap>(bus, log)),
      segment_(std::make_unique<canopen::Segment>(*tap_, segment_of(options, facts_))),
      image_(std::make_unique<image::ProcessImage>()),
      start_ns_(bus.now()) {
  image_->axis_count = 1;
  image_->now.period_ns = period_ns_;
}

std::unique_ptr<BusDrive> BusDrive::open(ToolBus& bus, const BenchOptions& options, const std::string& log,
                                         int& code) {
  DriveFacts facts = read_facts(bus, options);
  const std::string node = std::to_string(options.node);
  code = kAlarm;
  if (!(facts.counts_per_rev >= 4.0)) {
    complain(kNoScale, {node, "608Fh", "--counts"});
    return nullptr;
  }
  if (!(facts.rated_torque_nm > 0.0)) {
    complain(kNoScale, {node, "6076h", "--rated-torque"});
    return nullptr;
  }
  const auto before = number(bus, options.node, object::kMaxTorque);
  const std::int64_t limit = std::min<std::int64_t>(
      std::llround(options.torque_nm / facts.rated_torque_nm * 1000.0), before.value_or(65535));
  if (before) {
    const SdoOutcome outcome =
        write_word(bus, static_cast<canopen::NodeId>(options.node), object::kMaxTorque, limit);
    if (!outcome.ok()) {
      complain(kNoLimit, {node, outcome.why()});
      return nullptr;
    }
  }
  std::unique_ptr<BusDrive> drive(new BusDrive(bus, options, std::move(facts), log));
  drive->torque_limit_before_ = before;
  if (drive->boot()) return drive;
  complain(kNoBoot, {node, std::to_string(kBootSeconds), drive->said_});
  return nullptr;
}

BusDrive::~BusDrive() {
  bus_.ignore_signals();
  for (int i = 0; i < 1000 && !segment_->leave(image_->now.t_ns); ++i) {
    image_->now.t_ns += period_ns_;
    if (!bus_.wait_until(start_ns_ + image_->now.t_ns)) return;
  }
  if (!torque_limit_before_) return;
  if (!write_word(bus_, node_, object::kMaxTorque, *torque_limit_before_).ok())
    complain(kNotRestored, {std::to_string(node_), "?", std::to_string(*torque_limit_before_)});
}

bool BusDrive::boot() {
  bench::DriveAnswer answer;
  for (double t = 0.0; t < kBootSeconds && !bus_.over(); t += period_s()) {
    if (!cycle({}, answer)) return false;
    if (answer.online) return true;
  }
  return false;
}

double BusDrive::period_s() const noexcept { return static_cast<double>(period_ns_) * 1e-9; }

bool BusDrive::cycle(const bench::DriveAsk& ask, bench::DriveAnswer& answer) {
  const image::Nanoseconds due = start_ns_ + image_->now.t_ns;
  if (!bus_.wait_until(due)) return false;
  if (bus_.now() - due > period_ns_ / 2) ++late_;
  segment_->open_cycle(*image_);
  segment_->receive(*image_);
  canopen::BusEvent event;
  while (segment_->events().pop(event))
    said_ = canopen::describe(event, "bench", nullptr, text::user_language());

  image::AxisImage& axis = image_->axes[0];
  const image::DriveFeedback& feedback = axis.drive;
  const double rad_per_count = kTurn / facts_.counts_per_rev;
  const image::DriveMode modes[] = {image::DriveMode::csp, image::DriveMode::csv, image::DriveMode::cst};
  const image::DriveMode mode = modes[static_cast<int>(ask.loop)];
  answer.online = feedback.online && feedback.missed == 0;
  answer.faulted = feedback.state == image::DriveState::fault ||
                   feedback.state == image::DriveState::fault_reaction_active;
  answer.enabled = feedback.state == image::DriveState::operation_enabled;
  answer.statusword = feedback.statusword;
  answer.error_code = feedback.error_code;
  if (feedback.online) {
    if (!zero_counts_) zero_counts_ = feedback.position_counts;
    answer.position_rad = static_cast<double>(feedback.position_counts - *zero_counts_) * rad_per_count;
    answer.torque_nm = feedback.torque_permille * facts_.rated_torque_nm / 1000.0;
  }
  image::DriveCommand& command = axis.drive_command;
  command.power = ask.power;
  command.quick_stop = ask.quick_stop;
  command.mode = mode;
  command.position_counts = ask.loop == bench::Loop::position && zero_counts_
                                ? *zero_counts_ + std::llround(ask.value / rad_per_count)
                                : feedback.position_counts;
  command.velocity_counts_s = ask.loop == bench::Loop::velocity ? ask.value / rad_per_count : 0.0;
  command.torque_permille =
      ask.loop == bench::Loop::torque ? ask.value / facts_.rated_torque_nm * 1000.0 : 0.0;
  segment_->send(*image_);
  ++image_->now.number;
  image_->now.t_ns += period_ns_;
  return true;
}

}  // namespace servogate::gateway::command
