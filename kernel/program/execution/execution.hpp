// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kernel/program/execution/motion/followers.hpp"
#include "kernel/program/execution/motion/motion.hpp"
#include "kernel/program/values/expression.hpp"
#include "kernel/program/values/packet_view.hpp"

namespace servogate::program {

/// All that a copy of an execution copies. Each part of an execution works on its own piece of it.
struct ExecutionData {
  ExecutionData(const Dialect& dialect, MachineModel machine, Tables tables, std::string file_name,
                ProgramText text, ProgramLoader loader, const Position& start, int process);

  std::shared_ptr<const MachineModel> machine;
  std::shared_ptr<const Dialect> extended;  ///< with the own codes of the machine, where it has some
  const Dialect* dialect;
  AxisLetters axes;
  const Dialect* language;                 ///< as it is without them
  const Dialect* next_language = nullptr;  ///< of the blocks behind this one; null: the same
  /// What the caller of each subprogram comes back to.
  struct Caller {
    const Dialect* language;
    std::optional<Modes> modes;
  };
  std::vector<Caller> callers;
  int process;
  ProgramFiles files;
  State state;
  std::optional<ContourState> contour_before;  ///< of the block that is executed, where it has one
  std::optional<State> before_mdi;             ///< while a typed block runs: comes back where that fails
  Block block;
  std::uint32_t line = 0;  ///< of that block
  CommandQueue queue;
  Warnings warnings;
  std::optional<Step> last;  ///< the end of the run
  std::vector<SettingFault> setting_faults;
  std::optional<ProgramError> power_on_error;  ///< the first of them
  long long since_command = 0;                 ///< blocks executed
  PacketView view;
  Position to_go{};  ///< of each axis, see Interpreter::look_at()
  mutable bool snapshot_used = false;
  mutable bool machine_read = false;
  bool want_fresh = false;
};

/// Runs the blocks of a program by a dialect's tables: takes words together, gives each to the part whose
/// matter it is, and hands out the commands. The dialect's own functions (three-letter codes, variables) are
/// written against the public part and the four parts behind it. A value: copying it copies the whole state
/// of the run.
class Execution : public ValueSource {
 public:
  Execution(const Dialect& dialect, MachineModel machine, Tables tables, std::string file_name,
            ProgramText text, ProgramLoader loader, const Position& start, int process);
  Execution(const Execution& other) : ValueSource(), data_(other.data_) {}
  Execution& operator=(const Execution&) = delete;

  /// See Interpreter.
  Step next(const image::Packets& packets, bool synchronised);
  bool pass_over_error();
  void mdi(std::string_view block);
  void reposition(const Position& at);
  void look_at(const Position& to_go) { data_.to_go = to_go; }
  /// See Interpreter::probed().
  void probed(const Position& at);
  /// What an axis still has to go in its block.
  double to_go(int axis) const noexcept {
    data_.snapshot_used = data_.machine_read = true;
    return data_.to_go[static_cast<std::size_t>(axis)];
  }
  bool machine_read() const noexcept { return data_.machine_read; }
  const std::vector<SettingFault>& setting_faults() const noexcept { return data_.setting_faults; }
  const std::vector<text::Finding>& warnings() const noexcept { return data_.warnings.told; }

  Flow& flow() noexcept { return flow_; }
  const Flow& flow() const noexcept { return flow_; }
  Frames& frames() noexcept { return frames_; }
  const Frames& frames() const noexcept { return frames_; }
  Motion& motion() noexcept { return motion_; }
  Contour& contour() noexcept { return contour_; }
  const Contour& contour() const noexcept { return contour_; }
  Capability& capability() noexcept { return capability_; }
  const Capability& capability() const noexcept { return capability_; }
  const Numbers& numbers() const noexcept { return numbers_; }

  const Dialect& dialect() const noexcept { return dialect_; }
  const MachineModel& machine() const noexcept { return machine_; }
  int process() const noexcept { return data_.process; }  ///< from 0
  const AxisLetters& axes() const noexcept { return data_.axes; }
  State& state() noexcept { return state_; }
  const State& state() const noexcept { return state_; }
  Block& block() noexcept { return block_; }
  const Block& block() const noexcept { return block_; }

  // --- values and packets ---
  double parameter(int index, int column) const override;
  double place(const image::Place& place, int column) const override;
  double system(int number, int column) const override {
    return dialect_.system == nullptr ? 0.0 : dialect_.system(*this, number, column);
  }
  /// Value of an expression of the block, in its line from `pos` on; moves `pos` behind it.
  double evaluate(std::size_t& pos) const;
  void write(const image::Place& place, double value, int column);
  void write(const image::Place& place, std::string_view characters, int column);
  /// What the program does from here on depends on the machine.
  void depends_on_machine() const noexcept { data_.machine_read = true; }
  /// Characters that a write depends on are read from the snapshot.
  void use_snapshot() const noexcept { data_.snapshot_used = true; }
  std::string characters(const image::Place& place, int column) const {
    data_.machine_read = true;
    return data_.view.text(place, column);
  }
  void check_storable(const image::Place& place, double value, int column) const {
    data_.view.storable(place, value, column);
  }

