// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kernel/program/languages/sinumerik/iso/iso.hpp"

/// Machine data, setting data and user data of the cycles as variables of the machine file (specification 23,
/// 25).
namespace servogate::program::sinumerik::iso {
namespace {

struct Setting {
  const char* name;
  double otherwise, least, most;
  bool ends_alone = false;                               ///< only these two, nothing between them
  void (*also)(Execution& run, double value) = nullptr;  ///< beside being looked up by name
};

void watch(Execution& run, double value) { run.state().motion.watch.on = value == 2.0; }
void watched(Execution& run, double value) { run.state().motion.watch.elements = static_cast<int>(value); }

constexpr double kAny = 1e9;

constexpr Setting kSettings[] = {
    {"MD10240", 1, 1, 1},                    // base unit: mm
    {"MD10704", 2, 2, 2},                    // the switch of the dry run acts without slowing the path down
    {"MD10706", 2, 2, 2},                    // the same of the skip levels
    {"MD10760", 1, 0, 1},                    // G53 without the tool's offsets
    {"MD10881", 1, 0, 2},                    // G-code system: 0 B, 1 A, 2 C
    {"MD10884", 1, 0, 1},                    // 1: as a pocket calculator, 0: standard notation
    {"MD10886", 0, 0, 1},                    // 0: IS-B, 1: IS-C
    {"MD20095", 29, 6, 99999999},            // M of rigid tapping
    {"MD20110", 0, 0, 0},                    // bit 6: the length of a tool outlasts a reset
    {"MD20150_22", 1, 1, 2, true, watch},    // 2: CDON at power-on
    {"MD20240", 4, 2, 100, false, watched},  // elements of a contour over which CDON looks
    {"MD20250", 3, 3, 1000},                 // blocks without motion in a compensated contour
    {"MD20270", -2, -2, 0, true},            // behind a tool change: -2 H stays, 0 none is in force
    {"MD20382", 0, 0, 1, true},      // 1: another length moves its axis with the next motion of any axis
    {"MD20732", 1, 1, 1},            // G00 along a line
    {"MD20734", 0x800, 0, 0xFFFFF},  // function mask
    {"MD22910", 0, 0, 1},            // scaling: 0 by 0.001, 1 by 0.00001
    {"MD22914", 0, 0, 1},            // scaling by axis
    {"MD22220", 0, 0, 2, true},      // T goes to the PLC before the motion (0) or behind it (2)
    {"MD31090", 1, 1, 1},            // increments of jog count in mm, whatever G20 says
    {"SD42000", 0, 0, 359.999},      // start angle of threads
    {"SD42140", 1, 0, kAny},         // scaling factor without P
    {"SD42150", 0, -kAny, kAny},     // rotation without R
    {"SD43120_X", 1, -kAny, kAny},   // scaling factor of an axis
    {"SD43120_Y", 1, -kAny, kAny},
    {"SD43120_Z", 1, -kAny, kAny},
    {"SD42940", 0, 0, 17},   // 17: the length of a tool acts along Z in every plane
    {"SD43240", 0, 0, 360},  // angle of M19
    {"ZSFI0", 0, 0, 1},      // 1: Z is the drilling axis
    {"ZSFI1", 0, 0, 3},      // deep tapping: 2 breaks, 3 removes chips
    {"ZSFI2", 100, 1, 200},  // per cent of the speed out of a thread
    {"ZSFI5", 0, 0, 4},      // direction of the shift in G76 and G87
    {"ZSFI20", 0, 0, 1},     // turning: 1 removes chips
    {"ZSFI24", 1, 1, 99},    // G76: finishing passes, angle, run-out, least infeed, allowance
    {"ZSFI25", 60, 0, 120},
    {"ZSFI26", 10, 0, 99},
    {"ZSFI27", 0, 0, kAny},
    {"ZSFI28", 0, 0, kAny},
    {"ZSFI29", 1000, 0, kAny},  // G74, G75: retract, in 0.001 mm
    {"ZSFI30", 1000, 1, kAny},  // G71, G72: depth and retract, in 0.001 mm
    {"ZSFI31", 500, 0, kAny},
    {"ZSFI32", 0, -kAny, kAny},  // G73: escapes in 0.001 mm, passes
    {"ZSFI33", 0, -kAny, kAny},
    {"ZSFI34", 1, 1, 9999},
    {"ZSFI39", 1, 0, 2},     // G-code system of the cycles: that of MD10881
    {"ZSFR0", 0, 0, 1000},   // safety clearance
    {"ZSFR1", 0, 0, 1000},   // retract that breaks chips, 0: 1 mm or inch
    {"ZSFR2", 0, 0, 360},    // angle of the tip
    {"ZSFR10", 0, 0, 1000},  // re-entry, 0: by the depth
    {"ZSFR21", 1, 0, 1000},  // turning: retract that breaks chips
    {"ZSFR22", 0, 0, 1000},  // turning: dwell at R, s
};

void any(Execution&, double, int, int) {}

constexpr std::string_view kAxisLetters = "XYZABCUVW";

/// MD34100_X2: the second reference position of X.
std::string reference_name(char axis, int n) {
  return std::string("MD34100_") + axis + (n == 1 ? "" : std::to_string(n));
}

const Setting* row_of(std::string_view name) {
  const auto row = std::find_if(std::begin(kSettings), std::end(kSettings),
                                [&](const Setting& s) { return s.name == name; });
  return row == std::end(kSettings) ? nullptr : row;
}

/// One for each row: the name tells which.
template <std::size_t I>
void check(Execution& run, double value, int, int column) {
  const Setting& row = kSettings[I];
  const bool alone = row.least == row.most;
  if ((row.ends_alone || alone) && value != row.least && value != row.most)
    fail(Wrong::setting_choice, column,
         {row.name, text::number(value),
          alone ? text::number(row.least) : text::number(row.least) + ", " + text::number(row.most)});
  if (row.also != nullptr) row.also(run, value);
  if (!(value >= row.least && value <= row.most))
    fail(Fault::variable_range, column,
         {row.name, text::number(value), text::number(row.least), text::number(row.most)});
}

template <std::size_t... I>
void add_checks(std::vector<VariableRule>& rules, std::index_sequence<I...>) {
  (rules.push_back({kSettings[I].name, check<I>, false}), ...);
}

}  // namespace

std::span<const VariableRule> settings() {
  static const std::vector<std::string> references = [] {
    std::vector<std::string> names;
    for (const char axis : kAxisLetters) {
      for (int n = 1; n <= 4; ++n) names.push_back(reference_name(axis, n));
      for (const char* name : {"FLOATING_", "OVERRUN_"}) names.push_back(std::string(name) + axis);
    }
    return names;
  }();
  static const std::vector<VariableRule> rules = [] {
    std::vector<VariableRule> made;
    add_checks(made, std::make_index_sequence<std::size(kSettings)>());
    for (const std::string& name : references) made.push_back({name, any, false});
    return made;
  }();
  return rules;
}

double setting(const Execution& run, const char* name) {
  const Setting* row = row_of(name);
  return run.machine().variable(name, row == nullptr ? 0.0 : row->otherwise);
}

bool bit(const Execution& run, int bit) {
  return (static_cast<unsigned>(setting(run, "MD20734")) >> bit & 1u) != 0;
}

std::optional<double> axis_setting(const Execution& run, std::string_view name, int axis) {
  const MachineModel::Axis& a = run.machine().axes[at(axis)];
  const auto found = run.machine().variables.find(std::string(name) + a.letter);
  if (found == run.machine().variables.end()) return std::nullopt;
  return a.diameter ? found->second / 2.0 : found->second;
}

double reference_position(const Execution& run, int axis, int n) {
  const MachineModel::Axis& a = run.machine().axes[at(axis)];
  const auto set = run.machine().variables.find(reference_name(a.letter[0], n));
  if (set == run.machine().variables.end()) return n == 1 ? a.reference : 0.0;
  return a.diameter ? set->second / 2.0 : set->second;
}

}  // namespace servogate::program::sinumerik::iso
