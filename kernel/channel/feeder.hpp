// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/channel/event.hpp"
#include "kernel/channel/motion/infeed.hpp"
#include "kernel/channel/motion/path_elements.hpp"
#include "kernel/channel/motion/tap_commands.hpp"
#include "kernel/channel/motion/touch.hpp"
#include "kernel/channel/motion/touch_log.hpp"
#include "kernel/channel/motion/ways.hpp"
#include "kernel/channel/neighbours.hpp"
#include "kernel/channel/program_texts.hpp"
#include "kernel/path/planner.hpp"
#include "kernel/program/interpreter/interpreter.hpp"

namespace servogate::channel {

/// Constructs the interpreter of a loaded program for the position at which it starts.
using InterpreterFactory = std::function<program::Interpreter(const program::Position& start)>;

/// The same for a run that begins in the middle of its program, which depends on the packets at its start.
using RestartFactory =
    std::function<program::Interpreter(const program::Position& start, const image::Packets& packets)>;

/// What the cycle tells the feeder.
struct FeederOrder {
  enum class Kind : std::uint8_t {
    start,    ///< begin at the first block, axes stand at `position`
    abandon,  ///< drop what is under way; the next order is a start
    sync,     ///< the sync event has been reached; packets stand in Link::packets_of()
    run_on,   ///< no longer block by block
    supply,   ///< another process is at rest for the program of process_start `event`
    probed,   ///< the motion of a probe has ended: it stands at `position` and touched at `touched`
    way,      ///< along the path from where the held program stands, at `position`
  };
  Kind kind = Kind::start;
  std::uint32_t generation = 0;  ///< of the run it speaks of
  bool manual_data = false;      ///< start: the typed block instead of the program
  bool block_by_block = false;   ///< start: STEP mode
  program::Position position{}, touched{};
  std::uint32_t axes = 0;  ///< start: the machine axes that its programs move, as bits
  WayOrder way;
  std::uint32_t event = 0;       ///< supply: Event::id
  bool spindle_is_axis = false;  ///< start of a typed block: the first spindle is its rotary axis
};

/// The queues between feeder (outside) and process (in the cycle).
struct Link {
  explicit Link(const path::Config& config)
      : track(config), way(config), events(4096), at_once(1024), orders(64) {}
  path::Track track;
  WayLink way;
  path::Ring<Event> events;   ///< executed at rest, in path order
  path::Ring<Event> at_once;  ///< asynchronous writes, warnings
  path::Ring<FeederOrder> orders;

  /// Written by the cycle before a start or sync order of a run, read by the feeder after it. Runs alternate,
  /// so that a new one never writes what the feeder still reads.
  image::Packets& packets_of(std::uint32_t generation) { return packets[generation % packets.size()]; }
  std::array<image::Packets, 4> packets;
  /// What each axis still had to go then, mm or degrees; written and read as packets_of().
  program::Position& to_go_of(std::uint32_t generation) { return to_go[generation % to_go.size()]; }
  std::array<program::Position, 4> to_go{};
  /// Cycle: both, as they are now. real-time safe.
  void look(std::uint32_t generation, const image::ProcessImage& image) noexcept {
    packets_of(generation) = image.packets;
    for (int a = 0; a < image.axis_count; ++a)
      to_go_of(generation)[static_cast<std::size_t>(a)] =
          image.axes[static_cast<std::size_t>(a)].distance_to_go;
  }

