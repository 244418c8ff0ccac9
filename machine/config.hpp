// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/packets.hpp"
#include "firmware_if/image/process_image.hpp"
#include "machine/board_config.hpp"
#include "machine/config_basics.hpp"
#include "machine/pendant_config.hpp"
#include "machine/simulation_config.hpp"
#include "machine/station_config.hpp"

/// The machine file as plain values: what everything else is composed from. One struct a table of the file,
/// one member a key; defaults are the initialisers here, and validation, JSON schema and reference come from
/// keys.cpp. Units: mm or degrees (rotary axis), seconds, rpm for spindles; an X in diameter is described as
/// a radius. Nothing here is real-time safe (strings); the gateway copies what the cycle needs.
namespace servogate::machine {

/// What the feed of an arc under radius compensation is the speed of: the tool's centre, the contour, or the
/// contour on inside radii and the centre on outside ones.
enum class ArcFeed : std::uint8_t { tool_centre, contour, inside };
/// To which side an axis leaves a thread: by the sign of its thread_retract, or to where it came from.
enum class ThreadSide : std::uint8_t { declared, infeed };
/// What tells where the probe touched: the edge of its point, or input 1 or 2 of the axes' drives (60B8h).
enum class ProbeLatch : std::uint8_t { edge, drive_1, drive_2 };
enum class AxisType : std::uint8_t { linear, rotary };
/// For languages that have words of their own for each; `by_axes`: turning where an axis counts diameters.
enum class MachineKind : std::uint8_t { by_axes, turning, milling };
enum class Direction : std::uint8_t { plus, minus };
/// How an axis finds its zero. `absolute`: the kept reference of an absolute encoder; `none`: zero where it
/// is switched on; `drive`: by a method of the drive itself (6098h).
enum class HomingMethod : std::uint8_t { switch_and_index, switch_only, index, drive, absolute, none };

/// [axis.home]
struct HomingConfig {
  HomingMethod method = HomingMethod::none;
  Direction direction = Direction::minus;  ///< of the search for the switch
  std::string switch_point;                ///< key `switch`: name of an input point
  double fast = 0.0;                       ///< search for the switch, mm/s
  double slow = 0.0;                       ///< leaving the switch and search for the index, mm/s
  /// The decisive edge is crossed slowly and the index sought in this direction; opposite to `direction`:
  /// leaving the switch, equal: driving onto it.
  Direction index_direction = Direction::plus;
  double index_max_travel = 0.0;  ///< give up the search for the index after this, 0: one and a half turns
  int drive_method = 0;           ///< method drive: number of CiA 402-2 for 6098h
  double acceleration = 0.0;      ///< method drive: 609Ah, mm/s2; 0: the axis' own
  double position = 0.0;          ///< machine coordinate of the index (of the switch edge without one), mm
  double max_travel = 0.0;        ///< give up the search for the switch after this, 0: 1.2 x travel
  bool final_move = true;         ///< drives to final_position after referencing
  double final_position = 0.0;    ///< machine coordinate, mm
  double timeout = 60.0;          ///< s for the whole of it
  int order = 1;                  ///< axes of the same order home together, lower ones first
};

/// [axis.brake]: holding brake, opened by an output point or by the drive's own brake output.
struct BrakeConfig {
  std::string point;           ///< name of an output point, TRUE = open
  bool drive_output = false;   ///< the drive's own output (60FEh bit 0)
  double release_delay = 0.0;  ///< s from the output to an open brake; no motion before
  double torque_delay = 0.05;  ///< s from Operation enabled until the drive surely holds the load
  double slip_window = 0.5;    ///< mm of movement permitted while the brake opens or closes
  double engage_delay = 0.0;   ///< s from the output to a closed brake; power stays on that long
  /// s from the control's death until the relay that watches safety.control_alive takes the voltage from the
  /// brake; 0: no relay does.
  double relay_delay = 0.0;
  bool present() const { return drive_output || !point.empty(); }
};

/// [[axis]]
struct AxisConfig {
  std::string letter;  ///< "X", one of A-Z
  std::string name;    ///< for people
  AxisType type = AxisType::linear;
  bool diameter = false;   ///< programs and displays show twice the machine coordinate
  bool auxiliary = false;  ///< the PLC moves it, no program and nobody by hand
  std::string drive;       ///< "bus.node", or empty: an amplifier on a board
  int process = 1;         ///< whose programs move it, from 1

  double lead = 0.0;                          ///< mm (degrees) per turn of the screw (output of the gear)
  std::array<std::int64_t, 2> gear = {1, 1};  ///< motor turns : screw turns, exact
  std::int64_t counts_per_rev = 0;            ///< counts per turn of the motor
  Direction direction = Direction::plus;      ///< minus: rising counts are falling coordinates

