// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/packets.hpp"

namespace servogate::image {

/// Who writes a place. Declared once; another writer is an error that names both.
enum class Writer : std::uint8_t { nc, plc, input, program };

/// A named place of packet A or K: an I/O point of the machine file, or a place of the interface below.
struct Symbol {
  std::string name;  ///< "NC.m_strobe", "X.homed", "door_closed"; matched without case
  Place place;
  Writer writer = Writer::nc;
  std::string comment;
};

/// First byte in K of the interface between NC and PLC. Part programs of old machines keep the bytes below.
inline constexpr std::uint32_t kInterfaceBase = 512;
inline constexpr std::uint32_t kProcessBlock = 48;
inline constexpr std::uint32_t kAxisBlock = 12;
inline constexpr std::uint32_t kSpindleBlock = 24;
inline constexpr std::uint32_t process_base(int process) {
  return kInterfaceBase + kProcessBlock * static_cast<std::uint32_t>(process);
}
inline constexpr std::uint32_t axis_base(int axis) {
  return kInterfaceBase + kProcessBlock * 5 + kAxisBlock * static_cast<std::uint32_t>(axis);
}
inline constexpr std::uint32_t spindle_base(int spindle) {
  return kInterfaceBase + kProcessBlock * 5 + kAxisBlock * 16 +
         kSpindleBlock * static_cast<std::uint32_t>(spindle);
}
inline constexpr std::uint32_t kMachineBase =
    kInterfaceBase + kProcessBlock * 5 + kAxisBlock * 16 + kSpindleBlock * 2;
/// Orders of the PLC to its auxiliary axes lie above the default size of K: only a machine that has such an
/// axis needs a larger packet.
inline constexpr std::uint32_t kMotionBlock = 64;
inline constexpr std::uint32_t motion_base(int axis) {
  return kPacketKDefaultSize + kMotionBlock * static_cast<std::uint32_t>(axis);
}

/// One row of the interface: byte offset inside its block, bit (BL only), format, writer, meaning.
struct InterfaceField {
  std::string_view name;
  std::uint32_t byte;
  std::uint8_t bit;
  Format format;
  Writer writer;
  std::string_view comment;
  /// It guards motion or energy: it permits them, stops them, or tells the PLC whether something moves.
  /// Forced it is a protection out of action, so it is forced and released at standstill only, with a
  /// warning (kernel/cycle/gate/guarded_places.hpp).
  bool guards = false;
};
inline constexpr bool kGuards = true;

/// The blocks, as tables; the generated documentation and the symbols come from them.
inline constexpr InterfaceField kProcessFields[] = {
    {"mode", 0, 0, Format::by, Writer::nc, "0 off, 1 MDI, 2 AUTO, 3 STEP, 4 MANU, 5 MANJ, 6 PROF, 7 HOME"},
    {"state", 1, 0, Format::by, Writer::nc,
     "0 idle, 1 running, 2 held, 3 waiting, 4 stopped by alarm, 5 ended, 6 stopped without an alarm",
     kGuards},
    {"m_strobe", 2, 0, Format::bl, Writer::nc, "an M code stands in m_code; stays until m_ack"},
    {"s_strobe", 2, 1, Format::bl, Writer::nc, "a spindle word stands in s_value; stays until s_ack"},
    {"t_strobe", 2, 2, Format::bl, Writer::nc, "a tool word stands in t_number; stays until t_ack"},
    {"h_strobe", 2, 3, Format::bl, Writer::nc, "an H word stands in h_code; stays until h_ack"},
    {"running", 2, 4, Format::bl, Writer::nc, "a program runs", kGuards},
    {"held", 2, 5, Format::bl, Writer::nc,
     "feed hold of the operator or by stop: the program waits for start or resume", kGuards},
    {"in_position", 2, 6, Format::bl, Writer::nc, "all axes of the process are in position", kGuards},
    {"rapid", 2, 7, Format::bl, Writer::nc, "the block in motion is a rapid"},
    {"program_end", 3, 0, Format::bl, Writer::nc, "the program has ended (M02, M30)"},
    {"path_wheel_on", 3, 1, Format::bl, Writer::nc, "the program follows its handwheel along its path"},
    {"path_wheel_lost", 3, 2, Format::bl, Writer::nc,
     "that handwheel is pulled out, or its encoder is not healthy"},
    {"m_code", 4, 0, Format::in, Writer::nc, "M code handed over"},
    {"h_code", 6, 0, Format::in, Writer::nc, "H code handed over"},
    {"t_number", 8, 0, Format::li, Writer::nc, "tool number handed over"},
    {"t_corrector", 12, 0, Format::li, Writer::nc, "corrector number handed over"},
    {"s_value", 16, 0, Format::re, Writer::nc, "spindle word handed over, rpm"},
    {"line", 20, 0, Format::li, Writer::nc, "line of the block in motion"},
    {"feed", 24, 0, Format::re, Writer::nc, "path speed, mm/min"},
    {"override", 28, 0, Format::by, Writer::nc, "feed override in force, per cent"},
    {"retraced", 29, 0, Format::bl, Writer::nc,
     "the program is held and its axes are back on its path: return leads forward to where it was held",
     kGuards},
    {"alarm", 30, 0, Format::in, Writer::nc, "number of the first active alarm, 0: none", kGuards},
    {"m_ack", 32, 0, Format::bl, Writer::plc, "the M code is carried out", kGuards},
    {"s_ack", 32, 1, Format::bl, Writer::plc, "the spindle word is carried out", kGuards},
    {"t_ack", 32, 2, Format::bl, Writer::plc, "the tool word is carried out", kGuards},
    {"h_ack", 32, 3, Format::bl, Writer::plc, "the H code is carried out", kGuards},
    {"start", 32, 4, Format::bl, Writer::plc, "rising edge: cycle start"},
    {"stop", 32, 5, Format::bl, Writer::plc,
     "TRUE: feed hold; when it is FALSE again, start or resume goes on (feed_enable goes on by itself)",
     kGuards},
    {"reset", 32, 6, Format::bl, Writer::plc, "rising edge: reset", kGuards},
    {"m_unknown", 32, 7, Format::bl, Writer::plc, "with m_ack: the PLC does not know this M code"},
    {"feed_enable", 33, 0, Format::bl, Writer::plc, "TRUE permits feed; FALSE holds", kGuards},
    {"read_in_enable", 33, 1, Format::bl, Writer::plc,
     "TRUE permits the next function: M, S, T, H, a wait, a reading or writing of signals; feed_enable is "
     "for motion",
     kGuards},
    {"optional_stop", 33, 3, Format::bl, Writer::plc, "M01 stops"},
    {"dry_run", 33, 4, Format::bl, Writer::plc,
     "taken over when a program starts: feed motions run at rapid speed, to see the path without a part"},
    {"path_wheel", 33, 5, Format::bl, Writer::plc,
     "TRUE: the program follows its handwheel along its path; FALSE again: it is held"},
    {"feed_override", 34, 0, Format::by, Writer::plc, "per cent 1-150; 0: the operator's value"},
    {"external_alarm", 36, 0, Format::in, Writer::plc, "number of an alarm the PLC raises, 0: none", kGuards},
    {"skip_levels", 38, 0, Format::in, Writer::plc,
     "taken over when a program starts: bit 0 skips the blocks marked with /, bit n those marked with /n"},
    {"path_wheel_rate", 40, 0, Format::in, Writer::nc,
     "speed of that handwheel, per cent of the programmed feed, -100 to 100"},
    {"path_wheel_refusal", 42, 0, Format::in, Writer::nc,
     "why the handwheel could not lead back or forward, 0: it could; numbers as ErrorID"},
};
inline constexpr InterfaceField kAxisFields[] = {
    {"enabled", 0, 0, Format::bl, Writer::nc, "the drive is in Operation enabled", kGuards},
    {"homed", 0, 1, Format::bl, Writer::nc, "the axis is referenced", kGuards},
    {"in_position", 0, 2, Format::bl, Writer::nc, "inside the in-position window at standstill", kGuards},
    {"moving", 0, 3, Format::bl, Writer::nc, "the set-point moves", kGuards},
    {"alarm", 0, 4, Format::bl, Writer::nc, "an alarm names this axis", kGuards},
    {"on_limit_plus", 0, 5, Format::bl, Writer::nc, "on the positive hard limit", kGuards},
    {"on_limit_minus", 0, 6, Format::bl, Writer::nc, "on the negative hard limit", kGuards},
    {"brake_release", 0, 7, Format::bl, Writer::nc, "TRUE: the holding brake is to be open", kGuards},
    {"owner", 1, 0, Format::by, Writer::nc,
     "0 none, 1 process, 2 manual, 3 homing, 4 PLC, 5 bench, 6 electronic gear"},
    {"handwheel_refusal", 2, 0, Format::in, Writer::nc,
     "why the last counts of its handwheel did not move the axis, 0: they did; numbers as ErrorID"},
    {"position", 4, 0, Format::re, Writer::nc, "measured position, machine coordinates, mm or degrees",
     kGuards},
    {"enable", 8, 0, Format::bl, Writer::plc, "TRUE permits the drive to be on", kGuards},
    {"limit_plus", 8, 1, Format::bl, Writer::plc, "TRUE: on the positive limit, beside the axis' own input",
     kGuards},
    {"limit_minus", 8, 2, Format::bl, Writer::plc, "TRUE: on the negative limit", kGuards},
    {"home_switch", 8, 3, Format::bl, Writer::plc, "TRUE: on the home switch, beside the axis' own input",
     kGuards},
    {"feed_enable", 8, 4, Format::bl, Writer::plc, "TRUE permits motion of this axis", kGuards},
    {"jog_plus", 8, 5, Format::bl, Writer::plc, "jogs while TRUE"},
    {"jog_minus", 8, 6, Format::bl, Writer::plc, "jogs while TRUE"},
    {"handwheel", 9, 0, Format::by, Writer::plc, "the axis follows handwheel 1 or 2; 0: none"},
    {"gear", 10, 0, Format::by, Writer::plc,
     "the axis follows its master by this one of its [[gear]] tables, from 1; 0: none. After a stop 0 first"},
    {"gear_state", 11, 0, Format::by, Writer::nc,
     "its electronic gear: 0 none, 1 engaging, 2 in step, 3 disengaging, 4 refused", kGuards},
};
inline constexpr InterfaceField kSpindleFields[] = {
    {"run", 0, 0, Format::bl, Writer::nc, "the program wants the spindle to turn", kGuards},
    {"cw", 0, 1, Format::bl, Writer::nc, "clockwise", kGuards},
    {"ccw", 0, 2, Format::bl, Writer::nc, "counter-clockwise", kGuards},
    {"orient", 0, 3, Format::bl, Writer::nc, "oriented stop is wanted", kGuards},
    {"at_speed", 0, 4, Format::bl, Writer::nc, "measured speed inside the window", kGuards},
    {"zero_speed", 0, 5, Format::bl, Writer::nc, "standstill", kGuards},
    {"oriented", 0, 6, Format::bl, Writer::nc, "stands at the angle of the oriented stop", kGuards},
    {"gear", 1, 0, Format::by, Writer::nc, "gear in force, as `gears` counts from 1; 0: none, or it changes"},
    {"command", 4, 0, Format::re, Writer::nc, "commanded speed, rpm, + clockwise", kGuards},
    {"actual", 8, 0, Format::re, Writer::nc, "measured speed, rpm", kGuards},
    {"enable", 12, 0, Format::bl, Writer::plc, "TRUE permits the spindle to turn", kGuards},
    {"override", 16, 0, Format::by, Writer::plc, "per cent 50-125; 0: 100"},
    {"gear_wish", 17, 0, Format::by, Writer::plc,
     "gear that is wanted, by M41 to M44 or a lever; 0: the slowest that reaches the speed"},
    {"limit", 20, 0, Format::re, Writer::plc,
     "largest speed that the chuck or the work in it permits, rpm, override included; 0: that of the machine",
     kGuards},
};
inline constexpr InterfaceField kMachineFields[] = {
    {"control_alive", 0, 0, Format::bl, Writer::nc, "toggles while the control runs, for the safety relay",
     kGuards},
    {"ready", 0, 1, Format::bl, Writer::nc, "no alarm, drives may be switched on", kGuards},
    {"alarm", 0, 2, Format::bl, Writer::nc, "any alarm is active", kGuards},
    {"power_request", 0, 3, Format::bl, Writer::nc, "the operator wants the drives on", kGuards},
    {"estop_ok", 4, 0, Format::bl, Writer::plc,
     "TRUE: the emergency-stop chain is closed; FALSE: the axes stop, the brakes close, the power goes",
     kGuards},
    {"power_on", 4, 1, Format::bl, Writer::plc, "TRUE permits drive power", kGuards},
    {"handwheel1", 8, 0, Format::li, Writer::plc, "counter of handwheel 1; only what it changes by counts"},
    {"handwheel1_step", 12, 0, Format::re, Writer::plc,
     "mm or degrees for one count; below 0 turns it round"},
    {"handwheel2", 16, 0, Format::li, Writer::plc, "the same of handwheel 2"},
    {"handwheel2_step", 20, 0, Format::re, Writer::plc, "the same of handwheel 2"},
};
inline constexpr std::uint32_t kMachineBlock = 24;
/// Of an auxiliary axis: what the MC_ blocks of the PLC and the kernel say to one another. The blocks see it
/// as a structure AXIS_REF, which lies in memory as it lies here.
inline constexpr InterfaceField kMotionFields[] = {
    {"mc_taken", 0, 0, Format::li, Writer::nc, "number of the last order that was decided on"},
    {"mc_active", 4, 0, Format::li, Writer::nc, "number of the order in force, 0: none"},
    {"mc_refusal", 8, 0, Format::in, Writer::nc, "why the last order was refused, 0: accepted"},
    {"mc_error", 10, 0, Format::in, Writer::nc, "number of the alarm that stopped the axis, 0: none",
     kGuards},
    {"mc_state", 12, 0, Format::by, Writer::nc,
     "0 no axis, 1 disabled, 2 standstill, 3 homing, 4 discrete motion, 5 continuous motion, 6 stopping, "
     "7 stopped by an error",
     kGuards},
    {"mc_result", 13, 0, Format::by, Writer::nc,
     "of the order in force: 0 under way, 1 done (at speed, at torque), 2 aborted, 3 error"},
    {"mc_powered", 14, 0, Format::by, Writer::nc, "1: the drive holds the axis, and it may move", kGuards},
    {"mc_power_refusal", 16, 0, Format::in, Writer::nc, "why mc_power was refused or fell, 0: it was not"},
    {"mc_torque", 20, 0, Format::re, Writer::nc, "measured torque, per cent of the rated one"},
    {"mc_position", 24, 0, Format::lr, Writer::nc, "measured position, machine coordinates, mm or degrees"},
    {"mc_order_number", 32, 0, Format::li, Writer::plc, "another number: a new order"},
    {"mc_order", 36, 0, Format::by, Writer::plc,
     "0 none (stops), 1 home, 2 to a position, 3 by a distance, 4 at a speed, 5 stop, 6 end of the stop, 7 "
     "reset, 8 torque"},
    {"mc_power", 37, 0, Format::by, Writer::plc, "1: drive power is wanted; it comes on with the rising edge",
     kGuards},
    {"mc_direction", 38, 0, Format::by, Writer::plc,
     "to a position of an endless rotary axis: 0 counting on, 1 up, 2 the shorter way, 3 down, 4 as it "
     "turned last"},
    {"mc_target", 40, 0, Format::lr, Writer::plc,
     "position, distance (mm or degrees), direction (sign) or torque (per cent of the rated one)"},
    {"mc_velocity", 48, 0, Format::lr, Writer::plc, "speed, mm/s or degrees/s, above 0"},
    {"mc_acceleration", 56, 0, Format::lr, Writer::plc,
     "mm/s2 or degrees/s2, of a torque per cent a second; 0: the axis' limit"},
};

/// All symbols of the interface for a machine: `NC.` (process 1), `NC2.` ... , `<letter>.` per axis, `S.` and
/// `S2.` per spindle, `MC.` for the machine. `auxiliary`: the axes that the PLC moves, as bits. Not real-time
/// safe.
std::vector<Symbol> interface_symbols(int processes, const std::vector<std::string>& axis_letters,
                                      int spindles, std::uint32_t auxiliary = 0);

/// The page docs/interface.md: every place of the interface with its meaning. Not real-time safe.
std::string interface_page();

/// Place of a row in the block that begins at `base`. real-time safe.
constexpr Place place(const InterfaceField& f, std::uint32_t base) noexcept {
  const std::uint32_t byte = base + f.byte;
  return {Packet::k, f.format, f.format == Format::bl ? byte * 8 + f.bit : byte / format_size(f.format), 1};
}
/// Place of one field, for code inside the cycle. A misspelt name does not compile. real-time safe.
template <std::size_t N>
consteval Place field(const InterfaceField (&table)[N], std::string_view name, std::uint32_t base = 0) {
  for (const InterfaceField& f : table)
    if (f.name == name) return place(f, base);
  throw "no such interface field";
}
/// The same place moved by whole bytes (a block base is a multiple of 4). real-time safe.
constexpr Place at(Place p, std::uint32_t base) noexcept {
  p.index += p.format == Format::bl ? base * 8 : base / format_size(p.format);
  return p;
}

}  // namespace servogate::image