  /// Where the queues stood when the feeder began a run: what is published from there on belongs to it.
  struct Begin {
    path::Track::Begin track;
    std::uint64_t event = 0, at_once = 0;
  };
  /// Feeder: written before the first entry of the run is published.
  void begin(std::uint32_t generation, const Begin& at) noexcept {
    begins[generation % begins.size()] = at;
    begun.store(generation, std::memory_order_release);
  }
  /// Cycle: nullptr while the feeder has not begun this run. real-time safe.
  const Begin* begin_of(std::uint32_t generation) const noexcept {
    return begun.load(std::memory_order_acquire) == generation ? &begins[generation % begins.size()]
                                                               : nullptr;
  }
  std::array<Begin, 4> begins{};
  std::atomic<std::uint32_t> begun{0};
};

/// When a feeder is to work next.
enum class Reading : std::uint8_t {
  nothing,  ///< there is nothing to do until the cycle goes on
  beside,   ///< there is, and the motion has enough for a while: it may be done beside the next cycles
  now,      ///< the next cycle needs it
};

/// Pulls commands from the interpreter, turns them into path elements and events. Runs outside the cycle, on
/// one thread; in virtual time between two cycles, or beside them between hold() and let_go(). Not real-time
/// safe.
class Feeder {
 public:
  Feeder(path::Config config, AxisMap axes, Link& link, int process);
  ~Feeder();

  /// Makes a program ready for start; not while one runs.
  void load(InterpreterFactory factory);
  /// As load(); what MDI has in force (modes, origins) stays, with these tables from now on.
  void load(InterpreterFactory factory, program::Tables tables);
  /// The interpreter in which the next typed block will run, standing at `at`; a copy. Needs a loaded
  /// program.
  program::Interpreter manual_interpreter(const program::Position& at) const;
  /// The next run of the program is that of this interpreter; a load takes it back.
  void begin_next_with(RestartFactory once) { once_ = std::move(once); }
  /// MDI begins with the power-on modes again.
  void forget_manual() { manual_.reset(); }
  /// The block that the next start in MDI mode runs.
  void set_manual_block(std::string block) {
    manual_block_ = std::move(block);
    touch_order_.reset();
  }
  /// Instead of a block the next start in MDI mode measures; once.
  void set_touch(const TouchOrder& order) {
    touch_order_ = order;
    manual_block_.clear();
  }
  /// What the last such start has found.
  const Touches& touches() const noexcept { return touches_; }
  /// All that its measuring motions have found.
  const TouchLog& touch_log() const noexcept { return touch_log_; }
  /// A run is being read or about to be: load() has to wait. False once its last motion has been read
  /// and planned.
  bool reads() const noexcept {
    return state_ == State::feeding || state_ == State::syncing || state_ == State::probing || ordered() ||
           (state_ == State::ended && planner_.ends());
  }
  bool loaded() const noexcept { return static_cast<bool>(factory_); }
  /// The machine has so many processes, and programs of others come from there. Before the first program.
  void set_neighbours(int processes, ProgramSupplier supplier) {
    processes_ = processes;
    supplier_ = std::move(supplier);
  }

  /// Takes orders, reads ahead as far as the planner wants, publishes. Bounded work a call. True: it is to be
  /// called again soon, there is more to do.
  bool work();

  /// What is to be done next, by what the cycle has given back and ordered up to now. `driven`:
  /// path::Follower::driven().
  Reading reading(std::optional<double> driven) const;
  /// An order waits.
  bool ordered() const noexcept { return orders_read_ < link_.orders.written(); }
  /// Between these work_beside() sees what is given back as it is now.
  void hold() noexcept;
  void let_go() noexcept;
  /// For how long the cycle needs nothing of what reading beside it gives, s of the machine; at least 0.2
  /// where reading() says beside.
  double spare(std::optional<double> driven) const;
  /// As work() until nothing more is wanted, or until twice `seconds` of motion are planned, so that a round
  /// which may take that long has little more to do than the next one. Takes no orders. Bounded.
  void work_beside(double seconds);

