// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_motion.hpp"
#include "machine/keys/sections.hpp"

namespace servogate::machine {

namespace {

/// One axis under check, with the words its findings need.
class AxisCheck {
 public:
  AxisCheck(const MachineConfig& machine, std::size_t index, Reading& reading)
      : machine_(machine),
        index_(index),
        a_(machine.axes[index]),
        path_("axis." + std::to_string(index) + "."),
        reading_(reading) {}

  void all() {
    auxiliary();
    travel();
    homing();
    speeds();
    limits();
    brake();
    pitch();
    rest();
  }

 private:
  Where at(std::string_view key) const { return machine_.where(path_ + std::string(key)); }
  /// The key is there and was readable.
  bool has(std::string_view key) const {
    const std::string path = path_ + std::string(key);
    return machine_.places.contains(path) && !machine_.unread.contains(path);
  }
  bool unread(std::string_view key) const { return machine_.unread.contains(path_ + std::string(key)); }
  bool has_travel() const { return has("travel_min") && has("travel_max"); }
  std::string length(double v) const { return text::number(v) + " " + text::unit_words(a_.unit()); }
  std::string speed(double v) const { return text::number(v) + " " + text::unit_words(a_.speed_unit()); }
  void error(std::string_view key, const text::Entry& entry, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), a_.letter);
    reading_.error(at(key), entry, std::move(arguments));
  }
  void warning(std::string_view key, const text::Entry& entry, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), a_.letter);
    reading_.warning(at(key), entry, std::move(arguments));
  }

  /// Programs count their axes from the first on; the places of the MC_ blocks lie above the usual packet.
  void auxiliary() {
    if (has("process") && a_.process > machine_.control.processes)
      error("process", finding::kNoSuchProcess,
            {std::to_string(a_.process), std::to_string(machine_.control.processes)});
    if (a_.auxiliary && has("process")) error("process", finding::kAuxiliaryProcess, {});
    if (!a_.auxiliary && a_.torque_max > 0.0) error("torque_max", finding::kTorqueAuxiliary, {});
    if (!a_.auxiliary) {
      for (std::size_t i = 0; i < index_; ++i)
        if (machine_.axes[i].auxiliary)
          return error("letter", finding::kAuxiliaryOrder, {machine_.axes[i].letter});
      return;
    }
    if (a_.diameter) error("diameter", finding::kAuxiliaryDiameter, {});
    const std::uint32_t needed = image::motion_base(static_cast<int>(index_)) + image::kMotionBlock;
    if (index_ < image::kMaxAxes && static_cast<std::uint32_t>(machine_.control.k_size) < needed)
      error("auxiliary", finding::kAuxiliaryPacket,
            {std::to_string(needed), std::to_string(machine_.control.k_size)});
    if (machine_.program_axes() == 0) error("auxiliary", finding::kAuxiliaryAlone, {});
  }

  void travel() {
    if (!has_travel()) return;
    if (!a_.endless() && a_.travel_min >= a_.travel_max)
      error("travel_max", finding::kTravelOrder, {length(a_.travel_min), length(a_.travel_max)});
    if (a_.diameter && a_.type == AxisType::rotary) error("diameter", finding::kDiameter, {});
    if (!(a_.lead > 0.0) || a_.counts_per_rev <= 0) return;
    constexpr double kExact = 9007199254740992.0;  // of a double
    const double turn = a_.type == AxisType::rotary ? 360.0 : 0.0;
    const double farthest = std::max({turn, std::abs(a_.travel_min), std::abs(a_.travel_max)});
    const double counts = farthest * a_.counts_per_unit();
    if (counts > kExact)
      error("counts_per_rev", finding::kTravelCounts,
            {length(farthest), text::number(counts, 0), text::number(kExact, 0)});
  }

  void inside(std::string_view key, double value) {
    if (!has_travel() || a_.endless() || a_.travel_min >= a_.travel_max) return;
    if (value < a_.travel_min || value > a_.travel_max)
      error(key, finding::kHomeOutside,
            {std::string(key), length(value), length(a_.travel_min), length(a_.travel_max)});
  }

  void homing() {
    const HomingConfig& h = a_.home;
    const std::string method(choices_of<HomingMethod>()[static_cast<std::size_t>(h.method)]);
    if (!has("home")) warning("letter", finding::kNoHoming, {});
    if (has("home")) inside("home.position", h.position);
    const bool moves = h.method != HomingMethod::none && h.method != HomingMethod::absolute;
    const bool by_drive = h.method == HomingMethod::drive;
    if (!by_drive && has("home.drive_method"))
      error("home.drive_method", finding::kHomeDriveOnly, {"home.drive_method"});
    if (!by_drive && has("home.acceleration"))
      error("home.acceleration", finding::kHomeDriveOnly, {"home.acceleration"});
    if (!moves) return;
    if (h.final_move) inside("home.final_position", h.final_position);
    if (by_drive && h.drive_method == 0 && !unread("home.drive_method"))
      error("home", finding::kHomeMethodMissing, {});
    const bool here = by_drive && (h.drive_method == 35 || h.drive_method == 37);
    if (here) return;
    const bool by_switch = h.method != HomingMethod::index && !by_drive;
    if (by_switch && h.switch_point.empty() && !unread("home.switch"))
      error("home", finding::kHomeSwitchMissing, {method});
    if ((by_switch || by_drive) && h.fast <= 0.0 && !unread("home.fast"))
      error("home", finding::kHomeSpeedMissing, {method, "fast"});
    if (h.slow <= 0.0 && !unread("home.slow")) error("home", finding::kHomeSpeedMissing, {method, "slow"});
    if ((by_switch || by_drive) && h.fast > 0.0 && h.slow > h.fast)
      error("home.slow", finding::kHomeSpeedOrder, {speed(h.slow), speed(h.fast)});
    if (by_switch) home_switch_of_another();
  }
  /// A switch of two axes does not tell which of them is on it.
  void home_switch_of_another() {
    const HomingConfig& h = a_.home;
    if (h.switch_point.empty()) return;
    for (std::size_t i = 0; i < index_; ++i) {
      const AxisConfig& other = machine_.axes[i];
      if (other.home.switch_point != h.switch_point) continue;
      if (other.home.order == h.order)
        error("home.switch", finding::kHomeSwitchAtOnce,
              {other.letter, h.switch_point, std::to_string(h.order)});
      else
        warning("home.switch", finding::kHomeSwitchShared, {other.letter, h.switch_point});
    }
  }

  void not_above(std::string_view key, double value) {
    if (a_.max_velocity > 0.0 && value > a_.max_velocity)
      error(key, finding::kSpeedAboveLimit, {std::string(key), speed(value), speed(a_.max_velocity)});
  }
  void speeds() {
    not_above("jog_velocity", a_.jog_velocity);
    not_above("jog_velocity_not_homed", a_.jog_velocity_not_homed);
    not_above("home.fast", a_.home.fast);
    not_above("home.slow", a_.home.slow);
  }

  void limits() {
    if (!has_travel()) return;
    if (a_.endless()) {
      if (!a_.limit_plus.empty()) error("limit_plus", finding::kEndlessHoming, {});
      if (!a_.limit_minus.empty()) error("limit_minus", finding::kEndlessHoming, {});
      return;
    }
    if (a_.limit_plus.empty()) warning("letter", finding::kNoLimitSwitch, {"limit_plus"});
    if (a_.limit_minus.empty()) warning("letter", finding::kNoLimitSwitch, {"limit_minus"});
    same("limit_plus", a_.limit_plus, "limit_minus", a_.limit_minus);
    same("home.switch", a_.home.switch_point, "limit_plus", a_.limit_plus);
    same("home.switch", a_.home.switch_point, "limit_minus", a_.limit_minus);
    if (a_.hard_limit_plus < a_.travel_max)
      error("hard_limit_plus", finding::kLimitInside,
            {"hard_limit_plus", length(a_.hard_limit_plus), length(a_.travel_min), length(a_.travel_max)});
    if (a_.hard_limit_minus > a_.travel_min)
      error("hard_limit_minus", finding::kLimitInside,
            {"hard_limit_minus", length(a_.hard_limit_minus), length(a_.travel_min), length(a_.travel_max)});
    over_modbus("limit_plus", a_.limit_plus);
    over_modbus("limit_minus", a_.limit_minus);
    switch_of_another("limit_plus", a_.limit_plus);
    switch_of_another("limit_minus", a_.limit_minus);
  }
  /// Limit switches of several axes may be one chain: it stops all of them. As a home switch it would be
  /// found by one axis and stop the other.
  void switch_of_another(std::string_view key, const std::string& point) {
    if (point.empty()) return;
    for (std::size_t i = 0; i < machine_.axes.size(); ++i) {
      const AxisConfig& other = machine_.axes[i];
      if (i == index_) continue;
      if (other.home.switch_point == point)
        error(key, finding::kHomeIsLimit, {std::string(key), other.letter, point});
      for (const auto& [name, theirs] :
           {std::pair{"limit_plus", &other.limit_plus}, {"limit_minus", &other.limit_minus}})
        if (i < index_ && *theirs == point)
          warning(key, finding::kLimitShared, {std::string(key), other.letter, name, point});
    }
  }
  void same(std::string_view key, const std::string& one, std::string_view other_key,
            const std::string& other) {
    if (!one.empty() && one == other)
      error(key, finding::kSamePoint, {std::string(key), std::string(other_key), one});
  }
  void over_modbus(std::string_view key, const std::string& point) {
    int station = -1;
    if (machine_.point(point, &station) == nullptr) return;
    const StationConfig& s = machine_.stations[static_cast<std::size_t>(station)];
    if (s.kind == StationKind::modbus)
      warning(key, finding::kLimitModbus, {point, text::number(a_.max_velocity * s.period, 3)});
  }

  void brake() {
    const BrakeConfig& b = a_.brake;
    if (a_.vertical && !b.present()) error("vertical", finding::kVerticalBrake, {});
    if (!b.present()) return;
    if (!b.point.empty() && b.drive_output) error("brake.drive_output", finding::kBrakeTwo, {});
    const double cycle_s = static_cast<double>(machine_.cycle_ns()) * 1e-9;
    if (a_.vertical && b.engage_delay < cycle_s)
      error("brake.engage_delay", finding::kBrakeDelay,
            {text::number(b.engage_delay * 1e3), text::number(cycle_s * 1e3)});
    int station = -1;
    if (machine_.point(b.point, &station) == nullptr) return;
    const StationConfig& s = machine_.stations[static_cast<std::size_t>(station)];
    const PointConfig& p = *machine_.point(b.point);
    const double closed = p.inverted ? 1.0 : 0.0;
    if ((s.kind == StationKind::modbus || s.kind == StationKind::canopen) && (p.hold || p.loss != closed))
      error("brake.point", finding::kBrakeLoss, {b.point, text::number(closed)});
    if (s.kind == StationKind::modbus)
      warning("brake.point", finding::kBrakeModbus, {b.point, text::number(s.period * 1000.0)});
  }

  void pitch() {
    const auto& t = a_.pitch_table;
    for (std::size_t i = 1; i < t.size(); ++i) {
      const std::string key = "pitch_table." + std::to_string(i);
      const double step = t[i][0] - t[i - 1][0], rise = std::abs(t[i][1] - t[i - 1][1]);
      if (step <= 0.0)
        error(key, finding::kPitchOrder, {length(t[i][0]), length(t[i - 1][0])});
      else if (rise > 0.02 * step)
        error(key, finding::kPitchSteep, {length(rise), length(step)});
    }
  }

  void rest() {
    if (a_.following_error_warn > 0.0 && a_.following_error_stop > 0.0 &&
        a_.following_error_warn >= a_.following_error_stop)
      error("following_error_warn", finding::kWarnAboveStop,
            {length(a_.following_error_warn), length(a_.following_error_stop)});
    const double travel = a_.endless() ? 360.0 : a_.travel_max - a_.travel_min;
    if (has_travel() && travel > 0.0 && a_.following_error_stop > travel)
      error("following_error_stop", finding::kFollowingBeyondTravel,
            {length(a_.following_error_stop), length(travel)});
    if (a_.following_error_stop > 0.0 && a_.in_position_window > a_.following_error_stop)
      error("in_position_window", finding::kWindowBeyondFollowing,
            {length(a_.in_position_window), length(a_.following_error_stop)});
    if (a_.in_position_window_coarse > 0.0) {
      if (a_.in_position_window_coarse < a_.in_position_window)
        error("in_position_window_coarse", finding::kCoarseBelowFine,
              {length(a_.in_position_window_coarse), length(a_.in_position_window)});
      else if (a_.following_error_stop > 0.0 && a_.in_position_window_coarse > a_.following_error_stop)
        error("in_position_window_coarse", finding::kCoarseBeyondFollowing,
              {length(a_.in_position_window_coarse), length(a_.following_error_stop)});
    }
    if (a_.lead > 0.0 && a_.counts_per_rev > 0 && a_.in_position_window * a_.counts_per_unit() < 1.0)
      error("in_position_window", finding::kWindowBelowCount,
            {text::number(a_.in_position_window, 9) + " " + text::unit_words(a_.unit()),
             text::number(1.0 / a_.counts_per_unit(), 9) + " " + text::unit_words(a_.unit())});
  }

  const MachineConfig& machine_;
  const std::size_t index_;
  const AxisConfig& a_;
  std::string path_;
  Reading& reading_;
};

