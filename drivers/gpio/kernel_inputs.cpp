// SPDX-License-Identifier: Apache-2.0
#include "drivers/gpio/kernel_inputs.hpp"

#include <fcntl.h>
#include <linux/gpio.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace servogate::gpio {

namespace {

constexpr std::size_t kAtOnce = 32;

std::uint64_t flags_of(const InputSetting& line) noexcept {
  std::uint64_t flags = GPIO_V2_LINE_FLAG_INPUT;
  if (line.edges) flags |= GPIO_V2_LINE_FLAG_EDGE_RISING | GPIO_V2_LINE_FLAG_EDGE_FALLING;
  switch (line.bias) {
    case Bias::off:
      return flags | GPIO_V2_LINE_FLAG_BIAS_DISABLED;
    case Bias::up:
      return flags | GPIO_V2_LINE_FLAG_BIAS_PULL_UP;
    case Bias::down:
      return flags | GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN;
    case Bias::as_is:
      break;
  }
  return flags;
}

/// Lines of the same flags share an attribute; there are no more kinds than the kernel has room for.
void put_flags(std::span<const InputSetting> lines, gpio_v2_line_config& config) noexcept {
  config.flags = GPIO_V2_LINE_FLAG_INPUT;
  for (std::size_t n = 0; n < lines.size(); ++n) {
    const std::uint64_t flags = flags_of(lines[n]);
    auto* const end = config.attrs + config.num_attrs;
    auto* const found = std::find_if(
        config.attrs, end, [&](const gpio_v2_line_config_attribute& a) { return a.attr.flags == flags; });
    if (found == end) {
      ++config.num_attrs;
      found->attr.id = GPIO_V2_LINE_ATTR_ID_FLAGS;
      found->attr.flags = flags;
    }
    found->mask |= std::uint64_t{1} << n;
  }
}

}  // namespace

KernelInputs::KernelInputs(int descriptor, std::span<const InputSetting> lines)
    : descriptor_(descriptor), count_(lines.size()) {
  for (std::size_t n = 0; n < count_; ++n) {
    offsets_[n] = lines[n].offset;
    mask_ |= std::uint64_t{1} << n;
    edges_ = edges_ || lines[n].edges;
  }
}

KernelInputs::~KernelInputs() { ::close(descriptor_); }

std::unique_ptr<InputLines> KernelInputs::request(const std::string& path,
                                                  std::span<const InputSetting> lines,
                                                  const std::string& consumer) {
  const int chip = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (chip < 0) return nullptr;
  gpio_v2_line_request request{};
  for (std::size_t n = 0; n < lines.size(); ++n) request.offsets[n] = lines[n].offset;
  consumer.copy(request.consumer, sizeof request.consumer - 1);
  request.num_lines = static_cast<std::uint32_t>(lines.size());
  request.event_buffer_size = kEventRoom;
  put_flags(lines, request.config);
  const int refused = ::ioctl(chip, GPIO_V2_GET_LINE_IOCTL, &request);
  const int error = errno;
  ::close(chip);
  errno = error;
  if (refused != 0) return nullptr;
  ::fcntl(request.fd, F_SETFL, ::fcntl(request.fd, F_GETFL) | O_NONBLOCK);
  return std::unique_ptr<InputLines>(new KernelInputs(request.fd, lines));
}

bool KernelInputs::read(std::uint64_t& levels) noexcept {
  gpio_v2_line_values values{};
  values.mask = mask_;
  if (::ioctl(descriptor_, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) return false;
  levels = values.bits & mask_;
  return true;
}

std::size_t KernelInputs::line_of(unsigned offset) const noexcept {
  const auto* const begin = offsets_.data();
  return static_cast<std::size_t>(std::find(begin, begin + count_, offset) - begin);
}

int KernelInputs::take(std::span<LineEvent> events) noexcept {
  std::array<gpio_v2_line_event, kAtOnce> raw;
  const std::size_t most = std::min(events.size(), raw.size());
  const ssize_t bytes = ::read(descriptor_, raw.data(), most * sizeof raw[0]);
  if (bytes < 0) return errno == EAGAIN || errno == EINTR ? 0 : -1;
  const auto count = static_cast<std::size_t>(bytes) / sizeof raw[0];
  for (std::size_t n = 0; n < count; ++n)
    events[n] = {line_of(raw[n].offset), raw[n].id == GPIO_V2_LINE_EVENT_RISING_EDGE,
                 static_cast<image::Nanoseconds>(raw[n].timestamp_ns), raw[n].line_seqno};
  return static_cast<int>(count);
}

}  // namespace servogate::gpio
