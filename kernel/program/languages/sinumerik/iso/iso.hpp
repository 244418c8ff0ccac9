// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "kernel/program/execution/execution.hpp"
#include "kernel/program/languages/sinumerik/iso/faults.hpp"
#include "kernel/program/reading/dialect.hpp"

/// The ISO dialect of the SINUMERIK 808D (G291): one set of functions, and a table of their numbers for
/// milling and for each of the three G-code systems of turning. Source: specification sinumerik808d.
namespace servogate::program::sinumerik::iso {

/// By the kind of the machine and MD10881.
const Dialect& dialect(const MachineModel& machine);
/// True for one of the languages of this folder.
bool is_iso(const Dialect& language);

/// Places in State::own, which begin at 0 with every program.
namespace own {
inline constexpr std::size_t kAxes = image::kMaxAxes;
enum : std::size_t {
  feed_unit,      ///< of the Siemens mode, too
  dummy_blocks,   ///< in a compensated contour, since its last motion in the plane
  variable_lead,  ///< G34 is in force, not G32
  to_r,           ///< G99: drilling cycles end at the level R
  turning_cycle,  ///< a Simple, 0: none
  turning_x,      ///< its words: programmed coordinates, mm, X a radius
  turning_z,
  turning_taper,
  turning_lead,
  turning_angle,
  hole,  ///< number of the G word, 0: none
  hole_level,
  hole_depth,
  hole_step,
  hole_dwell,
  hole_feed,
  hole_shift,
  hole_incremental,
  hole_begun,
  hole_initial,
  macro,  ///< program of G66 and 1, 0: none
  macro_passes,
  finishing,  ///< G70: its contour is being worked
  finish_feed,
  finish_at,                      ///< 2
  cylinder_axis = finish_at + 2,  ///< and 1, 0: none
  pivot,                          ///< of a rotation in space: 3
  polar = pivot + 3,
  polar_pole,                 ///< 2
  polar_at = polar_pole + 2,  ///< radius and angle
  length_sign = polar_at + 2,
  length_row,
  length_due,   ///< an axis and 1: it goes to its programmed place with the next motion, whoever is named
  length_goal,  ///< that place
  start_angle,  ///< of threads, and whether a program has set it
  start_angle_set,
  copies,  ///< of G72.1 and G72.2 that are done, and where they stand
  copy_angle,
  copy_at,                   ///< 2
  copy_shift = copy_at + 2,  ///< of each axis
  rotation = copy_shift + kAxes,
  rotation_at,               ///< 2
  mirror = rotation_at + 2,  ///< bit of each axis
  mirror_at,
  preset = mirror_at + kAxes,
  local = preset + kAxes,
  measured_machine = local + kAxes,
  measured_work = measured_machine + kAxes,
  turning_depth = measured_work + kAxes,  ///< memory of G71 and G72: U, R ...
  turning_retract,
  pattern_x,  ///< ... of G73: U, W, R
  pattern_z,
  pattern_passes,
  groove_retract,  ///< ... of G74 and G75: R
  thread_passes,   ///< ... of G76: m, r, a, Q, R
  thread_chamfer,
  thread_angle,
  thread_least,
  thread_allowance,
  memory_set,                 ///< bit of each that a program has set
  argument = memory_set + 1,  ///< A to Z
  argument_set = argument + 26,
  argument_real = argument_set + 26,
  argument_ijk = argument_real + 26,  ///< 10 each of I, J, K
  argument_order = argument_ijk + 30,
  argument_count = argument_order + 30,
  argument_g = argument_count + 3,
  override_told,  ///< 1: the machine knows that the override of the feed does not count
  notation,       ///< MD10884 as the run has found it: one of the three below
  places,
};
inline constexpr double kNotationUnknown = 0.0, kStandard = 1.0, kCalculator = 2.0;
}  // namespace own

inline double& value(State& state, std::size_t place) { return state.own[place]; }
inline double value(const State& state, std::size_t place) { return state.own[place]; }
inline std::size_t at(int axis) { return static_cast<std::size_t>(axis); }

// settings.cpp
std::span<const VariableRule> settings();
/// Machine data and user data by their names: MD20734, SD42150, ZSFR10; defaults are those of the table
/// there.
double setting(const Execution& run, const char* name);
bool bit(const Execution& run, int bit);  ///< of MD20734
/// MD34100, the reference position `n` from 1 of an axis as programs count it; its unit is mm or degrees.
/// Where the machine file has none, the first one is where homing finds its mark.
double reference_position(const Execution& run, int axis, int n);
/// Data of an axis by the beginning of their names: FLOATING_X, its floating reference position, and
/// OVERRUN_X, by which G60 goes beyond its end. As programs count them; none: the machine file does not have
/// it.
std::optional<double> axis_setting(const Execution& run, std::string_view name, int axis);

// block.cpp: the words of the block by their letters
const Word* find(const Block& block, char letter);
/// Throws for a word whose letter is none of these; G and N may always stand.
void only(const Execution& run, std::string_view letters);
/// A word's number, `otherwise` where it is missing.
double number(const Execution& run, char letter, double otherwise = 0.0);
/// A whole number of at least 0, `otherwise` where the word is missing.
int whole(const Execution& run, char letter, int otherwise);
/// A length without sign of diameters, mm.
double length(const Execution& run, const Word& word);
/// In least increments where no point is written (specification 1.5), mm; no sign.
double increments(const Execution& run, const Word& word);
/// As axes' words count, mm; no sign.
double notated(const Execution& run, const Word& word);
/// Puts an axis to a programmed coordinate in mm or degrees, whatever its word says or whether it has one.
void set_axis(Execution& run, BlockWords& words, int axis, double programmed);
/// Takes the words of the block away from everything but `instead`.
void leave_to_instead(BlockWords& words);
/// Where a word leads its axis, a programmed coordinate in mm; where it stands without a word.
double target(const Execution& run, const BlockWords& words, int axis);
std::string g_word(const Execution& run, const BlockWords& words);
int column(const BlockWords& words);

// circles.cpp
/// Centres outside of the selected plane name that of their circle (specification 5.4).
void arrange_circle(Execution& run, BlockWords& words);

// values.cpp: X=$C_I[0], with MD20734 bit 3 (specification 16.2)
bool value_of_macro(BlockText& text, Value& value);
bool no_value_of_macro(BlockText& text, Value& value);

// arrange.cpp, numbers.cpp
void arrange(Execution& run, BlockWords& words);
void scale_numbers(Execution& run, const BlockWords& words);
const Dialect* speaks(const MachineModel& machine, std::string_view line, bool first);
void judge(const Judgement& reading, const Block& block);

// calls.cpp: M98, M99, G05, G65 to G67, macros by M and G (specification 13, 16)
bool is_macro_program(const Execution& run, double kind);
void arrange_calls(Execution& run, BlockWords& words);
/// True: the block is a macro's, whose words are arguments.
bool take_macro(Execution& run, BlockWords& words);
void call_macro(Execution& run, const BlockWords& words);
void modal_macro(Execution& run, const BlockWords& words);
void macro_off(Execution& run, BlockWords& words, const Word& word);
void fast_call(Execution& run, const BlockWords& words);
void copy_turned(Execution& run, const BlockWords& words);
void copy_shifted(Execution& run, const BlockWords& words);
/// $C_A and its like, $AA_MM[X]: `number` as the Siemens mode's expressions read them.
double system_value(const Execution& run, int number, int column);
/// Those numbers by the names of the variables; -1: there is no such.
int system_number(std::string_view name, int index);
int measured_number(std::string_view name, char axis);

// modes.cpp
void to_siemens(Execution& run, const BlockWords& words);
void dwell(Execution& run, const BlockWords& words);
void another_feed(Execution& run, BlockWords& words, const Word& word);
/// G61 and G64, and G63, in which the override of the feed does not count.
void path_mode(Execution& run, BlockWords& words, const Word& word);
void tapping_mode(Execution& run, BlockWords& words, const Word& word);
void arrange_override(Execution& run);
void plain_motion(Execution& run, BlockWords& words, const Word& word);
void thread_constant(Execution& run, BlockWords& words, const Word& word);
void thread_variable(Execution& run, BlockWords& words, const Word& word);
void thread(Execution& run, const BlockWords& words);
/// Q in degrees, which stays in force; before it SD42000.
double start_angle(Execution& run);
void measure(Execution& run, const BlockWords& words);
void ignored(Execution& run, const BlockWords& words);
void look_ahead(Execution& run, const BlockWords& words);
void to_initial(Execution& run, BlockWords& words, const Word& word);
void to_level(Execution& run, BlockWords& words, const Word& word);
void spindle_dwell(Execution& run, double rotations, int column);

// polygon.cpp: G51.2, G50.2 (specification 17)
void polygon(Execution& run, const BlockWords& words);
void polygon_off(Execution& run, const BlockWords& words);

// corners.cpp: ,C ,R ,A
extern const WordRule kComma;
void arrange_angle(Execution& run, BlockWords& words);  ///< of a block that has such a word

// references.cpp
void reference_return(Execution& run, const BlockWords& words);
void reference_check(Execution& run, const BlockWords& words);
void reference_other(Execution& run, const BlockWords& words);
void reference_floating(Execution& run, const BlockWords& words);
void one_sided(Execution& run, const BlockWords& words);
void machine_coordinates(Execution& run, const BlockWords& words);

// offsets.cpp: presets, G52, G54 P, scaling, mirror, rotation, polar coordinates
void refresh_offsets(Execution& run);
void preset(Execution& run, const BlockWords& words);
void preset_off(Execution& run, const BlockWords& words);
void local(Execution& run, const BlockWords& words);
void settable(Execution& run, BlockWords& words, const Word& word);
void arrange_offset(Execution& run, BlockWords& words);
void scale(Execution& run, const BlockWords& words);
void scale_off(Execution& run, const BlockWords& words);
void mirror(Execution& run, const BlockWords& words);
void mirror_off(Execution& run, const BlockWords& words);
void rotate(Execution& run, const BlockWords& words);
void rotate_turned(Execution& run, const BlockWords& words);  ///< of turning: in its plane, by R
void rotate_off(Execution& run, const BlockWords& words);
void polar_on(Execution& run, BlockWords& words, const Word& word);
void polar_off(Execution& run, BlockWords& words, const Word& word);
void arrange_polar(Execution& run, BlockWords& words);
/// Throws where scaling or mirroring is in force, with which a function cannot go.
void refuse_scaled(const Execution& run, const BlockWords& words);

// tools.cpp
void write_data(Execution& run, const BlockWords& words);
void arrange_tool(Execution& run, BlockWords& words);
/// With MD20382 = 1 another length moves its axis, too.
void arrange_length(Execution& run, BlockWords& words);
void length_plus(Execution& run, BlockWords& words, const Word& word);
void length_minus(Execution& run, BlockWords& words, const Word& word);
void length_off(Execution& run, BlockWords& words, const Word& word);
void nose_on(Execution& run, BlockWords& words, const Word& word);
void nose_off(Execution& run, BlockWords& words, const Word& word);

// drilling.cpp, milling_holes.cpp, turning_holes.cpp
void begin_hole(Execution& run, BlockWords& words, const Word& word);
void end_hole(Execution& run, BlockWords& words, const Word& word);
void arrange_hole(Execution& run, BlockWords& words);

// turning.cpp, contour_cycles.cpp, grooves.cpp, threads.cpp
void begin_longitudinal(Execution& run, BlockWords& words, const Word& word);
void begin_thread_cycle(Execution& run, BlockWords& words, const Word& word);
void begin_facing(Execution& run, BlockWords& words, const Word& word);
void arrange_turning(Execution& run, BlockWords& words);
void rough_along(Execution& run, const BlockWords& words);
void rough_across(Execution& run, const BlockWords& words);
void repeat_pattern(Execution& run, const BlockWords& words);
void finish(Execution& run, const BlockWords& words);
void groove_along(Execution& run, const BlockWords& words);
void groove_across(Execution& run, const BlockWords& words);
void thread_passes(Execution& run, const BlockWords& words);

/// What a program has stored at a place of own, else the machine's user data times `unit`.
double memory(const Execution& run, std::size_t place, const char* name, double unit = 1.0);
void remember(Execution& run, std::size_t place, double value);

// transformations.cpp
void turn_space(Execution& run, const BlockWords& words);
void end_transformation(Execution& run);
void cylinder(Execution& run, const BlockWords& words);
void polar_interpolation(Execution& run, const BlockWords& words);
void polar_interpolation_off(Execution& run, const BlockWords& words);
void arrange_transformation(Execution& run, BlockWords& words);

}  // namespace servogate::program::sinumerik::iso
