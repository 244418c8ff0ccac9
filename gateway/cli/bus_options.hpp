// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace servogate::gateway {

/// `servogate can bus`: a bus server for other processes.
struct CanBusOptions {
  std::vector<std::string> names;
  std::string listen = "127.0.0.1:29536";
  double bit_rate = 1'000'000.0;  ///< bit/s
  int lockstep = 0;
  double until = 0.0;  ///< s
  std::string log;
  bool json = false;
};

/// What goes wrong with simulated drives.
struct FaultOptions {
  std::vector<std::string> faults;  ///< lines of gateway/command/simulated/fault_line.hpp
  std::string script;               ///< file of such lines with times
};

/// `servogate drive`: simulated drives as a process of their own.
struct DriveOptions {
  std::string bus;
  std::vector<int> nodes;
  std::string device;
  std::string profile;                ///< servo, stepper, spindle, or a data sheet
  std::vector<std::string> plant;     ///< KEY=VALUE
  std::vector<std::string> switches;  ///< INPUT=FROM..TO, revolutions
  std::string write_eds;              ///< file for the data sheet of the simulated device
  std::string pdo_map;                ///< variable, whole, fixed; empty: as the device file says
  FaultOptions faults;
  double bit_rate = 0.0;  ///< bit/s; 0: that of the interface, 1 Mbit/s where the bus has none
  bool json = false;
};

/// `servogate io`: simulated I/O modules as a process of their own.
struct IoOptions {
  std::string bus;
  std::vector<int> nodes;
  std::string kind = "module";  ///< or "encoder"
  int digital_inputs = 16, digital_outputs = 16, analogue_inputs = 4, analogue_outputs = 2;
  int counts_per_rev = 8192, revolutions = 4096;  ///< of an encoder
  double bit_rate = 0.0;  ///< bit/s; 0: that of the interface, 1 Mbit/s where the bus has none
  bool json = false;
};

/// `servogate sim`: the simulated devices of a machine for somebody else's controller.
struct SimOptions {
  std::string machine;
  std::vector<std::string> buses;  ///< NAME=URL
  FaultOptions faults;
  bool json = false;
};

/// `servogate dump`: a bus as a log of can-utils.
struct DumpOptions {
  std::string bus;
  double bit_rate = 0.0;   ///< bit/s; 0: that of the interface, 1 Mbit/s where the bus has none
  std::int64_t count = 0;  ///< frames, 0: no end
  double seconds = 0.0;    ///< 0: no end
  bool json = false;
};

/// `servogate play`: such a log back onto a bus.
struct PlayOptions {
  std::string bus, file;
  double bit_rate = 0.0;  ///< bit/s; 0: that of the interface, 1 Mbit/s where the bus has none
  double speed = 1.0;
  bool may_move = false;
  std::vector<int> nodes;        ///< whose frames are played; empty: of all
  std::vector<std::string> ids;  ///< identifiers or ranges "180-1FF", hexadecimal; empty: all
  std::string sender;            ///< "master" or "devices"; empty: of both
  bool json = false;
};

/// Longer than any usual SYNC period, and not in the way of who reads one object after the other.
inline constexpr double kSilenceBeforeReading_s = 0.25;
inline constexpr double kSilenceBeforeWriting_s = 1.0;

/// What the command line tools for CANopen have in common.
struct CanopenBusOptions {
  std::string bus;
  double bit_rate = 0.0;      ///< bit/s; 0: that of the interface, 1 Mbit/s where the bus has none
  double timeout_ms = 500.0;  ///< for an answer to an SDO or layer setting request
  bool no_block = false;      ///< SDO in segments only
  bool json = false;
  /// How long a bus must be silent of masters, s; none: kSilenceBeforeReading_s or kSilenceBeforeWriting_s.
  std::optional<double> listen_s;
  bool may_move = false;
  bool anyway = false;  ///< reads although somebody controls the bus
};

/// `servogate scan`: who is on the bus.
struct ScanOptions : CanopenBusOptions {
  double seconds = 2.0;  ///< for heartbeats
};

/// `servogate sdo`: objects of one node.
struct SdoOptions : CanopenBusOptions {
  int node = 0;
  std::string action, object;
  std::vector<std::string> words;  ///< VALUE, TYPE, further accesses
  std::string eds, save;
};

/// `servogate od`: the whole object dictionary of a node.
struct OdOptions : CanopenBusOptions {
  int node = 0;
  std::string eds, save, compare, restore, write_eds;
  std::string range;  ///< FIRST-LAST, hexadecimal; empty: the standard areas
};

/// `servogate lss`: layer setting services, in the order of the words.
struct LssOptions : CanopenBusOptions {
  /// Fastscan waits for every answer that does not come, 130 times.
  LssOptions() { timeout_ms = 50.0; }
  std::vector<std::string> words;
};

/// `servogate nmt`.
struct NmtOptions : CanopenBusOptions {
  std::string command;
  std::string node = "all";
};

/// `servogate can restart`.
struct CanRestartOptions {
  std::string bus;
  bool json = false;
};

/// `servogate can check`.
struct CanCheckOptions : CanopenBusOptions {
  double seconds = 2.0;
  bool detect = false;
};

/// `servogate pendant list` and `watch`.
struct PendantOptions {
  std::string device;  ///< watch
  std::string url = "hid:any";
  int count = 0;  ///< reports; 0: until it is ended
  bool json = false;
};

/// `servogate modbus read`, `write` and `scan`: a Modbus line by hand.
struct ModbusOptions {
  std::string line;       ///< url, or MACHINE.toml#line
  double baud = 115'200;  ///< bit/s, of a serial device named by its url
  std::string parity = "even";
  int stop_bits = 0;  ///< 0: as the standard says
  double timeout_ms = 500.0;
  int unit = 1;
  std::string kind;  ///< coils, inputs, registers, input-registers
  int address = 0;
  int count = 1;                    ///< of read
  std::vector<std::string> values;  ///< of write
  int first = 1, last = 247;        ///< of scan
  bool may_move = false;
  bool json = false;
};

/// Options of the commands that work on a bus.
struct BusCommands {
  CanBusOptions can_bus;
  CanCheckOptions can_check;
  CanRestartOptions can_restart;
  DriveOptions drive;
  IoOptions io;
  SimOptions sim;
  DumpOptions dump;
  PlayOptions play;
  ScanOptions scan;
  SdoOptions sdo;
  OdOptions od;
  LssOptions lss;
  NmtOptions nmt;
  ModbusOptions modbus_read, modbus_write, modbus_scan;
  PendantOptions pendant_list, pendant_watch;
};

}  // namespace servogate::gateway
