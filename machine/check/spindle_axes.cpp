// SPDX-License-Identifier: Apache-2.0
// Spindles that become a rotary axis: both have one drive and one encoder.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "machine/check/check.hpp"
#include "machine/check/findings_io.hpp"

namespace servogate::machine {
namespace {

constexpr double kSameCounts = 1e-6;

class SpindleAxis {
 public:
  SpindleAxis(const LoadResult& loaded, Reading& reading, std::size_t index)
      : loaded_(loaded),
        m_(loaded.machine),
        s_(m_.spindles[index]),
        reading_(reading),
        path_("spindle." + std::to_string(index) + "."),
        number_(std::to_string(index + 1)) {}

  void check() {
    if (s_.axis.empty()) {
      if (m_.places.contains(path_ + "axis_m")) error("axis_m", finding::kAxisMAlone, {number_});
      return;
    }
    const int index = m_.axis_index(s_.axis);
    if (index < 0) return error("axis", finding::kSpindleAxisNone, {number_, s_.axis});
    const AxisConfig& a = m_.axes[static_cast<std::size_t>(index)];
    spindle(a);
    axis(a, "axis." + std::to_string(index) + ".");
    functions();
    device(a);
  }

 private:
  void error(const char* key, const text::Entry& entry, std::vector<std::string> arguments) {
    reading_.error(m_.where(path_ + key), entry, std::move(arguments));
  }

  void spindle(const AxisConfig& a) {
    if (m_.spindle_of_process(s_.process - 1) != &s_ || a.process != s_.process)
      error("axis", finding::kSpindleAxisProcess, {number_, s_.axis});
    if (s_.drive.empty() || !s_.has_encoder() || !s_.gears.empty() || s_.encoder_delay > 0.0)
      error("axis", finding::kSpindleAxisDrive, {number_, s_.axis});
  }

  void axis(const AxisConfig& a, const std::string& path) {
    const auto wrong = [&](const char* key, const text::Entry& entry, std::vector<std::string> arguments) {
      reading_.error(m_.where(path + key), entry, std::move(arguments));
    };
    if (a.type != AxisType::rotary || a.auxiliary)
      wrong("type", finding::kSpindleAxisType, {a.letter, number_});
    if (a.drive != s_.drive) wrong("drive", finding::kSpindleAxisOther, {a.letter, number_, s_.drive});
    if (a.home.method != HomingMethod::none)
      wrong("home.method", finding::kSpindleAxisHome, {a.letter, number_});
    if (a.brake.present()) wrong("brake", finding::kSpindleAxisBrake, {a.letter, number_});
    if (a.lead <= 0.0 || a.counts_per_rev <= 0 || !s_.has_encoder()) return;
    const double counts = 360.0 * a.counts_per_unit();
    if (std::abs(counts - static_cast<double>(s_.counts_per_rev)) > kSameCounts * counts)
      wrong("counts_per_rev", finding::kSpindleAxisCounts,
            {a.letter, text::number(counts, 3), number_, std::to_string(s_.counts_per_rev)});
  }

  void functions() {
    const auto [on, off] = s_.axis_m;
    if (on == off) return error("axis_m", finding::kAxisMSame, {number_, s_.axis});
    for (const std::int64_t m : s_.axis_m) {
      const std::string word = "M" + std::to_string(m);
      const bool own = std::any_of(m_.own_codes.begin(), m_.own_codes.end(),
                                   [&word](const OwnCodeConfig& code) { return code.code == word; });
      if (own || m == 98 || m == 99) error("axis_m", finding::kAxisMTaken, {number_, word});
    }
  }

  /// Both modes, and the words of both in the process data.
  void device(const AxisConfig& a) {
    const NodeConfig* node = m_.node(s_.drive);
    const DeviceConfig* device = node == nullptr ? nullptr : loaded_.device(node->device);
    if (device == nullptr || !device->drive()) return;
    const auto mapped = [device](std::uint16_t object) {
      return std::any_of(device->rpdos.begin(), device->rpdos.end(), [object](const PdoConfig& pdo) {
        return std::any_of(pdo.objects.begin(), pdo.objects.end(),
                           [object](const PdoObject& o) { return o.index == object; });
      });
    };
    const bool modes = device->behaviour.speed_mode == SpeedMode::csv &&
                       device->behaviour.position_mode == PositionMode::csp && !device->behaviour.sdo_only;
    if (!modes || !mapped(0x607A) || !mapped(0x60FF))
      error("axis", finding::kSpindleAxisDevice, {number_, a.letter, node->device});
  }

  const LoadResult& loaded_;
  const MachineConfig& m_;
  const SpindleConfig& s_;
  Reading& reading_;
  std::string path_, number_;
};

}  // namespace

void check_spindle_axes(const LoadResult& loaded, Reading& reading) {
  for (std::size_t i = 0; i < loaded.machine.spindles.size(); ++i) SpindleAxis(loaded, reading, i).check();
}

}  // namespace servogate::machine
