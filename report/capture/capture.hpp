// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "report/capture/layout.hpp"
#include "report/capture/trigger.hpp"

namespace servogate::report {

/// What of a machine's time is written. Without a trigger: all of it, into one file.
struct CaptureSettings {
  std::optional<Trigger> trigger;  ///< its channel is one of the layout
  double before_s = 1.0;           ///< time before the trigger that is kept in memory, s
  double after_s = 1.0;            ///< time behind it; another trigger meanwhile lengthens it
  int most = 1;                    ///< files; what would fire later is not written
};

/// Keeps the past in a ring, looks for the trigger, and hands what is to be written to sinks. One thread; not
/// for the cycle. Memory: before_s of rows, whatever the duration.
class Capture {
 public:
  /// Makes the sink of file `number`, from 1.
  using Open = std::function<std::unique_ptr<CaptureSink>(int number)>;
  Capture(CaptureLayout layout, CaptureSettings settings, Open open);

  const CaptureLayout& layout() const noexcept { return layout_; }
  void row(image::Nanoseconds t_ns, std::span<const double> values);
  void frame(const CaptureFrame& frame);
  /// Nothing more comes.
  void end();

  int files() const noexcept { return files_; }
  /// The first thing that went wrong, empty when nothing did.
  const std::string& error() const noexcept { return error_; }

 private:
  std::span<const double> kept(std::size_t n) const;
  void open();
  void fire();
  void close();

  CaptureLayout layout_;
  CaptureSettings settings_;
  Open open_;
  std::optional<TriggerWatch> watch_;
  // The past: row n of all rows is in slot n % rows_ of ring_ and times_.
  std::size_t rows_ = 0;
  std::uint64_t count_ = 0;
  std::vector<double> ring_;
  std::vector<image::Nanoseconds> times_;
  std::deque<CaptureFrame> frames_;
  std::unique_ptr<CaptureSink> sink_;
  std::optional<image::Nanoseconds> until_ns_;  ///< of the file that is open; nullopt: to the end
  int files_ = 0;
  std::string error_;
};

}  // namespace servogate::report
