// SPDX-License-Identifier: Apache-2.0
#include "drivers/gsusb/gsusb_bus.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "drivers/bus_thread.hpp"
#include "drivers/clock.hpp"
#include "firmware_if/text/system_words.hpp"

namespace servogate::gsusb {
namespace {

using image::CanState;

const text::Entry kNoBitRate{"gsusb.no-bit-rate",
                             "the bit rate of {0} has to be said (--bit-rate 500000, or the bus of a machine "
                             "file): an adapter at a wrong rate disturbs the bus",
                             "для {0} нужно указать скорость (--bit-rate 500000 или шина файла машины): "
                             "адаптер с неверной скоростью мешает шине"};
const text::Entry kNoAnswer{"gsusb.no-answer",
                            "the adapter {0} does not answer as one of the gs_usb class ({1})",
                            "адаптер {0} не отвечает как адаптер класса gs_usb ({1})"};
const text::Entry kNoChannel{"gsusb.no-channel", "the adapter {0} has no channel {1}; it has {2}, from 0",
                             "у адаптера {0} нет канала {1}; каналов {2}, с нулевого"};
const text::Entry kNoTiming{"gsusb.no-timing", "the adapter {0} cannot make {1} bit/s of its clock of {2} Hz",
                            "адаптер {0} не может получить {1} бит/с из своей частоты {2} Гц"};
const text::Entry kNoListening{"gsusb.no-listening", "the adapter {0} cannot listen without taking part",
                               "адаптер {0} не умеет слушать, не участвуя"};
const text::Entry kNoStart{"gsusb.no-start", "the adapter {0} refuses {1} bit/s ({2})",
                           "адаптер {0} отказывается работать на {1} бит/с ({2})"};
const text::Entry kSystem{"gsusb.system", "{0}: {1}", "{0}: {1}"};

constexpr std::uint16_t kDevice = 1;  ///< wValue of requests to the whole device
constexpr std::uint8_t code(Request r) noexcept { return static_cast<std::uint8_t>(r); }

}  // namespace

bool is_no_timing(const drivers::Notice& why) noexcept { return why.entry == &kNoTiming; }

std::unique_ptr<GsUsbBus> GsUsbBus::open(std::unique_ptr<UsbPort> port, const GsUsbConfig& config,
                                         drivers::Notice& why) {
  if (config.bit_rate == 0) {
    why = {&kNoBitRate, {config.adapter}};
    return nullptr;
  }
  const int event = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (event < 0) {
    why = {&kSystem, {config.adapter, text::words_of(errno)}};
    return nullptr;
  }
  std::unique_ptr<GsUsbBus> bus(new GsUsbBus(std::move(port), config, event));
  if (!bus->start(why)) return nullptr;
  bus->thread_ = std::thread([b = bus.get()] { b->work(); });
  return bus;
}

GsUsbBus::GsUsbBus(std::unique_ptr<UsbPort> port, GsUsbConfig config, int event)
    : port_(std::move(port)), config_(std::move(config)), event_(event) {}

GsUsbBus::~GsUsbBus() {
  if (thread_.joinable()) {
    ending_ = true;
    port_->wake();
    thread_.join();
    if (state() != CanState::down) port_->control_out(code(Request::mode), config_.channel, mode(false, 0));
  }
  close(event_);
}

bool GsUsbBus::start(drivers::Notice& why) {
  const std::string rate = std::to_string(config_.bit_rate);
  std::array<std::uint8_t, 64> bytes{};
  const auto ask = [&](Request request, std::uint16_t value) {
    return std::span<const std::uint8_t>(bytes.data(), port_->control_in(code(request), value, bytes));
  };
  const auto no_answer = [&] {
    why = {&kNoAnswer, {config_.adapter, port_->failure()}};
    return false;
  };
  if (!port_->control_out(code(Request::host_format), kDevice, host_format())) return no_answer();
  const auto device = parse_device_config(ask(Request::device_config, kDevice));
  if (!device) return no_answer();
  device_ = *device;
  if (config_.channel >= device_.channels) {
    why = {&kNoChannel, {config_.adapter, std::to_string(config_.channel), std::to_string(device_.channels)}};
    return false;
  }
  const auto limits = parse_limits(ask(Request::limits, config_.channel));
  if (!limits) return no_answer();
  limits_ = *limits;
  const auto timing = find_timing(limits_.timing, config_.bit_rate);
  if (!timing) {
    why = {&kNoTiming, {config_.adapter, rate, std::to_string(limits_.timing.clock_hz)}};
    return false;
  }
  timing_ = *timing;
  if (config_.listen_only && (limits_.feature & feature::kListenOnly) == 0) {
    why = {&kNoListening, {config_.adapter}};
    return false;
  }
  if (port_->start(kStampedBytes, *this) && start_channel()) return true;
  why = {&kNoStart, {config_.adapter, rate, port_->failure()}};
  return false;
}

bool GsUsbBus::start_channel() {
  const std::uint32_t flags =
      (limits_.feature & feature::kHardwareTimestamp) | (config_.listen_only ? feature::kListenOnly : 0u);
  return port_->control_out(code(Request::mode), config_.channel, mode(false, 0)) &&
         port_->control_out(code(Request::bit_timing), config_.channel, bit_timing(timing_)) &&
         port_->control_out(code(Request::mode), config_.channel, mode(true, flags));
}

bool GsUsbBus::send(const image::CanFrame& frame) noexcept {
  if (frame.error || frame.fd || config_.listen_only) return false;
  const CanState now = state();
  if (now == CanState::down || now == CanState::bus_off || !outgoing_.try_enqueue(frame)) return false;
  port_->wake();
  return true;
}

bool GsUsbBus::receive(image::CanFrame& frame) noexcept {
  if (incoming_.try_dequeue(frame)) return true;
  std::uint64_t told;
  if (::read(event_, &told, sizeof told) < 0) return false;
  return incoming_.try_dequeue(frame);
}

std::optional<ControllerState> GsUsbBus::ask_state() {
  if ((limits_.feature & feature::kGetState) == 0 || state() == CanState::down) return std::nullopt;
  answer_.reset();
  asking_ = true;
  // The thread says that it ends before it answers for the last time.
  if (state() == CanState::down) return std::nullopt;
  port_->wake();
  asking_.wait(true);
  return answer_;
}

void GsUsbBus::work() noexcept {
  drivers::begin_bus_thread("gsusb");
  bool plugged = true;
  while (plugged && !ending_) {
    pump();
    plugged = port_->serve(10 * image::kMillisecond);
    restart_when_due();
    if (asking_) {
      std::array<std::uint8_t, kStateBytes> bytes{};
      const std::size_t got = port_->control_in(code(Request::get_state), config_.channel, bytes);
      answer_ = parse_state(std::span(bytes.data(), got));
      asking_ = false;
      asking_.notify_all();
    }
  }
  if (plugged) return;
  abandon(CanState::down);
  asking_ = false;
  asking_.notify_all();
  tell();
}

/// Hands frames on: from the caller's queue into priority order, from there to the adapter.
void GsUsbBus::pump() noexcept {
  if (state() == CanState::bus_off) return abandon(CanState::bus_off);
  image::CanFrame frame;
  while (queue_.size() < drivers::SendQueue::kCapacity && outgoing_.try_dequeue(frame)) queue_.push(frame);
  for (std::size_t i = 0; i < slots_.size() && !queue_.empty(); ++i) {
    Slot& slot = slots_[i];
    if (slot.in_pipe || slot.in_adapter) continue;
    std::array<std::uint8_t, kStampedBytes> bytes;
    const std::size_t size =
        encode(queue_.first(), static_cast<std::uint32_t>(i), config_.channel, limits_.feature, bytes);
    slot = {true, true};
    if (!port_->write(i, {bytes.data(), size})) {
      slot = {};
      return;
    }
    queue_.pop();
  }
}

void GsUsbBus::abandon(CanState state) noexcept {
  state_.store(state, std::memory_order_release);
  std::uint64_t thrown = queue_.clear();
  image::CanFrame frame;
  while (outgoing_.try_dequeue(frame)) ++thrown;
  for (Slot& slot : slots_) {
    thrown += slot.in_adapter ? 1 : 0;
    slot.in_adapter = false;
  }
  lost_.fetch_add(thrown, std::memory_order_relaxed);
}

void GsUsbBus::restart_when_due() noexcept {
  if (state() != CanState::bus_off || drivers::clock_ns(CLOCK_MONOTONIC) < restart_at_) return;
  abandon(CanState::bus_off);
  restart_at_ += kRestartAfter;
  if (!start_channel()) return;
  state_.store(CanState::error_active, std::memory_order_release);
  image::CanFrame frame = restarted();
  frame.timestamp_ns = drivers::clock_ns(CLOCK_MONOTONIC);
  deliver(frame);
}

void GsUsbBus::read(std::span<const std::uint8_t> bytes) noexcept {
  HostFrame in;
  if (!decode(bytes, stamped(), in) || in.channel != config_.channel) return;
  if (in.overflow) lost_.fetch_add(1, std::memory_order_relaxed);
  if (in.echo != HostFrame::kReceived) {
    if (in.echo < slots_.size()) slots_[in.echo].in_adapter = false;
    return;
  }
  const image::Nanoseconds arrival = drivers::clock_ns(CLOCK_MONOTONIC);
  in.frame.timestamp_ns = in.timestamp_us ? clock_.to_host(*in.timestamp_us, arrival) : arrival;
  if (in.frame.error) {
    const CanState before = state(), now = state_after(in.frame, before);
    state_.store(now, std::memory_order_release);
    if (now == CanState::bus_off) abandon(now);
    if (now == CanState::bus_off && before != now) restart_at_ = arrival + kRestartAfter;
  }
  deliver(in.frame);
}

void GsUsbBus::written(std::size_t slot, bool good) noexcept {
  slots_[slot].in_pipe = false;
  if (good || !slots_[slot].in_adapter) return;
  slots_[slot].in_adapter = false;
  lost_.fetch_add(1, std::memory_order_relaxed);
}

void GsUsbBus::deliver(const image::CanFrame& frame) noexcept {
  if (!incoming_.try_enqueue(frame)) lost_.fetch_add(1, std::memory_order_relaxed);
  tell();
}

void GsUsbBus::tell() noexcept {
  const std::uint64_t one = 1;
  if (::write(event_, &one, sizeof one) < 0) return;  // the counter is full: it is readable
}

}  // namespace servogate::gsusb
