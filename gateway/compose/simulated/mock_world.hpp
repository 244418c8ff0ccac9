// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/mock/can/can_segment.hpp"
#include "drivers/mock/drive/simulated_drive.hpp"
#include "drivers/mock/gpio/mock_gpio.hpp"
#include "drivers/mock/indexer/indexer.hpp"
#include "drivers/mock/io/simulated_encoder.hpp"
#include "drivers/mock/io/simulated_io_module.hpp"
#include "drivers/mock/modbus/modbus_line.hpp"
#include "gateway/compose/setup/modbus_setup.hpp"
#include "gateway/machine/load.hpp"

namespace servogate::gateway {

/// Everything simulated that a machine file asks for: CAN segments with their drives, Modbus stations, GPIO
/// chips whose switches follow the simulated axes, wires from outputs to inputs, turrets. Time passes in
/// advance_to() only.
class MockWorld {
 public:
  explicit MockWorld(const machine::LoadResult& loaded);
  ~MockWorld();

  /// Brings everything to time t, buses first. Not called by the cycle but before it.
  void advance_to(image::Nanoseconds t);

  /// The control's endpoint on the mock bus with this index in the machine file; nullptr: that bus is no
  /// mock.
  image::CanBus* bus(std::size_t index);
  /// The simulated wire of a bus, nullptr: it is no mock. Endpoint 0 is the control, the nodes follow in the
  /// order of the machine file.
  mock::CanSegment* wire(std::size_t index) noexcept { return segments_[index].get(); }
  /// I/O devices for the cycle, in the order of the machine file.
  const std::vector<image::CycleDevice*>& io() const noexcept { return io_; }
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
  /// The operator of `run`: closes what the machine file names (the emergency-stop chain).
  void close_operator_points();

  mock::CanSegment* segment(std::size_t index) { return segments_[index].get(); }
  /// Drive of a node "bus.node"; nullptr: it is not simulated.
  mock::SimulatedDrive* drive(std::string_view reference);
  /// I/O module of a node "bus.node"; nullptr: it is not simulated.
  mock::SimulatedIoModule* module(std::string_view reference);
  /// Encoder of a node, the same.
  mock::SimulatedEncoder* encoder(std::string_view reference);
  /// Modbus station of that name, the same.
  mock::ModbusStation* modbus(std::string_view station);
  /// GPIO chip of the station of that name, the same.
  mock::MockGpio* chip(std::string_view station);
  /// The contact behind a digital input.
  struct Line {
    mock::MockGpio* chip = nullptr;  ///< nullptr: the point has none
    std::size_t number = 0;
    bool inverted = false;
  };
  Line line(std::string_view point);
  /// True position of a simulated axis, machine coordinates. An axis whose drive lives in another process is
  /// where its drive says, counted from where [[simulation.drive]] lets it stand at power-on.
  double axis_position(int axis) const;
  /// What drives in other processes report; between two cycles. real-time safe.
  void note_feedback(const image::ProcessImage& image) noexcept;

