// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware_if/image/packets.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/program/execution/state/record_files.hpp"

namespace servogate::program {

/// What the programmed feed of a compensated arc is the speed of. Straight lines do not know the difference.
enum class ArcFeed : std::uint8_t {
  tool_centre,  ///< of the tool's centre: faster than F at the wall of an inside radius
  contour,      ///< of the programmed contour, on inside and outside radii
  inside,       ///< of the contour on inside radii, of the tool's centre on outside ones
};

/// What an interpreter must know of the machine. Filled from the machine file by the gateway.
struct MachineModel {
  struct Axis {
    std::string letter;
    bool rotary = false;
    bool diameter = false;
    bool alternative_inch = false;
    double travel_min = -1e9, travel_max = 1e9;  ///< mm or degrees; lathe X as radius
    /// Where homing finds its mark, within the travel; mm or degrees of the machine; lathe X as radius.
    double reference = 0.0;
    double rapid = 0.0;          ///< largest speed, mm/s or degrees/s; 0: not known
    double acceleration = 0.0;   ///< mm/s2 or degrees/s2; 0: not known
    double jerk = 0.0;           ///< mm/s3 or degrees/s3; 0: not known
    double window_max = 0.0;     ///< largest in-position window of a program, mm or degrees; 0: not known
    double window_coarse = 0.0;  ///< in-position window of the coarse exact stop, mm or degrees
    int process = 0;             ///< whose programs move it, from 0
    bool endless = false;        ///< rotary without ends of travel
    bool is_virtual = false;     ///< no axis of the machine: programs name it while real ones follow it
    int index_positions = 0;     ///< programs count positions, so many in a turn; 0: they give degrees
  };
  /// For languages that have words of their own for each; `by_axes`: turning where an axis counts diameters.
  enum class Kind : std::uint8_t { by_axes, turning, milling };
  std::vector<Axis> axes;
  Kind kind = Kind::by_axes;
  int spindles = 1;
  double spindle_min_rpm = 0.0;  ///< of the spindle that S speaks to; 0: as slow as one likes
  double spindle_max_rpm = 0.0;  ///< 0: not known, S is not compared with it
  double coupled_max_rpm = 0.0;  ///< of the second spindle, which may follow the first; 0: none may
  bool spindle_angle = true;   ///< of the first spindle is measured: threads, rigid taps and its mark need it
  int spindle_axis = -1;       ///< the axis that the first spindle becomes, -1: none ...
  int spindle_axis_on_m = 0;   ///< ... by this M function,
  int spindle_axis_off_m = 0;  ///< and by this one it is a spindle again
  int tool_places = 0;         ///< of the magazine or turret: T takes 0 to this number; 0: not known
  double contour_tolerance_mm = 0.01;
  ArcFeed arc_feed = ArcFeed::tool_centre;  ///< until a word of the program chooses
  /// Power-on modes and values in the dialect's own words, e.g. {"G94", "G97", "G90", "G71"}; the values of
  /// its variables by their names.
  std::vector<std::string> power_on;
  std::map<std::string, double> variables;
  /// A G or M word of the machine builder's own: it calls a program, with words of its block as parameters.
  struct OwnCode {
    std::string code;                     ///< "G50", "M77"
    std::string program;                  ///< as the loader finds it
    std::map<std::string, double> words;  ///< letter of a word to the number of the parameter that takes it
  };
  std::vector<OwnCode> own_codes;
  std::vector<int> synchronous_m;  ///< reserved for dialects that let the machine builder choose
  /// A place that part programs must not write, and the name of who writes it (an input, the control).
  struct Protected {
    image::Place place;
    std::string owner;
  };
  std::vector<Protected> protected_places;
  std::uint32_t k_bytes = image::kPacketKDefaultSize;  ///< sizes of the packets of a dry run (check, canon)
  std::uint32_t syvar_bytes = image::kSyvarDefaultSize;

