// SPDX-License-Identifier: Apache-2.0
#include "kernel/cycle/executive.hpp"

#include <readerwriterqueue/readerwriterqueue.h>

#include <algorithm>
#include <cstring>

#include "firmware_if/image/alarms/drive_report.hpp"
#include "kernel/cycle/executive_queues.hpp"
#include "kernel/cycle/gate/interface_places.hpp"

namespace servogate::cycle {

namespace {
constexpr const char* kPhaseNames[kPhases] = {"receive", "logic", "interpolate", "axes", "send", "publish"};
}  // namespace

const char* name(Phase phase) noexcept { return kPhaseNames[static_cast<int>(phase)]; }

Cycle::Cycle(CycleParts parts)
    : parts_(std::move(parts)), alarms_(parts_.alarms), queues_(std::make_unique<Queues>()) {
  image_.axis_count = static_cast<int>(parts_.axes.size());
  image_.spindle_count = static_cast<int>(parts_.spindles.size());
  image_.process_count = static_cast<int>(parts_.processes.size());
  image_.now.period_ns = parts_.period_ns;
  image_.packets.resize(parts_.k_bytes, parts_.syvar_bytes);
  axes_.resize(parts_.axes.size());
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].configure(parts_.axes[i], static_cast<int>(i));
  spindles_.resize(parts_.spindles.size());
  for (std::size_t i = 0; i < spindles_.size(); ++i)
    spindles_[i].configure(parts_.spindles[i], static_cast<int>(i));
  for (std::size_t p = 0; p < path_wheels_.size(); ++p)
    path_wheels_[p].configure(parts_.path_wheels[p], static_cast<int>(p));
  configure_gears();
  for (const axis::SpindleConfig& s : parts_.spindles)
    if (s.axis >= 0) {
      axis::Axis& a = axes_[static_cast<std::size_t>(s.axis)];
      a.sleep(a.setpoint().x);
    }
}

Cycle::~Cycle() = default;

bool Cycle::step() noexcept {
  begin_measuring();
  image_.now.number = count_;
  image_.now.t_ns = count_ * parts_.period_ns;
  if (!receive()) return false;
  stamp(Phase::receive);
  run_logic();
  stamp(Phase::logic);
  for (const axis::Spindle& s : spindles_) s.show_drive(image_);
  for (axis::Axis& a : axes_) a.read(image_);
  for (axis::Spindle& s : spindles_) s.read(image_);
  look_at_masters();
  watch_machine();
  collect_events();  // what the axes have just read acts in this cycle
  handle_requests();
  reaction_ = alarms_.reaction();
  // Who wants the drives on after this has to say so again.
  if (reaction_ >= image::Reaction::stop_and_power_off) power_request_ = false;
  run_processes();
  stamp(Phase::interpolate);
  run_axes();
  write_machine_places();
  force();
  stamp(Phase::axes);
  if (source_ == nullptr)
    for (image::CycleDevice* d : parts_.devices) d->send(image_);
  stamp(Phase::send);
  ++count_;
  publish();
  stamp(Phase::publish);
  return true;
}

void Cycle::begin_measuring() noexcept {
  measuring_ = parts_.stopwatch != nullptr && count_ % measure_every_ == 0;
  if (!measuring_) return;
  duration_ns_ = 0;
  stamp_ns_ = parts_.stopwatch->now_ns();
}

void Cycle::stamp(Phase phase) noexcept {
  if (!measuring_) return;
  const image::Nanoseconds now = parts_.stopwatch->now_ns();
  phase_ns_[static_cast<std::size_t>(phase)] = now - stamp_ns_;
  duration_ns_ += now - stamp_ns_;
  stamp_ns_ = now;
}

bool Cycle::receive() noexcept {
  image_.edges.clear();
  if (source_ != nullptr) {
    if (!source_->give(inputs_)) return false;
    apply(inputs_);
  } else {
    for (image::CycleDevice* d : parts_.devices) d->open_cycle(image_);
    for (image::CycleDevice* d : parts_.devices) d->receive(image_, notices_);
    capture(inputs_);
    if (tap_ != nullptr) tap_->take(inputs_);
  }
  for (int i = 0; i < inputs_.notice_count; ++i) {
    const image::AlarmRecord& notice = inputs_.notices[static_cast<std::size_t>(i)];
    raise(notice);
    if (notice.number != alarm::kOverrunLimit) continue;
    for (axis::Axis& a : axes_) a.note_late(notice.value * 1e-3);
  }
  notices_.clear();
  force();
  return true;
}

