// SPDX-License-Identifier: Apache-2.0
#include "tests/channel/rig.hpp"
#include "tests/alarms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware_if/image/interface_map.hpp"

namespace servogate::channel::test {

using image::field;
using image::Format;
using image::Place;
using image::RequestKind;

namespace {

constexpr std::uint32_t kProcess = image::process_base(0);
constexpr Place nc(std::string_view name) {
  for (const image::InterfaceField& f : image::kProcessFields)
    if (f.name == name)
      return {image::Packet::k, f.format,
              f.format == Format::bl ? (kProcess + f.byte) * 8 + f.bit
                                     : (kProcess + f.byte) / image::format_size(f.format),
              1};
  return {};
}
constexpr char kLetters[] = {'M', 'S', 'T', 'H'};
constexpr Place kStrobes[] = {nc("m_strobe"), nc("s_strobe"), nc("t_strobe"), nc("h_strobe")};
constexpr Place kAcks[] = {nc("m_ack"), nc("s_ack"), nc("t_ack"), nc("h_ack")};
constexpr Place kCodes[] = {nc("m_code"), nc("s_value"), nc("t_number"), nc("h_code")};

}  // namespace

void IdealDrives::receive(image::ProcessImage& image, image::Notices&) noexcept {
  for (std::size_t i = 0; i < kAxes; ++i) {
    image::DriveFeedback& f = image.axes[i].drive;
    const bool on = commands_[i].power && !fault[i] && !commands_[i].quick_stop;
    if (on && !stuck[i]) counts_[i] = pipe_[i][0];
    pipe_[i] = {pipe_[i][1], commands_[i].position_counts};
    if (!on) pipe_[i] = {counts_[i], counts_[i]};
    f.online = true;
    f.state = fault[i]                  ? image::DriveState::fault
              : commands_[i].quick_stop ? image::DriveState::quick_stop_active
              : on                      ? image::DriveState::operation_enabled
                                        : image::DriveState::switch_on_disabled;
    f.error_code = fault[i] ? 0x2310 : 0;
    f.position_counts = counts_[i];
  }
  image::DriveFeedback& s = image.spindles[0].drive;
  s.online = true;
  s.state = spindle_fault    ? image::DriveState::fault
            : spindle_.power ? image::DriveState::operation_enabled
                             : image::DriveState::switch_on_disabled;
  s.mode = spindle_.mode;
  const double told = spindle_.power && !spindle_fault ? spindle_.velocity_counts_s : 0.0;
  if (!spindle_coasts) s.velocity_counts_s = spindle_one_way ? std::max(0.0, told) : told;
  if (spindle_backwards) s.velocity_counts_s = -told;
  if (spindle_stuck) s.velocity_counts_s = 0.0;
  s.missed = spindle_silent ? s.missed + 1 : 0;
  const double period = image.now.period_s(), was = turns;
  slipped_ += std::clamp(slip - slipped_, -0.002, 0.002);  // 10 % in 50 ms: it has inertia
  lead_spindle(s, period);
  if (spindle_.mode != image::DriveMode::csp)
    turns += s.velocity_counts_s / 4096.0 * (1.0 - slipped_) * period;
  if (spindle_.latch_arm && s.latch_sequence == 0 && std::floor(turns) != std::floor(was)) {
    s.latch_sequence = 1;
    s.latch_counts = 0;
  }
  if (!spindle_silent) s.position_counts = static_cast<std::int64_t>(std::floor(turns * 4096.0));
  second_spindle(image);

  if (clearance) probe(image);
}

/// To a position, as the axes; by a speed it is where that has led it.
void IdealDrives::lead_spindle(image::DriveFeedback& s, double period_s) {
  const double before = turns;
  const std::int64_t now = std::llround(turns * 4096.0);
  const bool on = spindle_.power && !spindle_fault && led_on_;
  led_on_ = spindle_.power && spindle_.mode == image::DriveMode::csp;
  if (on) turns = static_cast<double>(led_[0]) / 4096.0;
  led_ = {led_[1], spindle_.position_counts};
  if (!on) led_ = {now, now};
  if (spindle_.mode == image::DriveMode::csp) s.velocity_counts_s = (turns - before) * 4096.0 / period_s;
}

/// Where there is none, nobody reads it.
void IdealDrives::second_spindle(image::ProcessImage& image) {
  image::DriveFeedback& s = image.spindles[1].drive;
  s.online = true;
  s.state = second_.power ? image::DriveState::operation_enabled : image::DriveState::switch_on_disabled;
  s.velocity_counts_s = second_.power && !second_stuck ? second_.velocity_counts_s : 0.0;
  const double was =
      std::exchange(second_turns_, second_turns_ + s.velocity_counts_s / 4096.0 * image.now.period_s());
  if (second_.latch_arm && s.latch_sequence == 0 && std::floor(second_turns_) != std::floor(was))
    s.latch_sequence = 1;  // at 0 counts
  s.position_counts = static_cast<std::int64_t>(std::floor(second_turns_ * 4096.0));
}

void IdealDrives::probe(image::ProcessImage& image) {
  std::array<double, kAxes> at{};
  for (std::size_t i = 0; i < kAxes; ++i) at[i] = static_cast<double>(counts_[i]) / 100000.0;
  const double clear = clearance(at), before = std::exchange(clear_before_, clear);
  since_edge_ = (clear <= 0.0) != (before <= 0.0) ? 0 : since_edge_ + 1;
  const bool bounces = since_edge_ > 0 && since_edge_ <= bounce_cycles && since_edge_ / 2 % 2 != 0;
  const bool level = (clear <= 0.0) != bounces, was = image.packets.bit(kProbePlace);
  image.packets.set_bit(kProbePlace, level);
  if (edges && since_edge_ > 0 && level != was) image.edges.add({kProbePlace, level, image.now.t_ns});
  const double share = before / (before - clear);
  for (std::size_t i = 0; i < kAxes; ++i) {
    const image::DriveCommand& told = commands_[i];
    image::DriveFeedback& f = image.axes[i].drive;
    const bool armed = told.latch_arm && told.latch_source == image::LatchSource::probe_1;
    if (!armed) latched_[i] = false;
    if (!armed || latched_[i] || !latches[i] || clear > 0.0 || before <= 0.0) continue;
    latched_[i] = true;
    ++f.latch_sequence;
    f.latch_counts =
        counts_before_[i] + std::llround(share * static_cast<double>(counts_[i] - counts_before_[i]));
  }
  counts_before_ = counts_;
  if (!edges || clear > 0.0 || before <= 0.0) return;
  const auto ago = static_cast<image::Nanoseconds>((2.0 - before / (before - clear)) *
                                                   static_cast<double>(image.now.period_ns));
  image.edges.add({kProbePlace, true, image.now.t_ns - ago});
}

void IdealDrives::send(image::ProcessImage& image) noexcept {
  for (std::size_t i = 0; i < kAxes; ++i) commands_[i] = image.axes[i].drive_command;
  spindle_ = image.spindles[0].drive_command;
  second_ = image.spindles[1].drive_command;
}

void TestLogic::word(image::ProcessImage& image, int n) {
  image::Packets& k = image.packets;
  int& waited = waited_[static_cast<std::size_t>(n)];
  if (!k.bit(kStrobes[n])) {
    if (waited > 0) strobes.back().acknowledged_s = waited * image.now.period_s();
    waited = 0;
    k.set_bit(kAcks[n], false);
    if (n == 0) k.set_bit(nc("m_unknown"), false);
    return;
  }
  const double code = k.number(kCodes[n]);
  if (waited++ == 0) {
    const bool moving = std::any_of(image.axes.begin(), image.axes.begin() + kAxes,
                                    [](const image::AxisImage& a) { return a.moving; });
    strobes.push_back({kLetters[n], code, n == 2 ? k.number(nc("t_corrector")) : 0.0, image.axes[0].command,
                       moving, image.now.number});
  }
  const bool wanted = n == 0   ? !never.contains(code)
                      : n == 1 ? acknowledge_s
                      : n == 2 ? acknowledge_t
                               : acknowledge_h;
  if (wanted && waited > delay_cycles) {
    k.set_bit(kAcks[n], true);
    if (n == 0) k.set_bit(nc("m_unknown"), unknown.contains(code));
  }
}

void TestLogic::scan(image::ProcessImage& image, cycle::Notices&) noexcept {
  image::Packets& k = image.packets;
  k.set_bit(field(image::kMachineFields, "estop_ok", image::kMachineBase), estop_ok);
  k.set_bit(field(image::kMachineFields, "power_on", image::kMachineBase), estop_ok && power_on);
  for (int a = 0; a < kAxes; ++a) {
    k.set_bit(image::at(field(image::kAxisFields, "enable"), image::axis_base(a)),
              axis_enable[static_cast<std::size_t>(a)]);
    k.set_bit(image::at(field(image::kAxisFields, "limit_plus"), image::axis_base(a)),
              limit_plus[static_cast<std::size_t>(a)]);
    k.set_bit(image::at(field(image::kAxisFields, "feed_enable"), image::axis_base(a)),
              axis_feed_enable[static_cast<std::size_t>(a)]);
  }
  k.set_bit(image::at(field(image::kSpindleFields, "enable"), image::spindle_base(0)), spindle_enable);
  k.set_bit(image::at(field(image::kSpindleFields, "enable"), image::spindle_base(1)), spindle_enable);
  k.set_number(image::at(field(image::kSpindleFields, "override"), image::spindle_base(0)), spindle_override);
  k.set_bit(nc("feed_enable"), feed_enable);
  k.set_bit(nc("read_in_enable"), read_in_enable);
  k.set_bit(nc("optional_stop"), optional_stop);
  k.set_bit(nc("dry_run"), dry_run);
  k.set_number(nc("skip_levels"), skip_levels);
  k.set_bit(nc("start"), start_bit);
  k.set_bit(nc("stop"), stop_bit);
  k.set_bit(nc("reset"), reset_bit);
  k.set_number(nc("feed_override"), feed_override);
  k.set_number(nc("external_alarm"), external_alarm);
  for (int n = 0; n < 4; ++n) word(image, n);
  if (during) during();
}

Rig::Rig(std::string_view program, std::string_view power_on, double handshake_timeout_s, RigKind kind,
         std::string_view dialect)
    : dialect_(dialect) {
  ProcessConfig config;
  config.path.axis_count = kAxes;
  if (kind != RigKind::blind) config.probe = axis::SwitchPlace{kProbePlace, false};
  if (kind == RigKind::latching) config.probe_latch = image::LatchSource::probe_1;
  config.path.threads.hold_retracts = kind == RigKind::retracting;
  config.path.threads.retract = {2.0, 0.0, 0.0};
  config.path.threads.by_infeed = kind == RigKind::infeed;
  if (kind == RigKind::lawless) config.path.reserve = -1.0;
  config.handshake_timeout_s = handshake_timeout_s;
  cycle::CycleParts parts;
  parts.alarms = &tests::alarm_table();
  const bool c_axis = kind == RigKind::c_axis;
  const char* letters[] = {"X", kind == RigKind::rotary ? "B" : c_axis ? "C" : "Y", "Z"};
  if (kind == RigKind::lathe) config.axes.surface_speed_axis = 0;
  config.axes.spindle_max_rpm = model_.spindle_max_rpm = kSpindleMax;
  config.axes.spindle_rpm_s = axis::SpindleConfig{}.acceleration;
  for (int a = 0; a < kAxes; ++a) {
    config.axes.machine.push_back(a);
    config.path.limits[static_cast<std::size_t>(a)] = {kLimits.velocity, kLimits.acceleration, kLimits.jerk};
    axis::AxisConfig c;
    c.limits = kLimits;
    c.counts_numerator = 100000;
    c.homing.method = axis::HomingMethod::none;
    c.homing.position = 0.0;
    c.in_position_window = 0.002;
    program::MachineModel::Axis m;
    m.letter = letters[a];
    m.travel_min = -300;
    m.travel_max = 300;
    config.path.threads.travel_min[static_cast<std::size_t>(a)] = -300;
    config.path.threads.travel_max[static_cast<std::size_t>(a)] = 300;
    m.rapid = kLimits.velocity;
    m.diameter = kind == RigKind::lathe && a == 0;
    m.rotary = c.rotary = config.path.rotary[static_cast<std::size_t>(a)] = kind == RigKind::rotary && a == 1;
    if (c_axis && a == 1) {
      c.counts_numerator = 4096, c.counts_denominator = 360;
      m.rotary = c.rotary = config.path.rotary[1] = true;
      c.travel_limited = false;
      c.in_position_window = 0.1;
      m.travel_min = -1e9, m.travel_max = 1e9;
    }
    model_.axes.push_back(m);
    parts.axes.push_back(c);
  }
  model_.power_on = {"G94", "G97", "G90", "G71", std::string(power_on)};
  model_.variables = {{"ERF", 0.01}, {"MCD", 2}};
  if (c_axis) model_.spindle_axis = 1, model_.spindle_axis_on_m = 70, model_.spindle_axis_off_m = 71;
  if (dialect != "nc110") {
    model_.power_on = {std::string(power_on)};
    model_.variables.clear();
  }
  if (kind == RigKind::iso || kind == RigKind::fenix || kind == RigKind::polygon) {
    dialect_ = kind == RigKind::fenix ? "fenix" : "sinumerik-808d";
    model_.power_on =
        kind == RigKind::fenix ? std::vector<std::string>{"G94", "G90"} : std::vector<std::string>{"G291"};
    model_.kind = kind == RigKind::polygon ? program::MachineModel::Kind::turning
                                           : program::MachineModel::Kind::milling;
    model_.variables.clear();
    if (kind == RigKind::polygon) model_.coupled_max_rpm = kSpindleMax;
  }
  process = std::make_unique<Process>(config);
  process->load(factory(program));
  parts.devices = {&drives};
  parts.logic = &logic;
  parts.processes = {process.get()};
  parts.spindles.emplace_back().max_rpm = kSpindleMax;
  parts.spindles.back().encoder = kind != RigKind::blind;
  parts.spindles.back().thread_by_setpoint = kind == RigKind::setpoint;
  if (c_axis) parts.spindles.back().axis = 1;
  if (kind == RigKind::polygon) {
    parts.spindles.emplace_back().max_rpm = kSpindleMax;
    parts.spindles.back().coupling = axis::CouplingBy::setpoint;
  }
  cycle = std::make_unique<cycle::Cycle>(std::move(parts));
  run(0.01);
  EXPECT_EQ(ask(RequestKind::power, 1.0), cycle::Refusal::none);
  EXPECT_TRUE(until([this] {
    const auto axes = cycle->axes();
    return std::all_of(axes.begin(), axes.end(),
                       [](const axis::Axis& a) { return a.motion_permitted() || a.asleep(); });
  }));
  EXPECT_EQ(ask(RequestKind::mode, static_cast<double>(image::Mode::automatic)), cycle::Refusal::none);
}

InterpreterFactory Rig::factory(std::string_view program) const {
  return [model = model_, text = std::string(program), dialect = dialect_](const program::Position& at) {
    return program::Interpreter(dialect, model, {}, "test.nc", text, {}, at);
  };
}

void Rig::load(std::string_view program) { process->load(factory(program)); }

void Rig::step() {
  read ? read() : static_cast<void>(process->work());
  ASSERT_TRUE(cycle->step());
  std::array<double, kAxes> at{};
  for (int a = 0; a < kAxes; ++a) at[static_cast<std::size_t>(a)] = x(a);
  path.push_back(at);
  const std::size_t n = path.size();
  const double dt = image().now.period_s();
  for (std::size_t a = 0; a < kAxes && n >= 4 && violations_.size() < 400; ++a) {
    if (!image().axes[a].enabled) continue;
    const double p0 = path[n - 4][a], p1 = path[n - 3][a], p2 = path[n - 2][a], p3 = path[n - 1][a];
    const double values[] = {std::abs(p3 - p2) / dt, std::abs(p3 - 2 * p2 + p1) / (dt * dt),
                             std::abs(p3 - 3 * p2 + 3 * p1 - p0) / (dt * dt * dt)};
    const double limits[] = {kLimits.velocity, kLimits.acceleration, kLimits.jerk};
    for (int i = 0; i < 3; ++i)
      if (values[i] > limits[i] * 1.001)
        violations_ += "axis " + std::to_string(a) + " order " + std::to_string(i + 1) + " at " +
                       std::to_string(now()) + " s: " + std::to_string(values[i]) + "; ";
  }
  if (each) each();
}

void Rig::run(double seconds) {
  for (long n = std::lround(seconds * 1000.0); n > 0; --n) step();
}

bool Rig::until(const std::function<bool()>& met, double patience_s) {
  const double end = now() + patience_s;
  while (!met()) {
    if (now() > end) return false;
    step();
  }
  return true;
}

cycle::Refusal Rig::ask(RequestKind kind, double value, int axis) {
  image::Request r;
  r.kind = kind;
  r.value = value;
  r.axis = static_cast<std::int8_t>(axis);
  return ask(r);
}

cycle::Refusal Rig::ask(image::Request r) {
  r.id = next_id_++;
  EXPECT_TRUE(cycle->post(r));
  step();
  image::Answer answer;
  if (!cycle->take_answer(answer) || answer.id != r.id) ADD_FAILURE() << "no answer";
  return static_cast<cycle::Refusal>(answer.refusal);
}

bool Rig::finish(double patience_s) {
  start();
  EXPECT_EQ(started_, cycle::Refusal::none);
  return until([this] { return state() == image::ProcessState::ended; }, patience_s);
}

bool Rig::moving() const {
  return std::any_of(image().axes.begin(), image().axes.begin() + kAxes,
                     [](const image::AxisImage& a) { return a.moving; });
}

int Rig::alarms(image::AlarmNumber number) const {
  const auto history = cycle->alarms().history();
  return static_cast<int>(std::count_if(history.begin(), history.end(),
                                        [&](const image::AlarmRecord& r) { return r.number == number; }));
}

const image::AlarmRecord* Rig::alarm(image::AlarmNumber number) {
  history_ = cycle->alarms().history();
  for (const image::AlarmRecord& r : history_)
    if (r.number == number) return &r;
  return nullptr;
}

std::string Rig::alarm_list() const {
  std::string list;
  for (const image::AlarmRecord& r : cycle->alarms().history())
    list += std::to_string(r.number) + " line " + std::to_string(r.line) + "; ";
  return list;
}

double off_line(const std::array<double, kAxes>& p, double ax, double ay, double bx, double by) {
  const double dx = bx - ax, dy = by - ay;
  return std::abs((p[0] - ax) * dy - (p[1] - ay) * dx) / std::hypot(dx, dy);
}

}  // namespace servogate::channel::test
