// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/mock/board/simulated_board.hpp"
#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "drivers/mock/gpio/mock_gpio.hpp"
#include "drivers/mock/indexer/indexer.hpp"
#include "drivers/mock/io/simulated_encoder.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "drivers/mock/modbus/modbus_line.hpp"
#include "drivers/mock/pendant/mock_pendant.hpp"
#include "firmware_if/image/points/point_rule.hpp"

namespace servogate::mock {

/// Where an axis of the world is: at its simulated drive, or where a drive outside of it says it is.
struct WorldAxis {
  std::string drive;  ///< "bus.node"; of a drive that is not in this world: `start` and what is reported
  double units_per_revolution = 0.0;   ///< mm or degrees, with the sign of the direction
  double counts_per_revolution = 1.0;  ///< of what is reported
  double start = 0.0;                  ///< mm or degrees, machine coordinates, at power-on
  std::string board;                   ///< of an axis on a simulated board: its station ...
  std::size_t channel = 0;             ///< ... and channel
};

/// A point of a device of the world: its name, how a value becomes a level on the wire, and its channel.
struct WorldPoint {
  std::string name;
  image::PointRule rule;
  int channel = 0;
};

/// A contact that leads to an input of a drive (its bit of 60FDh) or to a terminal of an I/O module.
struct NodeContact {
  GpioInput contact;
  int channel = 0;
};

/// A unit of a simulated Modbus line.
struct WorldUnit {
  std::string station;
  StationSettings settings;
  int source = 0;  ///< index in image.sources
  std::vector<WorldPoint> points;
};

/// A wire from an output to an input. It carries levels: `inverted` of the two points is not the wire's.
struct WorldLoop {
  std::string output, input;
  bool inverted = false;
  image::Nanoseconds delay_ns = 0;
};

/// A turret: while the output is on, its positions pass, and the input of the present one is on.
struct WorldIndexer {
  std::string output;
  std::vector<std::string> inputs;
  image::Nanoseconds step_ns = 0;
  int start = 0;  ///< position at power-on
};

/// Everything simulated around one control: CAN segments with their nodes, GPIO chips whose switches follow
/// the simulated axes, Modbus lines, wires and turrets between them. It is put together with the add_...()
/// functions, buses and axes in the order of their indices and each device before what refers to it; then
/// time passes in advance_to() only. Equal calls give equal worlds. Not real-time safe but where it says so.
class World {
 public:
  World();
  ~World();
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// A CAN segment; endpoint 0 is the control's, the nodes that are added next follow in their order.
  void add_bus(const CanSegmentConfig& config);
  /// A bus that is not simulated: it only takes its index.
  void add_outside_bus();
  /// A node on the bus that was added last. `reference`: "bus.node"; `name`: of its endpoint.
  void add_drive(const std::string& reference, const std::string& name, const SimulatedDriveConfig& config);
  void add_module(const std::string& reference, const std::string& name, const SimulatedIoConfig& config);
  void add_encoder(const std::string& reference, const std::string& name,
                   const SimulatedEncoderConfig& config);
  void add_axis(const WorldAxis& axis);
  /// A USB board; its axes are added behind it.
  void add_board(const std::string& station, const SimulatedBoardConfig& config);
  /// What is wired to a board: contacts, outputs, and analog inputs with their raw values at first.
  void add_board_contacts(const std::string& station, std::vector<NodeContact> inputs,
                          const std::vector<WorldPoint>& outputs,
                          const std::vector<std::pair<WorldPoint, double>>& values);
  /// A GPIO chip. `source`: index in image.sources.
  void add_chip(const std::string& station, std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs,
                int source);
  /// What is wired to a simulated drive or I/O module: its levels reach packet A over the bus. Of a node that
  /// is not in this world nothing is made.
  void add_contacts(const std::string& node, std::vector<NodeContact> inputs,
                    const std::vector<WorldPoint>& outputs);
  /// An analog input of a simulated I/O module, or channel 0 of an encoder, its position. `initial`: raw.
  void add_value(const std::string& node, const WorldPoint& point, std::optional<double> initial);
  void add_line(const LineSettings& line, const modbus::Map& map, std::vector<WorldUnit> units);
  /// `name`: of the machine file.
  void add_pendant(const std::string& name, pendant::Layout layout);
  /// Points that are not in this world are no error: a loop or a turret with one of them is not made.
  void add_indexer(const WorldIndexer& indexer);
  void add_loop(const WorldLoop& loop);
  /// An input that the operator of close_operator_points() closes.
  void add_operator_point(const std::string& point) { operator_points_.push_back(point); }

  /// Brings everything to time t, buses first. Not called by the cycle but before it.
  void advance_to(image::Nanoseconds t);
  /// What drives outside of this world report; between two cycles. real-time safe.
  void note_feedback(const image::ProcessImage& image) noexcept;

  /// Sets a simulated input as the world does, after `inverted`: TRUE makes the point TRUE. False: no such
  /// input.
  bool set_input(std::string_view point, bool on);
  /// What a person playing the world does to an input.
  struct Play {
    std::optional<double> value;  ///< digital: not 0 makes the point TRUE; analog: the point's value;
                                  ///< nullopt: a switch follows its axis again
  };
  enum class Played { done, no_such_input, follows_nothing };
  /// Plays an input from any thread; it takes effect with the next advance_to(). A switch that follows an
  /// axis is held at the level until it is let go.
  Played play_input(std::string_view point, Play play);
  /// Largest value of a simulated analog register; they begin at 0.
  static constexpr double kLargestRegister = 65535.0;
  /// The operator of `run`: closes what add_operator_point() named (the emergency-stop chain).
  void close_operator_points();

