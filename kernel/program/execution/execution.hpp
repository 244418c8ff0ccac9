// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/program/execution/state/state.hpp"
#include "kernel/program/execution/state/step.hpp"
#include "kernel/program/faults/texts.hpp"
#include "kernel/program/geometry/circle.hpp"
#include "kernel/program/reading/block.hpp"
#include "kernel/program/reading/loader.hpp"
#include "kernel/program/reading/source.hpp"
#include "kernel/program/values/expression.hpp"
#include "kernel/program/values/packet_view.hpp"

namespace servogate::program {

class Reach;

/// What one block of words asks for, gathered before anything of it is executed.
struct BlockWords {
  const Block* block = nullptr;
  bool dwell = false, exact_once = false, machine_zero = false;
  std::uint64_t one_shot = 0;         ///< bit of each Function that holds for this block only
  Function then = Function::nothing;  ///< mode in force behind this block
  void (*instead)(Execution&, const BlockWords&) = nullptr;  ///< takes the place of the motion ...
  const Word* instead_word = nullptr;                        ///< ... and this word asks for it
  int cycle = 0;                                             ///< number of a G word that defines a cycle
  const Word *cycle_word = nullptr, *dwell_word = nullptr;
  int axes = 0;
  std::array<const Word*, image::kMaxAxes> axis{};
  const Word *centre1 = nullptr, *centre2 = nullptr, *pitch = nullptr, *radius = nullptr, *radius2 = nullptr;
  const Word *feed = nullptr, *time = nullptr, *speed = nullptr, *tool = nullptr, *h = nullptr;
  const Word *corrector = nullptr, *count = nullptr, *angle = nullptr, *amount = nullptr;
  bool has_centres = false;                 ///< words of Meaning::centre_of
  bool for_instead = false;                 ///< words that only `instead` can take
  std::array<const Word*, 4> statements{};  ///< those that act at the end of the block
  int statement_count = 0;
  std::array<const Word*, 8> m{};
  std::array<int, 8> m_code{};
  int m_count = 0;
};

/// Runs the blocks of a program by a dialect's tables. The dialect's own functions (three-letter codes,
/// variables) are written against the public part. A value: copying it copies the whole state of the run.
class Execution : public ValueSource {
 public:
  Execution(const Dialect& dialect, MachineModel machine, Tables tables, std::string file_name,
            std::string text, ProgramLoader loader, const Position& start, int process);

  Step next(const image::Packets& packets, bool synchronised);
  bool pass_over_error();  ///< see Interpreter
  void mdi(std::string_view block);
  /// See Interpreter.
  void reposition(const Position& at);
  void adopt(Tables tables);
  void preset(int axis, double value);

  const Dialect& dialect() const noexcept { return *dialect_; }
  const MachineModel& machine() const noexcept { return *machine_; }
  const AxisLetters& axes() const noexcept { return axes_; }
  const ProgramLoader& loader() const noexcept { return loader_; }
  const std::vector<std::string>& files() const noexcept { return files_; }
  const std::string& path(int file) const { return sources_[static_cast<std::size_t>(file)]->path(); }
  int column_at(int file, int line, int axis) const;
  const std::vector<SettingFault>& setting_faults() const noexcept { return setting_faults_; }
  const std::vector<text::Finding>& warnings() const noexcept { return warnings_; }
  const Source& main_source() const noexcept { return *sources_.front(); }
  State& state() noexcept { return state_; }
  const State& state() const noexcept { return state_; }
  const Source& source() const { return *sources_[static_cast<std::size_t>(state_.flow.file)]; }
  std::uint32_t line() const noexcept { return line_; }  ///< of the block that is executed, from 0
  int axis_count() const noexcept { return static_cast<int>(machine_->axes.size()); }
  bool rotary(int axis) const noexcept { return machine_->axes[static_cast<std::size_t>(axis)].rotary; }

