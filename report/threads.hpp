// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"

namespace servogate::report {

/// One block of a thread, or one tap, behind its lead-in, as encoders saw it: which lead was cut, and how far
/// the path was off the spindle's measured angle. mm, revolutions, seconds.
struct ThreadPass {
  /// Of a profile; equal parts of the pass in time.
  static constexpr std::size_t kParts = 32;
  struct Part {
    float least = 0.0f, greatest = 0.0f;  ///< mm
  };
  int process = 0;  ///< from 0
  int spindle = 0;  ///< of the machine, from 0
  std::uint32_t run = 0;
  std::int32_t line = 0, file = 0;  ///< image::ProcessStatus
  std::string file_name;            ///< empty: the main program; filled by who makes the report
  double begin_s = 0.0, duration_s = 0.0;
  double revolutions = 0.0;                         ///< that the spindle turned, both ways of a tap together
  double speed_min_rpm = 0.0, speed_max_rpm = 0.0;  ///< magnitudes, measured
  int axis = -1;                                    ///< that moves furthest in a revolution; -1: none moved
  std::string letter;                               ///< of it; filled by who makes the report
  /// Of that axis: mm in a revolution, from its measured positions over the measured angles by least squares;
  /// the mean one where the lead varies.
  double lead = 0.0;
  double off_mean = 0.0, off_least = 0.0, off_greatest = 0.0;  ///< image::ProcessStatus::off_spindle_mm
  std::vector<Part> profile;                                   ///< the same over the pass
};

/// Finds the threads and taps of a run in the image of each cycle. Memory is bounded and taken when it is
/// made: the first kMost passes are kept.
class ThreadLog {
 public:
  static constexpr std::size_t kMost = 500;

  /// `spindles`: by process the spindle whose angle its threads follow, -1: none.
  ThreadLog(int axes, const std::vector<int>& spindles);
  /// Takes the image as it stands at the end of a cycle. real-time safe.
  void add(const image::ProcessImage& image) noexcept;
  /// Those that have ended and the one under way; without those in which the spindle turned less than a tenth
  /// of a revolution. Not real-time safe.
  std::vector<ThreadPass> passes() const;

 private:
  /// What is summed up of a pass. Angles in revolutions and places from those of its first cycle on.
  struct Record {
    int process = 0;
    std::uint32_t run = 0;
    std::int32_t line = 0, file = 0;
    double begin_s = 0.0;
    std::int64_t cycles = 0;
    double angle = 0.0;  ///< of the newest cycle
    double turned = 0.0;
    double speed_min = 0.0, speed_max = 0.0;
    double angles = 0.0, squares = 0.0;  ///< sums
    std::array<double, image::kMaxAxes> origin{}, places{}, products{};
    double off_sum = 0.0, off_least = 0.0, off_greatest = 0.0;
    std::array<ThreadPass::Part, ThreadPass::kParts> parts{};
    std::int64_t per_part = 1;  ///< cycles
  };
  struct Process {
    int spindle = -1;
    int record = -1;  ///< the pass under way; -1: none
    double angle_deg = 0.0;
  };

  void begin(int process, const image::ProcessImage& image) noexcept;
  void go_on(Process& process, const image::ProcessImage& image) noexcept;
  static void add_part(Record& record, float off) noexcept;
  ThreadPass pass(const Record& record) const;

  int axes_;
  double period_s_ = 0.0;
  std::vector<Process> processes_;
  std::vector<Record> records_;  ///< kMost of them where a process has a spindle
  std::size_t count_ = 0;
};

}  // namespace servogate::report
