// SPDX-License-Identifier: Apache-2.0
// Boards, and axes whose amplifier is on a channel of one.
#include <algorithm>
#include <cmath>

#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_board.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

class BoardAxis {
 public:
  BoardAxis(const MachineConfig& machine, std::size_t index, Reading& reading)
      : m_(machine),
        index_(index),
        a_(machine.axes[index]),
        b_(a_.board),
        path_("axis." + std::to_string(index) + "."),
        output_(choices_of<BoardOutput>()[static_cast<std::size_t>(b_.output)]),
        reading_(reading) {}

  void all() {
    if (b_.present() == !a_.drive.empty() && !unread("drive") && !unread("board.station"))
      return error(b_.present() ? "board" : "letter", finding::kAxisSource, {});
    if (!b_.present()) return;
    station();
    not_here();
    b_.output == BoardOutput::step ? steps() : speed();
  }

 private:
  Where at(const std::string& key) const { return m_.where(path_ + key); }
  bool has(const std::string& key) const { return m_.places.contains(path_ + key) && !unread(key); }
  bool unread(const std::string& key) const { return m_.unread.contains(path_ + key); }
  void error(const std::string& key, const text::Entry& entry, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), a_.letter);
    reading_.error(at(key), entry, std::move(arguments));
  }
  std::string fastest() const {
    return text::number(a_.max_velocity) + " " + text::unit_words(a_.speed_unit());
  }

  void station() {
    const bool there = std::any_of(m_.stations.begin(), m_.stations.end(), [&](const StationConfig& s) {
      return s.name == b_.station && s.kind == StationKind::board;
    });
    if (!there) return error("board.station", finding::kNoBoard, {b_.station});
    for (std::size_t i = 0; i < index_; ++i)
      if (m_.axes[i].board.station == b_.station && m_.axes[i].board.channel == b_.channel)
        return error("board.channel", finding::kChannelTwice,
                     {std::to_string(b_.channel), b_.station, m_.axes[i].letter});
  }

  void not_here() {
    if (a_.home.method == HomingMethod::drive)
      error("home.method", finding::kNotOnBoard, {"method = \"drive\""});
    if (a_.home.method == HomingMethod::absolute)
      error("home.method", finding::kNotOnBoard, {"method = \"absolute\""});
    if (a_.brake.drive_output) error("brake.drive_output", finding::kNotOnBoard, {"drive_output"});
    if (a_.torque_max > 0.0) error("torque_max", finding::kNotOnBoard, {"torque_max"});
    const bool index =
        a_.home.method == HomingMethod::index || a_.home.method == HomingMethod::switch_and_index;
    if (index && b_.feedback == BoardFeedback::steps)
      error("home.method", finding::kBoardNeeds, {output_, "feedback = \"encoder\""});
  }

  void foreign(const char* key, const char* of) {
    if (has(std::string("board.") + key)) error(std::string("board.") + key, finding::kBoardKey, {key, of});
  }

  void steps() {
    for (const char* key : {"full_speed", "position_gain", "offset"}) foreign(key, "analog, pwm");
    const bool by_steps = b_.feedback == BoardFeedback::steps;
    if (by_steps) reading_.warning(at("board"), finding::kOpenLoop, {a_.letter});
    if (by_steps && b_.steps_per_rev > 0 && b_.steps_per_rev != a_.counts_per_rev)
      return error("board.steps_per_rev", finding::kStepsCounts,
                   {std::to_string(b_.steps_per_rev), std::to_string(a_.counts_per_rev)});
    if (!by_steps && b_.steps_per_rev <= 0 && !unread("board.steps_per_rev"))
      return error("board", finding::kBoardNeeds, {output_, "steps_per_rev"});
    if (!(a_.lead > 0.0) || !(b_.step_time > 0.0)) return;
    const double a_turn = static_cast<double>(by_steps ? a_.counts_per_rev : b_.steps_per_rev);
    const double rate = a_.motor_rpm(a_.max_velocity) / 60.0 * a_turn, most = 0.5 / b_.step_time;
    if (rate > most)
      error("max_velocity", finding::kStepRate,
            {fastest(), text::number(rate, 0), text::number(b_.step_time * 1e6), text::number(most, 0)});
  }

  void speed() {
    for (const char* key : {"steps_per_rev", "step_time"}) foreign(key, "step");
    if (b_.feedback == BoardFeedback::steps) return error("board.feedback", finding::kStepsFeedback, {});
    if (!(b_.full_speed > 0.0) && !unread("board.full_speed"))
      return error("board", finding::kBoardNeeds, {output_, "full_speed"});
    if (!(b_.position_gain > 0.0) && !unread("board.position_gain"))
      return error("board", finding::kBoardNeeds, {output_, "position_gain"});
    // A loop of gain K over a dead time T oscillates from K T = pi/2 on; half of it has a margin of 45
    // degrees.
    const double most = 1.0 / (3.0 * m_.control.cycle_time);
    if (b_.position_gain > most)
      error("board.position_gain", finding::kGainTooHigh,
            {text::number(b_.position_gain), text::number(most, 1)});
    if (!(a_.lead > 0.0)) return;
    const double rpm = a_.motor_rpm(a_.max_velocity);
    if (rpm >= b_.full_speed)
      error("max_velocity", finding::kFullSpeed,
            {fastest(), text::number(rpm, 1), text::number(b_.full_speed)});
  }

  const MachineConfig& m_;
  const std::size_t index_;
  const AxisConfig& a_;
  const BoardChannelConfig& b_;
  const std::string path_;
  const std::string output_;
  Reading& reading_;
};

}  // namespace

void check_boards(const MachineConfig& machine, Reading& reading) {
  constexpr int kFewest = 3;  // cycles
  for (std::size_t s = 0; s < machine.stations.size(); ++s) {
    const StationConfig& station = machine.stations[s];
    const double shortest = kFewest * machine.control.cycle_time;
    if (station.kind == StationKind::board && station.watchdog < shortest)
      reading.error(machine.where("station." + std::to_string(s) + ".watchdog"), finding::kBoardWatchdog,
                    {station.name, text::number(station.watchdog * 1e3), text::number(shortest * 1e3)});
  }
  for (std::size_t i = 0; i < machine.axes.size(); ++i) BoardAxis(machine, i, reading).all();
}

}  // namespace servogate::machine
