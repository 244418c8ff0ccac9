// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "firmware_if/fault/fault.hpp"
#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"
#include "firmware_if/text/finding.hpp"
#include "kernel/cycle/alarm/alarms.hpp"

namespace servogate::bench {

/// A running machine as this room sees it; the gateway hands it over. In virtual time it moves in step()
/// only, and same calls give the same bytes; in real time, or paced, it moves by itself, and step() waits for
/// news. One thread at a time. Nothing here is real-time safe.
class Machine {
 public:
  virtual ~Machine() = default;

  /// Virtual time: one cycle, simulated devices and reading ahead included. Moving by itself: a few
  /// milliseconds later. False: it has ended (a record that is replayed), nothing was done.
  virtual bool step() = 0;
  /// The image as the last step() left it.
  virtual const image::ProcessImage& image() const = 0;
  /// Active alarms as the last step() left them.
  virtual const cycle::AlarmSnapshot& alarms() = 0;
  /// How long Cycle::step() took in the last cycle, by the wall clock; simulated devices are not in it. -1:
  /// this cycle was not measured.
  virtual image::Nanoseconds cycle_duration_ns() const = 0;

  /// Posts a request to the gate. False: the queue is full.
  virtual bool post(const image::Request& request) = 0;
  /// Takes the oldest answer; false: there is none.
  virtual bool take(image::Answer& answer) = 0;
  /// Gives a process (from 0) a part program after it was proven as `check` proves it. False, and the one
  /// before stays: an error is among `findings`.
  virtual bool load(const std::string& program, std::vector<text::Finding>& findings, int process = 0) = 0;
  /// Plays a simulated input: a level (0, 1) or the value of an analog point; nullopt: it follows its axis or
  /// output again. False: `why` says why it cannot, in both languages.
  virtual bool play(const std::string& point, std::optional<double> value, std::string& why) = 0;

  /// Puts a fault on something simulated, named as in the machine file: a node ("can.x"), a bus ("can"), a
  /// station, an input. False: `why` says why it cannot happen to it, in both languages.
  virtual bool inject(std::string_view device, const fault::Fault& fault, std::string& why) = 0;
  /// The same without doing it; `fault` nullptr: an end. False as above.
  virtual bool possible(std::string_view device, const fault::Fault* fault, std::string& why) const = 0;
  /// Ends a lasting fault of a device before its time; nullopt: all of them. False as above.
  virtual bool clear(std::string_view device, std::optional<fault::Kind> kind, std::string& why) = 0;

  /// Report of the run so far (docs/trace-and-report.md) as JSON; empty: nobody watches it.
  virtual std::string report() const = 0;
};

}  // namespace servogate::bench