  double max_velocity = 0.0;      ///< mm/s
  double max_acceleration = 0.0;  ///< mm/s2
  double max_jerk = 0.0;          ///< mm/s3
  double travel_min = 0.0;        ///< machine coordinates, mm; rotary with both 0: endless
  double travel_max = 0.0;
  double following_error_warn = 0.0;       ///< mm at standstill, warning 1017; 0: none
  double following_error_stop = 0.0;       ///< mm at standstill
  double following_error_velocity = 0.0;   ///< s: allowed in addition per mm/s of set-point speed
  double in_position_window = 0.01;        ///< mm
  double in_position_window_coarse = 0.0;  ///< mm, where a program asks for it; 0: four times the other
  double in_position_time = 0.01;          ///< s inside the window
  double in_position_timeout = 2.0;        ///< s from the set-point's rest to an alarm, 0: none
  double jog_velocity = 0.0;               ///< mm/s, 0: a tenth of max_velocity
  double jog_velocity_not_homed = 0.0;     ///< mm/s, also off a hard limit; 0: a hundredth of max_velocity
  double thread_retract = 0.0;             ///< mm, signed: how far it goes from a thread that is left
  std::string limit_plus;                  ///< input points, TRUE = on the limit
  std::string limit_minus;
  double hard_limit_plus = kNoLimit;  ///< machine coordinate at which the switch works
  double hard_limit_minus = -kNoLimit;
  double mechanical_end_plus = kNoLimit;  ///< machine coordinate at which the axis runs into its end
  double mechanical_end_minus = -kNoLimit;
  double backlash = 0.0;                           ///< mm, taken up when moving in minus direction
  std::vector<std::array<double, 2>> pitch_table;  ///< machine coordinate mm -> error mm, rising coordinates
  bool vertical = false;
  double torque_max = 0.0;   ///< per cent of the motor's rated torque, for MC_TorqueControl; 0: none
  double torque_ramp = 0.0;  ///< per cent a second, 0: torque_max in a second
  HomingConfig home;
  BrakeConfig brake;
  BoardChannelConfig board;

