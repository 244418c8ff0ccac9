// SPDX-License-Identifier: Apache-2.0
#include "report/capture/capture_recorder.hpp"

#include <readerwriterqueue/readerwriterqueue.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

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
  std::size_t channels, rows;
  // A ring: row n lies in slot n % rows from `accepted` > n until `consumed` > n. All of it exists from the
  // start, so no page of it is touched for the first time inside a cycle.
  std::vector<double> values;
  std::vector<image::Nanoseconds> times;
  alignas(64) std::atomic<std::uint64_t> accepted{0};
  alignas(64) std::atomic<std::uint64_t> consumed{0};
  std::atomic<std::uint64_t> lost{0};
  moodycamel::ReaderWriterQueue<CaptureFrame> frames{kFrames};
  std::atomic<bool> closing{false};
  std::thread writer;
  int files = 0;
  std::string error;

  Impl(std::unique_ptr<Capture> c, std::size_t n)
      : capture(std::move(c)),
        channels(capture->layout().channels.size()),
        rows(rows_of(capture->layout(), n)),
        values(rows * channels),
        times(rows) {}

  std::span<double> slot(std::uint64_t n) {
    return std::span<double>(values).subspan(static_cast<std::size_t>(n % rows) * channels, channels);
  }

  bool drain() {
    const std::uint64_t from = consumed.load(std::memory_order_relaxed);
    const std::uint64_t to = accepted.load(std::memory_order_acquire);
    // In the order of time: all frames of a cycle were handed over before its row.
    for (std::uint64_t n = from; n < to; ++n) {
      const image::Nanoseconds t = times[static_cast<std::size_t>(n % rows)];
      for (const CaptureFrame* f = frames.peek(); f != nullptr && f->t_ns <= t; f = frames.peek()) {
        capture->frame(*f);
        frames.pop();
      }
      capture->row(t, slot(n));
      consumed.store(n + 1, std::memory_order_release);
    }
    return from != to;
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
  Impl& i = *impl_;
  const std::uint64_t n = i.accepted.load(std::memory_order_relaxed);
  if (n - i.consumed.load(std::memory_order_acquire) < i.rows) return i.slot(n);
  i.lost.fetch_add(1, std::memory_order_relaxed);
  return {};
}

void CaptureRecorder::commit(image::Nanoseconds t_ns) noexcept {
  Impl& i = *impl_;
  const std::uint64_t n = i.accepted.load(std::memory_order_relaxed);
  i.times[static_cast<std::size_t>(n % i.rows)] = t_ns;
  i.accepted.store(n + 1, std::memory_order_release);
}

void CaptureRecorder::frame(const CaptureFrame& frame) noexcept {
  if (!impl_->frames.try_enqueue(frame)) impl_->lost.fetch_add(1, std::memory_order_relaxed);
}

void CaptureRecorder::wait_for_room() const {
  const Impl& i = *impl_;
  while (i.accepted.load(std::memory_order_relaxed) - i.consumed.load(std::memory_order_acquire) >= i.rows ||
         i.frames.size_approx() >= kFrames - kFrameRoom)
    std::this_thread::yield();
}

std::string CaptureRecorder::close() {
  impl_->closing.store(true, std::memory_order_release);
  if (impl_->writer.joinable()) impl_->writer.join();
  return impl_->error;
}

std::uint64_t CaptureRecorder::lost() const noexcept { return impl_->lost.load(std::memory_order_relaxed); }
int CaptureRecorder::files() const noexcept { return impl_->files; }

}  // namespace servogate::report
