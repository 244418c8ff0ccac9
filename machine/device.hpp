// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/canopen/402/drive_profile.hpp"
#include "firmware_if/text/finding.hpp"
#include "machine/config.hpp"
#include "machine/inverter.hpp"
#include "machine/pendant_device.hpp"

namespace servogate::machine {

/// What a device file describes; which of the tables below have a meaning follows from it.
enum class DeviceKind : std::uint8_t {
  servo,
  stepper,
  spindle,
  modbus_io,
  gpio,
  canopen_io,
  canopen_encoder,
  inverter,
  pendant
};

/// One mapped object: "6040:00/16" = index, subindex, bits.
struct PdoObject {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bits = 0;
};
/// [[rpdo]] (to the device) and [[tpdo]] (from the device).
struct PdoConfig {
  int number = 1;        ///< 1-4, with predefined identifiers
  int transmission = 1;  ///< CiA 301 transmission type: 0-240 by SYNC (n: every n-th), 252/253 when asked
                         ///< for, 254/255 on event
  double inhibit = 0.0;  ///< s between two frames of an event-driven PDO
  /// s: TPDO on event is sent at least this often; TPDO 252/253: the control asks this often; RPDO: deadline.
  double event = 0.0;
  std::vector<std::string> object_texts;  ///< key `objects`
  std::vector<PdoObject> objects;         ///< taken apart by the loader
  int bytes() const;
  bool cyclic() const { return transmission >= 1 && transmission <= 240; }
  bool remote() const { return transmission == 252 || transmission == 253; }
  bool synchronous() const { return transmission <= 240; }
};

/// [motor]: what the drive and its motor can do; the simulated drive takes its plant from here.
struct MotorConfig {
  double max_speed = 0.0;           ///< rpm, 0: not stated
  double rated_torque = 0.0;        ///< N m
  double peak_torque = 0.0;         ///< N m
  double inertia = 0.0;             ///< kg m2, rotor
  std::int64_t counts_per_rev = 0;  ///< as the drive reports them, 0: set in the machine file
  bool brake_output = false;        ///< has an output for a holding brake (60FEh bit 0)
};

/// What a drive does when its master falls silent (6007h).
enum class ConnectionLoss : std::uint8_t { none, fault, disable_voltage, quick_stop };
enum class FaultResetBy : std::uint8_t { edge, level };
enum class PositionMode : std::uint8_t { csp, ip, pp };
enum class SpeedMode : std::uint8_t { csv, pv, vl };
enum class TorqueMode : std::uint8_t { cst, tq };

/// [behaviour]: where a drive differs from CiA 402, in the names of canopen::DriveProfile.
struct BehaviourConfig {
  double velocity_unit = 1.0;                ///< one unit of 60FFh and 606Ch in counts/s
  bool velocity_in_rpm = false;              ///< 60FFh and 606Ch are in rpm; velocity_unit is computed
  double acceleration_unit = 1.0;            ///< one unit of 609Ah in counts/s2
  double torque_unit = 1.0;                  ///< one unit of 6071h and 6077h in per mille
  std::vector<std::string> modes = {"csp"};  ///< modes of 6502h that must be there
  bool check_modes = true;                   ///< false: the drive has no 6502h
  /// ip: of a drive without csp, 60C1h:01 mapped; pp: the drive forms the motion to each set-point by itself.
  PositionMode position_mode = PositionMode::csp;
  std::vector<std::string> ip_record = {"position"};  ///< what 60C1h:01, :02 ... are
  bool ip_buffer = false;                             ///< has 60C4h
  SpeedMode speed_mode = SpeedMode::csv;              ///< the drive's mode for csv of the kernel
  TorqueMode torque_mode = TorqueMode::cst;           ///< the drive's mode for a torque command
  FaultResetBy fault_reset = FaultResetBy::edge;
  double fault_reset_hold = 0.02;           ///< s that controlword bit 7 stays set
  double transition_timeout = 2.0;          ///< s, then a transition counts as refused
  bool halt = true;                         ///< has a halt bit (6040h bit 8)
  std::vector<std::string> homing_methods;  ///< of 6098h that the drive has, by CiA 402-2; empty: not said
  int homing_method_here = 37;              ///< the drive's own number of method 37
  bool homing_method_none = true;           ///< 6098h takes 0
  bool homing_method_list = true;           ///< 60E3h is to be believed where it is there
  std::int64_t handover_counts = 0;         ///< 0: a quarter of a turn
  int brake_bit = -1;                       ///< bit of 60FEh:01, -1: none
  bool brake_bit_releases = true;
  /// The drive closes its brake by itself with its power stage: before the torque goes where it brakes first.
  bool brake_interlock = false;
  bool fixed_pdo_map = false;        ///< the map cannot be written: it is read and compared
  bool sdo_only = false;             ///< no process data: everything goes over SDO
  bool interpolation_period = true;  ///< the drive has 60C2h
  int interpolation_base = -3;       ///< exponent of 60C2h:02
  int command_delay = 1;             ///< cycles from a target's SYNC to the actual value that follows it
  bool cycle_period = false;         ///< 1006h is to be written
  bool heartbeat_consumer = true;    ///< has 1016h
  double guard_time = 0.0;           ///< s, node guarding instead of heartbeat (100Ch); 0: heartbeat
  int life_time_factor = 3;          ///< 100Dh
  ConnectionLoss connection_loss = ConnectionLoss::fault;
};

/// [[error]]: one error code (603Fh, EMCY) in words.
struct DeviceError {
  std::int64_t code = 0;
  std::string english;
  std::string russian;
};

/// [modbus]: channels of an I/O station, 0: none of this kind. Addresses as on the wire, from 0.
struct ModbusMap {
  int di_count = 0, dq_count = 0, ai_count = 0, aq_count = 0;
  int di_address = 0, dq_address = 0, ai_address = 0, aq_address = 0;
  /// Inputs are bits of input registers (function 4) instead of discrete inputs (function 2); input 0 is bit
  /// 0 of the register at di_address.
  bool di_as_registers = false;
  /// Registers or bits that the digital inputs take.
  int di_items() const { return di_as_registers ? (di_count + 15) / 16 : di_count; }
};

/// [encoder]: what an encoder of CiA 406 is to be, compared at boot.
struct EncoderConfig {
  std::int64_t counts_per_rev = 0;  ///< 6501h, 0: not checked
  std::int64_t revolutions = 0;     ///< 6502h, 0: not checked
};

/// [gpio]: a GPIO chip.
struct GpioConfig {
  int lines = 64;  ///< that the chip has, counted from 0
};

/// One device file of devices/ or of the machine file's folder.
struct DeviceConfig {
  int schema = 0;
  std::string name;  ///< for people
  DeviceKind kind = DeviceKind::servo;
  std::string manufacturer;
  std::string description;
  std::int64_t vendor_id = 0;     ///< 1018h:01, 0: not checked
  std::int64_t product_code = 0;  ///< 1018h:02, 0: not checked
  std::int64_t revision = 0;      ///< 1018h:03, 0: not checked
  MotorConfig motor;
  BehaviourConfig behaviour;
  std::vector<PdoConfig> rpdos;
  std::vector<PdoConfig> tpdos;
  std::map<std::string, double>
      objects;  ///< "6065:00/32" -> value, written at boot; bits 8, 16 or 32 (default)
  std::vector<std::string> write_only;  ///< of `objects`, or of a node's: cannot be read back
  std::vector<DeviceError> errors;
  ModbusMap modbus;
  GpioConfig gpio;
  EncoderConfig encoder;
  InverterMap inverter;
  PendantMap pendant;

