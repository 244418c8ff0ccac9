// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/drive/measurement/bench_drive.hpp"

namespace servogate::bench {

/// Inside of which every run stays, at the motor shaft.
struct Envelope {
  double travel_min_rad = 0.0, travel_max_rad = 0.0;  ///< from where the drive stands at the start
  double speed_rad_s = 0.0;
  double torque_nm = 0.0;
  double time_s = 0.0;         ///< with torque
  double following_rad = 0.0;  ///< of the position loop
  /// How hard the drive's quick stop brakes: the travel is kept behind it. 0: unknown, then the travel is
  /// where the stop begins.
  double quick_stop_rad_s2 = 0.0;
};

/// What motor and load surely have at the least, so that a torque can be looked at before it acts: less of
/// either would go further.
struct LeastLoad {
  double inertia_kg_m2 = 0.0;  ///< above 0
  double friction_nm = 0.0;    ///< dry friction, both at rest and in motion
};

/// Why a run ended before its end.
enum class Trip : std::uint8_t {
  none,
  travel,
  speed,
  torque,
  time,
  following,
  fault,        ///< the drive reports a fault
  offline,      ///< its process data do not come
  not_enabled,  ///< it did not reach Operation enabled, or left it
  ended,        ///< the operator ended it
  gone,         ///< the bus is gone
};

/// One cycle as it is kept.
struct Sample {
  double time_s = 0.0;
  Loop loop = Loop::velocity;
  double set_point = 0.0;
  double position_rad = 0.0, torque_nm = 0.0;
  std::uint16_t statusword = 0;
  std::uint16_t stage = 0;  ///< index in Guard::stages()
};

/// The only way from a run to its drive. After a trip every step is refused; release() or the destructor
/// stops the drive by its quick stop and takes its torque.
class Guard {
 public:
  Guard(BenchDrive& drive, const Envelope& envelope);
  ~Guard();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  /// Whether every set-point stays in the envelope, and the travel behind a quick stop in each cycle;
  /// positions from where the drive stood at the start, speeds as if they were followed at once. What does
  /// not is in trip(), and the guard refuses all steps. Of torques only their size is looked at:
  /// accepts_torque().
  bool accepts(Loop loop, std::span<const double> set_points);
  /// The same of torques, by the motion that they would give the least load.
  bool accepts_torque(std::span<const double> set_points, const LeastLoad& load);
  /// A run that needs so much of the envelope, before it begins.
  bool accepts_travel(double from_rad, double to_rad);

  /// Power, at rest where it stands; a few seconds at most.
  bool enable(Loop loop);
  /// One cycle with this set-point. False: the run is over.
  bool step(Loop loop, double set_point);
  /// One cycle of a motion to `target_rad` that the drive forms by itself (profile position).
  bool lead_to(double target_rad);
  /// Changes the speed evenly, then holds it for `hold_s`.
  bool run_at(double speed_rad_s, double acceleration_rad_s2, double hold_s);
  /// Computes what may take its time, on a thread of usual priority, while the drive stands in its velocity
  /// loop or, without power, is kept on the bus. `work` does not touch the guard. False: the run is over.
  bool meanwhile(const std::function<void()>& work);
  /// Stops it and takes the torque. True: the drive has shown that it has none.
  bool release();

  double period_s() const noexcept { return period_; }
  const Envelope& envelope() const noexcept { return envelope_; }
  const DriveAnswer& answer() const noexcept { return answer_; }
  /// Of the last two answers.
  double speed_rad_s() const noexcept { return speed_; }
  Trip trip() const noexcept { return trip_; }
  double trip_value() const noexcept { return trip_value_; }
  double trip_limit() const noexcept { return trip_limit_; }

  /// What follows belongs to this stage, for the record and for who watches.
  void stage(std::string name);
  const std::vector<std::string>& stages() const noexcept { return stages_; }
  const std::vector<Sample>& samples() const noexcept { return samples_; }
  /// Called every `watch_s` of the drive's time, and at every stage.
  std::function<void(const Guard&)> watch;
  double watch_s = 1.0;

 private:
  bool ready();
  bool exchange(const DriveAsk& ask);
  bool fail(Trip trip, double value = 0.0, double limit = 0.0);
  bool look_at_answer();
  bool look_at_following(Loop loop, double set_point);
  bool look_at_set_point(Loop loop, double set_point);
  bool look_at_travel(double position_rad, double speed_rad_s);
  double even_speed() const;
  double rest() const;

  BenchDrive& drive_;
  Envelope envelope_;
  double period_;
  DriveAnswer answer_;
  Loop last_loop_ = Loop::velocity;
  /// The last answers, as a ring: time and position.
  struct Place {
    double time_s = 0.0, position_rad = 0.0;
  };
  std::array<Place, 64> places_{};
  std::size_t place_count_ = 0;
  double speed_ = 0.0, mean_torque_ = 0.0, last_speed_asked_ = 0.0, last_position_asked_ = 0.0;
  double time_ = 0.0, powered_s_ = 0.0;
  bool known_ = false, powered_ = false, released_ = true;
  int offline_cycles_ = 0, cycles_since_online_ = 0;
  Trip trip_ = Trip::none;
  double trip_value_ = 0.0, trip_limit_ = 0.0;
  std::vector<std::string> stages_;
  std::vector<Sample> samples_;
};

}  // namespace servogate::bench
