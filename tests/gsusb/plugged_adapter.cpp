// SPDX-License-Identifier: Apache-2.0
#include "tests/gsusb/plugged_adapter.hpp"

#include <algorithm>
#include <chrono>

#include "drivers/clock.hpp"

namespace servogate::gsusb {
namespace {
std::uint32_t now_us() {
  return static_cast<std::uint32_t>(drivers::clock_ns(CLOCK_MONOTONIC) / image::kMicrosecond);
}
}  // namespace

bool PluggedPort::control_out(std::uint8_t request, std::uint16_t value, std::span<const std::uint8_t> data) {
  if (!plugged_->present) return false;
  return plugged_->with([&](SimulatedAdapter& a) { return a.take_request(request, value, data); });
}

std::size_t PluggedPort::control_in(std::uint8_t request, std::uint16_t value, std::span<std::uint8_t> data) {
  if (!plugged_->present) return 0;
  const auto answer =
      plugged_->with([&](SimulatedAdapter& a) { return a.answer_request(request, value, now_us()); });
  if (!answer) return 0;
  const std::size_t size = std::min(answer->size(), data.size());
  std::copy_n(answer->begin(), size, data.begin());
  return size;
}

bool PluggedPort::start(std::size_t bytes, PortListener& listener) {
  largest_ = bytes;
  listener_ = &listener;
  return plugged_->present;
}

bool PluggedPort::write(std::size_t slot, std::span<const std::uint8_t> bytes) noexcept {
  if (!plugged_->present) return false;
  plugged_->with([&](SimulatedAdapter& a) { a.take_bulk(bytes); });
  taken_.push_back(slot);
  return true;
}

bool PluggedPort::serve(image::Nanoseconds at_most) noexcept {
  for (; !taken_.empty(); taken_.pop_front()) listener_->written(taken_.front(), true);
  {
    // Nobody tells when something comes from the wire: it is looked for every millisecond.
    std::unique_lock hold(plugged_->mutex);
    plugged_->news.wait_for(hold, std::chrono::nanoseconds(std::min(at_most, image::kMillisecond)),
                            [this] { return plugged_->woken || !plugged_->present; });
    plugged_->woken = false;
  }
  if (!plugged_->present) return false;
  std::vector<SimulatedAdapter::Bytes> come;
  plugged_->with([&](SimulatedAdapter& a) {
    a.step(now_us());
    while (auto bytes = a.give_bulk()) come.push_back(std::move(*bytes));
  });
  for (const auto& bytes : come) listener_->read(std::span(bytes).first(std::min(bytes.size(), largest_)));
  return true;
}

void PluggedPort::wake() noexcept {
  {
    const std::lock_guard hold(plugged_->mutex);
    plugged_->woken = true;
  }
  plugged_->news.notify_all();
}

}  // namespace servogate::gsusb
