// SPDX-License-Identifier: Apache-2.0
#include "report/trace.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "firmware_if/image/interface_map.hpp"
#include "report/row_ring.hpp"

namespace servogate::report {

void sample(const image::ProcessImage& image, const TraceLayout& layout, TraceRow& row) noexcept {
  constexpr image::Place kRapid = image::field(image::kProcessFields, "rapid", image::process_base(0));
  row.cycle = image.now.number;
  row.t_ns = image.now.t_ns;
  row.feed_mm_s = image.processes[0].feed_mm_s;
  row.line = image.processes[0].line;
  row.rapid = image.packets.bit(kRapid);
  row.tool = image.processes[0].tool;
  row.alarms = image.alarms_active;
  row.run = image.processes[0].run;
  row.blocks = image.processes[0].blocks_done;
  row.off_spindle_mm = image.processes[0].off_spindle_mm;
  const std::size_t axes = std::min(layout.axes.size(), row.axes.size());
  for (std::size_t a = 0; a < axes; ++a) {
    const image::AxisImage& from = image.axes[a];
    row.axes[a] = {
        from.command, from.actual, from.following_error, from.command_velocity, from.command_acceleration,
        from.enabled, from.homed,  from.process};
  }
  const std::size_t spindles =
      std::min<std::size_t>(static_cast<std::size_t>(layout.spindles), row.spindles.size());
  for (std::size_t s = 0; s < spindles; ++s)
    row.spindles[s] = {image.spindles[s].command_rpm, image.spindles[s].actual_rpm,
                       image.spindles[s].angle_deg};
  for (int p = 1; p < layout.processes && p < image::kMaxProcesses; ++p) {
    const image::ProcessStatus& from = image.processes[static_cast<std::size_t>(p)];
    row.further[static_cast<std::size_t>(p - 1)] = {from.feed_mm_s, from.line, from.tool, from.run,
                                                    from.blocks_done};
  }
  row.signals.fill(0);
  const std::size_t signals = std::min<std::size_t>(layout.signals.size(), kMaxTraceSignals);
  for (std::size_t n = 0; n < signals; ++n)
    if (image.packets.bit(layout.signals[n].place)) row.signals[n / 64] |= std::uint64_t{1} << (n % 64);
}

struct TraceRecorder::Impl {
  TraceLayout layout;
  std::vector<std::unique_ptr<TraceSink>> sinks;
  RowRing ring;
  std::vector<TraceRow> slots;
  std::atomic<bool> closing{false};
  std::thread writer;

  Impl(TraceLayout l, std::vector<std::unique_ptr<TraceSink>> s, std::size_t rows)
      : layout(std::move(l)), sinks(std::move(s)), ring(rows), slots(ring.slots()) {}

  void run() {
    for (const auto& sink : sinks) sink->begin(layout);
    const std::size_t batch = std::max<std::size_t>(slots.size() / 8, 1);
    const auto take = [this](std::size_t slot) {
      for (const auto& sink : sinks) sink->row(slots[slot]);
    };
    for (;;) {
      const bool last = closing.load(std::memory_order_acquire);
      if (ring.drain(batch, take) > 0) continue;
      if (last) break;
      // The producer must not have to wake anybody: that would be a system call in the cycle.
      std::this_thread::sleep_for(std::chrono::microseconds(500));
    }
    for (const auto& sink : sinks) sink->end(ring.lost());
  }
};

TraceRecorder::TraceRecorder(TraceLayout layout, std::vector<std::unique_ptr<TraceSink>> sinks,
                             std::size_t capacity)
    : impl_(std::make_unique<Impl>(std::move(layout), std::move(sinks), capacity)) {
  impl_->writer = std::thread([this] { impl_->run(); });
}

TraceRecorder::~TraceRecorder() { close(); }

const TraceLayout& TraceRecorder::layout() const noexcept { return impl_->layout; }

bool TraceRecorder::record(const TraceRow& row) noexcept {
  const auto slot = impl_->ring.slot();
  if (!slot) return false;
  impl_->slots[*slot] = row;
  impl_->ring.commit();
  return true;
}

void TraceRecorder::wait_for_room() { impl_->ring.wait_for_room(); }

void TraceRecorder::close() {
  impl_->closing.store(true, std::memory_order_release);
  if (impl_->writer.joinable()) impl_->writer.join();
}

std::uint64_t TraceRecorder::recorded() const noexcept { return impl_->ring.accepted(); }
std::uint64_t TraceRecorder::dropped() const noexcept { return impl_->ring.lost(); }
const std::vector<std::unique_ptr<TraceSink>>& TraceRecorder::sinks() const noexcept { return impl_->sinks; }

}  // namespace servogate::report
