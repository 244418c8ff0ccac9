// SPDX-License-Identifier: Apache-2.0
#include "gateway/control/run/realtime_loop.hpp"

#include <algorithm>

namespace servogate::gateway {

namespace {

const text::Entry kRefused{
    "run.no-realtime", "real time was refused: {0}: {1}. Grant it with: {2}  (or use --realtime=best-effort)",
    "нет реального времени: {0}: {1}. Разрешить: {2}  (или --realtime=best-effort)"};
const text::Entry kWithout{"run.without", "goes on without {0}: {1}. What grants it: {2}",
                           "работает без этого: {0}: {1}. Разрешить: {2}"};

}  // namespace

RealtimeLoop::RealtimeLoop(Control& control, cycle::RealtimeSettings settings, AfterCycle after)
    : control_(control), settings_(settings), after_(std::move(after)) {}

RealtimeLoop::~RealtimeLoop() { stop(); }

bool RealtimeLoop::start() {
  cycle_thread_ = std::thread([this] { cycle_thread(); });
  ready_.wait(0);
  if (ready_.load() < 0) {
    cycle_thread_.join();
    return false;
  }
  if (plc::Logic* logic = control_.logic(); logic != nullptr)
    watchdog_ = std::make_unique<ScanWatchdog>(logic->scan_watch(), control_.longest_scan_ns(),
                                               settings_.priority + 1);
  reader_thread_ = std::thread([this] {
    const image::Nanoseconds pause = std::max<image::Nanoseconds>(control_.cycle().period_ns() / 2, 200'000);
    while (!stop_.load(std::memory_order_relaxed)) {
      control_.read_ahead();
      clock_.sleep_until(clock_.now_ns() + pause);
    }
  });
  return true;
}

void RealtimeLoop::cycle_thread() {
  cycle::RealtimeThread thread(settings_);
  refusals_ = thread.refusals();
  const bool go = thread.granted() || settings_.best_effort;
  ready_.store(go ? 1 : -1);
  ready_.notify_all();
  if (!go) return;
  const image::Nanoseconds period = control_.cycle().period_ns();
  image::Nanoseconds base = clock_.now_ns() + 5 * period;
  for (std::int64_t n = 0; !stop_.load(std::memory_order_relaxed); ++n) {
    const image::Nanoseconds due = base + n * period;
    const image::Nanoseconds asked_late = control_.advance_world();
    clock_.sleep_until(due + asked_late);
    const image::Nanoseconds late = clock_.now_ns() - due;
    if (late > period) {
      overruns_.fetch_add(1, std::memory_order_relaxed);
      // Best effort on simulated drives is a demonstration: late cycles are counted, nothing can be hurt by
      // them.
      if (!settings_.best_effort || !control_.nothing_real()) control_.cycle().note_overrun(late);
      // Cycles that are lost are not made up for: the next one is a period after this one.
      base += late;
    }
    control_.open_cycle(clock_, due);
    if (!control_.cycle().step()) break;
    control_.watch_logic();
    after_(control_, late);
  }
}

void RealtimeLoop::add_refusals(bool started, std::vector<drivers::Notice>& refusals) const {
  for (const cycle::RealtimeRefusal& r : refusals_)
    if (started || r.needed)
      refusals.push_back({started ? &kWithout : &kRefused, {r.what, r.cause, r.remedy}});
}

void RealtimeLoop::stop() {
  stop_.store(true);
  if (cycle_thread_.joinable()) cycle_thread_.join();
  if (reader_thread_.joinable()) reader_thread_.join();
  watchdog_.reset();  // the last scan may have needed it
}

}  // namespace servogate::gateway
