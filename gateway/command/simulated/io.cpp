// SPDX-License-Identifier: Apache-2.0
// `servogate io`: simulated CiA 401 modules on a bus, as a process of their own.
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <memory>

#include "drivers/clock.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/named_bus.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/drive_desk.hpp"
#include "gateway/compose/can_transport.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kLives{"io.lives", "node {0} on {1}: {2}", "узел {0} на {1}: {2}"};
const text::Entry kGone{"io.gone", "the bus {0} is gone", "шина {0} исчезла"};
const text::Entry kBadLine{
    "io.bad-line",
    "'{0}' is none of: di0 on, di0 off, ai0 1234, status, each with NODE. before it when there are several",
    "«{0}»: нужно di0 on, di0 off, ai0 1234 или status, перед ними УЗЕЛ., если узлов несколько"};

/// A module, and what was told of its outputs.
struct Module {
  explicit Module(const mock::SimulatedIoConfig& c)
      : config(c), device(c), digital(c.terminals.digital_outputs), analogue(c.terminals.analogue_outputs) {}
  mock::SimulatedIoConfig config;
  mock::SimulatedIoModule device;
  std::vector<bool> digital;
  std::vector<std::int16_t> analogue;
};

/// "7.dq3 on", "7.aq0 -1200".
void print_terminal(const Module& m, const char* kind, std::size_t number, const std::string& value) {
  print_line(std::to_string(m.config.node_id) + "." + kind + std::to_string(number) + " " + value);
}

/// What has changed on the output terminals, or with `all` everything.
void print_outputs(Module& m, bool all) {
  for (std::size_t i = 0; i < m.digital.size(); ++i) {
    const bool now = m.device.digital(static_cast<std::uint8_t>(i));
    if (all || now != m.digital[i]) print_terminal(m, "dq", i, now ? "on" : "off");
    m.digital[i] = now;
  }
  for (std::size_t i = 0; i < m.analogue.size(); ++i) {
    const std::int16_t now = m.device.analogue(static_cast<std::uint8_t>(i));
    if (all || now != m.analogue[i]) print_terminal(m, "aq", i, std::to_string(now));
    m.analogue[i] = now;
  }
  std::fflush(stdout);
}

/// The whole text as a number between two limits.
bool number_of(std::string_view text, int low, int high, int& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && number >= low && number <= high;
}

bool set_terminal(Module& m, std::string_view terminal, std::string_view value) {
  const canopen::IoTerminals& t = m.config.terminals;
  int number = 0, level = 0;
  if (terminal.starts_with("di") && (value == "on" || value == "off") &&
      number_of(terminal.substr(2), 0, t.digital_inputs - 1, number)) {
    m.device.set_digital(static_cast<std::uint8_t>(number), value == "on");
    return true;
  }
  if (terminal.starts_with("ai") && number_of(terminal.substr(2), 0, t.analogue_inputs - 1, number) &&
      number_of(value, -32768, 32767, level)) {
    m.device.set_analogue(static_cast<std::uint8_t>(number), static_cast<std::int16_t>(level));
    return true;
  }
  return false;
}

