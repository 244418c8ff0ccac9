// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "firmware_if/image/process_image.hpp"
#include "firmware_if/image/request.hpp"

namespace servogate::cycle {

/// [[path_wheel]] of one process.
struct PathWheelConfig {
  static constexpr int kNone = -1, kPendant = 0;
  int source = kNone;   ///< kPendant: its counts come as requests; 1, 2: that handwheel of the PLC
  double full = 100.0;  ///< counts a second at which the path has its programmed feed, above 0
  std::optional<image::Place> healthy;  ///< FALSE: what the counter says means nothing
};

/// The handwheel that drives the program of one process along its path. Its speed, measured over `kWindow`,
/// is what the path takes of its programmed feed, 0 to 1 (the process applies it as an override). Turned back
/// it asks the gate for the way back along the path, turned forward again for the way forward and for the
/// program to go on. A wheel that stands or is lost leaves the path at rest.
///
/// In each cycle, behind the requests and before the processes, all real-time safe:
///     wheel.read(image);
///     if (Request r; wheel.next(r, image)) wheel.answer(r, handle(r));
///     wheel.write(image);
class PathWheel {
 public:
  static constexpr image::Nanoseconds kWindow = 200 * image::kMillisecond;
  /// Blocks of one way back; behind them it rests and is asked for the next.
  static constexpr std::uint32_t kBlocks = 1000;

  void configure(const PathWheelConfig& config, int process) noexcept;
  bool declared() const noexcept { return config_.source != PathWheelConfig::kNone; }
  /// RequestKind::path_wheel, which the gate has let pass.
  void take(const image::Request& request) noexcept;
  /// What the PLC has written in this scan, and the speed of the wheel.
  void read(const image::ProcessImage& image) noexcept;
  /// What is asked of the gate: the way back or forward, or that the program goes on.
  bool next(image::Request& request, const image::ProcessImage& image) noexcept;
  /// The gate's decision, carried out already.
  void answer(const image::Request& request, const image::Answer& answer) noexcept;
  /// Writes ProcessStatus::wheel and the places NC.path_wheel_*.
  void write(image::ProcessImage& image) const noexcept;
  /// Somebody else decides where the program goes from here.
  void let_go() noexcept { leads_ = false; }

 private:
  static constexpr int kParts = 8;  ///< of the window
  void measure(std::int32_t counts, image::Nanoseconds period) noexcept;
  void forget() noexcept;
  std::int32_t counts_of_plc(const image::ProcessImage& image) noexcept;

  PathWheelConfig config_;
  int process_ = 0;
  bool asked_ = false;   ///< by a request to be chosen
  bool chosen_ = false;  ///< by that, or by the PLC
  bool here_ = false;    ///< the pendant is plugged in
  bool lost_ = false;
  bool counter_known_ = false;
  std::uint32_t counter_ = 0;
  double pending_ = 0.0;  ///< counts of requests
  std::array<double, kParts> parts_{};
  int part_ = 0;
  image::Nanoseconds in_part_ = 0;
  double turned_ = 0.0;
  bool leads_ = false;
  bool went_back_ = false;  ///< the last way was one back
  double went_from_ = 0.0;  ///< mm, where that began
  bool at_begin_ = false;   ///< nothing further back is kept
  std::uint16_t refusal_ = 0;
};

}  // namespace servogate::cycle
