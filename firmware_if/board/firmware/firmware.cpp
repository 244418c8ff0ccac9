// SPDX-License-Identifier: Apache-2.0
#include "firmware_if/board/firmware/firmware.hpp"

namespace servogate::board {

namespace {

constexpr std::uint32_t bit(std::size_t n) noexcept { return std::uint32_t{1} << n; }

void set(std::uint32_t& mask, std::size_t n, bool on) noexcept { on ? mask |= bit(n) : mask &= ~bit(n); }

void set(std::uint8_t& mask, std::size_t n, bool on) noexcept {
  mask = static_cast<std::uint8_t>(on ? mask | bit(n) : mask & ~bit(n));
}

std::int16_t bounded(std::int32_t value) noexcept {
  return static_cast<std::int16_t>(value > kFullScale    ? kFullScale
                                   : value < -kFullScale ? -kFullScale
                                                         : value);
}

Description filled(Description d, std::uint32_t tick_hz) noexcept {
  d.protocol = kProtocolVersion;
  d.max_step_rate = tick_hz / 2;
  return d;
}

}  // namespace

Firmware::Firmware(Hardware& hardware, const Description& description, std::uint32_t tick_hz) noexcept
    : hardware_(hardware), description_(filled(description, tick_hz)), tick_hz_(tick_hz) {
  drop();
}

std::uint32_t Firmware::ticks(std::uint32_t us) const noexcept {
  const std::uint64_t ticks = std::uint64_t{us} * tick_hz_ / 1'000'000u;
  return ticks > 0 ? static_cast<std::uint32_t>(ticks) : 1u;
}

void Firmware::put_outputs(std::uint32_t levels) noexcept {
  if (description_.outputs > 0) hardware_.set_outputs((levels | outputs_high_) & ~outputs_low_);
}

void Firmware::drop() noexcept {
  put_outputs(configuration_.safe_outputs);
  for (std::size_t n = 0; n < description_.analog_outputs && n < kAnalog; ++n)
    hardware_.set_analog(n, configuration_.safe_analog[n]);
  for (std::size_t n = 0; n < kChannels; ++n) {
    Channel& c = channels_[n];
    if (description_.capabilities[n] == 0) continue;
    hardware_.set_enable(n, false);
    c.enabled = false;
    rest(n, c);
  }
}

/// The set-point of a channel that is off.
void Firmware::rest(std::size_t n, Channel& c) noexcept {
  if (c.setting.output == Output::step) {
    const StepPins pins = c.steps.drop();
    hardware_.set_step(n, pins.step, pins.forward);
  } else if (c.setting.output != Output::off) {
    hardware_.set_value(n, 0);
  }
}

Configured Firmware::check(const Configuration& c) const noexcept {
  if (c.watchdog_us == 0) return {ConfigureResult::no_watchdog, 0};
  if (c.period_us == 0) return {ConfigureResult::no_period, 0};
  for (std::uint8_t n = 0; n < kChannels; ++n) {
    if (c.channels[n].output == Output::off) continue;
    if (description_.capabilities[n] == 0) return {ConfigureResult::no_such_channel, n};
    if ((description_.capabilities[n] & capability(c.channels[n].output)) == 0)
      return {ConfigureResult::no_such_output, n};
  }
  return {};
}

Configured Firmware::configure(const Configuration& configuration) noexcept {
  const Configured result = check(configuration);
  drop();
  configured_ = commanded_ = tripped_ = false;
  if (result.result != ConfigureResult::done) return result;
  configuration_ = configuration;
  watchdog_ticks_ = ticks(configuration.watchdog_us);
  lost_edges_ = 0;
  edge_count_ = 0;
  inputs_known_ = false;
  for (std::size_t n = 0; n < kChannels; ++n) {
    Channel& c = channels_[n];
    c.setting = configuration.channels[n];
    c.limited = c.armed = false;
    c.latches = 0;
    if (c.setting.output == Output::step)
      c.steps.configure(
          {tick_hz_, ticks(configuration.period_us), ticks(c.setting.step_us), c.setting.stop_rate});
    if (c.setting.output == Output::pwm) hardware_.set_pwm_hz(n, c.setting.pwm_hz);
    if ((description_.capabilities[n] & kHasIndex) != 0) hardware_.arm_index(n, false);
  }
  configured_ = true;
  drop();
  return result;
}

void Firmware::carry_out(std::size_t n, Channel& c, const Command& command) noexcept {
  const std::uint8_t has = description_.capabilities[n];
  if (has == 0) return;
  const bool armed = (command.latch & bit(n)) != 0 && (has & kHasIndex) != 0;
  if (armed != c.armed) {
    c.armed = armed;
    if ((has & kHasIndex) != 0) hardware_.arm_index(n, armed);
  }
  const bool on = (command.enable & bit(n)) != 0 && c.setting.output != Output::off;
  const ChannelCommand& to = command.channels[n];
  if (!on)
    rest(n, c);
  else if (c.setting.output == Output::step)
    c.limited = !c.steps.follow(to.target, to.rate);
  else
    hardware_.set_value(n, bounded(to.target));
  if (on != c.enabled) hardware_.set_enable(n, on);
  c.enabled = on;
}

void Firmware::carry_out(const Command& command) noexcept {
  silent_ticks_ = 0;
  commanded_ = true;
  if ((command.flags & kResetTrip) != 0) tripped_ = false;
  if (tripped_) return;
  put_outputs(command.outputs);
  for (std::size_t n = 0; n < description_.analog_outputs && n < kAnalog; ++n)
    hardware_.set_analog(n, command.analog[n]);
  for (std::size_t n = 0; n < kChannels; ++n) carry_out(n, channels_[n], command);
}

std::uint32_t Firmware::inputs(std::uint32_t t_us) noexcept {
  std::uint32_t levels = hardware_.inputs();
  for (std::size_t n = 0; inputs_chatter_ != 0 && n < kInputs; ++n)
    if ((inputs_chatter_ & bit(n)) != 0) set(levels, n, (t_us / chatter_us_[n] & 1u) != 0);
  return (levels | inputs_high_) & ~inputs_low_;
}

std::int32_t Firmware::counts(std::size_t n) noexcept {
  Channel& c = channels_[n];
  if ((description_.capabilities[n] & kHasEncoder) == 0) return 0;
  if (c.stuck) return c.stuck_at;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(hardware_.counts(n)) +
                                   static_cast<std::uint32_t>(c.offset));
}

