// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gateway/control/compose/control.hpp"
#include "report/capture/layout.hpp"

namespace servogate::gateway {

/// Values of a machine that a capture can hold, by name, and how a cycle reads them.
class MachineChannels {
 public:
  /// Adds what a name means: a value (`X.error`, `spindle.act`, `feed`, `alarms`), a point, a word of the
  /// interface, an address (`SK200`), a variable of the PLC (`Mill.count`), or a group of them: `axes`,
  /// `spindles`, `processes`, `points`, `interface`, `plc`, `all`. A name twice counts once. False: there is
  /// no such value. Not real-time safe.
  bool add(Control& control, const std::string& name);
  static bool is_group(std::string_view name);
  static constexpr std::string_view kGroups = "axes, spindles, processes, points, interface, plc, all";

  const std::vector<report::CaptureChannel>& channels() const noexcept { return channels_; }
  /// One value a channel, as it stands behind a cycle; the cycle's thread. real-time safe.
  void read(Control& control, std::span<double> values) const noexcept;

 private:
  struct Source {
    enum class Kind : std::uint8_t { alarms, axis, spindle, process, place, variable };
    Kind kind = Kind::alarms;
    std::uint8_t index = 0;  ///< of axis, spindle or process
    std::uint8_t field = 0;  ///< index in the table of its kind
    image::Place place{};
    plc::Handle handle{};
  };
  bool add_value(Control& control, const std::string& name);
  bool add_named(Control& control, const std::string& name);
  void add_group(Control& control, const std::string& group);
  void put(const Source& source, report::CaptureChannel channel);
  void put_axis(const Control& control, std::size_t axis, std::size_t field);
  void put_spindle(std::size_t spindle, std::size_t field);
  void put_process(std::size_t process, std::size_t field);

  std::vector<report::CaptureChannel> channels_;
  std::vector<Source> sources_;
  std::shared_ptr<const plc::LogicProgram> program_;  ///< that the handles belong to
};

}  // namespace servogate::gateway