class Modules {
 public:
  Modules(const IoOptions& options, image::CanBus& bus, image::Nanoseconds now) : bus_(bus) {
    for (const int node : options.nodes) {
      mock::SimulatedIoConfig c;
      c.node_id = static_cast<canopen::NodeId>(node);
      c.serial_number = static_cast<std::uint32_t>(node);
      c.terminals = {static_cast<std::uint8_t>(options.digital_inputs),
                     static_cast<std::uint8_t>(options.digital_outputs),
                     static_cast<std::uint8_t>(options.analogue_inputs),
                     static_cast<std::uint8_t>(options.analogue_outputs)};
      all_.push_back(std::make_unique<Module>(c));
      all_.back()->device.connect(bus, now);
    }
  }
  void advance_to(image::Nanoseconds now) {
    image::CanFrame frame;
    while (bus_.receive(frame)) {
      frame.timestamp_ns = std::min(frame.timestamp_ns, now);
      for (const auto& m : all_) m->device.on_frame(frame);
    }
    for (const auto& m : all_) {
      m->device.advance_to(now);
      print_outputs(*m, false);
    }
  }
  image::Nanoseconds next_action_ns() const {
    image::Nanoseconds next = all_.front()->device.next_action_ns();
    for (const auto& m : all_) next = std::min(next, m->device.next_action_ns());
    return next;
  }
  /// A line of standard input.
  void take(std::string line) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    const std::string_view text = line;
    const std::size_t point = text.find('.'), blank = text.find(' ');
    int node = 0;
    const bool named = point < blank && number_of(text.substr(0, point), 1, 127, node);
    if (named || all_.size() == 1) {
      const std::string_view rest = named ? text.substr(point + 1) : text;
      const std::size_t gap = rest.find(' ');
      for (const auto& m : all_) {
        if (named && m->config.node_id != node) continue;
        if (rest == "status") return print_outputs(*m, true);
        if (gap != std::string_view::npos && set_terminal(*m, rest.substr(0, gap), rest.substr(gap + 1)))
          return;
      }
    }
    complain(kBadLine, {line});
  }

 private:
  image::CanBus& bus_;
  std::vector<std::unique_ptr<Module>> all_;
};

int live(const std::string& url, const CanTransport& transport, Modules& modules, DriveDesk& desk,
         const EndBySignal& signals) {
  const auto take = [&](const std::string& line) {
    modules.take(line);
    return true;
  };
  bool heard = transport.bus->state() != image::CanState::down;
  while (!signals.ended()) {
    modules.advance_to(drivers::clock_ns(CLOCK_MONOTONIC));
    desk.advance(0, {}, take);
    const bool down = transport.bus->state() == image::CanState::down;
    // An interface comes back; a server or an adapter does not.
    if (down && heard && !url.starts_with("socketcan:")) {
      complain(kGone, {url});
      return kInfrastructure;
    }
    heard = heard || !down;
    pollfd p[] = {{transport.descriptor, POLLIN, 0}, {desk.descriptor(), POLLIN, 0}};
    const image::Nanoseconds quiet = modules.next_action_ns() - drivers::clock_ns(CLOCK_MONOTONIC);
    const timespec limit{0, std::clamp<image::Nanoseconds>(quiet, 50'000, image::kMillisecond)};
    ppoll(p, 2, &limit, nullptr);
  }
  return kDone;
}

int live_in_lockstep(const IoOptions& options, usercan::SocketcandBus& bus, const EndBySignal& signals) {
  auto now = bus.wait_grant();
  if (!now) return kDone;
  Modules modules(options, bus, *now);
  for (; now && !signals.ended(); now = bus.wait_grant()) {
    modules.advance_to(*now);
    bus.done(std::max(modules.next_action_ns(), *now + 1));
  }
  return kDone;
}

}  // namespace

int io(const IoOptions& options) {
  const auto named = named_bus(options.bus, options.bit_rate);
  if (!named) return kWrongUse;
  const EndBySignal signals;
  CanTransportOptions transport_options;
  transport_options.bit_rate = named->bit_rate;
  for (const int node : options.nodes) transport_options.participant += "node" + std::to_string(node);
  drivers::Notice why;
  const auto transport = open_can(named->url, transport_options, why);
  if (!transport) {
    complain(*why.entry, why.arguments);
    return kInfrastructure;
  }
  for (const int node : options.nodes)
    std::fprintf(stderr, "%s\n",
                 text::render(kLives,
                              std::vector<std::string>{std::to_string(node), named->url,
                                                       mock::SimulatedIoConfig{}.name},
                              text::user_language())
                     .c_str());
  if (transport->lockstep != nullptr) return live_in_lockstep(options, *transport->lockstep, signals);
  DriveDesk desk({}, true);
  Modules modules(options, *transport->bus, drivers::clock_ns(CLOCK_MONOTONIC));
  return live(named->url, *transport, modules, desk, signals);
}

}  // namespace servogate::gateway::command
