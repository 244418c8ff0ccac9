// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "report/capture/capture.hpp"

namespace servogate::report {

/// Carries rows and frames from the cycle to a capture on a thread of its own, through bounded lock-free
/// queues of one producer. Virtual time loses nothing: the loop's owner calls wait_for_room() before each
/// cycle. Real time never waits: what finds a queue full is lost and counted.
class CaptureRecorder {
 public:
  /// The layout has a channel at least. `rows` that the queue takes; 0: as many as a second has, within 64
  /// MB.
  explicit CaptureRecorder(std::unique_ptr<Capture> capture, std::size_t rows = 0);
  ~CaptureRecorder();
  CaptureRecorder(const CaptureRecorder&) = delete;
  CaptureRecorder& operator=(const CaptureRecorder&) = delete;

  /// Where the values of this cycle go; empty: the queue is full, the row is lost and counted. real-time
  /// safe.
  std::span<double> slot() noexcept;
  /// Hands over the row that slot() gave. real-time safe.
  void commit(image::Nanoseconds t_ns) noexcept;
  /// real-time safe.
  void frame(const CaptureFrame& frame) noexcept;
  /// Blocks until a cycle's row and frames are sure to find room; in virtual time.
  void wait_for_room() const;

  /// Writes what is queued, ends the capture and the thread; later calls do nothing. The error, empty: none.
  /// Not real-time safe.
  std::string close();
  /// Rows and frames that a full queue did not take.
  std::uint64_t lost() const noexcept;
  /// After close(): files that were written.
  int files() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace servogate::report