/// The outputs of an inverter, and what a spindle without feedback has not.
void check_inverter(const MachineConfig& machine, const SpindleConfig& s, const std::string& path,
                    const std::string& number, Reading& reading) {
  const bool analog = !s.speed_output.empty();
  for (const char* key : {".cw_output", ".ccw_output"})
    if (!analog && machine.places.contains(path + key))
      reading.error(machine.where(path + key), finding::kSpindleRelay, {number, key + 1});
  if (!analog) return;
  for (const char* key : {".counts_per_rev", ".direction", ".at_speed_window", ".at_speed_timeout",
                          ".orient_angle", ".orient_speed", ".gear"})
    if (machine.places.contains(path + key))
      reading.error(machine.where(path + key), finding::kSpindleNoFeedback, {number, key + 1});
  if (s.cw_output.empty() && !s.ccw_output.empty())
    reading.error(machine.where(path + ".ccw_output"), finding::kSpindleOnlyCcw, {number});
  // As on the wire: off, or the register of standstill.
  const auto rests = [](const PointConfig& p) {
    return p.is_analog() ? std::round((0.0 - p.shift) / p.scale) : p.inverted ? 1.0 : 0.0;
  };
  for (const auto& [key, name] :
       {std::pair(".speed_output", s.speed_output), std::pair(".cw_output", s.cw_output),
        std::pair(".ccw_output", s.ccw_output)})
    if (const PointConfig* p = machine.point(name);
        p != nullptr && !p->is_input() && p->scale != 0.0 && (p->hold || p->loss != rests(*p)))
      reading.error(machine.where(path + key), finding::kSpindleLoss,
                    {number, name, text::number(rests(*p))});
  const PointConfig* speed = machine.point(s.speed_output);
  if (speed == nullptr || !speed->is_analog() || speed->scale == 0.0) return;
  const double rest = std::round((0.0 - speed->shift) / speed->scale);
  const double most = s.largest_motor_rpm();  // behind gears the output has the speed of the motor
  const double full = std::round((most - speed->shift) / speed->scale);
  int station = -1;
  machine.point(s.speed_output, &station);
  // A channel of CiA 401 or of a board has a sign.
  const StationKind kind = machine.stations[static_cast<std::size_t>(station)].kind;
  const bool is_signed = kind == StationKind::canopen || kind == StationKind::board;
  const double low = is_signed ? -32768.0 : 0.0, high = is_signed ? 32767.0 : 65535.0;
  if (std::min(rest, full) < low || std::max(rest, full) > high)
    reading.error(machine.where(path + ".speed_output"), finding::kSpindleScale,
                  {number, s.speed_output, text::number(rest), text::number(full),
                   text::both(text::number(low) + " to " + text::number(high),
                              text::number(low) + " ... " + text::number(high))});
  if (speed->place.format == image::Format::in && most > 32767.0)
    reading.error(machine.where(path + ".max_speed"), finding::kSpindleWord,
                  {number, text::number(most), to_string(speed->place)});
}

}  // namespace