void Cycle::capture(CycleInputs& in) noexcept {
  in.number = count_;
  if (tap_ != nullptr) {  // the image itself has them for everybody else
    for (std::size_t i = 0; i < axes_.size(); ++i) in.axes[i] = image_.axes[i].drive;
    for (std::size_t i = 0; i < spindles_.size(); ++i) in.spindles[i] = image_.spindles[i].drive;
    std::memcpy(in.packet_a.data(), image_.packets.data(image::Packet::a), in.packet_a.size());
    in.sources = image_.sources;
    in.edges = image_.edges;
  }
  for (std::size_t p = 0; p < parts_.processes.size(); ++p)
    parts_.processes[p]->published(
        std::span(in.visible).subspan(p * ProcessInCycle::kCrossingsEach, ProcessInCycle::kCrossingsEach));
  in.request_count = 0;
  while (in.request_count < kRequestsPerCycle && take_request(in.requests[in.request_count]))
    ++in.request_count;
  in.notice_count = 0;
  for (const image::AlarmRecord& r : notices_.records()) in.notices[in.notice_count++] = r;
}

void Cycle::apply(const CycleInputs& in) noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) image_.axes[i].drive = in.axes[i];
  for (std::size_t i = 0; i < spindles_.size(); ++i) image_.spindles[i].drive = in.spindles[i];
  std::memcpy(image_.packets.data(image::Packet::a), in.packet_a.data(), in.packet_a.size());
  image_.sources = in.sources;
  image_.edges = in.edges;
}

void Cycle::run_logic() noexcept {
  if (parts_.logic != nullptr) {
    if (inputs_.scan_ended) parts_.logic->end_next_scan();
    parts_.logic->scan(image_, notices_);
  }
  force();  // what follows in this cycle sees it too
  for (const image::AlarmRecord& r : notices_.records()) raise(r);
  notices_.clear();
}

void Cycle::run_processes() noexcept {
  homing_.step(axes_);
  image_.homing = homing_.running();
  image_.homing_left = homing_.remaining();
  for (std::size_t p = 0; p < parts_.processes.size(); ++p) {
    ProcessContext c = context(static_cast<int>(p));
    parts_.processes[p]->interpolate(c);
  }
}

ProcessContext Cycle::context(int process) noexcept {
  return {image_,
          axes_,
          spindles_,
          std::span<const std::uint64_t>(inputs_.visible)
              .subspan(static_cast<std::size_t>(process) * ProcessInCycle::kCrossingsEach,
                       ProcessInCycle::kCrossingsEach),
          reaction_,
          power_request_,
          power_asker_,
          notices_};
}

void Cycle::set_time_scale(double scale) noexcept {
  time_scale_ = scale;
  for (axis::Axis& a : axes_) a.set_time_scale(scale);
}

void Cycle::run_axes() noexcept {
  for (axis::Spindle& s : spindles_)
    if (const int a = s.config().axis; a >= 0)
      s.share(axes_[static_cast<std::size_t>(a)], image_.now.period_s());
  const std::uint32_t followers = followers_now();
  for (axis::Axis& a : axes_) {
    a.react(reaction_);
    if ((followers >> a.index() & 1u) == 0) a.command(image_);
  }
  for (axis::ElectronicGear& g : gears_) g.lead(geared_machine());
  axis::command_all(spindles_, reaction_, image_);
  command_followers(followers);
  for (const image::AlarmRecord& r : notices_.records()) raise(r);
  notices_.clear();
  collect_events();
  note_rest();
}

