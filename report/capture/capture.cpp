// SPDX-License-Identifier: Apache-2.0
#include "report/capture/capture.hpp"

#include <algorithm>
#include <cmath>

#include "report/capture/csv_capture.hpp"

namespace servogate::report {

namespace {

image::Nanoseconds nanoseconds(double seconds) {
  return static_cast<image::Nanoseconds>(std::llround(seconds * 1e9));
}

std::string words(const Trigger& trigger) {
  constexpr const char* kWords[] = {"<", "<=", ">", ">=", "=", "!=", ""};
  if (trigger.compare == Trigger::Compare::rises) return "alarm";
  std::string text = trigger.channel + ' ' + kWords[static_cast<std::size_t>(trigger.compare)] + ' ';
  append_number(text, trigger.value, "nan");
  return text;
}

}  // namespace

Capture::Capture(CaptureLayout layout, CaptureSettings settings, Open open)
    : layout_(std::move(layout)), settings_(std::move(settings)), open_(std::move(open)) {
  if (settings_.trigger) {
    const auto at =
        std::find_if(layout_.channels.begin(), layout_.channels.end(),
                     [&](const CaptureChannel& c) { return c.name == settings_.trigger->channel; });
    if (at != layout_.channels.end())
      watch_.emplace(*settings_.trigger, static_cast<std::size_t>(at - layout_.channels.begin()));
  }
  if (!watch_) return;
  const double period_s = static_cast<double>(layout_.period_ns) * 1e-9;
  rows_ = static_cast<std::size_t>(std::ceil(settings_.before_s / period_s)) + 1;
  ring_.resize(rows_ * layout_.channels.size());
  times_.resize(rows_);
}

std::span<const double> Capture::kept(std::size_t slot) const {
  const std::size_t n = layout_.channels.size();
  return std::span<const double>(ring_).subspan(slot * n, n);
}

void Capture::row(image::Nanoseconds t_ns, std::span<const double> values) {
  if (sink_ != nullptr && until_ns_ && t_ns > *until_ns_) close();
  if (!settings_.trigger && files_ == 0) open();
  if (sink_ != nullptr) sink_->row(t_ns, values);
  if (!watch_) return;
  const auto slot = static_cast<std::size_t>(count_++ % rows_);
  std::copy(values.begin(), values.end(),
            ring_.begin() + static_cast<std::ptrdiff_t>(slot * layout_.channels.size()));
  times_[slot] = t_ns;
  if (watch_->fires(values)) fire();
}

void Capture::frame(const CaptureFrame& frame) {
  if (sink_ != nullptr) sink_->frame(frame);
  if (!watch_ || files_ >= settings_.most) return;
  frames_.push_back(frame);
  const image::Nanoseconds oldest = frame.t_ns - nanoseconds(settings_.before_s);
  while (frames_.front().t_ns < oldest) frames_.pop_front();
}

/// At the newest row.
void Capture::fire() {
  const image::Nanoseconds now = times_[static_cast<std::size_t>((count_ - 1) % rows_)];
  if (sink_ == nullptr) {
    if (files_ >= settings_.most) return;
    open();
    // What was before is in the order of time: frames between the rows of their cycles.
    auto frame = frames_.begin();
    const std::uint64_t first = count_ > rows_ ? count_ - rows_ : 0;
    for (std::uint64_t n = first; n < count_; ++n) {
      const auto slot = static_cast<std::size_t>(n % rows_);
      for (; frame != frames_.end() && frame->t_ns <= times_[slot]; ++frame) sink_->frame(*frame);
      sink_->row(times_[slot], kept(slot));
    }
    for (; frame != frames_.end(); ++frame) sink_->frame(*frame);
  }
  sink_->note(now, words(*settings_.trigger));
  until_ns_ = now + nanoseconds(settings_.after_s);
}

void Capture::end() { close(); }

void Capture::open() {
  ++files_;
  sink_ = open_(files_);
  sink_->begin(layout_);
}

void Capture::close() {
  if (sink_ == nullptr) return;
  sink_->end();
  if (error_.empty()) error_ = sink_->error();
  sink_.reset();
  until_ns_.reset();
}

}  // namespace servogate::report