bool Firmware::faulty(std::size_t n) noexcept {
  return description_.capabilities[n] != 0 &&
         (channels_[n].fault || hardware_.fault(n) != channels_[n].setting.fault_is_low);
}

Status Firmware::status() noexcept {
  Status s;
  s.t_us = hardware_.time_us();
  s.inputs = inputs(s.t_us);
  if (!hardware_.tells_edges()) find_edges(s.inputs, s.t_us);
  std::uint32_t injected =
      inputs_low_ | inputs_high_ | inputs_chatter_ | outputs_low_ | outputs_high_ | analog_injected_;
  for (std::size_t n = 0; n < description_.analog_inputs && n < kAnalog; ++n)
    s.analog[n] = (analog_injected_ & bit(n)) != 0 ? analog_value_[n] : hardware_.analog(n);
  for (std::size_t n = 0; n < kChannels; ++n) {
    Channel& c = channels_[n];
    ChannelStatus& to = s.channels[n];
    to.counts = counts(n);
    to.steps = c.steps.steps();
    std::int32_t at = 0;
    if (c.armed && hardware_.take_index(n, at)) {
      c.latched =
          static_cast<std::int32_t>(static_cast<std::uint32_t>(at) + static_cast<std::uint32_t>(c.offset));
      ++c.latches;
    }
    to.latched = c.latched;
    to.latches = c.latches;
    set(s.faults, n, faulty(n));
    set(s.enabled, n, c.enabled);
    set(s.limited, n, c.limited);
    if (c.stuck || c.fault || c.offset != 0) injected = 1;
  }
  s.flags = static_cast<std::uint8_t>((tripped_ ? kTripped : 0) | (configured_ ? kConfigured : 0) |
                                      (injected != 0 ? kInjected : 0));
  s.lost_edges = lost_edges_;
  s.trips = trips_;
  const std::size_t told = edge_count_ < kEdges ? edge_count_ : kEdges;
  for (std::size_t n = 0; n < told; ++n) s.edges[n] = edges_[n];
  for (std::size_t n = told; n < edge_count_; ++n) edges_[n - told] = edges_[n];
  edge_count_ -= told;
  s.edge_count = static_cast<std::uint8_t>(told);
  return s;
}

void Firmware::note_edge(std::uint8_t input, bool level, std::uint32_t t_us) noexcept {
  if (!configured_ || input >= kInputs || (configuration_.edge_mask & bit(input)) == 0) return;
  // Of a line with an injected fault the wire is not what is seen.
  if (((inputs_low_ | inputs_high_ | inputs_chatter_) & bit(input)) != 0 && hardware_.tells_edges()) return;
  if (edge_count_ == kKept)
    ++lost_edges_;
  else
    edges_[edge_count_++] = {input, level, t_us};
}

