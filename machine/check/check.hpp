// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "machine/keys/reader.hpp"
#include "machine/load.hpp"

/// What single keys cannot tell: one function a subject, each adds its findings. All of them take any machine
/// that the reader could make, however wrong.
namespace servogate::machine {

/// Names that are twice or not of the right form: letters, nodes, points, symbols, stations, buses.
void check_names(MachineConfig& machine, Reading& reading);
/// Outputs that the control itself writes (safety.control_alive, brakes, inverters): makes it their writer,
/// and finds another one.
void claim_control_outputs(MachineConfig& machine, Reading& reading);
/// Names that lead nowhere: points, nodes, axes, PLC files, simulated things that are no mock.
void check_references(const MachineConfig& machine, Reading& reading);
/// Places: inside their packet, not shared, not inside the interface of packet K, one writer.
void check_places(const MachineConfig& machine, Reading& reading);
/// Axes: travel, homing, limits, brakes, compensation tables.
void check_axes(const MachineConfig& machine, Reading& reading);
/// Spindles.
void check_spindles(const MachineConfig& machine, Reading& reading);
/// Emergency stop, start point, control alive: choices that are dangerous.
void check_safety(const MachineConfig& machine, Reading& reading);
/// Whether a CAN bus can be opened by such a url: `expected` forms in `check_control`'s words.
bool is_can_url(std::string_view url);
/// Cycle time, dialect words, transports and channels of stations.
void check_control(const MachineConfig& machine, Reading& reading);
/// Stations of kind canopen: their channels in the process data of their nodes.
void check_can_stations(const LoadResult& loaded, Reading& reading);
/// Heartbeats, guarding, deadlines, SYNC window and TIME against each other and the cycle.
void check_bus_times(const LoadResult& loaded, Reading& reading);
/// What takes longer than somebody waits for it: homing, brakes, spindles, Modbus lines.
void check_waits(const LoadResult& loaded, Reading& reading);
/// Mechanical ends: behind the switches, and far enough for a stop.
void check_overrun(const LoadResult& loaded, Reading& reading);
/// Axes with a brake: whether they fall when the control dies.
void check_control_death(const LoadResult& loaded, Reading& reading);
/// Addresses and ranges of the Modbus server.
void check_modbus_server(const MachineConfig& machine, Reading& reading);
/// Pendants against their device files and the axes.
void check_pendants(const LoadResult& loaded, Reading& reading);
/// Handwheels that drive programs along their path, against pendants and processes.
void check_path_wheels(const LoadResult& loaded, Reading& reading);
/// Spindles on inverters on Modbus.
void check_inverters(const LoadResult& loaded, Reading& reading);
/// Bus load and speed of motors against the device files.
void check_devices(const LoadResult& loaded, Reading& reading);
/// Channels of stations against their device files.
void check_station_devices(const LoadResult& loaded, Reading& reading);
/// What the lines of a GPIO chip can be: edges, biases, encoders; each line for one point.
void check_gpio_lines(const MachineConfig& machine, Reading& reading);
/// Boards, and axes whose amplifier is on one.
void check_boards(const MachineConfig& machine, Reading& reading);
/// Spindles that follow another one, and by what angle threads go.
void check_couplings(const MachineConfig& machine, Reading& reading);
/// Axes that follow another one, or a spindle.
void check_electronic_gears(const MachineConfig& machine, Reading& reading);
/// Spindles that become a rotary axis.
void check_spindle_axes(const LoadResult& loaded, Reading& reading);
/// Gear ranges of spindles.
void check_gears(const MachineConfig& machine, Reading& reading);

}  // namespace servogate::machine