void Cycle::collect_events() noexcept {
  const auto collect = [this](const axis::Events& events, int axis, int process,
                              const image::PartPlace& drive_of, const axis::Spindle* spindle) {
    for (const axis::Event& e : events) {
      image::AlarmRecord r;
      r.number = e.number;
      r.axis = static_cast<std::int8_t>(axis);
      r.part = drive_of;
      r.limit = e.limit;
      r.value = e.value;
      r.detail1 = e.detail1;
      r.detail2 = e.detail2;
      if (axis >= 0) {
        const image::DriveFeedback& drive = image_.axes[static_cast<std::size_t>(axis)].drive;
        image::DriveReport report;
        report.statusword = drive.statusword;
        report.error_code = drive.error_code;
        r.detail.put(report);
        const axis::AxisConfig& config = axes_[static_cast<std::size_t>(axis)].config();
        if (axis::is_drive_loss(e.number)) r.reaction = config.loss_reaction;
      }
      if (spindle != nullptr) {
        r.source = static_cast<std::int16_t>(spindle->config().source);
        r.detail2 = spindle->index();
        if (e.number == axis::alarm::kSpindleDriveLost) r.reaction = spindle->config().loss_reaction;
      }
      const image::ProcessStatus& program = image_.processes[static_cast<std::size_t>(process)];
      r.line = program.line;
      r.file = program.file;
      r.run = program.run;
      raise(r);
    }
  };
  for (axis::Axis& a : axes_) {
    collect(a.events(), a.index(), a.process(), a.config().drive, nullptr);
    a.clear_events();
  }
  for (axis::ElectronicGear& g : gears_) {
    const axis::Axis& a = axes_[static_cast<std::size_t>(g.config().follower)];
    collect(g.events(), a.index(), a.process(), a.config().drive, nullptr);
    g.clear_events();
  }
  for (axis::Spindle& s : spindles_) {
    collect(s.events(), -1, s.config().process, s.config().drive, &s);
    s.clear_events();
  }
}

void Cycle::note_rest() noexcept {
  bool rest = true;
  for (const axis::Axis& a : axes_) {
    if (a.homing().state() == axis::Homing::State::done)
      alarms_.cause_gone(axis::alarm::kHomingInterrupted, a.index());
    // Nobody's hand, and no alarm, moves what follows a master.
    rest = rest && (a.standstill() || a.follows());
  }
  alarms_.note_rest(rest);
  if (manual_held_ && rest && !homing_.running()) manual_held_ = false;
}

void Cycle::raise(const image::AlarmRecord& record) noexcept { alarms_.raise(record, image_.now); }

void Cycle::raise(image::AlarmNumber number) noexcept {
  image::AlarmRecord record;
  record.number = number;
  raise(record);
}

void Cycle::watch_machine() noexcept {
  watch_sources();  // first: what is lost with a source is a consequence of it
  if (parts_.estop_place && !image_.packets.bit(*parts_.estop_place))
    image_.packets.set_bit(places::kEstopOk, false);
  const bool estop_ok = image_.packets.bit(places::kEstopOk);
  // While the logic is held its output MC.estop_ok is off, and everything with it (kPlcHeld).
  if (estop_seen_ok_ && !estop_ok && !logic_held_) {
    image::AlarmRecord r;
    r.number = alarm::kEmergencyStop;
    raise(r);
  }
  if (!logic_held_) estop_seen_ok_ = estop_ok;
  for (std::size_t p = 0; p < parts_.processes.size(); ++p) {
    const auto number = static_cast<std::int16_t>(
        image_.packets.number(image::at(places::kExternalAlarm, image::process_base(static_cast<int>(p)))));
    if (number != external_alarm_[p] && number != 0) {
      image::AlarmRecord r;
      r.number = alarm::kExternalAlarm;
      r.process = static_cast<std::int8_t>(p);
      r.value = number;
      r.key = static_cast<std::uint16_t>(number);
      raise(r);
    }
    external_alarm_[p] = number;
  }
}

void Cycle::watch_sources() noexcept {
  for (std::size_t s = 0; s < source_quality_.size(); ++s) {
    const image::Quality q = image_.sources[s].quality;
    if (q == source_quality_[s]) continue;
    if (parts_.sources[s].watched && q >= image::Quality::stale) {
      image::AlarmRecord r;
      r.number = q == image::Quality::stale ? alarm::kSourceStale : alarm::kSourceBad;
      r.source = static_cast<std::int16_t>(s);
      r.value = static_cast<double>(image_.now.t_ns - image_.sources[s].updated_ns) / 1e6;
      raise(r);
    }
    source_quality_[s] = q;
  }
}

