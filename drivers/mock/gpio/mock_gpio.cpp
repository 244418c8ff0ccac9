// SPDX-License-Identifier: Apache-2.0
#include "drivers/mock/gpio/mock_gpio.hpp"

#include <algorithm>

namespace servogate::mock {

namespace {

template <typename T>
int find(const std::vector<T>& lines, std::string_view name) noexcept {
  for (std::size_t n = 0; n < lines.size(); ++n)
    if (lines[n].name == name) return static_cast<int>(n);
  return -1;
}

constexpr std::uint64_t kFlipsPerBounce = 24;

}  // namespace

MockGpio::MockGpio(std::vector<GpioInput> inputs, std::vector<GpioOutput> outputs, AxisPosition position,
                   int source)
    : inputs_(std::move(inputs)),
      outputs_(std::move(outputs)),
      position_(std::move(position)),
      source_(source) {
  lines_.resize(inputs_.size());
  for (std::size_t n = 0; n < inputs_.size(); ++n) {
    const image::Place& place = inputs_[n].place;
    random_.emplace_back(inputs_[n].bounce.seed);
    lines_[n].inverted = inputs_[n].inverted;
    if (place.packet != image::Packet::a || place.format != image::Format::bl) continue;
    if (place.byte() >= image::kPacketASize) continue;
    lines_[n].byte = place.byte();
    lines_[n].mask = static_cast<std::uint8_t>(1u << place.bit());
  }
  driven_.resize(outputs_.size());
  for (std::size_t n = 0; n < outputs_.size(); ++n) driven_[n] = outputs_[n].inverted;
  output_edges_.resize(outputs_.size());
}

bool MockGpio::contact(const GpioInput& input) const {
  if (const auto* set = std::get_if<SetInput>(&input.source)) return set->on;
  if (!position_) return false;
  if (const auto* limit = std::get_if<LimitSwitch>(&input.source)) {
    const double at = position_(limit->axis);
    return (limit->positive ? at >= limit->mm : at <= limit->mm) != input.inverted;
  }
  const auto& home = std::get<HomeSwitch>(input.source);
  const double at = position_(home.axis);
  return (at >= home.mm && at <= home.mm + home.width_mm) != input.inverted;
}

void MockGpio::move(Line& line, bool wanted, const Bounce& settings, std::mt19937_64& random,
                    image::Nanoseconds t) {
  if (!line.started) {
    line.started = true;
    line.contact = line.level = wanted;
    return;
  }
  const auto bounce = static_cast<std::uint64_t>(std::max<image::Nanoseconds>(settings.time_ns, 0));
  if (wanted != line.contact) {
    line.contact = wanted;
    line.settle_ns = t + static_cast<image::Nanoseconds>(
                             bounce == 0 ? 0 : bounce / 2 + random() % (bounce - bounce / 2) + 1);
    line.next_flip_ns = t;
  }
  while (line.next_flip_ns < line.settle_ns && line.next_flip_ns <= t) {
    line.level = !line.level;
    ++line.edges;
    const std::uint64_t step = bounce / kFlipsPerBounce + 1;
    line.next_flip_ns += static_cast<image::Nanoseconds>(step + random() % step);
  }
  if (t >= line.settle_ns && line.level != line.contact) {
    line.level = line.contact;
    ++line.edges;
  }
}

void MockGpio::advance_to(image::Nanoseconds t) {
  t_ns_ = std::max(t_ns_, t);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    Line& line = lines_[n];
    const bool wanted = line.forced ? line.forced_level : contact(inputs_[n]);
    if (!line.settled(wanted)) move(line, wanted, inputs_[n].bounce, random_[n], t_ns_);
  }
}

void MockGpio::receive(image::ProcessImage& image) noexcept {
  const bool known = source_ >= 0 && source_ < image::kMaxSources;
  if (!plugged_) {
    if (known) image.sources[static_cast<std::size_t>(source_)].quality = image::Quality::bad;
    return;
  }
  std::uint8_t* const packet_a = image.packets.data(image::Packet::a);
  for (std::size_t n = 0; n < lines_.size(); ++n) {
    const Line& line = lines_[n];
    const bool on = line.level != line.inverted;
    if (line.mask == 0) {
      image.packets.set_bit(inputs_[n].place, on);
      continue;
    }
    std::uint8_t& byte = packet_a[line.byte];
    byte = static_cast<std::uint8_t>(on ? byte | line.mask : byte & ~line.mask);
  }
  if (!known) return;
  image::IoSource& source = image.sources[static_cast<std::size_t>(source_)];
  source.quality = image::Quality::good;
  source.updated_ns = t_ns_;
}

void MockGpio::send(image::ProcessImage& image) noexcept {
  if (!plugged_) return;
  for (std::size_t n = 0; n < outputs_.size(); ++n) {
    const bool level = image.packets.bit(outputs_[n].place) != outputs_[n].inverted;
    if (level == driven_[n]) continue;
    driven_[n] = level;
    ++output_edges_[n];
  }
}

int MockGpio::input_index(std::string_view name) const noexcept { return find(inputs_, name); }
int MockGpio::output_index(std::string_view name) const noexcept { return find(outputs_, name); }

bool MockGpio::set_input(std::size_t n, bool on) {
  auto* set = n < inputs_.size() ? std::get_if<SetInput>(&inputs_[n].source) : nullptr;
  if (set != nullptr) set->on = on;
  return set != nullptr;
}

void MockGpio::force_input(std::size_t n, bool on) {
  lines_[n].forced = true;
  lines_[n].forced_level = on;
}

void MockGpio::release_input(std::size_t n) { lines_[n].forced = false; }
void MockGpio::set_bounce(std::size_t n, const Bounce& bounce) {
  inputs_[n].bounce = bounce;
  random_[n].seed(bounce.seed);
}

}  // namespace servogate::mock
