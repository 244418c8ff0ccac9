// SPDX-License-Identifier: Apache-2.0
#include "kernel/channel/feeder.hpp"

#include <algorithm>
#include <utility>

#include "firmware_if/image/interface_map.hpp"
#include "kernel/channel/for_cycle.hpp"

namespace servogate::channel {

namespace {

constexpr int kCommandsPerWork = 64;
constexpr int kWorksBeside = 64;
constexpr double kAmple = 1.2;       // s that lie ahead: the motion goes on in them while more is planned
constexpr double kLeastSpare = 0.2;  // s of them that a round may take at an override of 150 %
constexpr double kPlannedBeside = 2.0;
constexpr std::uint32_t kSpareEvents = 8;
// STEP: so many ends of blocks are read ahead. Where the program is to run on, it rests there all the same.
constexpr std::uint64_t kBlocksAhead = 3;

/// Something has been done when it is through: STEP stops behind it. A programmed stop waits by itself.
bool acts(const program::Command& command) {
  if (const auto* tool = std::get_if<program::Tool>(&command.what)) return !tool->activate;
  return !std::holds_alternative<program::Stop>(command.what) &&
         !std::holds_alternative<program::End>(command.what);
}

/// What the operator has set in the PLC's places, as they are when the program starts.
program::OperatorSwitches switches_of(const image::Packets& packets, int process) {
  using image::field;
  using image::kProcessFields;
  const std::uint32_t base = image::process_base(process);
  program::OperatorSwitches switches;
  switches.skip_levels =
      static_cast<std::uint16_t>(packets.number(image::at(field(kProcessFields, "skip_levels"), base)));
  switches.dry_run = packets.bit(image::at(field(kProcessFields, "dry_run"), base));
  return switches;
}

/// What was cut before it is not what the machine would cut now.
bool bars(EventKind kind) {
  return kind == EventKind::tool || kind == EventKind::spindle || kind == EventKind::m_function ||
         kind == EventKind::h_function || kind == EventKind::feed_override || kind == EventKind::spindle_axis;
}

bool stops(const program::Command& command) {
  const auto* stop = std::get_if<program::Stop>(&command.what);
  return stop != nullptr && !stop->optional;
}

}  // namespace

Feeder::Feeder(path::Config config, AxisMap axes, Link& link, int process)
    : config_(config),
      axes_(std::move(axes)),
      elements_(config, axes_, SpindleAt::fastest),
      infeed_(config),
      link_(link),
      planner_(config, link.track),
      ways_(config, link.way),
      process_(process) {}

Feeder::~Feeder() = default;

void Feeder::load(InterpreterFactory factory) {
  factory_ = std::move(factory);
  once_ = nullptr;
  interpreter_.reset();
  manual_.reset();
  tables_.reset();
  manual_runs_ = false;
}

void Feeder::load(InterpreterFactory factory, program::Tables tables) {
  if (manual_runs_) manual_ = std::move(interpreter_);
  std::optional<program::Interpreter> manual = std::move(manual_);
  load(std::move(factory));
  manual_ = std::move(manual);
  tables_ = std::move(tables);
}

program::Interpreter Feeder::manual_interpreter(const program::Position& at) const {
  if (!manual_ && !manual_runs_) return factory_(at);
  program::Interpreter interpreter = manual_runs_ ? *interpreter_ : *manual_;
  if (tables_) interpreter.adopt(*tables_);
  interpreter.reposition(at);
  return interpreter;
}

bool Feeder::work() {
  take_orders();
  supply();
  read_and_plan(kCommandsPerWork, std::nullopt);
  ways_.work();
  return wants_more() || planner_.ends();
}

Reading Feeder::reading(std::optional<double> driven) const {
  if (ordered() || supplied_event_ != 0 || ways_.waits()) return Reading::now;
  if (!wants_more() && !planner_.waits()) return Reading::nothing;
  return planner_.ahead(driven) >= kAmple ? Reading::beside : Reading::now;
}

double Feeder::spare(std::optional<double> driven) const {
  // Half of it: at an override of 150 % a quarter of what lies ahead is left at the end.
  return std::max(kLeastSpare, (planner_.ahead(driven) - kAmple) / 2.0);
}

void Feeder::hold() noexcept {
  link_.track.hold();
  link_.events.hold();
  link_.at_once.hold();
}

void Feeder::let_go() noexcept {
  link_.track.let_go();
  link_.events.let_go();
  link_.at_once.let_go();
}

void Feeder::work_beside(double seconds) {
  read_and_plan(kWorksBeside * kCommandsPerWork, planner_.planned() + kPlannedBeside * seconds);
}

void Feeder::read_and_plan(int commands, std::optional<double> planned) {
  // What is read is planned at once: a few long elements are enough, and the planner wants nothing while it
  // has something to publish. Windows of a course that may wait are left to the next call, if there will be
  // one: work() says so.
  const auto enough = [&](bool more) {
    if (planned) return planner_.planned() >= *planned;
    return more && (wants_more() || planner_.ends()) && planner_.ahead(std::nullopt) >= kAmple;
  };
  bool more = planner_.work_a_little();
  for (int n = 0; n < commands && (more || wants_more()) && !enough(more); ++n) {
    if (!more) read_one();
    more = planner_.work_a_little();
  }
  warn_of_rest();
}

bool Feeder::wants_more() const {
  const auto room = [](const path::Ring<Event>& ring) {
    return ring.capacity() - (ring.written() - ring.given_back()) > kSpareEvents;
  };
  if (block_by_block_ && link_.events.written() - link_.events.given_back() >= kBlocksAhead) return false;
  return state_ == State::feeding && planner_.wants_more() && room(link_.events) && room(link_.at_once);
}

void Feeder::take_orders() {
  for (; ordered(); link_.orders.free_below(++orders_read_)) {
    const FeederOrder& order = link_.orders[orders_read_];
    switch (order.kind) {
      case FeederOrder::Kind::start:
        begin(order);
        break;
      case FeederOrder::Kind::abandon:
        state_ = State::idle;
        tap_.uncouple();  // as the cycle does where a run is broken off
        break;
      case FeederOrder::Kind::sync:
        if (order.generation != generation_ || state_ != State::syncing) break;
        view_ = link_.packets_of(generation_);
        interpreter_->look_at(link_.to_go_of(generation_));
        synchronised_ = true;
        state_ = State::feeding;
        break;
      case FeederOrder::Kind::run_on:
        if (order.generation == generation_) block_by_block_ = false;
        break;
      case FeederOrder::Kind::supply:
        if (order.generation == generation_) supplied_event_ = order.event;
        break;
      case FeederOrder::Kind::probed:
        if (order.generation == generation_ && state_ == State::probing) take_touch(order);
        break;
      case FeederOrder::Kind::way:
        ways_.plan(order.way, elements_.path_position(order.position));
        break;
    }
  }
}

void Feeder::begin(const FeederOrder& order) {
  generation_ = order.generation;
  position_ = order.position;
  elements_.restart(order.axes);
  block_by_block_ = order.block_by_block;
  acted_in_block_ = false;
  last_line_ = 0;
  last_executed_ = 0;
  last_file_ = 0;
  files_told_ = 0;
  view_ = link_.packets_of(generation_);
  synchronised_ = true;
  ways_.restart();
  link_.begin(generation_, {planner_.restart(elements_.path_position(position_)), link_.events.written(),
                            link_.at_once.written()});
  state_ = State::feeding;
  std::optional<program::Interpreter> manual;
  if (order.manual_data) manual = manual_interpreter(position_);
  if (manual_runs_) manual_ = std::move(interpreter_);
  manual_runs_ = order.manual_data;
  touch_.reset();
  if (order.manual_data && touch_order_) {
    touch_.emplace(*std::exchange(touch_order_, std::nullopt), position_);
    touches_.put(generation_, *touch_);
  }
  if (manual) manual->set_spindle_axis(order.spindle_is_axis);
  if (manual)
    manual->mdi(manual_block_);
  else
    manual.emplace(once_ ? std::exchange(once_, nullptr)(position_, view_) : factory_(position_));
  if (!order.manual_data) manual->set_switches(switches_of(view_, process_));
  interpreter_ = std::move(manual);
  interpreter_->look_at(link_.to_go_of(generation_));
  executed_before_ = order.manual_data ? interpreter_->executed() : 0;
  frame_told_ = interpreter_->frame();
  texts_.add_frame(generation_, 0, frame_told_);
  published_in_ = -1;
  warned_ = 0;
  raised_.clear();
  wanted_.clear();
  tap_.clear();
  if (!order.manual_data) tap_.uncouple();
  infeed_.restart();
  supplied_event_ = 0;
}

void Feeder::read_one() {
  if (touch_) {
    if (const std::optional<program::Command> command = touch_->next()) return accept(*command);
    touch_.reset();
  }
  const program::Step step = interpreter_->next(view_, synchronised_);
  synchronised_ = false;
  if (const std::vector<std::string>& files = interpreter_->files(); files.size() != files_told_) {
    texts_.set_files(generation_, files);
    files_told_ = files.size();
  }
  if (!(interpreter_->frame() == frame_told_)) {
    frame_told_ = interpreter_->frame();
    // What was said of a block stays true: behind its first command a frame is the next block's.
    texts_.add_frame(generation_, published_in_ == executed() ? executed() + 1 : executed(), frame_told_);
  }
  warn();
  if (const auto* command = std::get_if<program::Command>(&step)) {
    accept(*command);
    published_in_ = executed();
  } else if (const auto* sync = std::get_if<program::NeedsSync>(&step)) {
    program::Command at;
    at.line = sync->line;
    at.file = last_file_;
    event(EventKind::sync, at, {});
    state_ = State::syncing;
  } else {
    fail(std::get<program::Error>(step).finding);
  }
}

/// True for the first warning of its kind about the same word and figure, S5000 say, in this run. `check`
/// names every place.
bool Feeder::is_news(const text::Finding& warning) {
  constexpr std::size_t kThing = 2;
  const auto end =
      warning.arguments.begin() + std::min<std::ptrdiff_t>(kThing, std::ssize(warning.arguments));
  std::pair<const text::Entry*, std::vector<std::string>> thing{warning.entry,
                                                                {warning.arguments.begin(), end}};
  if (std::find(raised_.begin(), raised_.end(), thing) != raised_.end()) return false;
  raised_.push_back(std::move(thing));
  return true;
}

/// Hands what the interpreter warns of to the cycle, which raises the alarm without touching the path.
void Feeder::warn() {
  const std::vector<text::Finding>& warnings = interpreter_->warnings();
  for (; warned_ < warnings.size(); ++warned_) {
    if (!is_news(warnings[warned_])) continue;
    Event e;
    e.kind = EventKind::warning;
    e.generation = generation_;
    e.line = warnings[warned_].line;
    e.code2 = warnings[warned_].column;
    e.code = texts_.add_finding(warnings[warned_]);
    link_.at_once.push(e);
  }
}

void Feeder::fail(const text::Finding& finding) {
  program::Command at;
  at.line = finding.line;
  Event e;
  e.code = texts_.add_finding(finding);
  e.kind = EventKind::error;
  e.executed = static_cast<std::uint32_t>(std::max(0LL, executed() - 1));  // the block that fails is not done
  e.line = at.line;
  e.block = at.block;
  e.file = static_cast<std::int16_t>(at.file);
  push(e, at);
  end();
}

/// The path comes to rest where its program does not ask for it.
void Feeder::warn_of_rest() {
  const std::optional<path::Tag> at = planner_.take_unasked_rest();
  if (!at || state_ == State::idle) return;
  program::Command command;
  command.line = at->line;
  command.file = at->file;
  command.block = at->block;
  Event e;
  e.kind = EventKind::warning;
  e.generation = generation_;
  e.line = at->line;
  e.code = texts_.add_finding(placed(rests_inside(), command));
  link_.at_once.push(e);
}

void Feeder::end() {
  planner_.finish();
  state_ = State::ended;
}

text::Finding Feeder::placed(text::Finding finding, const program::Command& command) const {
  finding.file = interpreter_->path(command.file);
  finding.line = command.line;
  finding.column = interpreter_->column(command.file, command.line, -1);
  return finding;
}

path::Tag Feeder::tag(const program::Command& command) const {
  path::Tag t;
  t.line = command.line;
  t.file = command.file;
  t.block = command.block;
  t.process = static_cast<std::int16_t>(process_);
  t.command = run_and_block(generation_, executed());
  return t;
}

void Feeder::event(EventKind kind, const program::Command& command, Event e) {
  e.kind = kind;
  e.executed = static_cast<std::uint32_t>(executed());
  e.line = command.line;
  e.block = command.block;
  e.file = static_cast<std::int16_t>(command.file);
  push(e, command);
}

/// STEP: the block before `next` has ended, and is the one that is shown.
void Feeder::end_block(const program::Command& next) {
  Event e;
  e.kind = EventKind::block_end;
  e.executed = static_cast<std::uint32_t>(last_executed_);
  e.line = last_line_;
  e.file = static_cast<std::int16_t>(last_file_);
  push(e, next);
}

void Feeder::push(Event& e, const program::Command& command) {
  planner_.rest();
  e.id = last_event_ = next_event_++;
  if (next_event_ == 0) next_event_ = 1;
  e.generation = generation_;
  link_.events.push(e);
  planner_.add_event(e.id, tag(command));
  if (bars(e.kind)) ways_.bar();
}

void Feeder::accept(const program::Command& command) {
  if (block_by_block_ && acted_in_block_ && executed() != last_executed_) {
    end_block(command);
    acted_in_block_ = false;
  }
  last_line_ = command.line;
  last_executed_ = executed();
  last_file_ = command.file;
  acted_in_block_ = (acted_in_block_ || acts(command)) && !stops(command);
  if (take_tap(command)) return;
  if (std::holds_alternative<program::Probe>(command.what)) return probe(command);
  if (is_motion(command)) {
    if (std::holds_alternative<program::Thread>(command.what)) ways_.bar();
    move(command);
    return;
  }
  if (const auto* process = std::get_if<program::ProcessOrder>(&command.what))
    return order_process(*process, command);
  if (const auto* windows = std::get_if<program::InPosition>(&command.what))
    return set_windows(*windows, command);
  std::optional<ForCycle> order = for_cycle(command, elements_, texts_, view_);
  if (!order) return;
  if (order->at_once) {
    order->event.kind = order->kind;
    order->event.generation = generation_;
    link_.at_once.push(order->event);
  } else {
    event(order->kind, command, order->event);
  }
  if (order->kind == EventKind::end) end();
}

void Feeder::set_windows(const program::InPosition& windows, const program::Command& command) {
  if (const int axis = elements_.foreign_axis(command, position_); axis >= 0)
    return refuse_foreign(axis, command);
  for (std::uint8_t a = 0; a < image::kMaxAxes; ++a) {
    if ((windows.axes >> a & 1u) == 0) continue;
    Event e;
    e.number = a;
    e.value = windows.window[a];
    event(EventKind::window, command, e);
  }
}

void Feeder::refuse_foreign(int axis, const program::Command& command) {
  text::Finding finding =
      placed(foreign(interpreter_->machine().axes[static_cast<std::size_t>(axis)].letter), command);
  finding.column = interpreter_->column(command.file, command.line, axis);
  fail(finding);
}

bool Feeder::move(const program::Command& command) {
  if (const int axis = elements_.foreign_axis(command, position_); axis >= 0) {
    refuse_foreign(axis, command);
    return false;
  }
  const path::Vector from = planner_.position();
  path::Element element = elements_.element(command, from);
  element.tag = tag(command);
  const bool thread = element.lock.kind != path::Lock::Kind::none;
  if (thread) infeed_.put(element.lock);
  if (planner_.add(element)) {
    if (!thread) infeed_.take(from, element.to);
    elements_.driven(element, from);
    ways_.add(element, from);
    return true;
  }
  fail(placed(cannot_drive(planner_.last_flaw()), command));
  return false;
}

}  // namespace servogate::channel
