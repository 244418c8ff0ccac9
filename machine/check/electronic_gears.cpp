// SPDX-License-Identifier: Apache-2.0
// Axes that follow another axis or a spindle.
#include <cmath>
#include <string>
#include <vector>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_gear.hpp"

namespace servogate::machine {
namespace {

class ElectronicGears {
 public:
  ElectronicGears(const MachineConfig& machine, Reading& reading) : m_(machine), reading_(reading) {}

  void check() {
    for (index_ = 0; index_ < m_.electronic_gears.size(); ++index_) {
      const ElectronicGearConfig& g = m_.electronic_gears[index_];
      ratio(g);
      if (!g.in_phase && m_.places.contains(path("phase"))) error("phase", finding::kGearPhaseAlone, {});
      const int follower = m_.axis_index(g.follower);
      if (follower < 0) continue;  // said by the references
      number(g);
      window(g, m_.axes[static_cast<std::size_t>(follower)]);
      if (const int spindle = m_.spindle_index(g.master); spindle >= 0)
        behind_spindle(g, static_cast<std::size_t>(spindle));
      else if (m_.axis_index(g.master) >= 0)
        behind_axis(g);
      else
        error("master", finding::kGearMaster, {g.master, masters()});
    }
  }

 private:
  std::string path(const char* key) const { return "gear." + std::to_string(index_) + "." + key; }
  void error(const char* key, const text::Entry& entry, std::vector<std::string> arguments) {
    reading_.error(m_.where(path(key)), entry, std::move(arguments));
  }
  std::string masters() const {
    std::string names;
    const auto add = [&names](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
    for (const AxisConfig& a : m_.axes) add(a.letter);
    for (std::size_t s = 0; s < m_.spindles.size(); ++s) add(s == 0 ? "S" : "S" + std::to_string(s + 1));
    return names;
  }

  void ratio(const ElectronicGearConfig& g) {
    const auto [turns, of_master] = g.ratio;
    const double quotient = std::abs(static_cast<double>(turns)) / static_cast<double>(of_master);
    const double most = ElectronicGearConfig::kMostRatio;
    if (turns == 0 || of_master <= 0 || quotient > most || quotient < 1.0 / most)
      error("ratio", finding::kGearRatio,
            {std::to_string(turns), std::to_string(of_master), text::number(most)});
  }

  /// The PLC chooses by number among the gears of an axis.
  void number(const ElectronicGearConfig& g) {
    constexpr int kMost = 255;  // a place of one byte
    int before = 0;
    for (std::size_t o = 0; o < index_; ++o) {
      const ElectronicGearConfig& other = m_.electronic_gears[o];
      if (other.follower != g.follower) continue;
      ++before;
      if (other.master == g.master && other.ratio == g.ratio && other.source == g.source &&
          other.in_phase == g.in_phase && other.phase == g.phase && other.window == g.window)
        return error("follower", finding::kGearSame, {g.follower, std::to_string(before)});
    }
    if (before == kMost)
      error("follower", finding::kGearMany, {g.follower, std::to_string(before + 1), std::to_string(kMost)});
  }

  void window(const ElectronicGearConfig& g, const AxisConfig& follower) {
    if (g.window > 0.0 && g.window < follower.in_position_window)
      error("window", finding::kGearWindow,
            {g.follower, text::number(g.window, 4), text::number(follower.in_position_window, 4)});
  }

  void behind_spindle(const ElectronicGearConfig& g, std::size_t index) {
    const SpindleConfig& s = m_.spindles[index];
    if (!s.has_encoder() || s.drive.empty()) error("master", finding::kGearEncoder, {g.master});
    if (s.axis == g.follower) error("master", finding::kGearOwnSpindle, {g.follower, g.master});
    if (g.source == GearSource::setpoint && s.coupling != Coupling::none)
      error("source", finding::kGearCoupled, {g.master});
  }

  void behind_axis(const ElectronicGearConfig& g) {
    const AxisConfig& master = m_.axes[static_cast<std::size_t>(m_.axis_index(g.master))];
    if (g.source == GearSource::measured && master.board.present() &&
        master.board.feedback == BoardFeedback::steps)
      error("source", finding::kGearSteps, {g.master});
    if (g.master == g.follower) return error("master", finding::kGearItself, {g.follower});
    // Any of the gears of the axes in between may be engaged.
    std::vector<std::string> reached = {g.master};
    for (std::size_t n = 0; n < reached.size(); ++n)
      for (const ElectronicGearConfig& next : m_.electronic_gears) {
        if (next.follower != reached[n]) continue;
        if (next.master == g.follower) return error("master", finding::kGearRing, {g.follower, reached[n]});
        bool known = false;
        for (const std::string& r : reached) known = known || r == next.master;
        if (!known) reached.push_back(next.master);
      }
  }

  const MachineConfig& m_;
  Reading& reading_;
  std::size_t index_ = 0;
};

}  // namespace

void check_electronic_gears(const MachineConfig& machine, Reading& reading) {
  ElectronicGears(machine, reading).check();
}

}  // namespace servogate::machine
