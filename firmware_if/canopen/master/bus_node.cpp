// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/canopen/master/bus_node.hpp"

#include <algorithm>

#include "firmware_if/canopen/301/nmt.hpp"
#include "firmware_if/canopen/402/objects.hpp"
#include "firmware_if/canopen/402/statusword.hpp"

namespace servogate::canopen {
namespace {

image::DriveFeedback& feedback_of(image::ProcessImage& image, const NodeConfig& node) noexcept {
  const auto i = static_cast<std::size_t>(node.target_index);
  return node.target == DriveTarget::axis ? image.axes[i].drive : image.spindles[i].drive;
}

const image::DriveCommand& command_of(const image::ProcessImage& image, const NodeConfig& node) noexcept {
  const auto i = static_cast<std::size_t>(node.target_index);
  return node.target == DriveTarget::axis ? image.axes[i].drive_command : image.spindles[i].drive_command;
}

bool same_failure(const BootReport& a, const BootReport& b) noexcept {
  return a.step == b.step && a.problem == b.problem && a.index == b.index && a.subindex == b.subindex;
}

}  // namespace

BusNode::BusNode(const NodeConfig& config, const SegmentConfig& segment)
    : config_(config),
      heartbeat_timeout_ns_(heartbeat_timeout_ms(config, segment) * image::kMillisecond),
      boot_pause_ns_(segment.boot_pause_ms * image::kMillisecond),
      first_limit_(segment.boot_timeout_ms * image::kMillisecond / segment.cycle_ns),
      boot_attempts_(config.setup.boot_attempts > 0 ? config.setup.boot_attempts : segment.boot_attempts),
      sync_counter_(segment.sync_counter_overflow > 0),
      sdo_(config.node, sdo_timeout_ms(config, segment) * image::kMillisecond,
           static_cast<std::uint32_t>(
               std::max(0, config.setup.sdo_retries >= 0 ? config.setup.sdo_retries : segment.sdo_retries))),
      boot_(config.node, boot_plan(config, segment),
            (config.setup.boot_timeout_ms > 0 ? config.setup.boot_timeout_ms : segment.boot_timeout_ms) *
                image::kMillisecond,
            config.setup.program_timeout_ms * image::kMillisecond) {
  if (config.target == DriveTarget::io) {
    auto io = std::make_unique<IoLink>(config, segment);
    io_ = io.get();
    link_ = std::move(io);
  } else {
    auto drive = std::make_unique<DriveLink>(config, segment);
    drive_ = drive.get();
    link_ = std::move(drive);
  }
  const DriveProfile& profile = config_.profile;
  if (profile.guard_time_ms > 0)
    guard_.emplace(config_.node, profile.guard_time_ms * image::kMillisecond, profile.life_time_factor);
  start_boot();
}

BusEvent BusNode::event(BusEventKind kind, const NodeContext& context) const noexcept {
  BusEvent e;
  e.kind = kind;
  e.segment = context.segment;
  e.node = config_.node;
  e.cycle = context.cycle;
  e.t_ns = context.now;
  e.statusword = link_->statusword();
  return e;
}

void BusNode::start_boot() noexcept {
  phase_ = Phase::booting;
  boot_.begin(sdo_);
}

void BusNode::go_offline() noexcept {
  if (online_) blocked_ = true;
  online_ = false;
}

void BusNode::on_frame(Service service, const image::CanFrame& frame, const NodeContext& context) noexcept {
  switch (service) {
    case Service::tpdo1:
      return on_tpdo(1, frame, context);
    case Service::tpdo2:
      return on_tpdo(2, frame, context);
    case Service::tpdo3:
      return on_tpdo(3, frame, context);
    case Service::tpdo4:
      return on_tpdo(4, frame, context);
    case Service::heartbeat:
      return on_heartbeat(frame, context);
    case Service::emcy:
      return on_emcy(frame, context);
    case Service::sdo_response:
      sdo_.on_frame(frame);
      return;
    default:
      return;
  }
}

void BusNode::on_tpdo(int number, const image::CanFrame& frame, const NodeContext& context) noexcept {
  // What a node sends by an old configuration before it has booted means nothing.
  if (phase_ != Phase::running || config_.profile.sdo_only) return;
  if (link_->process_data().take(number, frame) != ProcessData::Taken::too_short) return;
  const auto mark = static_cast<std::uint8_t>(1u << number);
  if ((short_said_ & mark) != 0) return;
  short_said_ |= mark;
  BusEvent e = event(BusEventKind::pdo_short, context);
  e.expected = link_->process_data().tpdo_bytes(number);
  e.got = frame.length;
  e.pdo = static_cast<std::uint8_t>(number);
  e.frame.id = frame.id;
  e.frame.length = frame.length;
  std::copy_n(frame.data.begin(), std::min<std::size_t>(frame.length, 8), e.frame.data.begin());
  context.events.push(e);
}

void BusNode::on_emcy(const image::CanFrame& frame, const NodeContext& context) noexcept {
  const auto emcy = parse_emcy(frame);
  if (!emcy) return;
  emcy_.add(*emcy, context.now);
  // A node that boots among others that run hears SYNC with a counter before 1019h can be written again. Its
  // message may come before the one that it has booted.
  if (sync_counter_ && emcy->error_code == kUnexpectedSyncLength) {
    sync_length_ = {*emcy, context.cycle};
    return;
  }
  take_emcy(*emcy, context);
}

void BusNode::take_emcy(const Emcy& emcy, const NodeContext& context) noexcept {
  link_->on_emcy(emcy.error_code);
  if (emcy.error_code != 0) history_.on_error(context.now);
  BusEvent e = event(BusEventKind::emcy, context);
  e.emcy = emcy;
  context.events.push(e);
}

/// Whether SYNC surprised a node in its boot is clear one cycle later.
void BusNode::judge_sync_length(const NodeContext& context) noexcept {
  if (!sync_length_ || context.cycle <= sync_length_->cycle) return;
  if (phase_ != Phase::booting || !boot_.before_sync()) take_emcy(sync_length_->emcy, context);
  sync_length_.reset();
}

bool BusNode::ready_for_sync() const noexcept {
  return phase_ != Phase::booting || attempts_ > 0 || boot_.awaits_sync();
}

void BusNode::on_heartbeat(const image::CanFrame& frame, const NodeContext& context) noexcept {
  const auto state = parse_heartbeat(frame);
  if (!state) return;
  if (*state == NmtState::boot_up) return on_boot_up(context);
  if (guard_ && guard_->on_answer(frame, context.now) == NodeGuard::Verdict::wrong_toggle) return;
  nmt_state_ = *state;
  heartbeat_deadline_ns_ = context.now + heartbeat_timeout_ns_;
  if (phase_ == Phase::booting) {
    boot_.on_heartbeat(*state);
  } else if (phase_ == Phase::lost) {
    attempts_ = 0;
    start_boot();
  } else if (phase_ == Phase::running && *state != NmtState::operational) {
    BusEvent e = event(BusEventKind::node_left, context);
    e.expected = static_cast<int>(NmtState::operational);
    e.got = static_cast<int>(*state);
    context.events.push(e);
    go_offline();
    attempts_ = 0;
    start_boot();
  }
}

void BusNode::on_boot_up(const NodeContext& context) noexcept {
  nmt_state_ = NmtState::pre_operational;  // CiA 301, 7.3.2.2: it is entered at once
  if (guard_) guard_->start(context.now);
  if (phase_ == Phase::booting && boot_.boot_up_belongs()) return boot_.on_boot_up();
  ++restarts_;
  if (phase_ == Phase::running) {
    context.events.push(event(BusEventKind::node_restarted, context));
    go_offline();
  }
  if (phase_ != Phase::booting) attempts_ = 0;
  phase_ = Phase::booting;
  boot_.begin_after_boot_up(sdo_);
}

void BusNode::follow_boot(const NodeContext& context) noexcept {
  if (boot_.state() == NodeBoot::State::done) return start_operation(context);
  if (boot_.state() != NodeBoot::State::failed) return;
  ++attempts_;
  const BootReport& report = boot_.report();
  const bool silent = report.problem == BootProblem::no_answer;
  phase_ = silent ? Phase::pausing : Phase::refused;
  pause_until_ns_ = context.now + boot_pause_ns_;
  if ((silent && attempts_ < boot_attempts_) || same_failure(report, reported_)) return;
  reported_ = report;
  BusEvent e = event(BusEventKind::boot_failed, context);
  e.boot = report;
  context.events.push(e);
}

void BusNode::start_operation(const NodeContext& context) noexcept {
  phase_ = Phase::running;
  attempts_ = 0;
  reported_ = {};
  missed_ = 0;
  seen_status_ = false;
  missing_said_ = false;
  short_said_ = 0;
  refusal_said_ = false;
  handover_said_ = false;
  interpolation_said_ = false;
  heartbeat_deadline_ns_ = context.now + heartbeat_timeout_ns_;
  link_->restart();
  link_->on_emcy(boot_.error_code());
  history_.restart();
  faulty_ = false;
  BusEvent e = event(BusEventKind::node_booted, context);
  e.boot = boot_.report();
  context.events.push(e);
}

void BusNode::supervise(bool on_time, const NodeContext& context) noexcept {
  missed_ = on_time ? 0 : missed_ + 1;
  if (on_time) {
    seen_status_ = online_ = true;
    missing_said_ = false;
  }
  if (context.now > heartbeat_deadline_ns_) {
    BusEvent e = event(BusEventKind::heartbeat_lost, context);
    e.expected = heartbeat_timeout_ns_ / image::kMillisecond;
    e.got = (context.now - heartbeat_deadline_ns_ + heartbeat_timeout_ns_) / image::kMillisecond;
    context.events.push(e);
    go_offline();
    sdo_.cancel();
    nmt_state_.reset();
    phase_ = Phase::lost;
    return;
  }
  const PdoWatch::Overdue overdue = link_->overdue();
  if (missing_said_ || !(seen_status_ ? overdue.lost() : missed_ >= first_limit_)) return;
  missing_said_ = true;
  BusEvent e = event(BusEventKind::pdo_missing, context);
  e.expected = seen_status_ ? overdue.limit : first_limit_;
  e.got = seen_status_ ? overdue.cycles : missed_;
  e.pdo = static_cast<std::uint8_t>(overdue.number);
  context.events.push(e);
  go_offline();
}

void BusNode::report_link(const NodeContext& context) noexcept {
  if (drive_ == nullptr) return;
  const bool faulty = drive_->in_fault();
  if (faulty && !faulty_ && !(drive_->error_code() == 0 && history_.tell_all()))
    history_.on_error(context.now);
  faulty_ = faulty;
  const bool refused = drive_->refusal().waited_ms != 0;
  if (refused && !refusal_said_) {
    BusEvent e = event(BusEventKind::refused, context);
    e.refusal = drive_->refusal();
    context.events.push(e);
  }
  refusal_said_ = refused;
  const bool held = drive_->handover_difference() != 0;
  if (held && !handover_said_) {
    BusEvent e = event(BusEventKind::handover_held, context);
    e.got = drive_->handover_difference();
    context.events.push(e);
  }
  handover_said_ = held;
  const std::int32_t waited_ms = drive_->interpolation_waited_ms();
  if (waited_ms != 0 && !interpolation_said_) {
    BusEvent e = event(BusEventKind::not_interpolating, context);
    e.expected = config_.profile.transition_timeout_ms;
    e.got = waited_ms;
    context.events.push(e);
  }
  interpolation_said_ = waited_ms != 0;
}

void BusNode::evaluate(image::ProcessImage& image, const NodeContext& context) noexcept {
  judge_sync_length(context);
  if (phase_ == Phase::booting) follow_boot(context);
  if (phase_ == Phase::pausing && context.now >= pause_until_ns_) start_boot();
  if (phase_ == Phase::running) {
    supervise(link_->update(), context);
    report_link(context);
  }
  if (drive_ != nullptr) fill(feedback_of(image, config_));
  if (io_ != nullptr) io_->fill(image, online_);
}

void BusNode::fill(image::DriveFeedback& feedback) const noexcept {
  drive_->fill(feedback);
  feedback.online = online_;
  feedback.missed = drive_->missed();
  feedback.restarts = restarts_;
  if (!online_) feedback.state = image::DriveState::offline;
}

/// The command or the outputs into the process data. False: there is nothing to say to the node.
bool BusNode::apply(const image::ProcessImage& image, const NodeContext& context) noexcept {
  const bool hears = phase_ == Phase::running || phase_ == Phase::lost;
  if (drive_ == nullptr) {
    // Before its inputs have come once its outputs stay as the module has them.
    if (!hears || !seen_status_) return false;
    io_->apply(image.packets, online_);
    return true;
  }
  image::DriveCommand wanted = command_of(image, config_);
  if (!wanted.power && online_) blocked_ = false;
  if (!hears) return false;
  // It may still hear us: until it is heard again it is to ramp down, whatever is asked of it.
  if (blocked_ && !online_) wanted.power = true;
  drive_->apply(context.now, wanted, blocked_);
  return true;
}

int BusNode::send_process_data(const image::ProcessImage& image, const NodeContext& context,
                               image::CanFrame& dropped) noexcept {
  if (!apply(image, context) || config_.profile.sdo_only) return 0;
  int lost = 0;
  const auto send = [&](const image::CanFrame& frame) {
    if (context.bus.send(frame)) return true;
    dropped = frame;
    ++lost;
    return false;
  };
  for (int number = 1; number <= 4; ++number) {
    ProcessData& data = link_->process_data();
    if (data.due(number, config_.node, context.cycle, context.now) && send(data.frame(number, config_.node)))
      data.sent(number, context.now);
    if (data.ask_due(number, config_.node, context.cycle)) send(data.request(number, config_.node));
  }
  return lost;
}

// A guarded node says nothing by itself: its state Operational and its return after a loss are asked for.
bool BusNode::send_guarding(const NodeContext& context) noexcept {
  const bool starting = phase_ == Phase::booting && boot_.report().step == BootStep::start;
  if (!guard_ || !(starting || phase_ == Phase::running || phase_ == Phase::lost)) return false;
  return guard_->poll(context.now, context.bus);
}

bool BusNode::send_acyclic(const NodeContext& context) noexcept {
  if (questioned_ && phase_ != Phase::running) {
    context.question.give_up();
    questioned_ = false;
  }
  if (send_guarding(context)) return true;
  if (phase_ == Phase::booting) return boot_.poll(context.now, sdo_, context.bus, context.sync_runs);
  if (phase_ == Phase::running && !sdo_.busy()) {
    const bool had_its_turn = questioned_;
    if (questioned_) context.question.finish(sdo_);
    questioned_ = false;
    if (link_->access_running()) finish_access(context);
    if (history_.running()) finish_history(context);
    // By turns: a drive whose objects are asked for again and again would never answer somebody else.
    if (!had_its_turn) questioned_ = context.question.start(config_.node, sdo_);
    if (!questioned_ && !history_.start(context.now, sdo_)) link_->start_access(context.now, sdo_);
  }
  return sdo_.poll(context.now, context.bus);
}

// A drive with torque goes on watching us: its own reaction is what stops it. Without process data its RPDO
// deadlines end, too.
bool BusNode::begin_leave(const NodeContext& context) noexcept {
  if (drive_ == nullptr || phase_ != Phase::running) return false;
  const auto state = decode_state(drive_->statusword());
  if (state == image::DriveState::operation_enabled || state == image::DriveState::quick_stop_active ||
      state == image::DriveState::fault_reaction_active)
    return false;
  phase_ = Phase::leaving;
  return context.bus.send(nmt_frame(NmtCommand::enter_pre_operational, config_.node));
}

bool BusNode::leave(const NodeContext& context) noexcept {
  if (phase_ != Phase::leaving) return !begin_leave(context);
  struct Watch {
    std::uint16_t index;
    std::uint8_t subindex, bytes;
    bool armed;
  };
  const bool guarded = config_.profile.guard_time_ms > 0;
  const Watch watches[] = {
      {object::kConsumerHeartbeatTime, 1, 4, !guarded && config_.profile.has_heartbeat_consumer},
      {object::kLifeTimeFactor, 0, 1, guarded},
      {object::kGuardTime, 0, 2, guarded}};
  while (!sdo_.busy() && leave_said_ < std::size(watches)) {
    const Watch& w = watches[leave_said_++];
    if (w.armed) sdo_.download(w.index, w.subindex, 0u, w.bytes);
  }
  sdo_.poll(context.now, context.bus);
  return !sdo_.busy() && leave_said_ == std::size(watches);
}

/// A message or 603Fh has named this error already.
bool BusNode::told(std::uint16_t error_code) const noexcept {
  for (std::size_t i = 0; i < emcy_.size(); ++i)
    if (emcy_[i].emcy.error_code == error_code) return true;
  return drive_ != nullptr && drive_->error_code() == error_code;
}

void BusNode::finish_history(const NodeContext& context) noexcept {
  const auto entry = history_.finish(sdo_);
  if (!entry || entry->error_code == 0 || told(entry->error_code)) return;
  BusEvent e = event(BusEventKind::error_history, context);
  e.emcy.error_code = entry->error_code;
  e.pdo = entry->subindex;
  context.events.push(e);
}

void BusNode::finish_access(const NodeContext& context) noexcept {
  if (link_->finish_access(sdo_)) return;
  const SdoResult& result = sdo_.result();
  BusEvent e = event(BusEventKind::sdo_failed, context);
  e.boot.index = result.index;
  e.boot.subindex = result.subindex;
  e.boot.writing = result.download;
  e.boot.abort = result.abort;
  e.boot.problem = result.status == SdoStatus::aborted     ? BootProblem::aborted
                   : result.status == SdoStatus::no_answer ? BootProblem::no_answer
                                                           : BootProblem::bad_protocol;
  context.events.push(e);
}

}  // namespace servogate::canopen
