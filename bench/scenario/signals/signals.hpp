// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenario/scenario.hpp"
#include "firmware_if/image/interface_map.hpp"
#include "firmware_if/image/process_image.hpp"
#include "kernel/cycle/alarm/alarms.hpp"
#include "machine/config.hpp"
#include "machine/keys/units.hpp"

namespace servogate::scenario {

/// Variables of the PLC that a scenario looks at; the gateway hands them over.
class Variables {
 public:
  virtual ~Variables() = default;
  /// Watches a variable from now on; nullopt: the PLC has none of that name with one number.
  virtual std::optional<int> watch(std::string_view name) = 0;
  /// Its value in the scan of the newest cycle.
  virtual double value(int variable) const = 0;
};

/// What is seen of a machine behind a cycle.
struct View {
  const image::ProcessImage& image;
  const cycle::AlarmSnapshot& alarms;
};

/// A quantity of a machine by its name. Switches are 0 and 1; of `words` it is the index of one.
struct Signal {
  std::string name = {};
  std::string_view unit = {};                    ///< "mm", "deg/s", "rpm", "%" ...; empty: none
  std::span<const std::string_view> words = {};  ///< of its values; empty: numbers
  bool digital = false;
  std::function<double(const View&)> read = {};
};

/// What names mean in a machine: `X.actual`, `S.actual`, `NC.line`, points, symbols, places (SA16.IN), and
/// variables of the PLC; the columns of a trace, too.
class Signals {
 public:
  /// All outlive it. `variables` nullptr: there is no PLC.
  Signals(const machine::MachineConfig& machine, const std::vector<image::Symbol>& symbols,
          Variables* variables)
      : machine_(machine), symbols_(symbols), variables_(variables) {}

  std::optional<Signal> find(std::string_view name) const;
  /// `value` as the signal's own number; nullopt: it is nothing of the kind.
  static std::optional<double> number(const Value& value, const Signal& signal);
  /// The same of a length of axis `axis`.
  std::optional<double> length(const Value& value, int axis) const;
  /// Indices of axes by their letters, "all" too; -1 at an unknown one.
  std::vector<int> axes(const std::vector<std::string>& letters) const;
  const machine::MachineConfig& machine() const noexcept { return machine_; }

 private:
  std::optional<Signal> of_axis(std::string_view letter, std::string_view what) const;
  std::optional<Signal> of_spindle(int index, std::string_view what) const;
  std::optional<Signal> of_process(int index, std::string_view what) const;
  std::optional<Signal> of_place(std::string_view name) const;

  const machine::MachineConfig& machine_;
  const std::vector<image::Symbol>& symbols_;
  Variables* variables_;
};

/// A value of a signal for people: "12.5 mm/s", "held", "on".
std::string words_of(double value, const Signal& signal);

/// The names of quantities beside those of the machine itself, for the documentation: name, unit, meaning in
/// two languages.
struct QuantityRow {
  std::string_view name, unit, english, russian;
};
std::span<const QuantityRow> quantities() noexcept;

}  // namespace servogate::scenario
