// SPDX-License-Identifier: Apache-2.0
#include "report/threads.hpp"

#include <algorithm>
#include <cmath>

namespace servogate::report {

namespace {

constexpr double kLeastTurned = 0.1;  // revolutions

/// Revolutions from one measured angle to the next; at this speed more than half of one may lie between.
double revolutions_between(double from_deg, double to_deg, double expected) noexcept {
  const double part = (to_deg - from_deg) / 360.0;
  return part + std::round(expected - part);
}

}  // namespace

ThreadLog::ThreadLog(int axes, const std::vector<int>& spindles)
    : axes_(std::clamp(axes, 0, image::kMaxAxes)), processes_(spindles.size()) {
  for (std::size_t p = 0; p < spindles.size(); ++p) processes_[p].spindle = spindles[p];
  if (std::any_of(spindles.begin(), spindles.end(), [](int s) { return s >= 0; })) records_.resize(kMost);
}

void ThreadLog::add(const image::ProcessImage& image) noexcept {
  period_s_ = static_cast<double>(image.now.period_ns) * 1e-9;
  const int processes = std::min(static_cast<int>(processes_.size()), image.process_count);
  for (int p = 0; p < processes; ++p) {
    Process& process = processes_[static_cast<std::size_t>(p)];
    if (process.spindle < 0) continue;
    const image::ProcessStatus& status = image.processes[static_cast<std::size_t>(p)];
    if (!status.by_spindle) {
      process.record = -1;
      continue;
    }
    const Record* under_way =
        process.record < 0 ? nullptr : &records_[static_cast<std::size_t>(process.record)];
    if (under_way == nullptr || under_way->line != status.line || under_way->file != status.file ||
        under_way->run != status.run)
      begin(p, image);
    if (process.record >= 0) go_on(process, image);
  }
}

void ThreadLog::begin(int p, const image::ProcessImage& image) noexcept {
  Process& process = processes_[static_cast<std::size_t>(p)];
  process.record = -1;
  if (count_ >= records_.size()) return;
  const image::ProcessStatus& status = image.processes[static_cast<std::size_t>(p)];
  const image::SpindleImage& spindle = image.spindles[static_cast<std::size_t>(process.spindle)];
  process.record = static_cast<int>(count_);
  process.angle_deg = spindle.angle_deg;
  Record& r = records_[count_++];
  r.process = p;
  r.run = status.run;
  r.line = status.line;
  r.file = status.file;
  r.begin_s = static_cast<double>(image.now.t_ns) * 1e-9;
  r.speed_min = r.speed_max = std::abs(spindle.actual_rpm);
  r.off_least = r.off_greatest = status.off_spindle_mm;
  for (int a = 0; a < axes_; ++a)
    r.origin[static_cast<std::size_t>(a)] = image.axes[static_cast<std::size_t>(a)].actual;
}

void ThreadLog::go_on(Process& process, const image::ProcessImage& image) noexcept {
  Record& r = records_[static_cast<std::size_t>(process.record)];
  const image::SpindleImage& spindle = image.spindles[static_cast<std::size_t>(process.spindle)];
  const double step =
      revolutions_between(process.angle_deg, spindle.angle_deg, spindle.actual_rpm / 60.0 * period_s_);
  process.angle_deg = spindle.angle_deg;
  r.angle += step;
  r.turned += std::abs(step);
  const double speed = std::abs(spindle.actual_rpm);
  r.speed_min = std::min(r.speed_min, speed);
  r.speed_max = std::max(r.speed_max, speed);
  r.angles += r.angle;
  r.squares += r.angle * r.angle;
  for (std::size_t a = 0; a < static_cast<std::size_t>(axes_); ++a) {
    const double place = image.axes[a].actual - r.origin[a];
    r.places[a] += place;
    r.products[a] += place * r.angle;
  }
  const double off = image.processes[static_cast<std::size_t>(r.process)].off_spindle_mm;
  r.off_sum += off;
  r.off_least = std::min(r.off_least, off);
  r.off_greatest = std::max(r.off_greatest, off);
  add_part(r, static_cast<float>(off));
  ++r.cycles;
}

/// Where the parts are full, two become one each.
void ThreadLog::add_part(Record& r, float off) noexcept {
  auto part = static_cast<std::size_t>(r.cycles / r.per_part);
  if (part >= r.parts.size()) {
    for (std::size_t n = 0; n < r.parts.size() / 2; ++n)
      r.parts[n] = {std::min(r.parts[2 * n].least, r.parts[2 * n + 1].least),
                    std::max(r.parts[2 * n].greatest, r.parts[2 * n + 1].greatest)};
    r.per_part *= 2;
    part = static_cast<std::size_t>(r.cycles / r.per_part);
  }
  ThreadPass::Part& now = r.parts[part];
  const bool fresh = r.cycles % r.per_part == 0;
  now = fresh ? ThreadPass::Part{off, off}
              : ThreadPass::Part{std::min(now.least, off), std::max(now.greatest, off)};
}

std::vector<ThreadPass> ThreadLog::passes() const {
  std::vector<ThreadPass> out;
  for (std::size_t n = 0; n < count_; ++n)
    if (records_[n].turned >= kLeastTurned) out.push_back(pass(records_[n]));
  return out;
}

ThreadPass ThreadLog::pass(const Record& r) const {
  ThreadPass out;
  out.process = r.process;
  out.spindle = processes_[static_cast<std::size_t>(r.process)].spindle;
  out.run = r.run;
  out.line = r.line;
  out.file = r.file;
  out.begin_s = r.begin_s;
  out.duration_s = static_cast<double>(r.cycles) * period_s_;
  out.revolutions = r.turned;
  out.speed_min_rpm = r.speed_min;
  out.speed_max_rpm = r.speed_max;
  const auto count = static_cast<double>(r.cycles);
  const double spread = r.squares - r.angles * r.angles / count;
  for (std::size_t a = 0; a < static_cast<std::size_t>(axes_) && spread > 0.0; ++a) {
    const double lead = std::abs((r.products[a] - r.angles * r.places[a] / count) / spread);
    if (lead <= out.lead) continue;
    out.lead = lead;
    out.axis = static_cast<int>(a);
  }
  out.off_mean = r.off_sum / count;
  out.off_least = r.off_least;
  out.off_greatest = r.off_greatest;
  const auto parts = static_cast<std::size_t>((r.cycles + r.per_part - 1) / r.per_part);
  out.profile.assign(r.parts.begin(),
                     r.parts.begin() + static_cast<std::ptrdiff_t>(std::min(parts, r.parts.size())));
  return out;
}

}  // namespace servogate::report
