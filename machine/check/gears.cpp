// SPDX-License-Identifier: Apache-2.0
// Gear ranges of spindles.
#include <map>

#include "firmware_if/text/units.hpp"
#include "machine/check/check.hpp"
#include "machine/check/findings_io.hpp"

namespace servogate::machine {

namespace {

class GearCheck {
 public:
  GearCheck(const MachineConfig& machine, std::size_t index, Reading& reading)
      : machine_(machine),
        s_(machine.spindles[index]),
        path_("spindle." + std::to_string(index) + "."),
        number_(std::to_string(index + 1)),
        reading_(reading) {}

  void all() {
    if (s_.gears.empty()) {
      for (const char* key : {"gear_change_speed", "gear_change_time", "gear_change_timeout"})
        if (written(key)) error(key, finding::kGearsOnly, {number_, key});
      return;
    }
    if (written("gear")) error("gear", finding::kGearsAndOne, {number_, "gear"});
    for (const char* key : {"counts_per_rev", "orient_angle", "orient_speed"})
      if (written(key)) error(key, finding::kGearsEncoder, {number_, key});
    std::map<std::string, std::string> names, confirms;  // of outputs it is said elsewhere
    bool without = false;
    for (std::size_t g = 0; g < s_.gears.size(); ++g) {
      const GearConfig& gear = s_.gears[g];
      const std::string path = "gears." + std::to_string(g);
      once(names, "name", gear.name, path);
      once(confirms, "confirm", gear.confirm, path);
      if (gear.output.empty() && without) error(path, finding::kGearNoOutput, {number_, gear.name});
      without = without || gear.output.empty();
      if (g > 0 && gear.max_speed <= s_.gears[g - 1].max_speed)
        error(path + ".max_speed", finding::kGearOrder, {number_, gear.name, text::number(gear.max_speed)});
    }
    const GearConfig &first = s_.gears.front(), &last = s_.gears.back();
    if (last.max_speed < s_.max_speed)
      error("max_speed", finding::kGearsTooSlow,
            {number_, text::number(s_.max_speed), text::number(last.max_speed)});
    if (s_.gear_change_speed > first.max_speed)
      error("gear_change_speed", finding::kGearChangeSpeed,
            {number_, text::number(s_.gear_change_speed), first.name});
  }

 private:
  bool written(const std::string& key) const { return machine_.places.contains(path_ + key); }
  void error(const std::string& key, const text::Entry& entry, std::vector<std::string> arguments) {
    reading_.error(machine_.where(path_ + key), entry, std::move(arguments));
  }
  void once(std::map<std::string, std::string>& seen, const std::string& key, const std::string& value,
            const std::string& path) {
    if (value.empty() || seen.try_emplace(value, path).second) return;
    error(path + "." + key, finding::kGearTwice, {number_, key + " = \"" + value + "\""});
  }

  const MachineConfig& machine_;
  const SpindleConfig& s_;
  const std::string path_, number_;
  Reading& reading_;
};

}  // namespace

void check_gears(const MachineConfig& machine, Reading& reading) {
  for (std::size_t i = 0; i < machine.spindles.size(); ++i) GearCheck(machine, i, reading).all();
}

}  // namespace servogate::machine