  // --- the block ---
  template <typename What>
  void emit(What&& what) {
    output_.emit(std::forward<What>(what));
  }
  /// Throws for an axis that no block may name now: a virtual one that is not in force, one that follows
  /// others.
  void refuse_barred(int axis, int column) const;
  /// The blocks behind this one are read in another language.
  void speak(const Dialect& language) { data_.next_language = &language; }
  const Dialect& language() const noexcept { return *data_.language; }
  /// The modes in force come back where this subprogram ends.
  void keep_modes();
  /// Refuses the words of a block that has no motion, but for those that its function takes.
  void refuse_all_but(const BlockWords& words, std::initializer_list<const Word*> taken) const;
  /// The same, but for axes and F.
  void refuse_words_but_axes(const BlockWords& words) const;
  /// The end of the main program; `rewind`: modes and frames are as after power-on then.
  void finish(bool rewind);

  /// Whether the first spindle is its rotary axis from here on; its place is where the program knows it.
  void set_spindle_axis(bool on);

 private:
  // language.cpp
  void follow_language();
  void take_language(const Dialect& language);

  // execution.cpp
  std::optional<Step> advance(bool synchronised);
  std::optional<Step> read_ahead(bool synchronised);
  bool must_wait() const;
  bool takes_effect_at_once(const image::Place& place) const;
  void execute();
  Step stop_with(const ProgramError& error);
  text::Finding finding(const ProgramError& error) const;
  void refuse_in_spline(int column) const;
  void end_contour_modes();
  void reset();

  // power_on.cpp
  void apply_power_on();
  void power_on_mode(std::size_t index);
  void power_on_value(const std::string& name, double value);
  void check_index(const std::string& name, double value) const;

  // gather.cpp
  BlockWords gather();
  void evaluate_words(Word& word);
  void gather_word(BlockWords& words, const Word& word);
  void gather_g(BlockWords& words, const Word& word, std::vector<const GRule*>& by_value);
  void gather_centre(BlockWords& words, const Word& word) const;
  void gather_statement(BlockWords& words, const Word& word);
  void gather_own(BlockWords& words, const Word& word);
  void check_parameter_g(const std::vector<const GRule*>& rules, const Word& last) const;

  // words.cpp
  void run_words();
  void take_g(BlockWords& words, const GRule& rule);
  void return_modes(const BlockWords& words, const Modes& before, const ProgrammedFeed& feed);
  void run_cycle_block(const BlockWords& words);
  bool begin_contour(const BlockWords& words, const Modes& before);
  void refuse_in_contour(const BlockWords& words) const;
  void wait_for_mark(const BlockWords& words, bool moves);
  std::string name_of(Function function) const;
  void refuse_stray_words(const BlockWords& words) const;

  // functions.cpp
  void before_motion(const BlockWords& words);
  void after_motion(const BlockWords& words);
  void spindle_word(const BlockWords& words, const MRule* start, const Word* start_word);
  void end_function(int code, const MRule* rule, int column);
  void change_spindle(int code, int column);
  void tool_words(const BlockWords& words);
  void replace_worn_out(const Word& word, int chosen);
  void change_tool();

  ExecutionData data_;
  Dialect spoken_ = *data_.dialect;
  const Dialect& dialect_ = spoken_;
  const MachineModel& machine_ = *data_.machine;
  State& state_ = data_.state;
  Block& block_ = data_.block;
  Flow flow_{dialect_, data_.axes, data_.files, state_.flow, data_.line};
  Numbers numbers_{dialect_, machine_, state_.modes, state_.parameters};
  Frames frames_{dialect_, machine_, data_.axes, state_.frames};
  Capability capability_{dialect_,     machine_,      block_,        flow_,
                         state_.modes, state_.frames, state_.motion, data_.warnings};
  Output output_{data_.queue, flow_, block_, data_.process, state_, machine_};
  Contour contour_{dialect_,       machine_,    flow_,         state_.frames,          frames_,
                   state_.contour, data_.queue, data_.process, state_.motion.arc_feed, state_.motion.watch};
  Motion motion_{dialect_,      machine_, block_,      numbers_, state_.modes, state_.frames,
                 state_.motion, frames_,  capability_, output_,  contour_};
};

}  // namespace servogate::program
