// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/packets.hpp"

namespace servogate::machine {

enum class StationKind : std::uint8_t { modbus, gpio, drive, canopen, board };
/// The resistor of a GPIO line inside its chip. `as_is`: as the firmware of the board left it.
enum class PointBias : std::uint8_t { as_is, off, up, down };
enum class ChannelKind : std::uint8_t { di, dq, ai, aq };

/// One of [[station]] points: a wire of the machine with its place in packet A.
struct PointConfig {
  std::string name;
  std::string channel_text;               ///< key `channel`: "di3", "do0", "ai1", "ao0"
  ChannelKind channel = ChannelKind::di;  ///< taken apart by the loader; its kind is the direction
  int number = -1;                        ///< -1: the channel could not be read
  image::Place place;
  bool inverted = false;
  double loss =
      0.0;  ///< value in packet A (input) or on the wire (output) while the station is lost, as written
  image::Writer writer = image::Writer::plc;  ///< of an output; an input's is `input`
  bool hold = false;   ///< keeps the last value while the station is lost, instead of `loss`
  double scale = 1.0;  ///< analog: value in packet A = raw * scale + shift
  double shift = 0.0;
  double debounce = 0.0;              ///< s
  double hysteresis = 0.0;            ///< analog input, in the unit of packet A
  PointBias bias = PointBias::as_is;  ///< gpio input
  bool edges = false;                 ///< gpio, board, digital input: its edges are told with their times
  int b_line = -1;  ///< gpio, `ai`: line of track B of an encoder whose track A is the channel; -1: none
  std::string comment;
  bool is_input() const { return channel == ChannelKind::di || channel == ChannelKind::ai; }
  bool is_analog() const { return channel == ChannelKind::ai || channel == ChannelKind::aq; }
  /// The counts of an encoder on two lines of a GPIO chip.
  bool is_encoder() const { return b_line >= 0; }
};

/// Of each character on a serial line.
enum class LineParity : std::uint8_t { none, even, odd };

/// [[line]]: a Modbus line, one wire or one TCP peer, with the stations that name it.
struct LineConfig {
  std::string name;
  std::string url;             ///< "mock:NAME", "tcp:HOST:PORT", "rtu:/dev/..."
  std::int64_t baud = 115200;  ///< bit/s, of RTU and of a mock
  /// RTU. Defaults of Modbus over Serial Line V1.02, 2.5.1: even, and 11 bits a character whatever the
  /// parity.
  LineParity parity = LineParity::even;
  int stop_bits = 0;     ///< RTU; 0: what makes 11 bits
  double timeout = 0.1;  ///< s until an answer is late
};

/// [[station]]: a Modbus unit, a GPIO chip, a USB board, the digital inputs and outputs of a drive, or a node
/// of CiA 401 or CiA 406.
struct StationConfig {
  std::string name;
  StationKind kind = StationKind::gpio;
  std::string line;      ///< modbus: name of a [[line]]
  std::string url;       ///< gpio: "mock:NAME", "chip:LABEL"; board: "mock:NAME", "usb:SERIAL"; modbus: that
                         ///< of its line, by the loader
  std::string node;      ///< drive, canopen: "bus.node"
  std::string device;    ///< device file without .toml, modbus
  int unit = 1;          ///< modbus unit identifier
  double period = 0.02;  ///< s between polls, modbus; GPIO and boards are read every cycle
  double watchdog = 0.02;  ///< s without a command until a board drops everything
  std::vector<PointConfig> points;
  /// Its points come over a node of a bus.
  bool over_bus() const { return kind == StationKind::drive || kind == StationKind::canopen; }
  /// Nothing real is behind it, but for what is behind its bus.
  bool mock() const { return over_bus() || url.starts_with("mock:"); }
};

}  // namespace servogate::machine