  std::string file;  ///< path it was read from
  std::map<std::string, Where, std::less<>> places;
  Where where(std::string_view path) const;
  bool drive() const {
    return kind == DeviceKind::servo || kind == DeviceKind::stepper || kind == DeviceKind::spindle;
  }
  /// A node of a bus that is no drive.
  bool terminals() const { return kind == DeviceKind::canopen_io || kind == DeviceKind::canopen_encoder; }
  /// Text of an error code in the language, empty: unknown.
  std::string_view error_text(std::uint16_t code, text::Language language) const;
  /// What the required register of an inverter at this address is, empty: unknown.
  std::string_view required_text(std::uint16_t address, text::Language language) const;
};

/// Whether a drive has a homing method: by `homing_methods`, without those every one that CiA 402-2
/// describes.
bool has_homing_method(const DeviceConfig& device, int method);

/// "6065:00/32", "6065:00", "6065" -> index (hexadecimal), subindex, bits (0 when not given); nullopt: not of
/// that form.
std::optional<PdoObject> parse_object(std::string_view text);

/// 604Bh or 604Ch of the velocity mode vl, as the device file or the node sets it; 1 where neither does.
struct VlFactor {
  std::int32_t numerator = 1, denominator = 1;
};
VlFactor vl_factor(const canopen::DriveProfile& profile, std::uint16_t index);

/// The device file as the CANopen master wants it: a node's own objects after the device's; counts_per_rev of
/// the axis.
canopen::DriveProfile drive_profile(const DeviceConfig& device, const NodeConfig& node,
                                    std::int64_t counts_per_rev);

struct DeviceResult {
  DeviceConfig device;
  std::vector<text::Finding> findings;
  bool ok() const;
};
/// Reads a device file; every finding of the file at once.
DeviceResult load_device(const std::string& path);
/// The same from memory; `file` is the name in findings.
DeviceResult parse_device(std::string_view text, const std::string& file);

}  // namespace servogate::machine