  int axis_count() const noexcept { return static_cast<int>(axes.size()); }
  bool turns() const noexcept {
    bool diameters = false;
    for (const Axis& axis : axes) diameters = diameters || axis.diameter;
    return kind == Kind::by_axes ? diameters : kind == Kind::turning;
  }
  bool is_virtual(int axis) const noexcept { return axes[static_cast<std::size_t>(axis)].is_virtual; }
  /// Axes that the machine has; virtual ones stand behind them.
  int real_axes() const noexcept {
    int count = axis_count();
    while (count > 0 && is_virtual(count - 1)) --count;
    return count;
  }
  bool rotary(int axis) const noexcept { return axes[static_cast<std::size_t>(axis)].rotary; }
  /// A variable by its name, `otherwise` where the machine file does not have it.
  double variable(const char* name, double otherwise) const {
    const auto at = variables.find(name);
    return at == variables.end() ? otherwise : at->second;
  }
};

/// Tables an interpreter reads and, for some words, changes; kept in the state directory by the gateway.
struct Tables {
  struct Corrector {
    std::string name;                          ///< for people
    std::map<std::string, double> length;      ///< axis letter to mm
    std::map<std::string, double> wear;        ///< axis letter to mm, added to the length
    double radius = 0.0;                       ///< mm
    double radius_wear = 0.0;                  ///< mm, added to the radius
    std::map<std::string, double> wear_limit;  ///< axis letter to mm: beyond it the tool is worn out
    double radius_wear_limit = 0.0;            ///< mm; 0: not limited
    int quadrant = 0;       ///< where the tip of a turning tool points, 1 to 9; 0: no turning tool
    double life_min = 0.0;  ///< minutes at feed after which the tool is worn out; 0: they are not limited
    double used_min = 0.0;  ///< minutes at feed so far
    int alternate = 0;      ///< tool that takes its place when it is worn out; 0: none
    bool worn_out() const { return life_min > 0.0 && used_min >= life_min; }
    /// What is in force along an axis, wear included; 0 where the row does not name it.
    double length_of(const std::string& letter) const {
      const auto own = length.find(letter), worn = wear.find(letter);
      return (own == length.end() ? 0.0 : own->second) + (worn == wear.end() ? 0.0 : worn->second);
    }
    /// Of minutes only that decides whether the tool is worn out: what programs do depends on no more.
    bool operator==(const Corrector& o) const {
      return name == o.name && length == o.length && wear == o.wear && radius == o.radius &&
             radius_wear == o.radius_wear && wear_limit == o.wear_limit &&
             radius_wear_limit == o.radius_wear_limit && quadrant == o.quadrant && life_min == o.life_min &&
             alternate == o.alternate && worn_out() == o.worn_out();
    }
  };
  std::map<int, std::map<std::string, double>> origins;  ///< number to axis letter to mm
  std::map<int, Corrector> correctors;                   ///< by number; what people call a tool's row
  RecordFiles record_files;
  bool operator==(const Tables&) const = default;
};

/// Carries over to `into` what differs between two states of the tables: entries that came, changed or went.
inline void carry_over(const Tables& before, const Tables& after, Tables& into) {
  const auto carry = [](const auto& was, const auto& is, auto& entries) {
    for (const auto& [key, value] : is)
      if (const auto old = was.find(key); old == was.end() || !(old->second == value)) entries[key] = value;
    for (const auto& [key, value] : was)
      if (!is.contains(key)) entries.erase(key);
  };
  carry(before.origins, after.origins, into.origins);
  carry_over(before.record_files, after.record_files, into.record_files);
  const auto used = into.correctors;  // a program knows the minutes of its beginning ...
  carry(before.correctors, after.correctors, into.correctors);
  const auto declared = [&](int number) {  // ... unless it says itself that a tool is worn out
    const auto was = before.correctors.find(number), is = after.correctors.find(number);
    return was != before.correctors.end() && is != after.correctors.end() &&
           was->second.used_min != is->second.used_min && is->second.worn_out();
  };
  for (auto& [number, row] : into.correctors)
    if (const auto old = used.find(number); old != used.end() && !declared(number))
      row.used_min = old->second.used_min;
}

/// A power-on mode, a value or an own code of the machine file that the language cannot take. Its program
/// does not run.
struct SettingFault {
  int mode = -1;         ///< index in MachineModel::power_on, -1: it is a variable or an own code
  std::string variable;  ///< its name in MachineModel::variables
  const text::Entry* entry = nullptr;
  std::vector<std::string> arguments;
  int own_code = -1;  ///< index in MachineModel::own_codes
};

}  // namespace servogate::program