void Firmware::find_edges(std::uint32_t levels, std::uint32_t t_us) noexcept {
  std::uint32_t changed = inputs_known_ ? levels ^ last_inputs_ : 0;
  last_inputs_ = levels;
  inputs_known_ = true;
  for (std::uint8_t n = 0; changed != 0; ++n, changed >>= 1)
    if ((changed & 1u) != 0) note_edge(n, (levels & bit(n)) != 0, t_us);
}

void Firmware::tick() noexcept {
  if (!configured_) return;
  if (configuration_.edge_mask != 0 && !hardware_.tells_edges()) {
    const std::uint32_t t_us = hardware_.time_us();
    find_edges(inputs(t_us), t_us);
  }
  for (std::size_t n = 0; n < kChannels; ++n) {
    Channel& c = channels_[n];
    if (c.setting.output != Output::step || !c.enabled) continue;
    const StepPins pins = c.steps.tick();
    hardware_.set_step(n, pins.step, pins.forward);
  }
  if (!commanded_ || tripped_ || ++silent_ticks_ <= watchdog_ticks_) return;
  tripped_ = true;
  ++trips_;
  drop();
}

void Firmware::clear_injections() noexcept {
  inputs_low_ = inputs_high_ = inputs_chatter_ = outputs_low_ = outputs_high_ = 0;
  analog_injected_ = 0;
  for (Channel& c : channels_) {
    c.stuck = c.fault = false;
    c.offset = 0;
  }
}

bool Firmware::inject(const Injection& i) noexcept {
  constexpr std::uint8_t kAll = 255;
  const std::size_t n = i.number;
  const bool channel = n < kChannels && description_.capabilities[n] != 0;
  switch (i.fault) {
    case Fault::none:
      if (i.number != kAll) return false;
      clear_injections();
      return true;
    case Fault::input_low:
    case Fault::input_high:
    case Fault::input_chatter:
      if (n >= description_.inputs || (i.fault == Fault::input_chatter && i.value <= 0)) return false;
      set(inputs_low_, n, i.fault == Fault::input_low);
      set(inputs_high_, n, i.fault == Fault::input_high);
      set(inputs_chatter_, n, i.fault == Fault::input_chatter);
      chatter_us_[n] = static_cast<std::uint32_t>(i.value);
      return true;
    case Fault::output_low:
    case Fault::output_high:
      if (n >= description_.outputs) return false;
      set(outputs_low_, n, i.fault == Fault::output_low);
      set(outputs_high_, n, i.fault == Fault::output_high);
      return true;
    case Fault::analog_value:
      if (n >= description_.analog_inputs || n >= kAnalog) return false;
      set(analog_injected_, n, true);
      analog_value_[n] = bounded(i.value);
      return true;
    case Fault::encoder_stuck:
      if (!channel) return false;
      channels_[n].stuck_at = counts(n);
      channels_[n].stuck = true;
      return true;
    case Fault::encoder_jump:
      if (!channel) return false;
      channels_[n].offset = static_cast<std::int32_t>(static_cast<std::uint32_t>(channels_[n].offset) +
                                                      static_cast<std::uint32_t>(i.value));
      return true;
    case Fault::drive_fault:
      if (!channel) return false;
      channels_[n].fault = true;
      return true;
  }
  return false;
}

std::size_t Firmware::receive(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> answer) noexcept {
  Message m;
  if (!parse(bytes, m)) return put({Kind::refused, 0}, Refusal{0, Reason::wrong_length}, answer);
  const std::uint32_t sequence = m.header.sequence;
  const auto refuse = [&](Reason reason) {
    return put({Kind::refused, sequence}, Refusal{static_cast<std::uint8_t>(m.header.kind), reason}, answer);
  };
  switch (m.header.kind) {
    case Kind::describe:
      return put({Kind::description, sequence}, description_, answer);
    case Kind::configure: {
      Configuration c;
      if (!take(m.body, c)) return refuse(Reason::wrong_length);
      return put({Kind::configured, sequence}, configure(c), answer);
    }
    case Kind::cycle: {
      Command c;
      if (!configured_) return refuse(Reason::not_configured);
      if (!take(m.body, c)) return refuse(Reason::wrong_length);
      carry_out(c);
      return put({Kind::status, sequence}, status(), answer);
    }
    case Kind::inject: {
      Injection i;
      if (!take(m.body, i) || !inject(i)) return refuse(Reason::wrong_length);
      return put({Kind::injected, sequence}, answer);
    }
    case Kind::leave:
      drop();
      configured_ = commanded_ = tripped_ = false;
      return put({Kind::left, sequence}, answer);
    default:
      return refuse(Reason::unknown_kind);
  }
}

}  // namespace servogate::board