  /// What its lengths are in, as files and JSON write it; people read text::unit_words() of it.
  const char* unit() const { return type == AxisType::rotary ? "deg" : "mm"; }
  const char* speed_unit() const { return type == AxisType::rotary ? "deg/s" : "mm/s"; }
  bool endless() const { return type == AxisType::rotary && travel_min == 0.0 && travel_max == 0.0; }
  /// Drive counts per mm (degree), without sign.
  double counts_per_unit() const {
    return static_cast<double>(counts_per_rev) * static_cast<double>(gear[0]) /
           (static_cast<double>(gear[1]) * lead);
  }
  /// Motor speed in rpm at a speed of the axis in mm/s (degrees/s).
  double motor_rpm(double velocity) const {
    return velocity / lead * static_cast<double>(gear[0]) / static_cast<double>(gear[1]) * 60.0;
  }
  double homing_acceleration() const {
    return home.acceleration > 0.0 ? home.acceleration : max_acceleration;
  }
  double greatest_torque_ramp() const { return torque_ramp > 0.0 ? torque_ramp : torque_max; }
  double coarse_window() const {
    return in_position_window_coarse > 0.0 ? in_position_window_coarse : 4.0 * in_position_window;
  }
  double jog() const { return jog_velocity > 0.0 ? jog_velocity : max_velocity / 10.0; }
  double jog_not_homed() const {
    return jog_velocity_not_homed > 0.0 ? jog_velocity_not_homed : max_velocity / 100.0;
  }
};

/// By what angle of the first spindle of its process a spindle follows it, where a program couples them.
enum class Coupling : std::uint8_t { none, setpoint, measured };
/// By what angle of the spindle threads go.
enum class ThreadMaster : std::uint8_t { measured, setpoint };

/// What the loss of a node or of an inverter makes the machine do, in rising severity.
enum class LossReaction : std::uint8_t { stop_on_path, stop_axes, stop_and_power_off, quick_stop, power_off };

/// One of `gears` of a spindle.
struct GearConfig {
  std::string name;
  double max_speed = 0.0;                     ///< rpm of the spindle
  std::array<std::int64_t, 2> gear = {1, 1};  ///< motor turns : spindle turns
  std::string output;                         ///< output point that engages it; empty: none
  std::string confirm;                        ///< input point: it is engaged; empty: none tells
  double ratio() const { return static_cast<double>(gear[0]) / static_cast<double>(gear[1]); }
};

/// [[spindle]]: a CANopen drive, an inverter on Modbus, or an analog output with relay points.
struct SpindleConfig {
  std::string name;
  std::string drive;                                        ///< "bus.node", or empty
  std::string inverter;                                     ///< station of an inverter on Modbus, or empty
  double rated_speed = 0.0;                                 ///< rpm of its motor ...
  double rated_frequency = 0.0;                             ///< ... at this frequency, Hz
  LossReaction loss_reaction = LossReaction::stop_on_path;  ///< to the loss of the inverter
  int process = 1;                                          ///< whose S, M3, M4, M5 and M19 it obeys, from 1
  std::string speed_output;  ///< analog output point of an inverter; rpm without sign
  std::string cw_output;     ///< output points of its relays
  std::string ccw_output;
  double min_speed = 0.0;                     ///< rpm
  double max_speed = 0.0;                     ///< rpm
  double acceleration = 1000.0;               ///< rpm/s
  std::array<std::int64_t, 2> gear = {1, 1};  ///< motor turns : spindle turns
  std::int64_t counts_per_rev = 0;            ///< encoder counts per turn of the spindle, 0: no encoder
  std::vector<GearConfig> gears;              ///< slow ones first; empty: the one of `gear`
  double gear_change_speed = 0.0;             ///< rpm of the spindle while its gear changes; 0: it stands
  double gear_change_time = 0.5;     ///< s from the outputs to an engaged gear that no input confirms
  double gear_change_timeout = 5.0;  ///< s to the confirmation of a gear, then an alarm
  double encoder_delay = 0.0;        ///< s by which its counts are older than those of the drives
  Direction direction = Direction::plus;
  double at_speed_window = 5.0;    ///< per cent
  double at_speed_timeout = 10.0;  ///< s from the ramp's end to an alarm, 0: none
  double orient_angle = 0.0;       ///< degrees, oriented stop
  double orient_speed = 60.0;      ///< rpm
  ThreadMaster thread_master = ThreadMaster::measured;
  Coupling coupling = Coupling::none;             ///< by what it follows the first spindle of its process
  double coupling_window = 2.0;                   ///< degrees off; beyond: alarm
  std::string axis;                               ///< letter of the rotary axis that it becomes; empty: none
  std::array<std::int64_t, 2> axis_m = {70, 71};  ///< M functions: it becomes that axis : a spindle again
  bool has_encoder() const { return counts_per_rev > 0; }
  /// The gear by which its supplier is told: the only one, or the first of `gears`.
  const std::array<std::int64_t, 2>& first_gear() const { return gears.empty() ? gear : gears.front().gear; }
  double motor_rpm(double rpm) const {
    return rpm * static_cast<double>(first_gear()[0]) / static_cast<double>(first_gear()[1]);
  }
  /// Of all gears at their largest speeds.
  double largest_motor_rpm() const {
    double most = gears.empty() ? motor_rpm(max_speed) : 0.0;
    for (const GearConfig& g : gears) most = std::max(most, std::min(g.max_speed, max_speed) * g.ratio());
    return most;
  }
  /// Hz of an inverter at its largest motor speed.
  double largest_hertz() const { return largest_motor_rpm() / rated_speed * rated_frequency; }
  /// Hz of an inverter at a speed of the spindle in rpm, in the first gear.
  double hertz(double rpm) const { return motor_rpm(rpm) / rated_speed * rated_frequency; }
};

/// By what an axis follows its master.
enum class GearSource : std::uint8_t { setpoint, measured };

/// [[gear]]: an axis that follows another one, or a spindle.
struct ElectronicGearConfig {
  std::string follower;                        ///< letter of the axis
  std::string master;                          ///< letter of an axis; S or S2: a spindle
  std::array<std::int64_t, 2> ratio = {1, 1};  ///< follower : master, in turns, of linear axes in mm; signed
  GearSource source = GearSource::setpoint;
  double window = 0.0;    ///< mm or degrees of the follower off its place; beyond: alarm
  bool in_phase = false;  ///< false: as both stand when its speed is reached
  double phase = 0.0;     ///< mm or degrees of the follower where the master is at its zero
  static constexpr double kMostRatio = 10000.0;  ///< either way
};

/// When a node gets its program: where 1F56h tells another version, or never, then another one is refused.
enum class ProgramWhen : std::uint8_t { other_version, never };

/// [[bus.node]]
struct NodeConfig {
  std::string name;
  int id = 0;                    ///< CANopen node-ID 1-127
  std::string device;            ///< device file without .toml
  double heartbeat = 0.1;        ///< s, producer time of the node
  int loss_cycles = 3;           ///< cycles without process data until the node counts as lost
  double boot_timeout = 0.0;     ///< s, wait for boot-up and for Operational; 0: the standard 2 s
  int boot_attempts = 0;         ///< before the failure is told; 0: the standard 3
  double sdo_timeout = 0.0;      ///< s, wait for each answer of an SDO transfer; 0: the standard 200 ms
  int sdo_retries = 2;           ///< repetitions of a transfer that got no answer
  std::string software_version;  ///< 100Ah at boot, to the letter; empty: any
  LossReaction loss_reaction = LossReaction::stop_on_path;
  std::string program;                ///< file for 1F50h, from the machine file's folder; empty: none
  std::int64_t program_version = -1;  ///< 1F56h of the right program; -1: not checked
  int program_number = 1;             ///< sub-index of 1F50h, 1F51h, 1F56h and 1F57h
  ProgramWhen program_when = ProgramWhen::other_version;
  double program_timeout = 60.0;          ///< s of clearing and of writing the flash
  std::string configuration;              ///< DCF, written at boot; empty: none
  std::string configuration_date;         ///< "2026-11-22 14:30:00" for 1020h; empty: written at every boot
  bool configuration_store = false;       ///< the device is told to store it (1010h:01)
  bool unsupervised = false;              ///< may run although it would not notice the control's death
  bool silent_status = false;             ///< the statusword may come on event only, its loss unseen
  std::map<std::string, double> objects;  ///< "6065:00" -> value, written at boot after the device file's own
};

/// [[bus]]
struct BusConfig {
  std::string name;
  std::string url;            ///< the transport, by its scheme: docs/can.md
  std::int64_t bit_rate = 0;  ///< bit/s
  bool simulated = false;     ///< nothing on it is real; holds only where no real bus can be behind the url
  bool sync_counter = false;  ///< SYNC carries a counter from 1 to 240 (1019h)
  double sync_window = 0.0;   ///< s, 1007h of the nodes; 0: none
  double time_period = 0.0;   ///< s between two TIME messages; 0: none
  std::vector<NodeConfig> nodes;
  bool mock() const { return url.starts_with("mock:"); }
  /// Time on it is granted to all participants together, as on a mock.
  bool lockstep() const { return url.starts_with("lockstep:"); }
  bool nothing_real() const { return mock() || lockstep() || simulated; }
};

/// [[symbol]]: a free place with a name.
struct SymbolConfig {
  std::string name;
  image::Place place;
  image::Writer writer = image::Writer::plc;
  std::string comment;
};

/// [[own_code]]
struct OwnCodeConfig {
  std::string code;                     ///< "G50", "M77"
  std::string program;                  ///< file, relative to the machine file
  std::map<std::string, double> words;  ///< letter -> number of the parameter that takes the word
};

/// [plc]
struct PlcConfig {
  std::vector<std::string> sources;    ///< as written; resolve() makes paths of them
  double handshake_timeout = 10.0;     ///< s until an M, S, T or H word that is not acknowledged is an alarm
  int instruction_budget = 1'000'000;  ///< of one scan, with all its tasks; more is alarm 5002
  double watchdog = 0.0;  ///< longest time of a scan in real time, s; more is alarm 5005; 0: not watched
};

/// [safety]
struct SafetyConfig {
  std::string estop;          ///< input point: TRUE = the chain is closed. Never over Modbus.
  std::string control_alive;  ///< output point that the control toggles while it runs in time
  /// Mock inputs may stand for the emergency stop and the limit switches of drives on a real bus: a bench.
  bool mock_inputs_guard_real_drives = false;
};

/// [modbus_server]: what panels and SCADA may see over Modbus TCP.
struct ModbusServerConfig {
  std::string listen;                ///< "127.0.0.1:1502"; empty: there is no server
  std::vector<std::string> clients;  ///< addresses of other computers that are served
  std::vector<std::string> write;    ///< ranges of packet K that may be written: "SK200-SK231"
};

/// [run]
struct RunConfig {
  bool allow_start_now = false;  ///< `run --start-now` may move real drives without the operator's start
  std::string start_point;       ///< input point of the operator's start button, for buses that are no mock
  std::string socket;            ///< control socket; empty: $XDG_RUNTIME_DIR/servogate/NAME.sock
  std::string state = "state";   ///< state directory, relative to the machine file
};

/// [realtime]
struct RealtimeConfig {
  int cpu = -1;  ///< -1: not bound
  int priority = 80;
};

/// [control]
struct ControlConfig {
  double cycle_time = 0.001;  ///< s
  std::string dialect = "nc110";
  MachineKind kind = MachineKind::by_axes;
  std::vector<std::string> power_on;        ///< in the dialect's words: "G94", ...
  std::map<std::string, double> variables;  ///< "ERF" -> mm, "MCD" -> 2, ...
  double contour_tolerance = 0.01;          ///< mm
  ArcFeed arc_feed = ArcFeed::tool_centre;  ///< until a word of the program chooses
  double path_reserve = 1.0;                ///< per cent of the axes' limits, for holds and overrides
  double thread_window = 0.2;               ///< mm of path off the spindle, further off a thread is left
  bool thread_hold_retracts = false;        ///< a hold leaves a thread; false: the pass goes on to its end
  ThreadSide thread_retract_side = ThreadSide::declared;
  double tap_overshoot = 3.0;  ///< mm that a tap may go beyond its depth with its spindle
  std::string probe;           ///< input point of the probe, TRUE = deflected
  ProbeLatch probe_latch = ProbeLatch::edge;
  int tool_places = 0;  ///< of the magazine or turret; 0: T is not compared with it
  int processes = 1;
  int k_size = static_cast<int>(image::kPacketKDefaultSize);  ///< bytes of packet K
  int syvar_size = static_cast<int>(image::kSyvarDefaultSize);
};

/// The whole machine file.
struct MachineConfig {
  int schema = 0;
  std::string name;
  ControlConfig control;
  RunConfig run;
  RealtimeConfig realtime;
  SafetyConfig safety;
  PlcConfig plc;
  std::vector<BusConfig> buses;
  std::vector<AxisConfig> axes;
  std::vector<SpindleConfig> spindles;
  std::vector<LineConfig> lines;
  std::vector<StationConfig> stations;
  std::vector<SymbolConfig> symbols;
  std::vector<OwnCodeConfig> own_codes;
  ModbusServerConfig modbus_server;
  std::vector<PendantConfig> pendants;
  std::vector<PathWheelConfig> path_wheels;
  std::vector<ElectronicGearConfig> electronic_gears;
  SimulationConfig simulation;