 private:
  struct Drive {
    std::string reference;
    std::unique_ptr<mock::SimulatedDrive> device;
  };
  struct Module {
    std::string reference;
    std::unique_ptr<mock::SimulatedIoModule> device;
  };
  struct Encoder {
    std::string reference;
    std::unique_ptr<mock::SimulatedEncoder> device;
  };
  struct Input {
    std::string name;
    std::size_t device;
    std::size_t number;
    bool gpio;
    bool inverted;
    bool analog = false;
    bool switched = false;  ///< follows an axis
    double scale = 1.0, shift = 0.0;
    mock::SimulatedIoModule* module = nullptr;  ///< analog: its channel `number` instead
    mock::SimulatedEncoder* encoder = nullptr;  ///< analog: its position instead
    bool looped = false;                        ///< follows an output: a loop or an indexer
    bool held = false;                          ///< looped, and played by somebody
    std::size_t unit = 0;                       ///< of a Modbus line
  };
  struct Output {
    std::string name;
    std::size_t device;
    std::size_t number;
    bool gpio;
    bool inverted;
    const mock::SimulatedDrive* drive = nullptr;      ///< its output `number` instead
    const mock::SimulatedIoModule* module = nullptr;  ///< the same
    std::size_t unit = 0;                             ///< of a Modbus line
  };
  /// What is wired to the inputs of a simulated drive or I/O module: contacts of gpios_[wires], line by line
  /// a bit of 60FDh or a terminal.
  struct NodeWires {
    std::size_t wires;
    mock::SimulatedDrive* drive;
    mock::SimulatedIoModule* module;
    std::vector<int> bits;
  };
  struct Turret {
    mock::Indexer indexer;
    std::size_t motor;                ///< of outputs_
    std::vector<std::size_t> inputs;  ///< of inputs_
    int shown = -2;                   ///< position that the inputs show
  };
  /// A wire from an output to an input, but for those inside a Modbus station.
  struct Wire {
    std::size_t output, input;  ///< of outputs_ and inputs_
    bool inverted;
    image::Nanoseconds delay_ns;
    std::optional<bool> level = {};  ///< of the output, since `since`
    image::Nanoseconds since = 0;
  };
  struct Wish {
    std::size_t input;
    Play play;
  };
  void play_looped(std::size_t input, const Play& play);
  void add_drives(const machine::LoadResult& loaded);
  void add_node(const machine::LoadResult& loaded, const machine::BusConfig& bus,
                const machine::NodeConfig& node);
  void add_gpio(const machine::LoadResult& loaded, const machine::StationConfig& station, int source);
  void add_node_wires(const machine::LoadResult& loaded, const machine::StationConfig& station);
  void add_analog(const machine::MachineConfig& machine, const machine::StationConfig& station,
                  const machine::PointConfig& point);
  mock::GpioInput contact(const machine::MachineConfig& machine, const machine::PointConfig& point);
  void carry_wires(const NodeWires& wires);
  void play_raw(const Input& input, double raw);
  void add_line(const machine::LoadResult& loaded, const machine::LineConfig& line);
  mock::StationSettings add_unit(const machine::MachineConfig& machine, const LineStation& unit,
                                 std::size_t number);
  void add_turrets(const machine::MachineConfig& machine);
  void add_wires(const machine::MachineConfig& machine);
  void carry(Wire& wire, image::Nanoseconds t);
  void apply_wishes();
  void turn(Turret& turret, image::Nanoseconds t);
  bool drive_input(const Input& input, bool on);
  bool motor_on(const Output& output) const;

  std::vector<std::unique_ptr<mock::CanSegment>> segments_;
  std::vector<image::CanBus*> endpoints_;
  std::vector<Drive> drives_;
  std::vector<Module> modules_;
  std::vector<Encoder> encoders_;
  struct AxisDrive {
    const mock::SimulatedDrive* drive = nullptr;  ///< nullptr: in another process
    double units_per_revolution = 0.0;
    double counts_per_revolution = 1.0;
    double start = 0.0;
    std::int64_t reported_counts = 0;
  };
  std::vector<AxisDrive> axes_;
  std::vector<std::unique_ptr<mock::MockGpio>> gpios_;
  std::vector<NodeWires> node_wires_;
  std::vector<std::unique_ptr<mock::MockModbusLine>> lines_;
  std::map<std::string, mock::MockGpio*, std::less<>> chips_;       ///< by station
  std::map<std::string, mock::ModbusStation*, std::less<>> units_;  ///< by station
  std::vector<image::CycleDevice*> io_;
  std::vector<Input> inputs_;
  std::vector<Output> outputs_;
  std::vector<Turret> turrets_;
  std::vector<Wire> wires_;
  std::vector<std::string> operator_points_;
  std::mutex wishes_lock_;
  std::vector<Wish> wishes_;
  std::atomic<bool> wished_{false};
};

}  // namespace servogate::gateway