  // --- values ---
  double parameter(int index, int column) const override;
  double place(const image::Place& place, int column) const override;
  double system(int number, int column) const override {
    return dialect_->system == nullptr ? 0.0 : dialect_->system(*this, number, column);
  }
  /// Value of an expression of the block, in its line from `pos` on; moves `pos` behind it.
  double evaluate(std::size_t& pos) const;
  /// Number of a value, its parameter read. Throws ProgramError.
  double resolve(const Value& value) const;
  /// Refuses the value of a word outside of `least` to `most`; where a parameter gave it, its name is said.
  [[noreturn]] void refuse_range(std::string_view word, const Value& value, double number, const char* least,
                                 const char* most) const;
  /// The same as a whole number of at least 0; `word` names it in messages.
  int whole(const Value& value, std::string_view word) const;
  /// A length of an axis in mm, degrees or as a radius, by the unit in force; `halve`: a diameter axis is
  /// halved.
  double length(int axis, const Value& value, bool halve = true) const;
  double unit_factor(int axis) const noexcept;

  // --- packets ---
  void write(const image::Place& place, double value, int column);
  void write(const image::Place& place, std::string_view characters, int column);
  /// Characters that a write depends on are read from the snapshot.
  void use_snapshot() const noexcept { snapshot_used_ = true; }
  std::string characters(const image::Place& place, int column) const {
    machine_read_ = true;
    return view_.text(place, column);
  }
  /// Some place of a packet has been read so far.
  bool machine_read() const noexcept { return machine_read_; }

  void check_storable(const image::Place& place, double value, int column) const {
    view_.storable(place, value, column);
  }

  // --- commands ---
  template <typename What>
  Command& emit(What&& what) {
    queue_.push_back(
        Command{line_number(), state_.flow.file, process_, block_.number, std::forward<What>(what)});
    return queue_.back();
  }
  /// Ends a continuous profile: what follows is no feed motion.
  void end_profile() noexcept { state_.profile_open = false; }

  // --- motion of cycles ---
  /// Rapid to the axes of a block, but for one (-1: all).
  void position(const BlockWords& words, int without_axis);
  /// A feed motion to the axes of a block.
  void move(const BlockWords& words);
  /// One axis to a programmed coordinate, at rapid or at the feed in force; nothing where it stands there
  /// already.
  void go(int axis, double programmed, bool rapid);
  void dwell(double seconds);
  void emit_spindle(SpindleMode mode);

  // --- warnings (capability.cpp) ---
  /// A column of the block that is executed.
  Written written(int column) const noexcept;
  /// Tells of a place once.
  void warn(Written& place, const text::Entry& kind, std::vector<std::string> arguments);
  void warn(Written& place, Fault fault, std::vector<std::string> arguments) {
    warn(place, entry(fault), std::move(arguments));
  }

  // --- frames ---
  /// After a change of the frame: the machine stands still, its programmed coordinates are new.
  void frame_changed();
  void set_plane(int axis1, int axis2, int normal);
  /// Throws where the machine lacks an axis of the plane in force, as at power-on: what needs a plane (arcs,
  /// rotation, cycles) has none then.
  void need_plane(int column) const;
  /// Origin, mirror, rotation, scale, field and modes as after power-on; tool lengths and parameters stay.
  void reset();

  // --- flow ---
  /// Line of a label of this file. Throws where there is none.
  std::uint32_t label_line(std::string_view label, int column) const;
  void jump(std::uint32_t line);
  /// The lines from this one's on up to the end of the repeat, so often.
  void repeat(int count, int column);
  void end_repeat(int column);
  /// Another program, so often; `arguments` are what it can ask for by number.
  void call(std::string_view name, int times, int column);
  /// A subprogram of this file that begins at a line.
  void call(std::uint32_t line, int times, int column, std::vector<double> arguments = {});
  /// Back from the subprogram; false: none has been called.
  bool leave_subprogram();
  /// Argument of the innermost call; 0 where it is missing.
  double argument(std::size_t index) const;
  void run_part(std::uint32_t first, std::uint32_t last);
  /// The end of the main program; `rewind`: modes and frames are as after power-on then.
  void finish(bool rewind);

  const Block& block() const noexcept { return block_; }
  Block& block() noexcept { return block_; }
  /// Refuses the words of a block that has no motion, but for those that its function takes.
  void refuse_all_but(const BlockWords& words, std::initializer_list<const Word*> taken) const;
  /// F, which stays in force where it is no matter of its block.
  void store_feed(const BlockWords& words);
  /// The lengths of a row of the tool table come into force; 0: none.
  void use_lengths(int row);

 private:
  // power_on.cpp
  void apply_power_on();
  void power_on_mode(std::size_t index);
  void power_on_value(const std::string& name, double value);