  std::string file;  ///< path as given to load(), the `file` of every finding
  /// Place of every key that the file has, by path: "axis.0.home.position", "bus.0.node.2.id", "control".
  std::map<std::string, Where, std::less<>> places;
  /// Paths of keys that the file has but whose value was wrong: already said, their members hold defaults.
  std::set<std::string, std::less<>> unread;

  /// Place of a key, or of the nearest table around it when the file does not have it.
  Where where(std::string_view path) const;
  /// Path of a name in this file (PLC source, state directory) seen from the machine file's folder.
  std::string resolve(std::string_view relative) const;
  std::int64_t cycle_ns() const;
  /// Index of the axis with this letter, -1: none.
  int axis_index(std::string_view letter) const;
  /// Index of the spindle that the interface calls S or S2, -1: none.
  int spindle_index(std::string_view wanted) const;
  /// A point by name (case as written), nullptr: none. `station` gets its station's index where asked for.
  const PointConfig* point(std::string_view name, int* station = nullptr) const;
  /// A Modbus line by name, nullptr: none. `index` gets its place where asked for.
  const LineConfig* line(std::string_view name, int* index = nullptr) const;
  /// A node by "bus.node", nullptr: none. The out-parameters get the indices where asked for.
  const NodeConfig* node(std::string_view reference, int* bus = nullptr, int* index = nullptr) const;
  /// True when what a station has comes from a mock, or over a bus on which nothing is real.
  bool nothing_real(const StationConfig& station) const;
  /// True when no bus and no station can reach anything real: mocks, and buses of simulated devices.
  bool nothing_real() const;
  /// True when every bus lives in virtual time.
  bool virtual_time() const;
  /// Letters in axis order.
  std::vector<std::string> letters() const;
  /// Unit of each axis as people read it, in both languages (text::unit_words).
  std::vector<std::string> unit_words() const;
  /// Axes that programs move; the auxiliary ones stand behind them.
  std::size_t program_axes() const;
  /// The axes that the programs of a process (from 0) move at first, as bits.
  std::uint32_t axes_of_process(int process) const;
  /// The first spindle of a process (from 0), nullptr: it has none.
  const SpindleConfig* spindle_of_process(int process) const;
  /// The process (from 0) whose T is the tool in the spindle: that of the first spindle.
  int tool_process() const { return spindles.empty() ? 0 : spindles.front().process - 1; }
  /// The auxiliary axes as bits.
  std::uint32_t auxiliary_axes() const;
  /// Every name the PLC, the part program and the operator can use: points, free symbols, interface of packet
  /// K.
  std::vector<image::Symbol> symbol_table() const;
};

}  // namespace servogate::machine
