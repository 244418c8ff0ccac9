// SPDX-License-Identifier: Apache-2.0
// `servogate io`: simulated CiA 401 modules or CiA 406 encoders on a bus, as a process of their own.
#include <poll.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/clock.hpp"
#include "drivers/mock/io/simulated_encoder.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "firmware_if/canopen/406/objects.hpp"
#include "gateway/cli/json_line.hpp"
#include "gateway/cli/messages.hpp"
#include "gateway/cli/standard_output.hpp"
#include "gateway/command/bus/lost_frames.hpp"
#include "gateway/command/bus/named_bus.hpp"
#include "gateway/command/commands.hpp"
#include "gateway/command/signals.hpp"
#include "gateway/command/simulated/drive_desk.hpp"
#include "gateway/command/simulated/node_presence.hpp"
#include "gateway/control/compose/can_transport.hpp"

namespace servogate::gateway::command {

namespace {

const text::Entry kLives{"io.lives", "node {0} on {1}: {2}", "узел {0} на {1}: {2}"};
const text::Entry kGone{"io.gone", "the bus {0} is gone", "шина {0} исчезла"};
const text::Entry kBadLine{"io.bad-line",
                           "'{0}' is none of: di0 on, di0 off, ai0 1234, of an encoder position 1234, speed "
                           "500, blind on, blind off; "
                           "status; each with NODE. before it when there are several",
                           "«{0}»: нужно di0 on, di0 off, ai0 1234, для датчика position 1234, speed 500, "
                           "blind on, blind off; status; "
                           "перед ними УЗЕЛ., если узлов несколько"};

/// The whole text as a number between two limits.
template <typename Number>
bool number_of(std::string_view text, Number low, Number high, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() && number >= low && number <= high;
}

/// A simulated node with what the world does to it, and what was told of it.
class Node {
 public:
  virtual ~Node() = default;
  virtual mock::CanNode& device() = 0;
  virtual const std::string& name() const = 0;
  virtual void advance_to(image::Nanoseconds now) { device().advance_to(now); }
  /// What has changed, or with `all` everything.
  virtual void print(bool all) = 0;
  /// "di3", "on". False: it has no such thing.
  virtual bool set(std::string_view what, std::string_view value) = 0;

  int id = 0;
  bool json = false;

 protected:
  /// "7.dq3 on", "7.aq0 -1200".
  void say(const std::string& what, const nlohmann::json& value) const {
    if (json) return print_json_line({{"event", "output"}, {"node", id}, {"name", what}, {"value", value}});
    print_line(std::to_string(id) + "." + what + " " +
               (value.is_boolean() ? value.get<bool>() ? "on" : "off" : value.dump()));
  }
};

class Module final : public Node {
 public:
  explicit Module(const mock::SimulatedIoConfig& c)
      : config_(c),
        device_(c),
        digital_(c.terminals.digital_outputs),
        analogue_(c.terminals.analogue_outputs) {}
  mock::CanNode& device() override { return device_; }
  const std::string& name() const override { return config_.name; }

  void print(bool all) override {
    for (std::size_t i = 0; i < digital_.size(); ++i) {
      const bool now = device_.digital(static_cast<std::uint8_t>(i));
      if (all || now != digital_[i]) say("dq" + std::to_string(i), now);
      digital_[i] = now;
    }
    for (std::size_t i = 0; i < analogue_.size(); ++i) {
      const std::int16_t now = device_.analogue(static_cast<std::uint8_t>(i));
      if (all || now != analogue_[i]) say("aq" + std::to_string(i), now);
      analogue_[i] = now;
    }
  }
  bool set(std::string_view terminal, std::string_view value) override {
    const canopen::IoTerminals& t = config_.terminals;
    int number = 0, level = 0;
    if (terminal.starts_with("di") && (value == "on" || value == "off") &&
        number_of(terminal.substr(2), 0, t.digital_inputs - 1, number)) {
      device_.set_digital(static_cast<std::uint8_t>(number), value == "on");
      return true;
    }
    if (terminal.starts_with("ai") && number_of(terminal.substr(2), 0, t.analogue_inputs - 1, number) &&
        number_of(value, -32768, 32767, level)) {
      device_.set_analogue(static_cast<std::uint8_t>(number), static_cast<std::int16_t>(level));
      return true;
    }
    return false;
  }

 private:
  mock::SimulatedIoConfig config_;
  mock::SimulatedIoModule device_;
  std::vector<bool> digital_;
  std::vector<std::int16_t> analogue_;
};

class Encoder final : public Node {
 public:
  explicit Encoder(const mock::SimulatedEncoderConfig& c) : config_(c), device_(c) {}
  mock::CanNode& device() override { return device_; }
  const std::string& name() const override { return config_.name; }

  void advance_to(image::Nanoseconds now) override {
    now_ = now;
    if (speed_ != 0)
      device_.set_position(
          from_ + std::llround(static_cast<double>(speed_) * static_cast<double>(now - since_) * 1e-9));
    Node::advance_to(now);
  }
  void print(bool all) override {
    if (all) say("position", device_.object(canopen::encoder::kPositionValue));
  }
  bool set(std::string_view what, std::string_view value) override {
    constexpr std::int64_t kFar = std::int64_t{1} << 40;
    std::int64_t number = 0;
    if (what == "blind" && (value == "on" || value == "off")) {
      device_.set_unreadable(value == "on");
      return true;
    }
    if ((what != "position" && what != "speed") || !number_of(value, -kFar, kFar, number)) return false;
    if (what == "position") device_.set_position(number);
    speed_ = what == "speed" ? number : 0;
    from_ = device_.position();
    since_ = now_;
    return true;
  }