  /// The control's endpoint on the bus of this index; nullptr: that bus is not simulated.
  image::CanBus* bus(std::size_t index) { return buses_[index].control; }
  /// The simulated wire of a bus, the same.
  CanSegment* wire(std::size_t index) noexcept { return buses_[index].segment.get(); }
  /// Devices by their names, "bus.node" or the name of a station; nullptr: not in this world.
  SimulatedDrive* drive(std::string_view reference);
  SimulatedIoModule* module(std::string_view reference);
  SimulatedEncoder* encoder(std::string_view reference);
  ModbusStation* modbus(std::string_view station);
  MockModbusLine* line_of(std::string_view station);
  MockGpio* chip(std::string_view station);
  SimulatedBoard* board(std::string_view station);
  MockPendant* pendant(std::string_view name);
  /// The contact behind a digital input.
  struct Contact {
    MockGpio* chip = nullptr;  ///< nullptr: the point has none
    std::size_t number = 0;
    image::PointRule rule;
  };
  Contact contact(std::string_view point);
  /// True position of an axis, machine coordinates.
  double axis_position(int axis) const;

 private:
  struct Bus {
    std::unique_ptr<CanSegment> segment;
    image::CanBus* control = nullptr;
  };
  struct Axis {
    WorldAxis settings;
    const SimulatedDrive* drive = nullptr;  ///< nullptr: on a board, or outside
    const Amplifier* amplifier = nullptr;   ///< on a channel of a board
    std::int64_t reported_counts = 0;
  };
  /// Where a point ends: channel `number` of one of these.
  struct Terminal {
    MockGpio* chip = nullptr;
    ModbusStation* unit = nullptr;
    SimulatedIoModule* module = nullptr;
    SimulatedEncoder* encoder = nullptr;
    const SimulatedDrive* drive = nullptr;
    SimulatedBoard* board = nullptr;
    std::size_t number = 0;
  };
  struct Input {
    std::string name;
    image::PointRule rule;
    Terminal at;
    bool switched = false;  ///< follows an axis
    bool looped = false;    ///< follows an output: a loop or an indexer
    bool held = false;      ///< looped, and played by somebody
  };
  struct Output {
    std::string name;
    image::PointRule rule;
    Terminal at;
  };
  /// Contacts of a node, line by line a channel.
  struct NodeWires {
    MockGpio* contacts;
    SimulatedDrive* drive;
    SimulatedIoModule* module;
    SimulatedBoard* board = nullptr;
    std::vector<int> channels{};
  };
  struct Turret {
    Indexer indexer;
    std::size_t motor;                ///< of outputs_
    std::vector<std::size_t> inputs;  ///< of inputs_
    int shown = -2;                   ///< position that the inputs show
  };
  struct Wire {
    std::size_t output, input;  ///< of outputs_ and inputs_
    WorldLoop loop;
    std::optional<bool> level = {};  ///< of the output, since `since`
    image::Nanoseconds since = 0;
  };
  struct Request {
    std::size_t input;
    Play play;
  };
  MockGpio& add_contacts_of_chip(std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs, int source);
  void add_unit(const WorldUnit& unit, ModbusStation& station);
  void carry_contacts(const NodeWires& wires);
  void carry(Wire& wire, image::Nanoseconds t);
  void turn(Turret& turret, image::Nanoseconds t);
  void apply_requests();
  void play_looped(std::size_t input, const Play& play);
  static void set_level(const Terminal& at, bool level);
  static void set_raw(const Terminal& at, double raw);
  static bool level(const Terminal& at);
  static bool set(const Input& input, bool on);
  static bool is_on(const Output& output);

  std::vector<Bus> buses_;
  std::map<std::string, std::unique_ptr<SimulatedDrive>, std::less<>> drives_;
  std::map<std::string, std::unique_ptr<SimulatedIoModule>, std::less<>> modules_;
  std::map<std::string, std::unique_ptr<SimulatedEncoder>, std::less<>> encoders_;
  std::vector<Axis> axes_;
  std::vector<std::unique_ptr<MockGpio>> gpios_;
  std::vector<NodeWires> node_wires_;
  std::map<std::string, std::unique_ptr<SimulatedBoard>, std::less<>> boards_;  ///< by station
  std::vector<std::unique_ptr<MockModbusLine>> lines_;
  std::map<std::string, MockGpio*, std::less<>> chips_;          ///< by station
  std::map<std::string, ModbusStation*, std::less<>> units_;     ///< by station
  std::map<std::string, MockModbusLine*, std::less<>> line_of_;  ///< by station
  std::map<std::string, std::unique_ptr<MockPendant>, std::less<>> pendants_;
  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
  std::vector<Turret> turrets_;
  std::vector<Wire> wires_;
  std::vector<std::string> operator_points_;
  std::mutex requests_lock_;
  std::vector<Request> requests_;
  std::atomic<bool> requested_{false};
};

}  // namespace servogate::mock