void check_axes(const MachineConfig& machine, Reading& reading) {
  if (machine.axes.empty() && machine.places.contains("axis") && !machine.unread.contains("axis"))
    reading.error(machine.where("axis"), finding::kNoAxes, {});
  if (machine.axes.size() > static_cast<std::size_t>(image::kMaxAxes))
    reading.error(machine.where("axis." + std::to_string(image::kMaxAxes)), finding::kTooMany,
                  {std::to_string(machine.axes.size()), text::both("axes", "Осей слишком много"),
                   std::to_string(image::kMaxAxes)});
  for (std::size_t i = 0; i < machine.axes.size(); ++i) AxisCheck(machine, i, reading).all();
}

void check_spindles(const MachineConfig& machine, Reading& reading) {
  if (machine.spindles.size() > static_cast<std::size_t>(image::kMaxSpindles))
    reading.error(machine.where("spindle." + std::to_string(image::kMaxSpindles)), finding::kTooMany,
                  {std::to_string(machine.spindles.size()), text::both("spindles", "Шпинделей слишком много"),
                   std::to_string(image::kMaxSpindles)});
  for (std::size_t i = 0; i < machine.spindles.size(); ++i) {
    const SpindleConfig& s = machine.spindles[i];
    const std::string path = "spindle." + std::to_string(i), number = std::to_string(i + 1);
    if (s.process > machine.control.processes)
      reading.error(machine.where(path + ".process"), finding::kNoSuchProcess,
                    {text::both("spindle " + number, "шпиндель " + number), std::to_string(s.process),
                     std::to_string(machine.control.processes)});
    if (int{s.drive.empty()} + int{s.speed_output.empty()} + int{s.inverter.empty()} != 2)
      reading.error(machine.where(path), finding::kSpindleSource, {number});
    if (s.max_speed > 0.0 && s.min_speed >= s.max_speed)
      reading.error(machine.where(path + ".min_speed"), finding::kSpindleSpeeds,
                    {number, text::number(s.min_speed) + " " + text::unit_words("rpm"),
                     text::number(s.max_speed) + " " + text::unit_words("rpm")});
    check_inverter(machine, s, path, number, reading);
  }
}

}  // namespace servogate::machine