  // execution.cpp
  int line_number() const noexcept { return static_cast<int>(line_) + 1; }
  Step take();
  std::optional<Step> advance(bool synchronised);
  std::optional<Step> read_ahead(bool synchronised);
  bool must_wait() const;
  void execute();
  Step stop_with(const ProgramError& error);
  text::Finding finding(const ProgramError& error) const;
  int column_of(int axis) const noexcept { return program::column_of(block_, axis); }
  std::string letter(Meaning meaning) const { return std::string(1, dialect_->letter_of(meaning)); }
  void begin_flow();
  void enter(Flow::Call call, std::size_t file, std::uint32_t line, int column);
  bool leave_part_or_file();

  // words.cpp
  void run_words();
  BlockWords gather();
  void evaluate_words(Word& word);
  void gather_word(BlockWords& words, const Word& word);
  void gather_g(BlockWords& words, const Word& word, std::vector<const GRule*>& by_value);
  void gather_centre(BlockWords& words, const Word& word) const;
  void gather_statement(BlockWords& words, const Word& word);
  void take_g(BlockWords& words, const GRule& rule);
  void select_plane(Function plane, bool required);
  [[noreturn]] void refuse_plane(Function plane, int column) const;
  void return_modes(const BlockWords& words, const Modes& before);
  void check_parameter_g(const std::vector<const GRule*>& rules, const Word& last) const;
  void use_origin(int number, int column);
  void run_cycle_block(const BlockWords& words);
  void refuse_stray_words(const BlockWords& words) const;

  // functions.cpp
  void before_motion(const BlockWords& words);
  void after_motion(const BlockWords& words);
  void spindle_word(const BlockWords& words, const MRule* start, const Word* start_word);
  void end_function(int code, const MRule* rule, int column);
  void tool_words(const BlockWords& words);
  void change_tool();

  // capability.cpp
  void learn_machine();
  void check_tool(int column);
  void check_start(const Word& word);
  void check_speed(const Word& word);
  void check_turning(const Feed& feed);
  void check_line_feed(const BlockWords& words, const Feed& feed, const Position& to);
  void check_arc_feed(const BlockWords& words, const Arc& arc, double radius);
  double spindle_rpm(const Position& to) const;
  double path_speed(const Feed& feed, double length, const Position& to) const;
  void check_feed(const BlockWords& words, double speed, const Reach& reach, bool linear);

  // motion.cpp
  Position target_of(const BlockWords& words);
  void rapid(const Position& to);
  void line(const BlockWords& words, const Position& to);
  void arc(const BlockWords& words, const Position& to);
  Point find_centre(const BlockWords& words, Point start, Point end, bool counter_clockwise) const;
  double helix_length(const Arc& arc, double radius) const;
  Point arc_centre(const BlockWords& words) const;
  double helix_turns(const BlockWords& words, const Position& to, double sweep_deg, double radius) const;
  Feed feed_of(const BlockWords& words, double length_mm, bool rotary_only);
  Feed programmed_feed(const BlockWords& words, double length_mm, bool rotary_only);
  CornerRule corner_of(const BlockWords& words) const;
  void check_axis(int axis, double value, int column) const;
  bool incremental(const Value& value) const noexcept;

  const Dialect* dialect_;
  std::shared_ptr<const MachineModel> machine_;
  AxisLetters axes_;
  ProgramLoader loader_;
  int process_;
  double resolution_ = 1e4;  ///< steps per mm or inch of a programmed coordinate, 0: not rounded
  std::vector<std::shared_ptr<const Source>> sources_;
  std::vector<std::string> files_;
  State state_;
  State before_mdi_;
  bool mdi_ = false;
  PacketView view_;
  std::vector<text::Finding> warnings_;
  bool standing_told_ = false;
  double every_rapid_ = 0.0;  ///< speed that every axis reaches, mm/s and degrees/s
  double all_rapids_ = 0.0;   ///< more than all axes together reach; 0: not known
  int surface_axis_ = -1;     ///< whose coordinate is the radius for G96
  std::vector<Command> queue_;
  std::size_t head_ = 0;
  std::optional<Step> last_;
  std::vector<SettingFault> setting_faults_;
  std::optional<ProgramError> power_on_error_;  ///< the first of them
  Block block_;
  std::uint32_t line_ = 0;
  long long since_command_ = 0;
  mutable bool snapshot_used_ = false;
  mutable bool machine_read_ = false;
  bool want_fresh_ = false;
};

}  // namespace servogate::program