  /// What its programs have said so far; Event::code of messages, warnings and errors are numbers in it. For
  /// any thread outside the cycle.
  const ProgramTexts& texts() const noexcept { return texts_; }
  /// Blocks of the run that the interpreter has executed (read ahead of motion), and blocks of the main
  /// program.
  long long executed() const noexcept {
    return interpreter_ ? interpreter_->executed() - executed_before_ : 0;
  }
  int block_count() const noexcept { return interpreter_ ? interpreter_->block_count() : 0; }
  /// Tables as the running program left them (RQO ...).
  const program::Tables* tables() const noexcept { return interpreter_ ? &interpreter_->tables() : nullptr; }
  const program::Interpreter* interpreter() const noexcept { return interpreter_ ? &*interpreter_ : nullptr; }

 private:
  enum class State { idle, feeding, syncing, probing, ended };

  bool wants_more() const;
  /// Up to so many commands, until so much is planned; nullopt: until nothing is left to do for now.
  void read_and_plan(int commands, std::optional<double> planned);
  void take_orders();
  void begin(const FeederOrder& order);
  void read_one();
  void accept(const program::Command& command);
  bool is_news(const text::Finding& warning);
  void warn();
  void fail(const text::Finding& finding);
  void warn_of_rest();
  void end();
  bool move(const program::Command& command);
  bool take_tap(const program::Command& command);
  void tap();
  void probe(const program::Command& command);
  void take_touch(const FeederOrder& order);
  void refuse_foreign(int axis, const program::Command& command);
  void set_windows(const program::InPosition& windows, const program::Command& command);
  void order_process(const program::ProcessOrder& order, const program::Command& command);
  void supply();
  void event(EventKind kind, const program::Command& command, Event event);
  void end_block(const program::Command& next);
  void push(Event& event, const program::Command& command);
  path::Tag tag(const program::Command& command) const;
  text::Finding placed(text::Finding finding, const program::Command& command) const;

  path::Config config_;
  AxisMap axes_;
  PathElements elements_;
  Infeed infeed_;
  Link& link_;
  path::Planner planner_;
  Ways ways_;
  int process_;
  int processes_ = 1;
  ProgramSupplier supplier_;
  /// A program for another process, from its block to its process_start.
  struct Wanted {
    std::uint32_t event = 0;
    int process = 0;
    std::string name;
    text::Finding missing;
  };
  std::vector<Wanted> wanted_;
  TapCommands tap_;
  std::uint32_t supplied_event_ = 0;  ///< whose process is at rest now; 0: none
  InterpreterFactory factory_;
  RestartFactory once_;  ///< instead, for the next run
  std::string manual_block_;
  std::optional<TouchOrder> touch_order_;
  std::optional<Touch> touch_;  ///< of the run
  Touches touches_;
  TouchPlace measuring_;  ///< of the measuring motion under way
  TouchLog touch_log_;
  std::optional<program::Interpreter> interpreter_;
  std::optional<program::Interpreter> manual_;  ///< modes that MDI left, between two blocks
  bool manual_runs_ = false;                    ///< interpreter_ runs a typed block
  std::optional<program::Tables> tables_;       ///< newer than those in manual_
  State state_ = State::idle;
  bool synchronised_ = false;
  bool block_by_block_ = false;
  bool acted_in_block_ = false;
  int last_line_ = 0;
  long long last_executed_ = 0;  ///< blocks executed up to the last command
  image::Packets view_;          ///< packets as the interpreter sees them
  program::Position position_{};
  std::uint32_t next_event_ = 1, last_event_ = 0;
  std::uint32_t generation_ = 0;
  std::uint64_t orders_read_ = 0;
  ProgramTexts texts_;
  std::size_t files_told_ = 0;
  program::Frame frame_told_;
  long long published_in_ = -1;    ///< executed() of the last command that was published
  long long executed_before_ = 0;  ///< by the interpreter, typed blocks before this one
  int last_file_ = 0;
  std::size_t warned_ = 0;  ///< of interpreter_'s warnings
  /// What of them has been raised in this run: the text with the word and its figure, whatever the line.
  std::vector<std::pair<const text::Entry*, std::vector<std::string>>> raised_;
};

}  // namespace servogate::channel
