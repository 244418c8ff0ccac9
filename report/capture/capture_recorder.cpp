// SPDX-License-Identifier: Apache-2.0
#include "report/capture/capture_recorder.hpp"

#include <readerwriterqueue/readerwriterqueue.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "report/row_ring.hpp"

namespace servogate::report {

namespace {

// The longest cycle has some hundreds of frames: a segment of 1 Mbit/s carries 21 in a millisecond.
constexpr std::size_t kFrames = 16384, kFrameRoom = 8192;
constexpr std::size_t kMostBytes = std::size_t{64} << 20;

std::size_t rows_of(const CaptureLayout& layout, std::size_t rows) {
  if (rows > 0) return rows;
  const auto second =
      static_cast<std::size_t>(std::max<image::Nanoseconds>(1, 1'000'000'000 / layout.period_ns));
  const std::size_t row = sizeof(double) * std::max<std::size_t>(1, layout.channels.size());
  return std::max<std::size_t>(64, std::min(kMostBytes / row, second));
}

}  // namespace

struct CaptureRecorder::Impl {
  std::unique_ptr<Capture> capture;
  std::size_t channels;
  RowRing ring;
  std::vector<double> values;
  std::vector<image::Nanoseconds> times;
  moodycamel::ReaderWriterQueue<CaptureFrame> frames{kFrames};
  std::atomic<bool> closing{false};
  std::thread writer;
  int files = 0;
  std::string error;

  Impl(std::unique_ptr<Capture> c, std::size_t n)
      : capture(std::move(c)),
        channels(capture->layout().channels.size()),
        ring(rows_of(capture->layout(), n)),
        values(ring.slots() * channels),
        times(ring.slots()) {}

  std::span<double> row_in(std::size_t slot) {
    return std::span<double>(values).subspan(slot * channels, channels);
  }

  bool drain() {
    // In the order of time: all frames of a cycle were handed over before its row.
    return ring.drain(ring.slots(), [this](std::size_t slot) {
      const image::Nanoseconds t = times[slot];
      for (const CaptureFrame* f = frames.peek(); f != nullptr && f->t_ns <= t; f = frames.peek()) {
        capture->frame(*f);
        frames.pop();
      }
      capture->row(t, row_in(slot));
    }) > 0;
  }

  void run() {
    for (;;) {
      const bool last = closing.load(std::memory_order_acquire);
      if (drain()) continue;
      if (last) break;
      // The producer must not have to wake anybody: that would be a system call in the cycle.
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    for (CaptureFrame frame; frames.try_dequeue(frame);) capture->frame(frame);
    capture->end();
    files = capture->files();
    error = capture->error();
  }
};

CaptureRecorder::CaptureRecorder(std::unique_ptr<Capture> capture, std::size_t rows)
    : impl_(std::make_unique<Impl>(std::move(capture), rows)) {
  impl_->writer = std::thread([this] { impl_->run(); });
}

CaptureRecorder::~CaptureRecorder() { close(); }

std::span<double> CaptureRecorder::slot() noexcept {
  const auto slot = impl_->ring.slot();
  return slot ? impl_->row_in(*slot) : std::span<double>();
}

void CaptureRecorder::commit(image::Nanoseconds t_ns) noexcept {
  impl_->times[*impl_->ring.slot()] = t_ns;
  impl_->ring.commit();
}

void CaptureRecorder::frame(const CaptureFrame& frame) noexcept {
  if (!impl_->frames.try_enqueue(frame)) impl_->ring.lose();
}

void CaptureRecorder::wait_for_room() const {
  impl_->ring.wait_for_room();
  while (impl_->frames.size_approx() >= kFrames - kFrameRoom) std::this_thread::yield();
}

std::string CaptureRecorder::close() {
  impl_->closing.store(true, std::memory_order_release);
  if (impl_->writer.joinable()) impl_->writer.join();
  return impl_->error;
}

std::uint64_t CaptureRecorder::lost() const noexcept { return impl_->ring.lost(); }
int CaptureRecorder::files() const noexcept { return impl_->files; }

}  // namespace servogate::report
