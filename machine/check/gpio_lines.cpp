// SPDX-License-Identifier: Apache-2.0
// Lines of GPIO chips: what a point can be there, and that each line has one.
#include <map>

#include "machine/check/check.hpp"
#include "machine/check/findings_io.hpp"

namespace servogate::machine {

namespace {

class LineCheck {
 public:
  LineCheck(const MachineConfig& machine, std::size_t station, Reading& reading)
      : machine_(machine),
        s_(machine.stations[station]),
        path_("station." + std::to_string(station) + ".points."),
        reading_(reading) {}

  void all() {
    for (std::size_t i = 0; i < s_.points.size(); ++i) {
      const PointConfig& p = s_.points[i];
      const std::string path = path_ + std::to_string(i) + ".";
      if (p.number < 0) continue;  // said by the names
      keys(p, path);
      if (s_.kind != StationKind::gpio) continue;
      take(p.number, p, path + "channel");
      if (p.is_encoder() && p.channel == ChannelKind::ai) encoder(p, path);
    }
  }

 private:
  void keys(const PointConfig& p, const std::string& path) {
    const bool here = s_.kind == StationKind::gpio;
    const auto only = [&](const char* key, bool fits, const std::string& what) {
      if (machine_.places.contains(path + key) && !fits)
        reading_.error(machine_.where(path + key), finding::kGpioOnly, {key, p.name, what});
    };
    only("bias", here && p.is_input(), text::both("input", "вход"));
    only("edges", (here || s_.kind == StationKind::board) && p.channel == ChannelKind::di,
         text::both("digital input (di)", "дискретный вход (di)"));
    only("b_line", here && p.channel == ChannelKind::ai, text::both("counter (ai)", "счётчик (ai)"));
  }
  void encoder(const PointConfig& p, const std::string& path) {
    take(p.b_line, p, path + "b_line");
    for (const char* key : {"loss", "hold", "inverted", "debounce"})
      if (machine_.places.contains(path + key))
        reading_.error(machine_.where(path + key), finding::kEncoderKey, {p.name, key});
    if (machine_.places.contains(path + "place") && !machine_.unread.contains(path + "place") &&
        p.place.format != image::Format::li)
      reading_.error(machine_.where(path + "place"), finding::kEncoderPlace, {p.name, to_string(p.place)});
  }
  /// The same channel twice was said by the names.
  void take(int line, const PointConfig& p, const std::string& path) {
    const auto [owner, fresh] = owners_.try_emplace(line, &p);
    if (fresh) return;
    if (!p.is_encoder() && owner->second->channel == p.channel && owner->second->number == p.number) return;
    reading_.error(machine_.where(path), finding::kLineTwice,
                   {p.name, std::to_string(line), owner->second->name});
  }

  const MachineConfig& machine_;
  const StationConfig& s_;
  const std::string path_;
  Reading& reading_;
  std::map<int, const PointConfig*> owners_;
};

}  // namespace

void check_gpio_lines(const MachineConfig& machine, Reading& reading) {
  for (std::size_t s = 0; s < machine.stations.size(); ++s) LineCheck(machine, s, reading).all();
}

}  // namespace servogate::machine