bool Cycle::still_present(const image::AlarmRecord& r) const noexcept {
  if (r.cycle == image_.now.number) return true;  // nobody who asks for a reset in this cycle has seen it
  switch (r.number) {
    case alarm::kEmergencyStop:
      return !image_.packets.bit(places::kEstopOk);
    case alarm::kPlcHeld:
      return logic_held_;
    case alarm::kSourceStale:
    case alarm::kSourceBad:
      return r.source >= 0 &&
             image_.sources[static_cast<std::size_t>(r.source)].quality >= image::Quality::stale;
    case alarm::kExternalAlarm:
      return r.process >= 0 &&
             external_alarm_[static_cast<std::size_t>(r.process)] == static_cast<std::int16_t>(r.value);
    default:
      break;
  }
  if (parts_.alarms != nullptr && parts_.alarms->mark(r.number) == image::AlarmMark::of_part)
    return part_missing(r);
  if (r.axis >= 0) return axes_[static_cast<std::size_t>(r.axis)].present(r.number);
  return std::any_of(spindles_.begin(), spindles_.end(),
                     [&](const axis::Spindle& s) { return s.present(r.number); });
}

/// The part that a record names, or where it names none any part of its device, is not there.
bool Cycle::part_missing(const image::AlarmRecord& r) const noexcept {
  const auto meant = [&r](const image::PartPlace& place) {
    return r.part.device == place.device && (r.part.part < 0 || r.part.part == place.part);
  };
  const auto missing = [&meant](const image::PartPlace& place, const image::DriveFeedback& drive) {
    return meant(place) && !drive.online;
  };
  for (std::size_t s = 0; s < parts_.sources.size(); ++s)
    if (parts_.sources[s].place.device >= 0 && meant(parts_.sources[s].place) &&
        image_.sources[s].quality != image::Quality::good)
      return true;
  for (std::size_t i = 0; i < axes_.size(); ++i)
    if (missing(axes_[i].config().drive, image_.axes[i].drive) ||
        (r.axis == static_cast<int>(i) && axes_[i].present(r.number)))
      return true;
  for (std::size_t i = 0; i < spindles_.size(); ++i)
    if (missing(spindles_[i].config().drive, image_.spindles[i].drive)) return true;
  return false;
}

void Cycle::note_overrun(image::Nanoseconds late_ns, bool by_clock) noexcept {
  ++overruns_;
  if (late_ns < 2 * parts_.period_ns) return;
  image::AlarmRecord r;
  r.number = alarm::kOverrunLimit;
  r.limit = static_cast<double>(2 * parts_.period_ns) / 1e6;
  r.value = static_cast<double>(late_ns) / 1e6;
  if (by_clock && duration_ns_ > parts_.period_ns)  // the cycle before was too long: name its longest phase
    r.detail1 =
        1.0 + static_cast<double>(std::max_element(phase_ns_.begin(), phase_ns_.end()) - phase_ns_.begin());
  notices_.add(r);
}

void Cycle::watch_logic(image::Nanoseconds limit_ns, bool ended) noexcept {
  const image::Nanoseconds took = measuring_ ? phase_ns_[static_cast<std::size_t>(Phase::logic)] : 0;
  if (!ended && (limit_ns <= 0 || took <= limit_ns)) return;
  image::AlarmRecord r;
  if (ended) r.detail1 = kScanEnded;
  r.number = alarm::kPlcWatchdog;
  r.limit = static_cast<double>(limit_ns) / 1e6;
  r.value = static_cast<double>(took) / 1e6;
  notices_.add(r);
}

void Cycle::write_machine_places() noexcept {
  alarms_.write_interface(image_);
  image::Packets& k = image_.packets;
  // A level that stands still tells the safety relay: no cycles, cycles far too late, or no logic.
  const bool alive = (count_ / places::kAliveCycles) % 2 != 0 && !alarms_.control_fails();
  k.set_bit(places::kControlAlive, alive);
  if (parts_.alive_place) k.set_bit(*parts_.alive_place, alive);
  k.set_bit(places::kReady, reaction_ < image::Reaction::stop_at_block_end && k.bit(places::kEstopOk));
  k.set_bit(places::kPowerRequest, power_request_);
}

void Cycle::force() noexcept {
  for (int i = 0; i < forced_count_; ++i)
    image_.packets.set_number(forced_[static_cast<std::size_t>(i)].place,
                              forced_[static_cast<std::size_t>(i)].value);
}

void Cycle::publish() noexcept {
  if (publish_every_ == 0 || count_ % publish_every_ != 0) return;
  image_snapshot_.publish(image_);
  alarms_.snapshot(alarm_copy_);
  alarm_snapshot_.publish(alarm_copy_);
  References references{};
  for (std::size_t i = 0; i < axes_.size(); ++i) references[i] = axes_[i].reference_counts();
  reference_snapshot_.publish(references);
}

}  // namespace servogate::cycle