 private:
  mock::SimulatedEncoderConfig config_;
  mock::SimulatedEncoder device_;
  std::int64_t speed_ = 0;  ///< counts/s from `from_` at `since_` on
  std::int64_t from_ = 0;
  image::Nanoseconds since_ = 0, now_ = 0;
};

template <class Config>
Config with_node(int id) {
  Config c;
  c.node_id = static_cast<canopen::NodeId>(id);
  c.serial_number = static_cast<std::uint32_t>(id);
  return c;
}

std::unique_ptr<Node> make_node(const IoOptions& options, int id) {
  std::unique_ptr<Node> node;
  if (options.kind == "encoder") {
    auto c = with_node<mock::SimulatedEncoderConfig>(id);
    c.resolution = {static_cast<std::uint32_t>(options.counts_per_rev),
                    static_cast<std::uint16_t>(options.revolutions)};
    node = std::make_unique<Encoder>(c);
  } else {
    auto c = with_node<mock::SimulatedIoConfig>(id);
    c.terminals = {static_cast<std::uint8_t>(options.digital_inputs),
                   static_cast<std::uint8_t>(options.digital_outputs),
                   static_cast<std::uint8_t>(options.analogue_inputs),
                   static_cast<std::uint8_t>(options.analogue_outputs)};
    node = std::make_unique<Module>(c);
  }
  node->id = id;
  node->json = options.json;
  return node;
}

class Nodes {
 public:
  Nodes(const IoOptions& options, image::CanBus& bus, image::Nanoseconds now)
      : bus_(bus), twins_(options.bus, [this](int node) { return has(node); }) {
    for (const int id : options.nodes) {
      all_.push_back(make_node(options, id));
      all_.back()->device().connect(bus, now);
      all_.back()->advance_to(now);
    }
  }
  void advance_to(image::Nanoseconds now) {
    image::CanFrame frame;
    while (bus_.receive(frame)) {
      frame.timestamp_ns = std::min(frame.timestamp_ns, now);
      twins_.hear(frame);
      for (const auto& n : all_) n->device().on_frame(frame);
    }
    for (const auto& n : all_) {
      n->advance_to(now);
      n->print(false);
    }
    std::fflush(stdout);
  }
  image::Nanoseconds next_action_ns() const {
    image::Nanoseconds next = all_.front()->device().next_action_ns();
    for (const auto& n : all_) next = std::min(next, n->device().next_action_ns());
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
      for (const auto& n : all_) {
        if (named && n->id != node) continue;
        if (rest == "status") return n->print(true);
        if (gap != std::string_view::npos && n->set(rest.substr(0, gap), rest.substr(gap + 1))) return;
      }
    }
    complain(kBadLine, {line});
  }

 private:
  bool has(int node) const {
    return std::any_of(all_.begin(), all_.end(), [node](const auto& n) { return n->id == node; });
  }

  image::CanBus& bus_;
  TwinWatch twins_;
  std::vector<std::unique_ptr<Node>> all_;
};

int live(const IoOptions& options, const std::string& url, const CanTransport& transport,
         const EndBySignal& signals) {
  DriveDesk desk({}, true, options.json);
  Nodes nodes(options, *transport.bus, drivers::clock_ns(CLOCK_MONOTONIC));
  const auto take = [&](const std::string& line) {
    nodes.take(line);
    return true;
  };
  bool heard = transport.bus->state() != image::CanState::down;
  while (!signals.ended()) {
    nodes.advance_to(drivers::clock_ns(CLOCK_MONOTONIC));
    desk.advance(0, {}, take);
    const bool down = transport.bus->state() == image::CanState::down;
    // An interface comes back; a server or an adapter does not.
    if (down && heard && !url.starts_with("socketcan:")) {
      complain(kGone, {url});
      return kInfrastructure;
    }
    heard = heard || !down;
    pollfd p[] = {{transport.descriptor, POLLIN, 0}, {desk.descriptor(), POLLIN, 0}};
    const image::Nanoseconds quiet = nodes.next_action_ns() - drivers::clock_ns(CLOCK_MONOTONIC);
    const timespec limit{0, std::clamp<image::Nanoseconds>(quiet, 50'000, image::kMillisecond)};
    ppoll(p, 2, &limit, nullptr);
  }
  return kDone;
}

int live_in_lockstep(const IoOptions& options, usercan::SocketcandBus& bus, const EndBySignal& signals) {
  auto now = bus.wait_grant();
  if (!now) return kDone;
  Nodes nodes(options, bus, *now);
  for (; now && !signals.ended(); now = bus.wait_grant()) {
    nodes.advance_to(*now);
    bus.done(std::max(nodes.next_action_ns(), *now + 1));
  }
  return kDone;
}

}  // namespace

int io(const IoOptions& options) {
  if (!each_once(options.nodes)) return kWrongUse;
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
  if (transport->lockstep == nullptr)
    if (const int code = may_join(*transport, named->url, options.nodes, !named->machine, signals);
        code != kDone)
      return code;
  const std::string name = make_node(options, 1)->name();
  for (const int node : options.nodes) {
    tell(text::render(kLives, std::vector<std::string>{std::to_string(node), named->url, name},
                      text::user_language()));
    if (options.json)
      print_json_line({{"event", "node"}, {"node", node}, {"bus", named->url}, {"device", name}});
  }
  const int code = transport->lockstep != nullptr ? live_in_lockstep(options, *transport->lockstep, signals)
                                                  : live(options, named->url, *transport, signals);
  return unless_frames_lost(code, named->url, *transport->bus);
}

}  // namespace servogate::gateway::command
